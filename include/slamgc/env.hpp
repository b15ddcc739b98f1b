/// @file
/// The environment: everything atomic and everything per thread that slamgc uses.
///
/// Every header takes these from an `Env` parameter, which users never see. Another environment
/// runs the same headers under a weak-memory model checker or under a scheduler that injects yields
/// (tests/support). This is the only file that names `std::atomic`.
#pragma once

#include <atomic>
#include <cstddef>
#include <type_traits>

#include "fwd.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// The environment of ordinary programs.
struct std_env {
  /// Atomic variable.
  template <class T>
  using atomic = std::atomic<T>;

  /// The calling thread's own record of type @p Record, made on first use and zero at first.
  ///
  /// Trivial types only: their storage stays valid while the thread's other thread-local objects
  /// are destroyed.
  template <class Record>
  [[nodiscard]] static Record& thread_record() noexcept {
    static_assert(std::is_trivially_destructible<Record>::value,
                  "slamgc: a thread record must outlive every other thread-local object");
    static thread_local Record record{};
    return record;
  }

  /// As many mutators of a domain at a time have a place of their own in its tables; more share one.
  static constexpr std::size_t mutator_doors = 62;

  /// Reads an element of a standard container that others may assign at the same time, without lock.
  template <class T>
  [[nodiscard]] static T* load(T* const& element) noexcept {
    // (1) memory_order_acquire: sees the object that exchange (2) published.
    return __atomic_load_n(&element, __ATOMIC_ACQUIRE);
  }

  /// Replaces an element of a standard container; each old pointer is handed to exactly one caller.
  template <class T>
  [[nodiscard]] static T* exchange(T*& element, T* desired) noexcept {
    // (2) memory_order_acq_rel: publishes *desired to load (1) and to the next exchange, and sees
    // what the exchange that stored the old pointer published.
    return __atomic_exchange_n(&element, desired, __ATOMIC_ACQ_REL);
  }

  /// Replaces an element of a standard container if it is @p expected.
  template <class T>
  [[nodiscard]] static bool compare_exchange(T*& element, T* expected, T* desired) noexcept {
    // (2) memory_order_acq_rel: as exchange().
    // (2) memory_order_relaxed: a failure reads nothing that anybody uses.
    return __atomic_compare_exchange_n(&element, &expected, desired, false,
                                       __ATOMIC_ACQ_REL,   // (2)
                                       __ATOMIC_RELAXED);  // (2)
  }
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
