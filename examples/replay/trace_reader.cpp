// Reads traces line by line, and refuses what does not follow docs/trace-format.md.
#include <charconv>
#include <string_view>
#include <utility>

#include "line_fields.hpp"
#include "line_source.hpp"
#include "trace.hpp"

namespace replay {
namespace {

class reader {
 public:
  explicit reader(line_source& lines) : lines_(lines) { t_.name = lines.name(); }

  trace read() {
    std::string line;
    while (lines_.next(line)) {
      try {
        take(line);
      } catch (const std::string& reason) {
        throw bad_trace(lines_.name(), lines_.number(), reason);
      }
    }
    finish();
    return std::move(t_);
  }

 private:
  enum state : char { unknown, named, made, inserted, marked };
  struct known {
    state is = unknown;
    int line = 0;  // where it was named first
    int slots = 0;
  };

  void take(const std::string& line) {
    fields in(line);
    if (!in.more()) return;
    if (line[0] == '#') return comment(line);
    const std::string_view letter = in.word("the letter");
    if (letter.size() != 1) throw "no event: '" + std::string(letter) + "'";
    if (!has_format_) detect(letter[0], in);
    e_ = trace_event{letter[0], 0, lines_.number(), 0};
    switch (t_.format) {
      case trace_format::edges:
        edges(in);
        break;
      case trace_format::objects:
        objects(in);
        break;
      case trace_format::graph:
        graph(in);
        break;
    }
    in.end();
    t_.events.push_back(e_);
  }

  void comment(const std::string& line) {
    constexpr std::string_view mark = "# slamtrace ";
    if (line.compare(0, mark.size(), mark) != 0) {
      if (t_.about.empty())
        t_.about = line.substr(line.find_first_not_of("# ") == std::string::npos
                                   ? line.size()
                                   : line.find_first_not_of("# "));
      return;
    }
    if (has_format_) throw std::string("the version is not on the first line");
    fields in(line);
    in.word("#");
    in.word("slamtrace");
    const std::string version(in.word("the version"));
    if (version == "1")
      t_.format = trace_format::objects;
    else if (version == "2")
      t_.format = trace_format::edges;
    else if (version == "graph")
      t_.format = trace_format::graph;
    else
      throw "version '" + version + "' of the format is not known";
    has_format_ = true;
    if (in.more()) t_.about = line.substr(line.find(version) + version.size() + 1);
  }
  // Without a version: a graph begins with a keyframe, a list of events with a frame.
  void detect(char letter, fields in) {
    int n = 0;
    while (in.more()) {
      in.word("");
      ++n;
    }
    if (letter == 'F')
      t_.format = trace_format::objects;
    else if (letter == 'K' && (n == 1 || n == 8))
      t_.format = trace_format::graph;
    else
      throw std::string(
          "neither a trace nor a graph: there is no '# slamtrace' line, and no event that could "
          "come first");
    has_format_ = true;
  }

  // ---- what is known of the ids

  template <class Known>
  static Known& at(std::vector<Known>& all, int id) {
    const auto i = static_cast<std::size_t>(id);
    // Ids are consecutive numbers: a leap is a mistake, and would need the memory of all between.
    if (i >= all.size() + 1000000) throw "id " + std::to_string(id) + " leaps ahead";
    if (i >= all.size()) all.resize(i + 1);
    return all[i];
  }
  known& keyframe(int id, state least) { return known_as(keyframes_, id, least, "keyframe"); }
  known& point(int id, state least) { return known_as(points_, id, least, "point"); }
  known& known_as(std::vector<known>& all, int id, state least, const char* what) {
    known& k = at(all, id);
    if (k.is < least) throw std::string(what) + " " + std::to_string(id) + " was not made before";
    if (k.is == unknown) k = {named, lines_.number(), 0};
    return k;
  }
  void make(std::vector<known>& all, int id, const char* what) {
    known& k = at(all, id);
    if (k.is >= made) throw std::string(what) + " " + std::to_string(id) + " was made before";
    k = {made, k.line != 0 ? k.line : lines_.number(), k.slots};
  }
  static void insert(known& k, int id, const char* what) {
    if (k.is == marked)
      throw std::string(what) + " " + std::to_string(id) + " is inserted after it was marked";
    if (k.is == inserted)
      throw std::string(what) + " " + std::to_string(id) + " is inserted a second time";
    k.is = inserted;
  }

