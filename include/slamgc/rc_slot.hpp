/// @file
/// The counted pointer for members: an edge of the graph.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "detail/counted_member.hpp"
#include "detail/header.hpp"
#include "env.hpp"
#include "fwd.hpp"
#include "intrusive_rc.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Counted pointer for a member of an object: what was `KeyFrame* mpParent;` becomes
/// `slamgc::rc_slot<KeyFrame> mpParent;`, and the code that uses it stays.
///
/// Reading is a load and gives a borrowed pointer, exactly as a raw member does. Assignment is an
/// atomic exchange, unless the pointer is there already: several threads may assign one slot without a
/// lock, and each old pointer is released once. It is as large as a pointer; `T` may be incomplete where the member is declared.
///
/// Thread-safety: any thread may read or assign at any time. A pointer that was *read* is safe to use
/// or to count only while something else keeps the object: a lock under which all writers assign, a
/// reference of the reader's own, or a grace period. Copying, moving and swapping read the other
/// slot, so the same holds for them. All operations are O(1), apart from a destructor that the last
/// reference sets off.
template <class T, class Env>
class rc_slot : private detail::counted_member<rc_slot<T, Env>> {
  static_assert(!std::is_pointer<T>::value,
                "slamgc: write rc_slot<KeyFrame>, not rc_slot<KeyFrame*>");

 public:
  /// What it points to.
  using element_type = T;

  /// Null.
  constexpr rc_slot() noexcept = default;
  /// Null. A template, so that `NULL` is taken as a pointer.
  template <class Null, class = std::enable_if_t<std::is_same<Null, std::nullptr_t>::value>>
  constexpr rc_slot(Null) noexcept {}
  /// Refers to @p p. Explicit, so that `condition ? slot : pointer` stays a pointer.
  explicit rc_slot(T* p) noexcept : p_((detail::add_reference(p), p)) {}
  /// Refers to the same object as @p p, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  explicit rc_slot(const intrusive_rc<U>& p) noexcept : rc_slot(static_cast<T*>(p.get())) {}
  /// Takes over the reference of @p p, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  explicit rc_slot(intrusive_rc<U>&& p) noexcept : p_(moved(p.detach())) {}
  /// Another reference to the same object.
  rc_slot(const rc_slot& other) noexcept : rc_slot(other.get()) {}
  /// Moves the reference here; @p other becomes null.
  rc_slot(rc_slot&& other) noexcept : p_(moved(other.replace(nullptr))) {}
  /// Removes the reference.
  ~rc_slot() { detail::drop_reference(replace(nullptr)); }

  /// Refers to @p p. Costs a load if it does already: references that are set in every frame mostly do.
  rc_slot& operator=(T* p) noexcept {
    if (get() == p) return *this;
    detail::add_reference(p);
    detail::drop_reference(replace(p));
    return *this;
  }
  /// Refers to the same object as @p other.
  rc_slot& operator=(const rc_slot& other) noexcept { return *this = other.get(); }
  /// Moves the reference here; @p other becomes null.
  rc_slot& operator=(rc_slot&& other) noexcept {
    detail::drop_reference(replace(moved(other.replace(nullptr))));
    return *this;
  }
  /// Refers to the same object as @p p, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  rc_slot& operator=(const intrusive_rc<U>& p) noexcept {
    return *this = static_cast<T*>(p.get());
  }
  /// Takes over the reference of @p p, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  rc_slot& operator=(intrusive_rc<U>&& p) noexcept {
    detail::drop_reference(replace(moved(p.detach())));
    return *this;
  }

  /// The pointer: borrowed.
  [[nodiscard]] T* get() const noexcept {
    return p_.load(std::memory_order_acquire);  // (9) sees the object that (10) published.
  }
  /// The pointer: borrowed.
  [[nodiscard]] operator T*() const noexcept { return get(); }
  /// The object's members. Not for a null slot.
  [[nodiscard]] T* operator->() const noexcept { return get(); }
  /// The object. Not for a null slot.
  [[nodiscard]] T& operator*() const noexcept { return *get(); }

  /// Refers to @p p and gives the old reference to the caller.
  [[nodiscard]] intrusive_rc<T> exchange(T* p) noexcept {
    detail::add_reference(p);
    return intrusive_rc<T>(moved(replace(p)), false);
  }
  /// If it refers to @p expected: refers to @p p and returns true. Else nothing changes.
  bool compare_exchange(T* expected, T* p) noexcept {
    detail::add_reference(p);
    // (10) as replace(): a failure reads nothing that anybody uses.
    const bool done = p_.compare_exchange_strong(expected, p, std::memory_order_acq_rel,
                                                 std::memory_order_relaxed);  // (10)
    detail::drop_reference(done ? expected : p);
    return done;
  }
  /// For a function that takes a `T*&`, as an argument of its call: a plain pointer, which the slot refers to when this ends.
  class edit_scope {
   public:
    explicit edit_scope(rc_slot& slot) noexcept : slot_(slot), p_(slot.get()) {}  ///< See edit().
    ~edit_scope() { slot_ = p_; }                                                 ///< Stores it.
    edit_scope(const edit_scope&) = delete;
    edit_scope& operator=(const edit_scope&) = delete;
    operator T*&() noexcept { return p_; }  ///< The pointer.

   private:
    rc_slot& slot_;
    T* p_;
  };
  /// See edit_scope. What other threads store meanwhile is overwritten.
  [[nodiscard]] edit_scope edit() & noexcept { return edit_scope(*this); }
  /// Becomes null.
  void reset() noexcept { *this = static_cast<T*>(nullptr); }

  /// Exchanges the references of two slots. No reader of either sees null in between.
  void swap(rc_slot& other) noexcept {
    // Another thread may assign either slot meanwhile: what this one puts away is what it finds.
    T* const mine = get();
    detail::add_reference(mine);
    T* const theirs = moved(other.replace(mine));
    detail::drop_reference(replace(theirs));
  }

 private:
  friend struct detail::member_access;

  /// Stores @p p, which is counted already; whatever stood here is the caller's.
  T* replace(T* p) noexcept {
    // (10) release: publishes the object and its count to (9) and (10); acquire: the caller may be
    // the one that destroys the old object, which another thread's (10) published.
    return p_.exchange(p, std::memory_order_acq_rel);
  }
  static T* moved(T* p) noexcept {
    detail::move_reference(p);
    return p;
  }

  typename Env::template atomic<T*> p_{nullptr};
};

/// Whether both point to the same object.
template <class T, class Env, class U>
[[nodiscard]] bool operator==(const rc_slot<T, Env>& a, const intrusive_rc<U>& b) noexcept {
  return a.get() == b.get();
}
/// Whether both point to the same object.
template <class T, class U, class Env>
[[nodiscard]] bool operator==(const intrusive_rc<T>& a, const rc_slot<U, Env>& b) noexcept {
  return a.get() == b.get();
}
/// Whether they point to different objects.
template <class T, class Env, class U>
[[nodiscard]] bool operator!=(const rc_slot<T, Env>& a, const intrusive_rc<U>& b) noexcept {
  return a.get() != b.get();
}
/// Whether they point to different objects.
template <class T, class U, class Env>
[[nodiscard]] bool operator!=(const intrusive_rc<T>& a, const rc_slot<U, Env>& b) noexcept {
  return a.get() != b.get();
}

/// Exchanges the references of two slots.
template <class T, class Env>
void swap(rc_slot<T, Env>& a, rc_slot<T, Env>& b) noexcept {
  a.swap(b);
}

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
