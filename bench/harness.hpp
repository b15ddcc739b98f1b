// Measures alternatives of one thing against each other on a machine that does other things, too.
//
// - All alternatives ("contenders") are measured in one run, in rounds; a round measures each of them
//   once, in random order. What is compared is the ratio within a round.
// - Time is the threads' own CPU time, so that being descheduled is not counted.
// - Threads are pinned, and exist all the time: libstdc++ leaves atomics out of std::shared_ptr as
//   long as a program has one thread.
// - With no more threads than processors, a window counts only if at least 80 % of it was measured by
//   all threads at the same time, and none of them was preempted; others are repeated.
//
// Google Benchmark has no means for the last two; google_benchmark.cc runs the same under it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace bench {

/// One of the alternatives.
struct contender {
  std::string name;
  /// Does it @p n times on thread @p thread, in round @p round.
  std::function<void(unsigned thread, std::uint64_t n, unsigned round)> run;
  /// For counters without synchronisation.
  bool one_thread_only = false;
  /// What comes before and after on each thread and is not measured, such as registering it; may be empty.
  std::function<void(unsigned thread, std::uint64_t n)> prepare = {};
  std::function<void(unsigned thread)> finish = {};
  /// How often it may be done in one window.
  std::uint64_t most = std::uint64_t{1} << 40;
};

/// Alternatives that do the same.
struct group {
  std::string operation;  ///< Such as "copy+destroy".
  std::string shape;      ///< Such as "one object".
  std::vector<contender> contenders;
  /// Operations that one call of contender::run does per n: elements of a container.
  std::uint64_t operations = 1;
  /// Numbers of threads; empty: 1, 2, 4, 8.
  std::vector<unsigned> threads = {};
};

/// Threads that a contender is measured with at most, unless its group names more.
constexpr unsigned max_threads = 8;
/// Threads that any contender is measured with at most.
constexpr unsigned most_threads = 64;

/// "One object" is another one each round: how long a cache line takes from one core to another
/// depends on its address, by more than what the counters differ.
constexpr unsigned object_choices = 64;

/// Keeps the compiler from leaving out what was computed.
template <class T>
void use(const T& value) {
  asm volatile("" : : "g"(value) : "memory");
}

/// Measures @p groups as the command line says and writes one JSON object per window.
/// Returns main's exit code.
int run(int argc, char** argv, const std::vector<group>& groups);

}  // namespace bench
