/// @file
/// The roots of a domain, and how a collector visits them while others come and go.
///
/// **States** of a place in the list: *free*; *rooted*, from the root's constructor to its destructor; *held*, while a
/// collector is in its edges(). The collector goes from rooted to held and back; the root's destructor from rooted to
/// free, for which it waits while it is held. Places are used again and freed with the domain's state. A root that belongs
/// to a mutator is not visited by the collector.
#pragma once

#include <chrono>
#include <cstdint>
#include <utility>

#include "../env.hpp"
#include "../fwd.hpp"
#include "clock.hpp"
#include "heap_walk.hpp"
#include "participant.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

template <class Env>
struct root_place {
  enum : std::uint32_t { free, rooted, held };
  typename Env::template atomic<std::uint32_t> state{free};
  const char* name = nullptr;
  void* described = nullptr;
  const described_operations<Env>* operations = nullptr;
  enum : std::uint32_t { no, wanted, begun };
  typename Env::template atomic<std::uint32_t> suspicion{no};  // collect_cycles()
  bool owned = false;                                          // by a mutator
  participant<Env>* owner = nullptr;                           // that mutator, while it exists
  root_place* next = nullptr;
  root_place* next_of_owner = nullptr;

  bool is_suspected() const noexcept {
    return suspicion.load(std::memory_order_relaxed) != no;  // (31) what matters is under `held`.
  }
  /// By the collector: whether it is wanted.
  bool begin_suspicion() noexcept {
    if (!is_suspected()) return false;
    suspicion.store(begun, std::memory_order_relaxed);  // (31)
    return true;
  }
  /// Unless it was wanted again meanwhile.
  void end_suspicion() noexcept {
    std::uint32_t expected = begun;
    suspicion.compare_exchange_strong(expected, no, std::memory_order_relaxed,  // (31)
                                      std::memory_order_relaxed);               // (31)
  }
  void join(participant<Env>& of) noexcept {
    owner = &of;
    next_of_owner = of.roots;
    of.roots = this;
  }
  void leave() noexcept {
    if (owner == nullptr) return;
    root_place** at = &owner->roots;
    while (*at != this) at = &(*at)->next_of_owner;
    *at = next_of_owner;
    owner = nullptr;
  }
};

template <class Env>
class root_list {
 public:
  using place = root_place<Env>;

  root_list() noexcept = default;
  ~root_list() {
    place* p = first_.load(std::memory_order_relaxed);  // (31) alone here.
    while (p != nullptr) {
      place* const next = p->next;
      delete p;
      p = next;
    }
  }
  root_list(const root_list&) = delete;
  root_list& operator=(const root_list&) = delete;

  /// A place that is not free, and not rooted yet. Throws std::bad_alloc.
  place& take() {
    for (place* p = first_.load(std::memory_order_acquire); p != nullptr; p = p->next) {  // (31)
      std::uint32_t state = place::free;
      // (31) acquire: its last user has finished with it.
      if (p->state.compare_exchange_strong(state, place::held, std::memory_order_acquire,
                                           std::memory_order_relaxed))  // (31)
        return *p;
    }
    place* const made = new place;
    made->state.store(place::held, std::memory_order_relaxed);  // (31) nobody else knows it.
    place* first = first_.load(std::memory_order_relaxed);      // (31) a guess.
    do {
      made->next = first;
    } while (!first_.compare_exchange_weak(
        first, made, std::memory_order_release,  // (31) publishes the place to who walks the list.
        std::memory_order_relaxed));             // (31) a guess.
    return *made;
  }
  static void put(place& p) noexcept {
    p.suspicion.store(place::no, std::memory_order_relaxed);  // (31) of its last user.
    p.state.store(place::rooted, std::memory_order_release);  // (31) its content, to visit().
  }
  /// Waits while a collector is in its edges().
  static void remove(place& p) noexcept {
    std::uint32_t state = place::rooted;
    // (31) acquire: what the collector did in there is over; release: to take().
    while (!p.state.compare_exchange_weak(state, place::free, std::memory_order_acq_rel,
                                          std::memory_order_relaxed)) {  // (31)
      state = place::rooted;
      clock_of<Env>::pause(std::chrono::nanoseconds(0));
    }
  }
  void want_suspicion(place& p) noexcept {
    p.suspicion.store(place::wanted, std::memory_order_relaxed);  // (31)
    suspicions_.fetch_add(1, std::memory_order_release);          // (31) so that the wish is seen.
  }
  /// Whether one was wanted since the last time.
  bool any_suspected() noexcept {
    const std::uint64_t now = suspicions_.load(std::memory_order_acquire);  // (31)
    return now != std::exchange(suspicions_seen_, now);
  }
  /// Calls f(place) for each root; for those of mutators, too, if @p all. By a collector. A root that ends meanwhile is
  /// left out.
  template <class F>
  void visit(F f, bool all = false) {
    for (place* p = first_.load(std::memory_order_acquire); p != nullptr; p = p->next) {  // (31)
      std::uint32_t state = place::rooted;
      // (31) acquire: sees its content.
      if (!p->state.compare_exchange_strong(state, place::held, std::memory_order_acquire,
                                            std::memory_order_relaxed))  // (31)
        continue;
      if (all || !p->owned) f(*p);
      p->state.store(place::rooted, std::memory_order_release);  // (31) to remove() and take().
    }
  }

 private:
  typename Env::template atomic<place*> first_{nullptr};
  typename Env::template atomic<std::uint64_t> suspicions_{0};
  std::uint64_t suspicions_seen_ = 0;  // the collector's
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
