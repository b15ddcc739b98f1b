// A recorded SLAM session as a list of events: what happened to keyframes, slots, observations and points, and when a
// culling pass was due. Reads graphs and event traces of ORB-SLAM2 and ORB-SLAM3, compressed ones if zlib is there.
#pragma once

#include <cstdio>
#include <fstream>
#include <functional>
#include <istream>
#include <sstream>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#if RECORDED_SESSION_ZLIB
#include <zlib.h>
#endif

struct recorded_event {
  enum kind {
    new_keyframe,
    set_slot,
    clear_slot,
    observe,
    unobserve,
    mark_bad,
    remove_keyframe,
    pass
  };
  kind what;
  int keyframe = -1;
  int point = -1;
  int slot = -1;
};

class recorded_session {
 public:
  std::vector<recorded_event> events;
  std::vector<std::vector<int>> levels;  // by keyframe and slot
  int points = 0;

  // Whether the file could be read.
  bool load(const std::string& path) {
#if RECORDED_SESSION_ZLIB
    const gzFile file = gzopen(path.c_str(), "rb");  // plain files, too
    if (file == nullptr) return false;
    char line[4096];
    bool whole = true;  // only the beginning of a line counts: no event is long
    while (gzgets(file, line, sizeof line) != nullptr) {
      if (std::exchange(whole, std::string(line).back() == '\n')) parse(line);
    }
    gzclose(file);
#else
    std::ifstream file(path);
    if (!file) return false;
    for (std::string line; std::getline(file, line);) parse(line);
#endif
    finish();
    return !events.empty();
  }
  void load(std::istream& in) {
    for (std::string line; std::getline(in, line);) parse(line);
    finish();
  }

 private:
  using kind = recorded_event::kind;

  void parse(const std::string& line) {
    if (line.compare(0, 12, "# slamtrace ") == 0) timed_ = true;
    std::istringstream in(line);
    std::string letter;
    if (!(in >> letter) || letter.size() != 1 || letter[0] == '#') return;
    timed_ ? parse_timed(letter[0], in) : parse_plain(letter[0], in);
  }

  // ORB-SLAM3, format 2: slots and observations are events of their own.
  void parse_timed(char letter, std::istream& in) {
    long time = 0;
    int thread = 0, a = -1, b = -1, c = -1, d = -1;
    in >> time >> thread >> a >> b >> c >> d;
    switch (letter) {
      case 'k':
        keyframe(a);
        slot_level(a, c - 1, 0);
        break;
      case 'K':
        current_ = a;
        break;
      case 's':
        add(kind::set_slot, a, c, b);
        break;
      case 'z':
        add(kind::clear_slot, a, -1, b);
        break;
      case 'O':
        slot_level(a, c, d);
        add(kind::observe, a, b, c);
        break;
      case 'X':
        add(kind::unobserve, a, b);
        break;
      case 'R':
      case 'B':
        add(kind::mark_bad, -1, a);
        break;
      case 'D':
        add(kind::remove_keyframe, a);
        break;
      case 'Z':
        if (thread == 1) pass();
        break;
      default:
        break;
    }
  }

  // Graphs, and ORB-SLAM2 (format 1): an observation is a slot as well, the next free one of its keyframe.
  void parse_plain(char letter, std::istream& in) {
    int a = -1, b = -1, level = 0;
    double u = 0, v = 0;
    in >> a;
    switch (letter) {
      case 'K':
        if (current_ != a) pass();
        keyframe(a);
        current_ = a;
        break;
      case 'O':
        in >> b >> u >> v >> level;
        keyframe(a);
        if (slots_of_[b].count(a) == 0) {
          const int slot = slot_level(a, static_cast<int>(levels[at(a)].size()), in ? level : 0);
          slots_of_[b][a] = slot;
          points_of_[a].push_back(b);
          add(kind::observe, a, b, slot);
          add(kind::set_slot, a, b, slot);
        }
        break;
      case 'X':
        in >> b;
        unlink(a, b);
        break;
      case 'R':
      case 'B':
        add(kind::mark_bad, -1, a);
        for (const auto& s : slots_of_[a]) add(kind::clear_slot, s.first, -1, s.second);
        slots_of_.erase(a);
        break;
      case 'D':
        for (const int p : points_of_[a]) unlink(a, p, true);
        add(kind::remove_keyframe, a);
        break;
      default:
        break;
    }
  }
  void unlink(int k, int p, bool keep_slot = false) {
    const auto it = slots_of_.find(p);
    if (it == slots_of_.end() || it->second.count(k) == 0) return;
    add(kind::unobserve, k, p);
    if (!keep_slot) add(kind::clear_slot, k, -1, it->second[k]);
    it->second.erase(k);
  }

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  void add(kind what, int k, int p = -1, int slot = -1) {
    events.push_back({what, k, p, slot});
    if (p >= points) points = p + 1;
  }
  void keyframe(int k) {
    if (at(k) >= levels.size()) levels.resize(at(k) + 1);
    if (at(k) >= known_.size()) known_.resize(at(k) + 1);
    if (!known_[at(k)]) add(kind::new_keyframe, k);
    known_[at(k)] = true;
  }
  int slot_level(int k, int slot, int level) {
    auto& of = levels[at(k)];
    if (slot >= static_cast<int>(of.size())) of.resize(at(slot) + 1);
    if (slot >= 0 && level != 0) of[at(slot)] = level;
    return slot;
  }
  void pass() {
    if (current_ >= 0) add(kind::pass, std::exchange(current_, -1));
  }
  void finish() {
    pass();
    slots_of_.clear();
    points_of_.clear();
  }

  bool timed_ = false;
  int current_ = -1;
  std::vector<char> known_;
  std::unordered_map<int, std::unordered_map<int, int>> slots_of_;  // point: keyframe: slot
  std::unordered_map<int, std::vector<int>> points_of_;
};
