/// @file
/// What a call that collects may do, and what it did.
#pragma once

#include <chrono>
#include <cstddef>

namespace slamgc {

/// How much one call of collect() may do. It stops at whichever it reaches first, after the object it is
/// at: one destructor is the smallest unit of time.
struct budget {
  /// Objects to handle. One that is reclaimed is handled twice: noted, and after the grace period destroyed.
  std::size_t objects = static_cast<std::size_t>(-1);
  std::chrono::nanoseconds time = std::chrono::nanoseconds::max();  ///< Time.
  /// No purge begins until this many times as long as the last one took has passed since its end. A purge walks through all live
  /// objects, for however few that are stuck: with 15 it takes a sixteenth of the caller's time at most, however large the
  /// map is, and what is stuck waits. 0: one begins whenever there is reason to.
  unsigned purge_rest = 0;
};

/// What a call of collect() did.
struct collected {
  /// How it ended.
  enum class outcome {
    done,     ///< Nothing is left that could be reclaimed now.
    waiting,  ///< The rest waits until each mutator has passed a quiescent state.
    partial,  ///< The budget is used up.
    busy,     ///< Another thread is collecting, or this one further up the stack; nothing was done.
    refused,  ///< The thread declared that it never reclaims; nothing was done.
  };
  outcome result = outcome::done;  ///< How it ended.
  std::size_t reclaimed = 0;       ///< Objects destroyed.
};

/// Why drain() or synchronize() ended.
enum class waited {
  done,       ///< What was waited for has happened.
  timed_out,  ///< A mutator did not pass a quiescent state in time.
  /// The calling thread is an online mutator of the domain, or collects, and would wait for itself; or it is online and never
  /// reclaims. (Two threads, each an online mutator of the domain that the other one waits for, wait for ever: go offline
  /// in all domains first.)
  refused,
};

}  // namespace slamgc