  // ---- version 2

  void edges(fields& in) {
    e_.time = in.integer("the time", 0, std::int64_t{1} << 60);
    e_.thread = static_cast<std::uint8_t>(in.integer("the thread", 0, most_threads - 1));
    switch (e_.letter) {
      case 'F':
        e_.a = in.id("the frame");
        if (e_.thread != tracking) throw std::string("a frame on another thread than 0");
        if (frame_ >= 0) throw "frame " + std::to_string(frame_) + " has not ended";
        frame_ = e_.a;
        break;
      case 'E':
        e_.a = in.id("the frame");
        if (frame_ != e_.a) throw "frame " + std::to_string(e_.a) + " ends and has not begun";
        frame_ = -1;
        break;
      case 'S':
      case 'Z': {
        bool& open = open_[e_.thread];
        if (e_.thread == tracking) throw std::string("S and Z are for other threads than 0");
        if (open == (e_.letter == 'S'))
          throw std::string(open ? "the last iteration has not ended" : "no iteration has begun");
        open = !open;
        break;
      }
      case 'k': {
        e_.a = in.id("the keyframe");
        e_.b = in.id("the frame");
        e_.c = static_cast<int>(in.integer("the number of features", 0, 1 << 20));
        make(keyframes_, e_.a, "keyframe");
        at(keyframes_, e_.a).slots = e_.c;
        break;
      }
      case 'K':
        e_.a = in.id("the keyframe");
        insert(keyframe(e_.a, made), e_.a, "keyframe");
        break;
      case 'p':
        e_.a = in.id("the point");
        make(points_, e_.a, "point");
        break;
      case 'P':
        e_.a = in.id("the point");
        insert(point(e_.a, made), e_.a, "point");
        break;
      case 'O':
        kf_point(in);
        index(e_.c = in.id("the index"));
        e_.d = static_cast<int>(in.integer("the octave", 0, 63));
        break;
      case 'X':
        kf_point(in);
        break;
      case 's':
        e_.a = in.id("the keyframe");
        keyframe(e_.a, made);
        index(e_.b = in.id("the index"));
        e_.c = in.id("the point");
        point(e_.c, made);
        break;
      case 'z':
        e_.a = in.id("the keyframe");
        keyframe(e_.a, made);
        index(e_.b = in.id("the index"));
        break;
      case 'C':
        kf_kf(in);
        e_.c = static_cast<int>(in.integer("the weight", 0, 1 << 30));
        break;
      case 'T':
        e_.a = in.id("the keyframe");
        keyframe(e_.a, made);
        if ((e_.b = in.id_or_none("the parent")) >= 0) keyframe(e_.b, made);
        break;
      case 'N':
        e_.a = in.id("the keyframe");
        keyframe(e_.a, made);
        if ((e_.b = in.id_or_none("the previous keyframe")) >= 0) keyframe(e_.b, made);
        if ((e_.c = in.id_or_none("the next keyframe")) >= 0) keyframe(e_.c, made);
        break;
      case 'c':
      case 'H':
      case 'h':
      case 'G':
      case 'g':
      case 'L':
        kf_kf(in);
        break;
      case 'Q':
      case 'q':
        e_.a = in.id("the keyframe");
        keyframe(e_.a, made);
        break;
      case 'D':
        mark_keyframe(in);
        break;
      case 'R':
        replace(in, made);
        break;
      case 'B':
        e_.a = in.id("the point");
        point(e_.a, made).is = marked;
        break;
      case 'r':
        e_.a = in.id("the frame");
        e_.b = in.id("the keyframe");
        keyframe(e_.b, made);
        break;
      case 'm': {
        e_.a = in.id("the frame");
        list(
            in, [this](int id) { point(id, made); }, "the point");
        in_frame();
        break;
      }
      case 'l':
        e_.a = in.id("the frame");
        list(
            in, [this](int id) { keyframe(id, made); }, "the keyframe");
        e_.d = in.id("the number of points");
        in_frame();
        break;
      default:
        throw std::string("there is no event '") + e_.letter + "' in version 2";
    }
  }
  void kf_point(fields& in) {
    e_.a = in.id("the keyframe");
    e_.b = in.id("the point");
    keyframe(e_.a, made);
    point(e_.b, made);
  }
  void kf_kf(fields& in) {
    e_.a = in.id("the keyframe");
    e_.b = in.id("the other keyframe");
    keyframe(e_.a, made);
    keyframe(e_.b, made);
  }
  void index(int i) {
    const int n = at(keyframes_, e_.a).slots;
    if (i >= n)
      throw "keyframe " + std::to_string(e_.a) + " has " + std::to_string(n) +
          " features, no number " + std::to_string(i);
  }
  void in_frame() {
    if (frame_ != e_.a) throw "frame " + std::to_string(e_.a) + " is not the current one";
  }
  template <class Check>
  void list(fields& in, Check check, const char* what) {
    e_.c = static_cast<int>(in.integer("the number", 0, 1 << 20));
    e_.b = static_cast<int>(t_.lists.size());
    for (int i = 0; i != e_.c; ++i) {
      const int id = in.id(what);
      check(id);
      t_.lists.push_back(id);
    }
  }
  void mark_keyframe(fields& in) {
    e_.a = in.id("the keyframe");
    known& k = keyframe(e_.a, made);
    if (k.is == marked) throw "keyframe " + std::to_string(e_.a) + " was marked before";
    k.is = marked;
  }
  void replace(fields& in, state least) {
    e_.a = in.id("the point");
    e_.b = in.id("the new point");
    if (e_.a == e_.b) throw std::string("a point is replaced by itself");
    point(e_.a, least).is = marked;
    point(e_.b, least);
  }

