// Plays a session in a scheme: by one thread in the order of the trace, or by the threads that did it.
#pragma once

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "result.hpp"
#include "state.hpp"
#include "work.hpp"

namespace replay {

// How far each thread has come: what others wait for.
class positions {
 public:
  void post(int thread, int position) {
    at_[thread].store(position);
    if (waiting_.load() == 0) return;
    { const std::lock_guard<std::mutex> l(mutex_); }
    changed_.notify_all();
  }
  void wait(int thread, int position) {
    for (int i = 0; i != 200; ++i)
      if (at_[thread].load() >= position) return;
    std::unique_lock<std::mutex> l(mutex_);
    ++waiting_;
    changed_.wait(l, [&] { return at_[thread].load() >= position; });
    --waiting_;
  }

 private:
  std::atomic<int> at_[most_threads] = {};
  std::atomic<int> waiting_{0};
  std::mutex mutex_;
  std::condition_variable changed_;
};

// One thread of the recorded system, at its steps.
template <class S>
class actor : public S::owner {
 public:
  actor(world<S>& w, typename S::thread& thread, int id) : w_(w), thread_(thread), id_(id) {}

  void take(const step& x) {
    using k = step_kind;
    switch (x.kind) {
      case k::frame_begin:
        tracking_.begin();
        begin(x.a);
        break;
      case k::iteration_begin:
        begin(++iterations_);
        if (id_ == global_adjustment) {
          adjustment_.begin(w_);
          thread_.offline([this] { adjustment_.compute(); });
        }
        break;
      case k::matched:
        tracking_.matched(w_, w_.of.lists.data() + x.b, x.c);
        break;
      case k::reference:
        reference_ = x.b;
        w_.tracker.mlpReferences.push_back(
            S::template reference_to<KeyFrame<S>, pose_record<S>>(w_.keyframe(x.b)));
        break;
      case k::frame_end:
        tracking_.end(w_, x.a, w_.keyframe(reference_));
        end();
        break;
      case k::iteration_end:
        finish_iteration();
        end();
        break;
      default:
        if (x.kind == k::insert_keyframe || x.kind == k::database_add) current_ = x.a;
        if (!inside_) thread_.begin();
        w_.apply(x);
        if (!inside_) thread_.end();
        break;
    }
  }
  void wait(positions& others, const step& x) {
    const std::int64_t wall = nanoseconds_now(), cpu = cpu_nanoseconds_now();
    others.wait(x.a, x.b);
    waited_wall_ += nanoseconds_now() - wall;
    waited_cpu_ += cpu_nanoseconds_now() - cpu;
  }

 private:
  void begin(long iteration) {
    at_iteration(iteration);
    inside_ = true;
    thread_.begin();
    waited_wall_ = waited_cpu_ = 0;
    wall_ = nanoseconds_now();
    cpu_ = cpu_nanoseconds_now();
  }
  void end() {
    thread_.end();
    role_ledger& mine = ledger::now().mine();
    mine.wall.add(static_cast<double>(nanoseconds_now() - wall_ - waited_wall_) / 1e6);
    mine.cpu.add(static_cast<double>(cpu_nanoseconds_now() - cpu_ - waited_cpu_) / 1e6);
    inside_ = false;
  }
  __attribute__((noinline)) void finish_iteration() {
    if (id_ == local_mapping) {
      if (current_ >= 0 && w_.keyframe(current_) != nullptr) mapping_work<S>(w_.keyframe(current_));
      const std::int64_t begin = nanoseconds_now();
      w_.program.collect();
      role_ledger& mine = ledger::now().mine();
      const double ms = static_cast<double>(nanoseconds_now() - begin) / 1e6;
      mine.longest_pause = std::max(mine.longest_pause, ms);
      mine.reclaiming += ms;
    } else if (id_ == loop_closing) {
      if (current_ >= 0 && w_.keyframe(current_) != nullptr)
        ledger::now().mine().work += w_.database.DetectCandidates(w_.keyframe(current_));
    } else if (id_ == global_adjustment) {
      adjustment_.end();
    }
    current_ = -1;
  }

