// Who has to wait for whom, so that each object sees its steps in the order of the trace.
#include <algorithm>
#include <utility>

#include "session.hpp"

namespace replay {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

}  // namespace

std::vector<std::vector<step>> schedule(const session& s) {
  // By object and thread: the last step that named it, as a position in that thread. Position 0 is before all.
  struct last {
    int position[most_threads] = {};
  };
  std::vector<last> keyframes(at(s.keyframes)), points(at(s.points));
  int position[most_threads] = {};
  int knows[most_threads][most_threads] = {};  // what a thread has waited for
  std::vector<std::vector<step>> mine(most_threads);
  std::vector<std::vector<int>> step_at(most_threads);  // by position: the index in mine
  std::vector<std::vector<char>> awaited(most_threads);
  for (int t = 0; t != most_threads; ++t) step_at[at(t)].push_back(-1), awaited[at(t)].push_back(0);

  // A thread that waits for its next keyframe has not begun: it is between two iterations.
  std::vector<step> held[most_threads];
  const auto put = [&](const step& x) {
    step_at[x.thread].push_back(static_cast<int>(mine[x.thread].size()));
    mine[x.thread].push_back(x);
  };
  const auto begin_held = [&](std::size_t t) {
    for (const step& x : std::exchange(held[t], {})) put(x);
  };
  for (const step& x : s.steps) {
    int needed[most_threads] = {};
    each_name(s, x, [&](bool kf, int id) {
      const last& l = (kf ? keyframes : points)[at(id)];
      for (int t = 0; t != most_threads; ++t) needed[t] = std::max(needed[t], l.position[t]);
    });
    const bool begins = x.kind == step_kind::frame_begin || x.kind == step_kind::iteration_begin;
    const bool ends = x.kind == step_kind::frame_end || x.kind == step_kind::iteration_end;
    // A global adjustment begins after the correction of a loop, and lasts as long as it lasted.
    if (x.thread == global_adjustment && begins) needed[loop_closing] = position[loop_closing];
    if (x.thread == global_adjustment && ends) std::copy(position, position + most_threads, needed);
    for (int t = 0; t != most_threads; ++t) {
      if (t == x.thread || needed[t] <= knows[x.thread][t]) continue;
      knows[x.thread][t] = needed[t];
      awaited[at(t)][at(needed[t])] = 1;
      if (x.thread == global_adjustment && ends) begin_held(x.thread);
      mine[x.thread].push_back({step_kind::wait, x.thread, x.time, t, needed[t], -1, -1});
    }
    ++position[x.thread];
    awaited[x.thread].push_back(0);
    if (begins) {
      held[x.thread].push_back(x);
    } else {
      begin_held(x.thread);
      put(x);
    }
    each_name(s, x, [&](bool kf, int id) {
      (kf ? keyframes : points)[at(id)].position[x.thread] = position[x.thread];
    });
  }
  for (std::size_t t = 0; t != most_threads; ++t) begin_held(t);

  // After what somebody waits for, say so.
  std::vector<std::vector<step>> all(most_threads);
  for (std::size_t t = 0; t != most_threads; ++t) {
    std::size_t next = 1;  // position
    for (std::size_t i = 0; i != mine[t].size(); ++i) {
      all[t].push_back(mine[t][i]);
      if (next == step_at[t].size() || step_at[t][next] != static_cast<int>(i)) continue;
      if (awaited[t][next])
        all[t].push_back({step_kind::post, static_cast<std::uint8_t>(t), mine[t][i].time,
                          static_cast<int>(next), -1, -1, -1});
      ++next;
    }
  }
  return all;
}

}  // namespace replay
