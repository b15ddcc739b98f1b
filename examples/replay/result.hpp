// What a replay in one scheme came to.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "ledger.hpp"
#include "session.hpp"

namespace replay {

struct map_state;

struct play_options {
  bool threads = true;  // else one, in the order of the trace
  double speed = 0;     // as recorded: 1; 0: as fast as it can
  int laps = 1;         // the map is reset between them
  double minutes = 0;   // no lap begins later; 0: all laps
  bool viewer = false;
  bool background = true;     // deferred: a thread of its own reclaims; else local mapping does
  bool count_faults = false;  // what would be deleted too early is not, and its uses are counted
};

// Called now and then, by one thread at a time: after how many frames of all laps.
using on_progress = std::function<void(long frames)>;

struct sample {
  double seconds = 0;
  long frames = 0;
  std::int64_t live_bytes = 0, resident_bytes = 0;  // more than before the session began
  std::uint64_t marked[2] = {}, freed[2] = {};      // keyframes, points; so far
};

struct distribution {
  std::uint64_t count = 0;
  double mean = 0, median = 0, p90 = 0, p99 = 0, max = 0;
};

struct thread_result {
  std::string name;
  distribution wall, cpu;                    // ms of an iteration, without what it waited for
  std::uint64_t destroyed[2] = {};           // by this thread
  double longest_pause = 0, reclaiming = 0;  // ms
};

struct run_result {
  std::string scheme;
  bool finished = false;
  std::string explanation;  // if it did not finish
  std::string complaint;    // what it wrote to its standard error stream: a sanitizer's report
  bool counted = false;     // with count_faults: memory says nothing then
  std::uint64_t faults = 0;
  double seconds = 0;  // without what comes after the last frame
  long frames = 0;
  // Keyframes, points; of all laps. Freed: of those that were marked, before their map was reset.
  std::uint64_t made[2] = {}, inserted[2] = {}, marked[2] = {}, freed[2] = {};
  // Bytes more than before the session began: at the end of the last lap, and after the reset that ends it.
  std::int64_t peak_live = 0, final_live = 0, reset_live = 0, peak_resident = 0, final_resident = 0;
  std::vector<std::int64_t> lap_live;  // after the reset that ends each lap
  std::vector<thread_result> threads;
  distribution death_delay;              // ms from marking to freeing
  std::uint64_t map_digest = 0;          // of what is alive at the end of the first lap, by content
  bool compared = false;                 // with the recorded final state
  std::vector<std::string> differences;  // from it
  std::vector<sample> samples;
};

struct run_request {
  const session* of = nullptr;
  const std::vector<std::vector<step>>* steps = nullptr;  // by thread
  const map_state* final_state = nullptr;
  play_options options;
  on_progress progress;
};

// One of the schemes.
struct scheme_entry {
  const char* name;
  const char* about;
  bool is_unsafe;  // deletes what may be in use
  run_result (*run)(const run_request&);
};
const std::vector<scheme_entry>& all_schemes();

// Bytes by which memory grew from the second lap to the last: 0 if there are not three.
std::int64_t growth_of(const run_result& r);

distribution distribution_of(const std::vector<const thinned*>& parts);
std::uint64_t digest_of(const map_state& s);
// What the ledger knows.
void add_ledger(run_result& r);

}  // namespace replay