  // ---- version 1: the thread comes last

  void objects(fields& in) {
    switch (e_.letter) {
      case 'F':
        e_.a = in.id("the frame");
        e_.time = microseconds(in.seconds("the time"));
        if (e_.a <= frame_) throw std::string("the frame is not later than the last");
        frame_ = e_.a;
        break;
      case 'K': {
        e_.a = in.id("the keyframe");
        known& k = keyframe(e_.a, unknown);
        if (k.is == marked)
          throw "keyframe " + std::to_string(e_.a) + " is inserted after it was marked";
        // The first one is announced twice.
        if (k.is >= made && e_.a != 0)
          throw "keyframe " + std::to_string(e_.a) + " is inserted a second time";
        k.is = inserted;
        e_.time = microseconds(in.seconds("the time"));
        pose(in);
        k.slots = e_.c = static_cast<int>(in.integer("the number of features", 0, 1 << 20));
        std::string_view frame = in.word("the frame");
        if (frame.front() != 'f')
          throw std::string("the frame has no f: '") + std::string(frame) + "'";
        frame.remove_prefix(1);
        const auto end = std::from_chars(frame.data(), frame.data() + frame.size(), e_.b);
        if (end.ec != std::errc() || end.ptr != frame.data() + frame.size() || e_.b < 0)
          throw std::string("the frame is no number");
        break;
      }
      case 'P': {
        e_.a = in.id("the point");
        known& p = point(e_.a, unknown);
        if (p.is >= made) throw "point " + std::to_string(e_.a) + " was made before";
        p.is = made;
        auto& at_point = at(t_.positions, e_.a);
        for (float& x : at_point) x = in.real("the position");
        break;
      }
      case 'O':
      case 'o':
        e_.a = in.id("the keyframe");
        e_.b = in.id("the point");
        keyframe(e_.a, unknown);
        if (point(e_.b, unknown).is == marked)
          throw "point " + std::to_string(e_.b) + " is observed after it was removed";
        if (e_.letter == 'O') {  // the position in the image tells features apart
          const float u = in.real("the position"), v = in.real("the position");
          e_.c = feature(e_.a, u, v);
          e_.letter = 'o';
        } else {
          e_.c = static_cast<int>(in.integer("the index", 0, 1 << 20));
        }
        e_.d = static_cast<int>(in.integer("the octave", 0, 63));
        break;
      case 'X':
        e_.a = in.id("the keyframe");
        e_.b = in.id("the point");
        keyframe(e_.a, named);
        point(e_.b, named);
        break;
      case 'R':
        e_.a = in.id("the point");
        e_.b = in.id("the new point");
        if (e_.a == e_.b) throw std::string("a point is replaced by itself");
        point(e_.a, named);
        point(e_.b, named);
        break;
      case 'B': {
        e_.a = in.id("the point");
        known& p = point(e_.a, named);
        if (p.is == marked) throw "point " + std::to_string(e_.a) + " was removed before";
        p.is = marked;
        break;
      }
      case 'D':
        mark_keyframe(in);
        break;
      case 'L':
        e_.a = in.id("the keyframe");
        e_.b = in.id("the other keyframe");
        keyframe(e_.a, named);
        keyframe(e_.b, named);
        break;
      default:
        throw std::string("there is no event '") + e_.letter + "' in version 1";
    }
    e_.thread = static_cast<std::uint8_t>(in.integer("the thread", 0, most_threads - 1));
  }
  std::int64_t microseconds(double seconds) {
    if (first_ < 0) first_ = seconds;
    if (seconds < first_) throw std::string("the time is before the first one");
    return static_cast<std::int64_t>((seconds - first_) * 1e6);
  }
  void pose(fields& in) {
    auto& p = at(t_.poses, e_.a);
    for (float& x : p) x = in.real("the pose");
    at(t_.has_pose, e_.a) = 1;
  }
  int feature(int kf, float u, float v) {
    auto& of = at(features_, kf);
    for (std::size_t i = 0; i != of.size(); ++i)
      if (of[i] == std::make_pair(u, v)) return static_cast<int>(i);
    of.emplace_back(u, v);
    return static_cast<int>(of.size()) - 1;
  }

