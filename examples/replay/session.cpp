#include "session.hpp"

#include <algorithm>
#include <map>
#include <utility>

namespace replay {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

step from_edges(const trace_event& e) {
  using k = step_kind;
  step_kind kind = k::corrected;
  switch (e.letter) {
    case 'F':
      kind = k::frame_begin;
      break;
    case 'E':
      kind = k::frame_end;
      break;
    case 'S':
      kind = k::iteration_begin;
      break;
    case 'Z':
      kind = k::iteration_end;
      break;
    case 'k':
      kind = k::make_keyframe;
      break;
    case 'K':
      kind = k::insert_keyframe;
      break;
    case 'p':
      kind = k::make_point;
      break;
    case 'P':
      kind = k::insert_point;
      break;
    case 'O':
      kind = k::observe;
      break;
    case 'X':
      kind = k::unobserve;
      break;
    case 's':
      kind = k::set_slot;
      break;
    case 'z':
      kind = k::clear_slot;
      break;
    case 'C':
      kind = k::connect;
      break;
    case 'c':
      kind = k::disconnect;
      break;
    case 'T':
      kind = k::parent;
      break;
    case 'H':
      kind = k::add_child;
      break;
    case 'h':
      kind = k::erase_child;
      break;
    case 'G':
      kind = k::loop_edge;
      break;
    case 'g':
      kind = k::merge_edge;
      break;
    case 'N':
      kind = k::temporal;
      break;
    case 'Q':
      kind = k::database_add;
      break;
    case 'q':
      kind = k::database_erase;
      break;
    case 'R':
      kind = k::replace;
      break;
    case 'D':
      kind = k::mark_keyframe;
      break;
    case 'B':
      kind = k::mark_point;
      break;
    case 'm':
      kind = k::matched;
      break;
    case 'l':
      kind = k::local;
      break;
    case 'r':
      kind = k::reference;
      break;
    default:
      break;
  }
  return {kind, e.thread, e.time, e.a, e.b, e.c, e.d};
}

// Version 2 has everything but the order of neighbours, which is sorted again after each run of changes.
void add_steps_of_edges(const trace& from, session& s) {
  int changed[most_threads];
  std::fill(std::begin(changed), std::end(changed), -1);
  for (const trace_event& e : from.events) {
    const bool changes = e.letter == 'C' || e.letter == 'c';
    int& open = changed[e.thread];
    if (open >= 0 && !(changes && open == e.a)) {
      s.steps.push_back({step_kind::order, e.thread, e.time, open, -1, -1, -1});
      open = -1;
    }
    if (changes) open = e.a;
    s.steps.push_back(from_edges(e));
  }
}

// A frame that is not finished ends where the trace ends.
void close(session& s) {
  bool open[most_threads] = {};
  int frame = -1;
  std::int64_t last = 0;
  for (const step& x : s.steps) {
    last = std::max(last, x.time);
    if (x.kind == step_kind::frame_begin || x.kind == step_kind::iteration_begin)
      open[x.thread] = true;
    if (x.kind == step_kind::frame_end || x.kind == step_kind::iteration_end)
      open[x.thread] = false;
    if (x.kind == step_kind::frame_begin) frame = x.a;
  }
  for (std::uint8_t t = 0; t != most_threads; ++t)
    if (open[t])
      s.steps.push_back({t == tracking ? step_kind::frame_end : step_kind::iteration_end, t, last,
                         t == tracking ? frame : -1, -1, -1, -1});
}

// When each object is retired and let go.
//
// Marking is one thread's doing: it is done with an object at the last step in the same iteration that names it. Steps that name
// it later stand for pointers that the recorded program had in places that the trace does not show.
class lifetimes {
 public:
  explicit lifetimes(session& s) : s_(s) {}

  void add() {
    keyframes_.resize(at(s_.keyframes));
    points_.resize(at(s_.points));
    drop_second_marks();
    find();
    insert();
  }

 private:
  struct life {
    int marked = -1, thread = -1, retire = -1, last = -1;  // indices of steps
    bool inserted = false;
  };

