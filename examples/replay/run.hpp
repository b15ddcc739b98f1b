// Runs a session in a scheme, and measures it.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "play.hpp"
#include "result.hpp"

namespace replay {

constexpr long frames_between_samples = 10, most_samples = 20000, most_laps = 100000;

// Notes memory and deaths while a session is played.
class sampler {
 public:
  sampler(run_result& to, const on_progress& also)
      : to_(to),
        also_(also),
        start_(nanoseconds_now()),
        live_(live_bytes()),
        resident_(resident_bytes()) {}

  void at(long frames) {
    if (frames < next_) return;
    next_ = frames + spacing_;
    sample s;
    s.seconds = seconds();
    s.frames = frames;
    s.live_bytes = live();
    s.resident_bytes = resident();
    for (std::size_t k = 0; k != 2; ++k) {
      s.marked[k] = ledger::now().marked[k].load(std::memory_order_relaxed);
      s.freed[k] = ledger::now().freed[k].load(std::memory_order_relaxed);
    }
    to_.peak_live = std::max(to_.peak_live, s.live_bytes);
    if (to_.samples.size() == to_.samples.capacity()) thin();
    to_.samples.push_back(s);
    if (also_) also_(frames);
  }
  double seconds() const { return static_cast<double>(nanoseconds_now() - start_) / 1e9; }
  std::int64_t live() const { return live_bytes() - live_; }
  std::int64_t resident() const { return resident_bytes() - resident_; }
  std::int64_t peak_resident() const {
    return std::max<std::int64_t>(0, peak_resident_bytes() - resident_);
  }

 private:
  // Memory that does not grow: every second one goes.
  void thin() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < to_.samples.size(); i += 2) to_.samples[kept++] = to_.samples[i];
    to_.samples.resize(kept);
    spacing_ *= 2;
  }

  run_result& to_;
  const on_progress& also_;
  const std::int64_t start_, live_, resident_;
  long next_ = 0, spacing_ = frames_between_samples;
};

// Of what was marked: destroyed so far.
inline std::uint64_t freed_so_far(std::size_t k) {
  return ledger::now().sum([k](const role_ledger& one) { return one.destroyed_marked[k]; });
}

template <class S>
run_result run(const run_request& request) {
  const session& s = *request.of;
  const play_options& how = request.options;
  ledger::now().clear();
  count_faults(how.count_faults);
  run_result r;
  r.scheme = S::name;
  r.samples.reserve(static_cast<std::size_t>(
      std::min(most_samples, long{s.frames} * how.laps / frames_between_samples + 2)));
  r.lap_live.reserve(static_cast<std::size_t>(std::min<long>(most_laps, how.laps)));
  sampler watch(r, request.progress);
  {
    typename S::program program(how.threads && how.background);
    typename S::thread me(program, "main", role::main);
    for (int lap = 0; lap != how.laps && (how.minutes <= 0 || watch.seconds() < 60 * how.minutes);
         ++lap) {
      begin_lap();
      const std::uint64_t freed_before[2] = {freed_so_far(0), freed_so_far(1)};
      me.begin();  // what is made now belongs to the program
      auto w = std::make_unique<world<S>>(program, s);
      me.end();
      const auto progress = [&](long frames) { watch.at(frames); };
      if (how.threads)
        play_in_threads(*w, *request.steps, how, progress, r.frames);
      else
        play_in_order(*w, progress, r.frames);
      r.frames += s.frames;
      r.seconds = watch.seconds();
      me.begin();
      w->end_tracking();
      me.end();
      program.finish();
      r.peak_live = std::max(r.peak_live, watch.live());
      r.final_live = watch.live();
      r.final_resident = watch.resident();
      for (std::size_t k = 0; k != 2; ++k) r.freed[k] += freed_so_far(k) - freed_before[k];
      r.inserted[0] += static_cast<std::uint64_t>(s.inserted_keyframes);
      r.inserted[1] += static_cast<std::uint64_t>(s.inserted_points);

      me.begin();
      if (lap == 0) {
        const map_state state = state_of(*w);
        r.map_digest = digest_of(live_part(state, s));
        r.compared = request.final_state != nullptr;
        if (r.compared)
          r.differences =
              S::keeps_all ? differences(state, *request.final_state)
                           : differences(live_part(state, s), live_part(*request.final_state, s));
      }
      w->reset();
      me.end();
      program.finish();
      w.reset();
      r.lap_live.push_back(watch.live());
    }
    r.reset_live = watch.live();
  }
  r.peak_resident = watch.peak_resident();
  add_ledger(r);
  r.counted = how.count_faults;
  r.faults = counted_faults();
  r.finished = true;
  return r;
}

}  // namespace replay