  world<S>& w_;
  typename S::thread& thread_;
  const int id_;
  tracking_work<S> tracking_;
  adjustment_work<S> adjustment_;
  int reference_ = -1, current_ = -1;
  long iterations_ = -1;
  bool inside_ = false;
  std::int64_t wall_ = 0, cpu_ = 0, waited_wall_ = 0, waited_cpu_ = 0;
};

inline role role_of(int thread) {
  static const role all[most_threads] = {role::tracking, role::mapping, role::looping,
                                         role::adjustment};
  return all[thread];
}

// One lap by one thread, in the order of the trace.
template <class S>
void play_in_order(world<S>& w, const on_progress& progress, long frames_before) {
  std::vector<std::unique_ptr<typename S::thread>> threads;
  std::vector<std::unique_ptr<actor<S>>> actors;
  for (int t = 0; t != most_threads; ++t) {
    // Not as tracking, which may not reclaim: here it is the same thread that does.
    threads.push_back(
        std::make_unique<typename S::thread>(w.program, name_of(role_of(t)), role::main));
    actors.push_back(std::make_unique<actor<S>>(w, *threads.back(), t));
  }
  const typename S::thread::template root<tracking_members<S>> root(*threads[0], "Tracking",
                                                                    w.tracker);
  long frames = frames_before;
  for (const step& x : w.of.steps) {
    const playing as(role_of(x.thread));
    actors[x.thread]->take(x);
    if (x.kind == step_kind::frame_end) progress(++frames);
  }
}

// One lap by the recorded system's threads.
template <class S>
void play_in_threads(world<S>& w, const std::vector<std::vector<step>>& steps,
                     const play_options& options, const on_progress& progress, long frames_before) {
  positions done;
  std::atomic<long> frames{frames_before};
  std::atomic<bool> ended{false};
  const std::int64_t start = nanoseconds_now();
  const auto run = [&](int t) {
    const playing as(role_of(t));
    typename S::thread thread(w.program, name_of(role_of(t)), role_of(t));
    std::unique_ptr<typename S::thread::template root<tracking_members<S>>> root;
    if (t == tracking)
      root = std::make_unique<typename S::thread::template root<tracking_members<S>>>(
          thread, "Tracking", w.tracker);
    actor<S> a(w, thread, t);
    for (const step& x : steps[static_cast<std::size_t>(t)]) {
      if (x.kind == step_kind::wait) {
        a.wait(done, x);
      } else if (x.kind == step_kind::post) {
        done.post(t, x.a);
      } else {
        if (options.speed > 0 &&
            (x.kind == step_kind::frame_begin || x.kind == step_kind::iteration_begin)) {
          const auto due =
              start + static_cast<std::int64_t>(static_cast<double>(x.time) * 1e3 / options.speed);
          std::this_thread::sleep_for(
              std::chrono::nanoseconds(std::max<std::int64_t>(0, due - nanoseconds_now())));
        }
        a.take(x);
        if (x.kind == step_kind::frame_end) frames.fetch_add(1, std::memory_order_relaxed);
      }
    }
  };
  const auto view = [&] {
    const playing as(role::viewer);
    typename S::thread thread(w.program, "viewer", role::viewer);
    while (!ended.load()) {
      thread.begin();
      viewer_work(w);
      thread.end();
      std::this_thread::sleep_for(std::chrono::milliseconds(30));
    }
  };

  std::vector<std::thread> threads;
  for (int t = 0; t != most_threads; ++t) threads.emplace_back(run, t);
  std::thread viewer;
  if (options.viewer) viewer = std::thread(view);
  std::thread watch([&] {
    while (!ended.load()) {
      progress(frames.load(std::memory_order_relaxed));
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  for (auto& t : threads) t.join();
  ended = true;
  if (viewer.joinable()) viewer.join();
  watch.join();
  progress(frames.load());
}

}  // namespace replay