  // ---- graphs

  void graph(fields& in) {
    e_.a = in.id("the keyframe");
    if (e_.letter == 'K') {
      known& k = keyframe(e_.a, unknown);
      if (k.is >= made) throw "keyframe " + std::to_string(e_.a) + " was made before";
      k.is = made;
      if (in.more()) pose(in);
    } else if (e_.letter == 'O') {
      keyframe(e_.a, made);
      e_.b = in.id("the point");
      point(e_.b, unknown).is = made;
      const float u = in.real("the position"), v = in.real("the position");
      e_.letter = 'o';
      e_.c = feature(e_.a, u, v);
      e_.d = in.more() ? static_cast<int>(in.integer("the octave", 0, 63)) : 0;
    } else {
      throw std::string("there is no event '") + e_.letter + "' in a graph";
    }
  }

  void finish() {
    if (t_.events.empty()) throw bad_trace(lines_.name(), lines_.number(), "no event");
    for (std::size_t i = 0; i != keyframes_.size(); ++i)
      if (keyframes_[i].is == named)
        throw bad_trace(lines_.name(), keyframes_[i].line,
                        "keyframe " + std::to_string(i) + " is made nowhere");
    for (std::size_t i = 0; i != points_.size(); ++i)
      if (points_[i].is == named)
        throw bad_trace(lines_.name(), points_[i].line,
                        "point " + std::to_string(i) + " is made nowhere");
    t_.keyframes = static_cast<int>(keyframes_.size());
    t_.points = static_cast<int>(points_.size());
  }

  line_source& lines_;
  trace t_;
  trace_event e_{};
  bool has_format_ = false;
  int frame_ = -1;
  double first_ = -1;
  bool open_[most_threads] = {};
  std::vector<known> keyframes_, points_;
  std::vector<std::vector<std::pair<float, float>>> features_;  // by keyframe: where
};

}  // namespace

trace read_trace(const std::string& path) {
  line_source lines = line_source::of_file(path);
  return reader(lines).read();
}
trace read_trace(const std::string& name, const std::string& content) {
  line_source lines = line_source::of_memory(name, content);
  return reader(lines).read();
}

}  // namespace replay
