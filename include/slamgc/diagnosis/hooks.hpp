/// @file
/// What a domain tells a profiler.
#pragma once

#include <chrono>
#include <cstdint>

#include "../budget.hpp"
#include "../stats.hpp"

namespace slamgc {

/// One call of collect() that was not refused: a slice of a domain's collection.
struct slice_stats {
  using time_point = std::chrono::steady_clock::time_point;  ///< When something was.

  collected did;                     ///< What the call returns.
  time_point begin;                  ///< When it began.
  std::chrono::nanoseconds took{0};  ///< How long it took.
  std::uint64_t grace_periods = 0;   ///< Grace periods that began in it.
  delay delayed;                     ///< Whom the domain waits for at its end.
};

/// What a domain calls while it collects: derive from this, override what is wanted, and install() it.
///
/// All functions are called in collect(), on the thread that collects, one at a time for one domain. They must not throw, and
/// must not collect, count or retire. They may read stats() of the domain.
///
/// Without hooks a call of collect() has one branch more. With hooks it sums up the numbers of all types, twice
/// at most: O(types + mutators), as stats().
class collector_hooks {
 public:
  using time_point = slice_stats::time_point;  ///< When something was.

  virtual ~collector_hooks() = default;

  /// A slice begins.
  virtual void slice_begins(time_point) noexcept {}
  /// The grace period with this number, which was open when the slice began, is over. Told before the slice ends; that it is
  /// over was found at @p when.
  virtual void grace_period_closed(std::uint64_t /*number*/, time_point /*when*/) noexcept {}
  /// The slice ends while the grace period with this number is open, since @p when. (Those that begin and end within one slice are
  /// in its numbers only.)
  virtual void grace_period_opened(std::uint64_t /*number*/, time_point /*when*/) noexcept {}
  /// The numbers of one type at the end of the slice, if they are others than at the end of the last one; @p reclaimed objects of
  /// the type were destroyed since then. The type's name stays valid, at its address.
  virtual void objects(const type_stats& /*now*/, std::uint64_t /*reclaimed*/) noexcept {}
  /// The slice ends.
  virtual void slice_ended(const slice_stats&) noexcept {}
};

}  // namespace slamgc
