/// @file
/// An element of a counted container, as an expression that can be read and assigned.
#pragma once

#include "header.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// What `v[i]` is where `v` is an rc_vector: reads like a `T*`, and counts when it is assigned.
///
/// Assignment is an atomic exchange, as in rc_slot: two threads that assign one element each release
/// another old pointer, even where the program forgot its lock. Not for keeping: like any reference
/// to an element it dies with the next change of the container's size, and `auto p = v[i];` copies
/// the reference, not the pointer.
template <class T>
class element_ref {
 public:
  /// Refers to @p element.
  explicit element_ref(T*& element) noexcept : element_(element) {}
  /// Refers to the same element.
  element_ref(const element_ref&) noexcept = default;

  /// The pointer, borrowed: for a reader that does not hold the lock of the container.
  [[nodiscard]] T* get() const noexcept { return policy_of<T>::env::load(element_); }
  /// The pointer, borrowed, under the lock of the container: a plain read.
  [[nodiscard]] operator T*() const noexcept { return element_; }
  /// The object's members. Not for null.
  [[nodiscard]] T* operator->() const noexcept { return *this; }
  /// The object. Not for null.
  [[nodiscard]] T& operator*() const noexcept { return *static_cast<T*>(*this); }

  /// The element refers to @p p.
  const element_ref& operator=(T* p) const noexcept {
    detail::add_reference(p);
    detail::drop_reference(policy_of<T>::env::exchange(element_, p));
    return *this;
  }
  /// If the element refers to @p expected: it refers to @p p, and returns true. Else nothing changes.
  bool compare_exchange(T* expected, T* p) const noexcept {
    detail::add_reference(p);
    const bool done = policy_of<T>::env::compare_exchange(element_, expected, p);
    detail::drop_reference(done ? expected : p);
    return done;
  }
  /// The element refers to what @p other refers to now.
  element_ref& operator=(const element_ref& other) noexcept {
    *this = other.get();
    return *this;
  }
  /// Exchanges the pointers of two elements.
  friend void swap(element_ref a, element_ref b) noexcept {
    T* const from_a = a.get();
    detail::add_reference(from_a);  // it is in neither element for a moment
    a = b.get();
    b = from_a;
    detail::drop_reference(from_a);
  }

 private:
  T*& element_;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
