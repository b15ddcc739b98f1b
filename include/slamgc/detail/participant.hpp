/// @file
/// How a thread takes part in a domain: as a mutator, or as the collector at work.
#pragma once

#include <cstddef>
#include <cstdint>

#include "../env.hpp"
#include "../fwd.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

inline constexpr std::size_t cache_line = 64;

template <class Env>
struct table_door;
template <class Env>
struct root_place;

/// A registered thread, as collectors see it. Records are used again and freed with the domain's state
/// only, so a collector reads them without a lock.
template <class Env>
struct alignas(cache_line) mutator_record {
  static constexpr std::uint64_t offline = 0;

  typename Env::template atomic<std::uint64_t> epoch{offline};
  typename Env::template atomic<bool> taken{true};
  typename Env::template atomic<const char*> name{nullptr};
  mutator_record* next = nullptr;
  std::size_t door = 0;
};

/// One part of a thread in a domain, known to that thread alone.
template <class Env>
struct participant {
  participant* outer;
  domain_state<Env>* domain;
  mutator_record<Env>* record;  // null: the collector
  std::size_t door;             // which door of each table is its own; 0: none
  bool online;
  bool never_reclaim;
  std::uint64_t number = 0;            // no other part of the thread ever has it
  std::uint64_t passed = 0;            // which of the thread's quiescent states was its last
  table_door<Env>* pending = nullptr;  // its doors with a chain to publish
  root_place<Env>* roots = nullptr;    // that it owns
  std::uint64_t purged = 0;            // the last purge that it has joined

  /// Whether it keeps what enters a table in a chain of its own, which it publishes later.
  bool keeps_chains() const noexcept { return door != 0 && may_borrow(); }

  /// Whether pointers may be borrowed: the collector's destructors, too, read what their objects refer to.
  bool may_borrow() const noexcept { return online || record == nullptr; }

  /// What was borrowed before is not valid any more; for the checks of borrow.hpp.
  void pass_quiescent_state() noexcept;

  /// Drops the stale edges of the roots that it owns, if a purge has begun since the last time.
  void join_purge() noexcept;
  /// Makes what entered tables visible to the collector.
  void publish() noexcept {
    for (; pending != nullptr; pending = pending->next_pending) pending->publish();
  }
};

/// The parts of one thread, the innermost first.
template <class Env>
struct participants {
  participant<Env>* innermost;
  std::uint64_t current;  // the number of the innermost; 0: none
  std::uint64_t last;     // the last number that was given
  std::uint64_t quiescent_states;

  static participants& of_this_thread() noexcept {
    return Env::template thread_record<participants>();
  }

  /// The innermost that may borrow, or null.
  static participant<Env>* borrower() noexcept {
    participant<Env>* p = of_this_thread().innermost;
    while (p != nullptr && !p->may_borrow()) p = p->outer;
    return p;
  }
  /// Whether some part of the thread in @p domain holds for @p condition.
  template <class Condition>
  static bool any_in(const domain_state<Env>& domain, Condition condition) noexcept {
    for (participant<Env>* p = of_this_thread().innermost; p != nullptr; p = p->outer)
      if (p->domain == &domain && condition(*p)) return true;
    return false;
  }
};

template <class Env>
void participant<Env>::pass_quiescent_state() noexcept {
  passed = ++participants<Env>::of_this_thread().quiescent_states;
}

/// Makes @p part one of the calling thread's, its innermost at first, from begin() to end(). They may end in
/// any order: a `thread_local` mutator outlives automatic ones that were made before it.
template <class Env>
class participation {
 public:
  explicit participation(participant<Env>& part, bool at_once = true) noexcept : part_(part) {
    if (at_once) begin();
  }
  ~participation() { end(); }
  participation(const participation&) = delete;
  participation& operator=(const participation&) = delete;

  void begin() noexcept {
    auto& all = participants<Env>::of_this_thread();
    part_.outer = all.innermost;
    part_.number = ++all.last;
    all.innermost = &part_;
    all.current = part_.number;
    has_begun_ = true;
  }
  void end() noexcept {
    if (!has_begun_) return;
    has_begun_ = false;
    auto& all = participants<Env>::of_this_thread();
    participant<Env>** at = &all.innermost;
    while (*at != nullptr && *at != &part_) at = &(*at)->outer;
    if (*at != nullptr) *at = part_.outer;
    all.current = all.innermost != nullptr ? all.innermost->number : 0;
  }

 private:
  participant<Env>& part_;
  bool has_begun_ = false;
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
