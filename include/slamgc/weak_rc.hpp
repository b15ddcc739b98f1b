/// @file
/// Handles that do not keep their object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>  // std::hash
#include <type_traits>
#include <utility>

#include "assert.hpp"
#include "deferred.hpp"
#include "detail/participant.hpp"
#include "detail/side_block.hpp"
#include "fwd.hpp"
#include "intrusive_rc.hpp"
#include "rc_slot.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Base class of objects that weak handles may refer to, beside rc_object:
///
/// ```
/// class KeyFrame : public slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
///                  public slamgc::enable_weak_rc<KeyFrame> {
/// ```
///
/// Adds one pointer. The first weak handle to an object allocates its side block, of 56 bytes on 64-bit systems. A copy of an
/// object has no weak handles; assignment leaves them alone. Types without it pay nothing.
///
/// A program that itself deletes an object says that no thread uses it, not by a weak handle either; handles that
/// are left expire.
///
/// @tparam T   The class that derives from rc_object, with reclaim_deferred or reclaim_retired.
/// @tparam Env The environment of its counter policy.
template <class T, class Env>
class enable_weak_rc : public detail::block_owner<T, Env> {
 protected:
  /// No weak handle yet.
  enable_weak_rc() noexcept {
    static_assert(
        detail::is_deferred<T>::value,
        "slamgc: weak handles need a deferred reclaimer: another thread could destroy the "
        "object before lock() has counted it");
  }
  /// A copy is a new object.
  enable_weak_rc(const enable_weak_rc&) noexcept : enable_weak_rc() {}
  /// Handles refer to the object, not to its value: nothing changes.
  enable_weak_rc& operator=(const enable_weak_rc&) noexcept { return *this; }
  ~enable_weak_rc() = default;
};

/// Refers to an object without keeping it: what `std::weak_ptr` is. `sizeof(weak_rc<T>) == sizeof(T*)`.
///
/// A plain pointer says nothing about identity across quiescent states, because addresses are used again. A weak handle
/// does: handles are equal if they refer to the same object, for ever, also after it is gone.
///
/// **Expiry.** The handles of an object expire all at once, and for ever, when a collector has found that nobody can see the
/// object but by weak handles; those of objects that only refer to each other expire by one decision: if one of them is locked
/// in time, all live on. While a counted reference exists, handles have not expired, with one exception. A *retired* object
/// (or one that is found at a count of zero again and again) that is disturbed in 4 rounds of collection, by references that come
/// and go, expires although it may still be referred to: otherwise a thread that polls lock() could keep it for ever.
///
/// Thread-safety: as `std::shared_ptr`: different handles by any threads at any time; one handle that somebody
/// changes needs the program's lock. All operations are lock-free and O(1).
template <class T, class Env>
class weak_rc {
 public:
  using element_type = T;  ///< What it refers to.

  /// Null: refers to nothing, and is expired.
  constexpr weak_rc() noexcept = default;
  /// Null: refers to nothing, and is expired.
  constexpr weak_rc(std::nullptr_t) noexcept {}
  /// Refers to @p p. By an online mutator of the object's domain, or who holds a counted reference. Throws
  /// std::bad_alloc, if it is the object's first.
  explicit weak_rc(T* p) : block_(p != nullptr ? block_of(*p) : nullptr) {}
  /// Refers to the same object.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  weak_rc(const intrusive_rc<U>& p) : weak_rc(static_cast<T*>(p.get())) {}
  /// Refers to the same object.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  weak_rc(const rc_slot<U, Env>& p) : weak_rc(static_cast<T*>(p.get())) {}
  /// Refers to the same object, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value &&
                                              !std::is_same<U, T>::value>>
  weak_rc(const weak_rc<U, Env>& other) noexcept : block_(other.block_) {}

  /// A reference to the object, or null if it has expired. On an online mutator of the object's domain.
  ///
  /// What it returns is counted as any other reference. A pointer taken from it is borrowed.
  [[nodiscard]] intrusive_rc<T> lock() const noexcept {
    SLAMGC_ASSERT(block_ == nullptr || runtime::participants<Env>::borrower() != nullptr,
                  (misuse{"locks a weak handle on a thread that is no online mutator",
                          detail::type_name<T>::get(), block_.get(), 0}));
    if (block_ == nullptr) return nullptr;
    using object = detail::object_of<T>;
    return intrusive_rc<T>(static_cast<T*>(detail::lock<object>(*block_)), false);
  }
  /// Whether lock() will return null, now and for ever. False says nothing about later.
  [[nodiscard]] bool expired() const noexcept { return block_ == nullptr || block_->is_dead(); }

  /// Becomes null.
  void reset() noexcept { block_.reset(); }
  /// Exchanges two handles.
  void swap(weak_rc& other) noexcept { block_.swap(other.block_); }

  /// Whether both refer to the same object, dead or alive, or both are null.
  template <class U>
  [[nodiscard]] bool owner_equal(const weak_rc<U, Env>& other) const noexcept {
    return block_ == other.block_;
  }
  /// An order of objects, dead or alive, which stays the same as long as handles to them exist.
  template <class U>
  [[nodiscard]] bool owner_before(const weak_rc<U, Env>& other) const noexcept {
    return block_ < other.block_;
  }
  /// A hash that goes with owner_equal().
  [[nodiscard]] std::size_t owner_hash() const noexcept {
    return std::hash<const void*>()(block_.get());
  }

 private:
  using block = detail::counted_block<Env>;
  template <class U, class OtherEnv>
  friend class weak_rc;

  static intrusive_rc<block> block_of(const T& p) {
    return intrusive_rc<block>(&detail::owner_of<Env>(p).get_or_make());
  }

  intrusive_rc<block> block_;
};

/// Exchanges two handles.
template <class T, class Env>
void swap(weak_rc<T, Env>& a, weak_rc<T, Env>& b) noexcept {
  a.swap(b);
}
/// Whether both refer to the same object, dead or alive, or both are null.
template <class T, class U, class Env>
[[nodiscard]] bool operator==(const weak_rc<T, Env>& a, const weak_rc<U, Env>& b) noexcept {
  return a.owner_equal(b);
}
/// Whether they refer to different objects.
template <class T, class U, class Env>
[[nodiscard]] bool operator!=(const weak_rc<T, Env>& a, const weak_rc<U, Env>& b) noexcept {
  return !a.owner_equal(b);
}
/// An order of objects, dead or alive.
template <class T, class U, class Env>
[[nodiscard]] bool operator<(const weak_rc<T, Env>& a, const weak_rc<U, Env>& b) noexcept {
  return a.owner_before(b);
}

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

/// The hash of the object's identity, which its end does not change.
template <class T, class Env>
struct std::hash<slamgc::weak_rc<T, Env>> {
  /// The hash of the object's identity.
  [[nodiscard]] std::size_t operator()(const slamgc::weak_rc<T, Env>& w) const noexcept {
    return w.owner_hash();
  }
};
