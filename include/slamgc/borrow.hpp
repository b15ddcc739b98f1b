/// @file
/// A borrowed pointer that checks itself.
#pragma once

#include <cstdint>
#include <type_traits>

#include "assert.hpp"
#include "detail/participant.hpp"
#include "env.hpp"
#include "fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A local `T*` that says that it is borrowed: `slamgc::borrow<KeyFrame> pKF = mpReferenceKF;`.
///
/// In the checked flavour each use checks that the thread is an online mutator, the same as when the pointer
/// was borrowed, and that it has passed no quiescent state since. (Destructors that a collector runs may borrow, too.) On a
/// thread with several mutators that is the innermost online one, whatever the object's domain. In the unchecked flavour it is a pointer and
/// nothing else. For locals and parameters only: it is larger in the checked flavour.
///
/// Thread-safety: it belongs to the thread that made it. Every use is O(mutators of the thread).
template <class T, class Env>
class borrow {
 public:
  using element_type = T;  ///< What it points to.

  /// Borrows @p p now; null may be borrowed by any thread.
  borrow(T* p = nullptr) noexcept : p_(p) {
#if SLAMGC_DEBUG
    const auto* me = runtime::participants<Env>::borrower();
    SLAMGC_ASSERT(p == nullptr || me != nullptr,
                  (misuse{"borrows on a thread that is no online mutator",
                          detail::type_name<T>::get(), p, 0}));
    passed_ = me != nullptr ? me->passed : 0;
    if (auto* const watch = detail::watch()) {
      SLAMGC_ASSERT(!watch->holds(p), (misuse{"borrows an object that was reclaimed",
                                              detail::type_name<T>::get(), p, 0}));
      place_ = watch->here();
    }
#endif
  }
  /// Borrows what @p from, a slot or an element of a container, refers to now.
  template <class U, class = std::enable_if_t<std::is_convertible<const U&, T*>::value &&
                                              !std::is_same<U, borrow>::value>>
  borrow(const U& from) noexcept : borrow(static_cast<T*>(from)) {}
  /// Copies borrow what the original borrowed, since then.
  borrow(const borrow&) noexcept = default;
  /// Copies borrow what the original borrowed, since then.
  borrow& operator=(const borrow&) noexcept = default;

  /// The pointer.
  [[nodiscard]] T* get() const noexcept {
    check();
    return p_;
  }
  /// The pointer.
  operator T*() const noexcept { return get(); }
  /// The object.
  T& operator*() const noexcept { return *get(); }
  /// The object.
  T* operator->() const noexcept { return get(); }

 private:
#if SLAMGC_DEBUG
  void check() const noexcept {
    if (p_ == nullptr) return;
    const auto* me = runtime::participants<Env>::of_this_thread().innermost;
    while (me != nullptr && !(me->may_borrow() && me->passed == passed_)) me = me->outer;
    SLAMGC_ASSERT(me != nullptr, (misuse{"uses a borrowed pointer after a quiescent state",
                                         detail::type_name<T>::get(), p_, 0, place_}));
  }
  std::uint64_t passed_;
  std::uint32_t place_ = 0;  // in the program, for reports
#else
  void check() const noexcept {}
#endif
  T* p_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
