/// @file
/// A counted member that hands out references of the reader's own.
#pragma once

#include <type_traits>
#include <utility>

#include "deferred.hpp"
#include "detail/counted_member.hpp"
#include "detail/header.hpp"
#include "detail/participant.hpp"
#include "fwd.hpp"
#include "intrusive_rc.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Like rc_slot, plus load(), which returns a counted reference, and compare-and-exchange: what
/// `std::atomic<std::shared_ptr<T>>` is, without a lock.
///
/// Only for objects with a deferred reclaimer, and load() and compare-and-exchange only on online mutators
/// of the object's domain: that the pointer read is still an object when it is counted, is what the grace
/// period is for. (A counted load by a plain load and an increment; the price elsewhere is a hazard pointer
/// or a lock.)
///
/// Thread-safety: any thread at any time. All operations are lock-free and O(1).
template <class T, class Env>
class atomic_rc : private detail::counted_member<atomic_rc<T, Env>> {
 public:
  using value_type = intrusive_rc<T>;  ///< What load() returns.

  /// Null.
  constexpr atomic_rc() noexcept = default;
  /// Takes over the reference of @p p.
  explicit atomic_rc(intrusive_rc<T> p) noexcept : p_(moved(p.detach())) {}
  /// Removes the reference.
  ~atomic_rc() { store(nullptr); }
  atomic_rc(const atomic_rc&) = delete;
  atomic_rc& operator=(const atomic_rc&) = delete;

  /// A reference to what it refers to now. On an online mutator.
  [[nodiscard]] intrusive_rc<T> load() const noexcept {
    check_borrower();
    return intrusive_rc<T>(get());
  }
  /// The pointer: borrowed.
  [[nodiscard]] T* get() const noexcept {
    return p_.load(std::memory_order_acquire);  // (23) sees the object that (24) published.
  }
  /// Takes over the reference of @p p.
  void store(intrusive_rc<T> p) noexcept { (void)exchange(std::move(p)); }
  /// Takes over the reference of @p p.
  atomic_rc& operator=(intrusive_rc<T> p) noexcept {
    store(std::move(p));
    return *this;
  }
  /// Takes over the reference of @p p and returns the old one.
  [[nodiscard]] intrusive_rc<T> exchange(intrusive_rc<T> p) noexcept {
    // (24) as rc_slot's exchange (10).
    return adopted(p_.exchange(moved(p.detach()), std::memory_order_acq_rel));
  }
  /// If it refers to @p expected: takes over the reference of @p desired and returns true. Else writes what
  /// it refers to, borrowed, into @p expected, and drops @p desired. On an online mutator.
  bool compare_exchange_strong(T*& expected, intrusive_rc<T> desired) noexcept {
    return compare_exchange(expected, std::move(desired), [this](T*& e, T* d) {
      return p_.compare_exchange_strong(e, d, std::memory_order_acq_rel,  // (24)
                                        std::memory_order_acquire);       // (23)
    });
  }
  /// The same, but it may fail although it refers to @p expected: for loops.
  bool compare_exchange_weak(T*& expected, intrusive_rc<T> desired) noexcept {
    return compare_exchange(expected, std::move(desired), [this](T*& e, T* d) {
      return p_.compare_exchange_weak(e, d, std::memory_order_acq_rel,  // (24)
                                      std::memory_order_acquire);       // (23)
    });
  }

 private:
  friend struct detail::member_access;

  template <class Exchange>
  static bool compare_exchange(T*& expected, intrusive_rc<T> desired, Exchange exchange) noexcept {
    check_borrower();
    T* const old = expected;
    if (!exchange(expected, moved(desired.get()))) return false;
    (void)desired.detach();
    (void)adopted(old);
    return true;
  }
  static T* moved(T* p) noexcept {
    detail::move_reference(p);
    return p;
  }
  static intrusive_rc<T> adopted(T* p) noexcept { return intrusive_rc<T>(moved(p), false); }
  static void check_borrower() noexcept {
    static_assert(
        detail::is_deferred<T>::value,
        "slamgc: what an atomic_rc refers to needs a deferred reclaimer: another thread could "
        "destroy it before load() has counted it");
    SLAMGC_ASSERT(runtime::participants<Env>::borrower() != nullptr,
                  (misuse{"reads an atomic_rc on a thread that is no online mutator",
                          detail::type_name<T>::get(), nullptr, 0}));
  }

  typename Env::template atomic<T*> p_{nullptr};
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
