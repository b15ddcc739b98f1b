// A session to be replayed: what each thread does to the map, step by step, whatever the format of the trace.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "trace.hpp"

namespace replay {

enum class step_kind : std::uint8_t {
  frame_begin,       // a frame
  frame_end,         // a frame: tracking holds no pointer
  iteration_begin,   // a keyframe, or -1
  iteration_end,     // the thread holds no pointer
  make_keyframe,     // a keyframe, b frame, c features
  insert_keyframe,   // a keyframe
  make_point,        // a point
  insert_point,      // a point
  observe,           // a keyframe, b point, c index, d octave
  unobserve,         // a keyframe, b point
  set_slot,          // a keyframe, b index, c point
  clear_slot,        // a keyframe, b index
  connect,           // a keyframe, b other, c weight
  disconnect,        // a keyframe, b other
  order,             // a keyframe: sort its neighbours
  parent,            // a keyframe, b parent or -1
  add_child,         // a keyframe, b child
  erase_child,       // a keyframe, b child
  loop_edge,         // a keyframe, b other
  merge_edge,        // a keyframe, b other
  temporal,          // a keyframe, b previous or -1, c next or -1
  database_add,      // a keyframe
  database_erase,    // a keyframe
  replace,           // a point, b by
  mark_keyframe,     // a keyframe: bad
  mark_point,        // a point: bad
  retire_keyframe,   // a keyframe: whoever marked it is done with it
  retire_point,      // a point
  release_keyframe,  // a keyframe: the trace does not name it any more
  release_point,     // a point
  matched,           // b first in lists, c number
  local,             // b first in lists, c number
  reference,         // b keyframe
  corrected,         // a keyframe, b other
  post,              // a position: what other threads wait for is done
  wait,              // a thread, b position: until that is done
};

struct step {
  step_kind kind;
  std::uint8_t thread;
  std::int64_t time;  // microseconds
  int a, b, c, d;
};

struct session {
  std::string name, about;
  trace_format format;
  std::vector<step> steps;  // in the order of the trace
  std::vector<int> lists;
  int keyframes = 0, points = 0, frames = 0;
  int marked_keyframes = 0, marked_points = 0, inserted_keyframes = 0, inserted_points = 0;
  std::int64_t duration = 0;                               // microseconds
  std::vector<std::array<float, 7>> poses;                 // by keyframe
  std::vector<char> has_pose, is_marked, is_marked_point;  // by keyframe; the last by point
  std::vector<std::array<float, 3>> positions;             // by point; empty: not known
  std::vector<std::vector<std::uint8_t>> octaves;          // by keyframe and feature
};

// What happens, and who holds what until when.
session make_session(const trace& from);

// The steps of one thread: with what it waits for, so that each object sees its steps in the trace's order.
std::vector<std::vector<step>> schedule(const session& s);

// Adds the steps of a trace of version 1, or of a graph, to @p s: what ORB-SLAM2 does with slots, covisibility, the
// spanning tree, and the database (session_objects.cpp).
void add_steps_of_objects(const trace& from, session& s);

// The ids that a step names.
struct named_ids {
  int keyframes[3] = {-1, -1, -1};
  int points[2] = {-1, -1};
  bool list_of_points = false, list_of_keyframes = false;
};
named_ids names_of(const step& s);

// Calls what(is_keyframe, id) for each of them.
template <class What>
void each_name(const session& s, const step& of, What what) {
  const named_ids n = names_of(of);
  for (const int k : n.keyframes)
    if (k >= 0) what(true, k);
  for (const int p : n.points)
    if (p >= 0) what(false, p);
  if (!n.list_of_keyframes && !n.list_of_points) return;
  for (int i = of.b; i != of.b + of.c; ++i)
    what(n.list_of_keyframes, s.lists[static_cast<std::size_t>(i)]);
}

}  // namespace replay
