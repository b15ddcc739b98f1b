// What traces of version 1 and graphs do not say: slots, covisibility, the spanning tree, links in time, the database and the
// iterations, as ORB-SLAM2 makes them.
#include <algorithm>
#include <map>
#include <utility>

#include "session.hpp"

namespace replay {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

constexpr int strong = 15;  // shared points that make a neighbour a neighbour from both sides
constexpr std::int64_t graph_frame = 100000;  // microseconds: graphs have no times

class objects {
 public:
  objects(const trace& from, session& s)
      : from_(from), s_(s), keyframes_(at(from.keyframes)), points_(at(from.points)) {
    for (const trace_event& e : from.events) {
      if (e.letter == 'o') {
        int& n = keyframes_[at(e.a)].features;
        n = std::max(n, e.c + 1);
      }
      if (e.letter == 'K' && from.format == trace_format::objects) {
        int& n = keyframes_[at(e.a)].features;
        n = std::max(n, e.c);
        made_of_[e.b].push_back(e.a);
      }
    }
  }

  void add() {
    for (const trace_event& e : from_.events) {
      thread_ = e.thread;
      if (from_.format == trace_format::graph)
        graph(e);
      else
        event(e);
    }
    end_iteration();
    end_frame();
  }

 private:
  struct keyframe {
    int features = 0, parent = -1, previous = -1, next = -1;
    bool made = false, inserted = false, bad = false, connected = false;
    std::map<int, int> slots;    // index: point
    std::map<int, int> weights;  // neighbour: weight
    std::map<int, char> children;
  };
  struct point {
    bool made = false, bad = false;
    std::map<int, int> seen;  // keyframe: index
  };

  void step_of(step_kind kind, int thread, int a, int b = -1, int c = -1, int d = -1) {
    s_.steps.push_back({kind, static_cast<std::uint8_t>(thread), time_, a, b, c, d});
  }
  void now(step_kind kind, int a, int b = -1, int c = -1, int d = -1) {
    step_of(kind, thread_, a, b, c, d);
  }

  void event(const trace_event& e) {
    if (e.letter == 'F') {
      end_frame();
      time_ = e.time;
      begin_frame(e.a);
      return;
    }
    const bool starts = e.letter == 'o' && !keyframes_[at(e.a)].inserted && current_ != e.a;
    if (thread_ == local_mapping && (current_ < 0 || starts))
      begin_iteration(e.letter == 'o' || e.letter == 'K' ? e.a : -1);
    switch (e.letter) {
      case 'K':
        if (!keyframes_[at(e.a)].inserted) insert(e.a);
        break;
      case 'P':
        make_point(e.a);
        now(step_kind::insert_point, e.a);
        break;
      case 'o':
        observe(e.a, e.b, e.c, e.d);
        break;
      case 'X':
        unobserve(e.a, e.b, true);
        break;
      case 'R':
        now(step_kind::replace, e.a, e.b);
        forget(e.a);
        break;
      case 'B':
        forget(e.a);
        now(step_kind::mark_point, e.a);
        break;
      case 'D':
        cull(e.a);
        break;
      default:
        now(step_kind::corrected, e.a, e.b);
        break;
    }
  }
  void graph(const trace_event& e) {
    if (e.letter == 'K') {
      end_iteration();
      end_frame();
      time_ = graph_frame * frame_count_;
      begin_frame(frame_count_++);
      make_keyframe(e.a);
      end_frame();
      thread_ = local_mapping;
      begin_iteration(e.a);
      return;
    }
    thread_ = local_mapping;
    const bool is_new = !points_[at(e.b)].made;
    observe(e.a, e.b, e.c, e.d);
    if (is_new) now(step_kind::insert_point, e.b);
  }

  // ---- threads

  void begin_frame(int frame) {
    frame_ = frame;
    step_of(step_kind::frame_begin, tracking, frame);
  }
  void end_frame() {
    if (frame_ < 0) return;
    const auto made = made_of_.find(frame_);
    if (made != made_of_.end())
      for (const int kf : made->second) make_keyframe(kf);
    if (newest_ >= 0) step_of(step_kind::reference, tracking, frame_, newest_);
    step_of(step_kind::frame_end, tracking, frame_);
    frame_ = -1;
  }
  void begin_iteration(int kf) {
    end_iteration();
    current_ = kf < 0 ? newest_ : kf;
    if (current_ >= 0) make_keyframe(current_);
    step_of(step_kind::iteration_begin, local_mapping, current_);
    in_iteration_ = true;
  }
  // Mapping hands its keyframe over to loop closing, which puts it into the database.
  void end_iteration() {
    if (!std::exchange(in_iteration_, false)) return;
    const int thread = std::exchange(thread_, static_cast<int>(local_mapping));
    const int kf = current_;
    if (kf >= 0 && !keyframes_[at(kf)].bad) {
      if (!keyframes_[at(kf)].inserted) insert(kf);
      update_connections(kf);
    }
    step_of(step_kind::iteration_end, local_mapping, kf);
    if (kf >= 0 && !keyframes_[at(kf)].bad) {
      step_of(step_kind::iteration_begin, loop_closing, kf);
      step_of(step_kind::database_add, loop_closing, kf);
      step_of(step_kind::iteration_end, loop_closing, kf);
    }
    current_ = -1;
    thread_ = thread;
  }

  // ---- keyframes and points

