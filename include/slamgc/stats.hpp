/// @file
/// What a domain can say about itself, as plain numbers.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace slamgc {

/// Numbers of the objects of one type in one domain.
struct type_stats {
  const char* type = "";        ///< The type, as the compiler spells it.
  std::size_t object_size = 0;  ///< Bytes of one object, without what it allocates itself.
  std::uint64_t created = 0;    ///< Objects made so far.
  std::uint64_t live = 0;       ///< Objects that exist now.
  std::uint64_t retired = 0;    ///< Objects declared dead so far; see retire().
  std::uint64_t reclaimed = 0;  ///< Objects destroyed by collectors so far.
  std::uint64_t stuck = 0;      ///< Retired objects with described edges that others refer to now.
  std::uint64_t backlog = 0;    ///< Objects that wait for a collector now.

  /// Bytes of the objects that exist now, without what they allocate themselves.
  [[nodiscard]] std::uint64_t live_bytes() const noexcept { return live * object_size; }
  /// Bytes of the objects destroyed by collectors so far, without what they had allocated themselves.
  [[nodiscard]] std::uint64_t reclaimed_bytes() const noexcept { return reclaimed * object_size; }
};

/// Numbers of one registered thread.
struct mutator_stats {
  const char* name = "";  ///< The name it registered with.
  bool online = false;    ///< Whether it may hold borrowed pointers.
  bool delays = false;    ///< Whether the open grace period waits for it.
};

/// Whom reclamation waits for.
struct delay {
  const char* oldest = nullptr;  ///< Who holds the open grace period up, the longest; null: nobody.
  std::chrono::nanoseconds age{0};  ///< For how long it has held it up.
  std::uint64_t backlog = 0;        ///< Objects that wait.
};

/// Numbers of one domain.
struct domain_stats {
  std::vector<type_stats> types;                ///< One for each type of which an object was made.
  std::vector<mutator_stats> mutators;          ///< One for each registered thread.
  delay delayed;                                ///< Whom reclamation waits for.
  std::uint64_t grace_periods = 0;              ///< Grace periods begun so far, by collecting.
  std::chrono::nanoseconds longest_collect{0};  ///< Longest call of collect() so far.
  std::uint64_t refused_collects = 0;  ///< Calls on threads that declared never to reclaim.

  /// The sum of one number over all types.
  [[nodiscard]] std::uint64_t total(std::uint64_t type_stats::*number) const noexcept {
    std::uint64_t sum = 0;
    for (const type_stats& t : types) sum += t.*number;
    return sum;
  }
  /// Bytes of the objects of all types that exist now, without what they allocate themselves.
  [[nodiscard]] std::uint64_t live_bytes() const noexcept {
    std::uint64_t sum = 0;
    for (const type_stats& t : types) sum += t.live_bytes();
    return sum;
  }
};

}  // namespace slamgc
