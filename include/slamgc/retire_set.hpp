/// @file
/// The thesis's collector: a set of dead objects that is scanned.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "assert.hpp"
#include "detail/header.hpp"
#include "fwd.hpp"
#include "rc_object.hpp"
#include "reclaim_at_zero.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Reclaimer: counts, and destroys nothing. Objects go through a retire_set.
struct reclaim_by_scan {
  /// Removes a reference.
  template <class T>
  static void release(T* object) noexcept {
    (void)uncount_reference(object);
  }
  /// New objects are linked to nothing.
  template <class T>
  static void* first_link() noexcept {
    return nullptr;
  }
  /// Nothing is to be done for an object that the program deletes; one that is in a set is reported.
  template <class T>
  static void last_link(void*) noexcept {}
  /// Nothing is destroyed while a count changes.
  template <class T>
  struct scope {
    scope() noexcept {}  ///< Does nothing.
  };
};

/// Objects that the program declared dead, until a scan finds their count at zero (thesis, chapter 4.3).
///
/// It knows of no mutators, so **every pointer that a thread uses has to be counted, and counted under the
/// lock of the slot it was read from** (scoped_count); and every container has to be counted. Then a zero
/// count means that no slot holds the pointer and no thread can get it. With one uncounted local it does not:
///
///     mapping                              tracking
///     pMP = pKF->mvpMapPoints[3]  (count 1)
///                                          pMP->SetBadFlag(): leaves all slots  (count 0)
///                                          retire_set.insert(pMP); scan()       destroyed
///     pMP->GetWorldPos()                   <- use after free
///
/// For raw locals use reclaim_retired with mutators.
///
/// Thread-safety: all operations by any thread at any time. insert() is lock-free; none allocates.
template <class T>
class retire_set {
 public:
  /// Empty.
  retire_set() noexcept = default;
  /// Scans once more; what is still counted is left alone: it is the program's again.
  ~retire_set() {
    (void)scan();
    // (25) acquire: sees the links that push() wrote.
    T* left = first_.exchange(nullptr, std::memory_order_acquire);
    while (left != nullptr) {
      auto& header = detail::access::header_of(*left);
      left = static_cast<T*>(header.link.load(std::memory_order_relaxed));  // (25)
      std::uint64_t now = policy::load(header.state);
      while (!policy::compare_exchange(header.state, now, now & ~state_word::queued_flag)) {
      }
    }
  }
  retire_set(const retire_set&) = delete;
  retire_set& operator=(const retire_set&) = delete;

  /// Declares *object dead. Returns false if it was dead already, since it is in a set once, or is null. O(1).
  bool insert(T* object) noexcept {
    static_assert(std::is_same<detail::reclaimer_of<T>, reclaim_by_scan>::value,
                  "slamgc: objects of a retire_set need the reclaimer reclaim_by_scan");
    if (object == nullptr) return false;
    auto& state = detail::access::header_of(*object).state;
    std::uint64_t now = policy::load(state);
    do {
      if (state_word{now}.is_retired()) return false;
    } while (!policy::compare_exchange(state, now,
                                       now | state_word::retired_flag | state_word::queued_flag));
    if (detail::watch() != nullptr) detail::watch()->retired(object, detail::type_name<T>::get());
    push(object);
    return true;
  }

  /// Destroys the objects in the set whose count is zero; returns how many. Destructors run on this
  /// thread, outside of any lock, and may insert. O(size).
  std::size_t scan() noexcept {
    std::size_t destroyed = 0;
    // (25) acquire: sees the links that push() wrote.
    T* object = first_.exchange(nullptr, std::memory_order_acquire);
    while (object != nullptr) {
      auto& header = detail::access::header_of(*object);
      T* const next = static_cast<T*>(header.link.load(std::memory_order_relaxed));  // (25)
      if (state_word{policy::load(header.state)}.count() == 0) {
        destroy_object(object);
        ++destroyed;
      } else {
        push(object);
      }
      object = next;
    }
    return destroyed;
  }

  /// Whether no object waits; another thread may change it at once.
  [[nodiscard]] bool empty() const noexcept {
    return first_.load(std::memory_order_relaxed) == nullptr;  // (25) nothing is read through it.
  }

 private:
  using policy = detail::policy_of<T>;

  void push(T* object) noexcept {
    auto& link = detail::access::header_of(*object).link;
    T* below = first_.load(std::memory_order_relaxed);  // (25)
    do {
      link.store(below, std::memory_order_relaxed);  // (25)
      // (25) release: publishes the links to scan().
    } while (!first_.compare_exchange_weak(below, object, std::memory_order_release,
                                           std::memory_order_relaxed));  // (25)
  }

  typename policy::env::template atomic<T*> first_{nullptr};
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