  // A point that is replaced is marked by that.
  void drop_second_marks() {
    std::vector<step> steps;
    steps.reserve(s_.steps.size() + points_.size());
    for (const step& x : s_.steps) {
      const bool mark = x.kind == step_kind::mark_point;
      if (mark || x.kind == step_kind::replace) {
        bool& marked = marked_[x.a];
        if (!mark) steps.push_back(x);
        if (!marked) steps.push_back({step_kind::mark_point, x.thread, x.time, x.a, -1, -1, -1});
        marked = true;
      } else {
        steps.push_back(x);
      }
    }
    s_.steps = std::move(steps);
  }
  void find() {
    std::vector<int> iteration(s_.steps.size());
    int now[most_threads] = {};
    for (std::size_t i = 0; i != s_.steps.size(); ++i) {
      const step& x = s_.steps[i];
      iteration[i] = now[x.thread];
      if (x.kind == step_kind::frame_end || x.kind == step_kind::iteration_end) ++now[x.thread];
      const int n = static_cast<int>(i);
      if (x.kind == step_kind::mark_keyframe || x.kind == step_kind::mark_point) {
        life& l = x.kind == step_kind::mark_keyframe ? keyframes_[at(x.a)] : points_[at(x.a)];
        l.marked = l.retire = n;
        l.thread = x.thread;
      }
      each_name(s_, x, [&](bool kf, int id) {
        life& l = kf ? keyframes_[at(id)] : points_[at(id)];
        l.last = n;
        if (l.marked >= 0 && l.thread == x.thread && iteration[i] == iteration[at(l.marked)])
          l.retire = n;
      });
    }
  }
  void insert() {
    struct end {
      step_kind kind;
      int id;
    };
    std::map<int, std::vector<end>> after;
    for (std::size_t k = 0; k != keyframes_.size(); ++k) {
      const life& l = keyframes_[k];
      if (l.marked < 0) continue;
      after[l.retire].push_back({step_kind::retire_keyframe, static_cast<int>(k)});
      after[l.last].push_back({step_kind::release_keyframe, static_cast<int>(k)});
    }
    for (std::size_t p = 0; p != points_.size(); ++p) {
      const life& l = points_[p];
      if (l.marked < 0) continue;
      after[l.retire].push_back({step_kind::retire_point, static_cast<int>(p)});
      after[l.last].push_back({step_kind::release_point, static_cast<int>(p)});
    }
    std::vector<step> steps;
    steps.reserve(s_.steps.size() + 2 * (keyframes_.size() + points_.size()));
    auto next = after.begin();
    // What goes at the end of an iteration goes before it: the thread is still allowed to use it.
    for (std::size_t i = 0; i != s_.steps.size(); ++i) {
      const step& x = s_.steps[i];
      steps.push_back(x);
      if (next == after.end() || next->first != static_cast<int>(i)) continue;
      for (const end& e : next->second)
        steps.push_back({e.kind, x.thread, x.time, e.id, -1, -1, -1});
      ++next;
    }
    s_.steps = std::move(steps);
  }

  session& s_;
  std::vector<life> keyframes_, points_;
  std::map<int, bool> marked_;
};

}  // namespace

named_ids names_of(const step& s) {
  named_ids n;
  using k = step_kind;
  switch (s.kind) {
    case k::make_keyframe:
    case k::insert_keyframe:
    case k::clear_slot:
    case k::order:
    case k::database_add:
    case k::database_erase:
    case k::mark_keyframe:
    case k::retire_keyframe:
    case k::release_keyframe:
      n.keyframes[0] = s.a;
      break;
    case k::make_point:
    case k::insert_point:
    case k::mark_point:
    case k::retire_point:
    case k::release_point:
      n.points[0] = s.a;
      break;
    case k::observe:
    case k::unobserve:
      n.keyframes[0] = s.a;
      n.points[0] = s.b;
      break;
    case k::set_slot:
      n.keyframes[0] = s.a;
      n.points[0] = s.c;
      break;
    case k::connect:
    case k::disconnect:
    case k::parent:
    case k::add_child:
    case k::erase_child:
    case k::loop_edge:
    case k::merge_edge:
    case k::corrected:
      n.keyframes[0] = s.a;
      n.keyframes[1] = s.b;
      break;
    case k::temporal:
      n.keyframes[0] = s.a;
      n.keyframes[1] = s.b;
      n.keyframes[2] = s.c;
      break;
    case k::replace:
      n.points[0] = s.a;
      n.points[1] = s.b;
      break;
    case k::reference:
      n.keyframes[0] = s.b;
      break;
    case k::matched:
      n.list_of_points = true;
      break;
    case k::local:
      n.list_of_keyframes = true;
      break;
    default:
      break;
  }
  return n;
}

session make_session(const trace& from) {
  session s;
  s.name = from.name;
  s.about = from.about;
  s.format = from.format;
  s.lists = from.lists;
  s.keyframes = from.keyframes;
  s.points = from.points;
  s.poses = from.poses;
  s.has_pose = from.has_pose;
  s.positions = from.positions;
  if (from.format == trace_format::edges)
    add_steps_of_edges(from, s);
  else
    add_steps_of_objects(from, s);
  close(s);
  lifetimes(s).add();

  s.is_marked.resize(at(s.keyframes));
  s.is_marked_point.resize(at(s.points));
  s.octaves.resize(at(s.keyframes));
  std::int64_t first = -1;
  for (step& x : s.steps) {
    if (first < 0) first = x.time;
    x.time = std::max<std::int64_t>(x.time - first, 0);
    s.duration = std::max(s.duration, x.time);
    s.frames += x.kind == step_kind::frame_begin;
    s.inserted_keyframes += x.kind == step_kind::insert_keyframe;
    s.inserted_points += x.kind == step_kind::insert_point;
    s.marked_points += x.kind == step_kind::mark_point;
    s.marked_keyframes += x.kind == step_kind::mark_keyframe;
    if (x.kind == step_kind::mark_keyframe) s.is_marked[at(x.a)] = 1;
    if (x.kind == step_kind::mark_point) s.is_marked_point[at(x.a)] = 1;
    if (x.kind == step_kind::make_keyframe) s.octaves[at(x.a)].resize(at(x.c));
    if (x.kind == step_kind::observe) s.octaves[at(x.a)][at(x.c)] = static_cast<std::uint8_t>(x.d);
  }
  return s;
}

}  // namespace replay