  // Tracking makes keyframes, whoever names them first.
  void make_keyframe(int kf) {
    keyframe& k = keyframes_[at(kf)];
    if (std::exchange(k.made, true)) return;
    step_of(step_kind::make_keyframe, tracking, kf, frame_, k.features);
    k.previous = newest_;
    if (newest_ >= 0) {
      keyframe& before = keyframes_[at(newest_)];
      before.next = kf;
      step_of(step_kind::temporal, tracking, newest_, before.previous, kf);
      step_of(step_kind::temporal, tracking, kf, newest_, -1);
    }
    newest_ = kf;
  }
  void insert(int kf) {
    make_keyframe(kf);
    if (thread_ == local_mapping) update_connections(kf);
    keyframes_[at(kf)].inserted = true;
    now(step_kind::insert_keyframe, kf);
  }
  void make_point(int p) {
    if (!std::exchange(points_[at(p)].made, true)) now(step_kind::make_point, p);
  }
  void observe(int kf, int p, int index, int octave) {
    make_keyframe(kf);
    make_point(p);
    points_[at(p)].seen[kf] = index;
    keyframes_[at(kf)].slots[index] = p;
    now(step_kind::observe, kf, p, index, octave);
    now(step_kind::set_slot, kf, index, p);
  }
  void unobserve(int kf, int p, bool slot) {
    auto& seen = points_[at(p)].seen;
    const auto found = seen.find(kf);
    if (found == seen.end()) return;
    auto& slots = keyframes_[at(kf)].slots;
    const auto held = slots.find(found->second);
    if (slot && held != slots.end() && held->second == p) {
      now(step_kind::clear_slot, kf, found->second);
      slots.erase(held);
    }
    now(step_kind::unobserve, kf, p);
    seen.erase(found);
  }
  void forget(int p) {
    points_[at(p)].bad = true;
    const auto seen = points_[at(p)].seen;
    for (const auto& of : seen) unobserve(of.first, p, true);
  }

  // KeyFrame::SetBadFlag: neighbours that this one does not know keep it, as do its points' empty slots.
  void cull(int kf) {
    make_keyframe(kf);
    keyframe& k = keyframes_[at(kf)];
    for (const auto& neighbour : k.weights)
      if (keyframes_[at(neighbour.first)].weights.erase(kf) != 0) {
        now(step_kind::disconnect, neighbour.first, kf);
        now(step_kind::order, neighbour.first);
      }
    const auto slots = k.slots;
    for (const auto& slot : slots) unobserve(kf, slot.second, false);
    for (const auto& neighbour : std::exchange(k.weights, {}))
      now(step_kind::disconnect, kf, neighbour.first);
    now(step_kind::order, kf);
    for (const auto& child : std::exchange(k.children, {})) {
      now(step_kind::erase_child, kf, child.first);
      set_parent(child.first, k.parent);
    }
    if (k.parent >= 0 && keyframes_[at(k.parent)].children.erase(kf) != 0)
      now(step_kind::erase_child, k.parent, kf);
    k.bad = true;
    now(step_kind::mark_keyframe, kf);
    now(step_kind::database_erase, kf);
  }
  void set_parent(int kf, int parent) {
    keyframes_[at(kf)].parent = parent;
    now(step_kind::parent, kf, parent);
    if (parent < 0) return;
    keyframes_[at(parent)].children[kf] = 1;
    now(step_kind::add_child, parent, kf);
  }

  // KeyFrame::UpdateConnections: all with whom it shares a point become keys here; this becomes a key of the strong ones.
  void update_connections(int kf) {
    keyframe& k = keyframes_[at(kf)];
    std::map<int, int> shared;
    for (const auto& slot : k.slots) {
      const point& p = points_[at(slot.second)];
      if (p.bad) continue;
      for (const auto& of : p.seen)
        if (of.first != kf && !keyframes_[at(of.first)].bad) ++shared[of.first];
    }
    if (shared.empty()) return;
    int best = shared.begin()->first;
    for (const auto& x : shared)
      if (x.second > shared[best]) best = x.first;
    for (const auto& x : shared) {
      if (x.second < strong && !(x.first == best && shared[best] < strong)) continue;
      int& weight = keyframes_[at(x.first)].weights[kf];
      if (std::exchange(weight, x.second) == x.second) continue;
      now(step_kind::connect, x.first, kf, x.second);
      now(step_kind::order, x.first);
    }
    for (const auto& old : k.weights)
      if (shared.count(old.first) == 0) now(step_kind::disconnect, kf, old.first);
    for (const auto& x : shared) {
      const auto old = k.weights.find(x.first);
      if (old == k.weights.end() || old->second != x.second)
        now(step_kind::connect, kf, x.first, x.second);
    }
    k.weights = shared;
    now(step_kind::order, kf);
    if (!std::exchange(k.connected, true) && kf != 0) set_parent(kf, best);
  }

  const trace& from_;
  session& s_;
  std::vector<keyframe> keyframes_;
  std::vector<point> points_;
  std::map<int, std::vector<int>> made_of_;  // frame: keyframes
  std::int64_t time_ = 0;
  int thread_ = 0, frame_ = -1, frame_count_ = 0, newest_ = -1, current_ = -1;
  bool in_iteration_ = false;
};

}  // namespace

void add_steps_of_objects(const trace& from, session& s) { objects(from, s).add(); }

}  // namespace replay
