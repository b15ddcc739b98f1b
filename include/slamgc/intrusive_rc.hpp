/// @file
/// The counted pointer for locals, parameters and roots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <type_traits>
#include <typeindex>  // the smallest header with std::hash
#include <utility>

#include "detail/header.hpp"
#include "fwd.hpp"
#include "rc_object.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Whether an `intrusive_rc<T>` converts to `T*` without being asked, as existing code may need.
///
/// Off unless the program says, after the type's declaration:
/// `template <> inline constexpr bool slamgc::implicit_to_raw<KeyFrame> = true;`
template <class T>
inline constexpr bool implicit_to_raw = false;

/// Counted pointer: while it exists, the object does.
///
/// Everything that `boost::intrusive_ptr` offers is here under the same name. It is as large as a
/// pointer, allocates nothing, and a move costs no count. For a member of an object use rc_slot,
/// which several threads may assign.
///
/// Thread-safety: that of a plain pointer. Different intrusive_rc to one object may be used by
/// different threads. Every operation is O(1), apart from what a destructor does when the last
/// reference goes. Misuse is reported through SLAMGC_ASSERT.
template <class T>
class intrusive_rc {
 public:
  /// What it points to.
  using element_type = T;

  /// Null.
  constexpr intrusive_rc() noexcept = default;
  /// Null. A template, so that `NULL` and `0` are taken as pointers.
  template <class Null, class = std::enable_if_t<std::is_same<Null, std::nullptr_t>::value>>
  constexpr intrusive_rc(Null) noexcept {}
  /// Refers to @p p; takes over a reference that is already counted if @p add_ref is false.
  intrusive_rc(T* p, bool add_ref = true) noexcept : p_(p) {
    if (add_ref) {
      detail::add_reference(p_);
    } else {
      SLAMGC_ASSERT(p_ == nullptr || (detail::count_of(p_) != 0 && !detail::is_dying(p_)),
                    (detail::misuse_of(p_, "adopts a reference that nobody counted")));
    }
  }
  /// Another reference to the same object.
  intrusive_rc(const intrusive_rc& other) noexcept : p_(other.p_) { detail::add_reference(p_); }
  /// Takes over the reference of @p other, which becomes null.
  intrusive_rc(intrusive_rc&& other) noexcept : p_(std::exchange(other.p_, nullptr)) {}
  /// Another reference to the same object, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  intrusive_rc(const intrusive_rc<U>& other) noexcept : p_(other.get()) {
    detail::add_reference(p_);
  }
  /// Takes over the reference of @p other, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  intrusive_rc(intrusive_rc<U>&& other) noexcept : p_(other.detach()) {}
  /// A reference to what a slot refers to.
  template <class U, class Env, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  intrusive_rc(const rc_slot<U, Env>& slot) noexcept : intrusive_rc(slot.get()) {}
  /// Gives its reference up.
  ~intrusive_rc() { detail::drop_reference(p_); }

  /// Refers to the same object as @p other.
  intrusive_rc& operator=(const intrusive_rc& other) noexcept {
    intrusive_rc(other).swap(*this);
    return *this;
  }
  /// Takes over the reference of @p other, which becomes null.
  intrusive_rc& operator=(intrusive_rc&& other) noexcept {
    intrusive_rc(std::move(other)).swap(*this);
    return *this;
  }
  /// Refers to the same object as @p other, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  intrusive_rc& operator=(const intrusive_rc<U>& other) noexcept {
    intrusive_rc(other).swap(*this);
    return *this;
  }
  /// Takes over the reference of @p other, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  intrusive_rc& operator=(intrusive_rc<U>&& other) noexcept {
    intrusive_rc(std::move(other)).swap(*this);
    return *this;
  }
  /// Refers to @p p.
  intrusive_rc& operator=(T* p) noexcept {
    intrusive_rc(p).swap(*this);
    return *this;
  }

  /// Refers to what @p slot refers to.
  template <class U, class Env, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  intrusive_rc& operator=(const rc_slot<U, Env>& slot) noexcept {
    intrusive_rc(slot.get()).swap(*this);
    return *this;
  }

  /// Takes over a reference that detach() gave up and is still counted.
  [[nodiscard]] static intrusive_rc adopt(T* p) noexcept { return intrusive_rc(p, false); }

  /// Becomes null.
  void reset() noexcept { intrusive_rc().swap(*this); }
  /// Refers to @p p; takes over a reference that is already counted if @p add_ref is false.
  void reset(T* p, bool add_ref = true) noexcept { intrusive_rc(p, add_ref).swap(*this); }

  /// The pointer.
  [[nodiscard]] constexpr T* get() const noexcept { return p_; }
  /// Becomes null and leaves its reference counted: the caller owns it now.
  T* detach() noexcept { return std::exchange(p_, nullptr); }
  /// The object. Not for a null pointer.
  [[nodiscard]] constexpr T& operator*() const noexcept { return *p_; }
  /// The object's members. Not for a null pointer.
  [[nodiscard]] constexpr T* operator->() const noexcept { return p_; }
  /// Whether it refers to an object.
  [[nodiscard]] constexpr explicit operator bool() const noexcept { return p_ != nullptr; }
  /// The pointer, as its base or as const, without being asked, for types that opted in; see
  /// implicit_to_raw.
  template <class U, class = std::enable_if_t<std::is_convertible<T*, U*>::value &&
                                              implicit_to_raw<std::remove_cv_t<T>>>>
  [[nodiscard]] constexpr operator U*() const noexcept {
    return p_;
  }

  /// Exchanges two references; no count changes.
  void swap(intrusive_rc& other) noexcept { std::swap(p_, other.p_); }

 private:
  T* p_ = nullptr;
};

/// Makes an object and its first reference. Throws what the allocation or the constructor throws.
template <class T, class... Args>
[[nodiscard]] intrusive_rc<T> make_rc(Args&&... args) {
  return intrusive_rc<T>(new T(std::forward<Args>(args)...));
}

/// Exchanges two references; no count changes.
template <class T>
void swap(intrusive_rc<T>& a, intrusive_rc<T>& b) noexcept {
  a.swap(b);
}

/// The pointer, for generic code such as `boost::mem_fn`.
template <class T>
[[nodiscard]] constexpr T* get_pointer(const intrusive_rc<T>& p) noexcept {
  return p.get();
}

// Casts. Those from an rvalue take the reference over.

/// static_cast of the pointer.
template <class T, class U>
[[nodiscard]] intrusive_rc<T> static_pointer_cast(const intrusive_rc<U>& p) noexcept {
  return static_cast<T*>(p.get());
}
/// static_cast of the pointer.
template <class T, class U>
[[nodiscard]] intrusive_rc<T> static_pointer_cast(intrusive_rc<U>&& p) noexcept {
  return intrusive_rc<T>(static_cast<T*>(p.detach()), false);
}
/// const_cast of the pointer.
template <class T, class U>
[[nodiscard]] intrusive_rc<T> const_pointer_cast(const intrusive_rc<U>& p) noexcept {
  return const_cast<T*>(p.get());
}
/// const_cast of the pointer.
template <class T, class U>
[[nodiscard]] intrusive_rc<T> const_pointer_cast(intrusive_rc<U>&& p) noexcept {
  return intrusive_rc<T>(const_cast<T*>(p.detach()), false);
}
/// dynamic_cast of the pointer; null if the object is no T.
template <class T, class U>
[[nodiscard]] intrusive_rc<T> dynamic_pointer_cast(const intrusive_rc<U>& p) noexcept {
  return dynamic_cast<T*>(p.get());
}
/// dynamic_cast of the pointer; null if the object is no T, and @p p keeps its reference then.
template <class T, class U>
[[nodiscard]] intrusive_rc<T> dynamic_pointer_cast(intrusive_rc<U>&& p) noexcept {
  T* const cast = dynamic_cast<T*>(p.get());
  if (cast == nullptr) return nullptr;
  (void)p.detach();
  return intrusive_rc<T>(cast, false);
}

// Comparisons: by address, with raw pointers too, without touching a count.

/// Whether both point to the same object.
template <class T, class U>
[[nodiscard]] constexpr bool operator==(const intrusive_rc<T>& a,
                                        const intrusive_rc<U>& b) noexcept {
  return a.get() == b.get();
}
/// Whether they point to different objects.
template <class T, class U>
[[nodiscard]] constexpr bool operator!=(const intrusive_rc<T>& a,
                                        const intrusive_rc<U>& b) noexcept {
  return a.get() != b.get();
}
/// Whether both point to the same object.
template <class T, class U>
[[nodiscard]] constexpr bool operator==(const intrusive_rc<T>& a, U* b) noexcept {
  return a.get() == b;
}
/// Whether they point to different objects.
template <class T, class U>
[[nodiscard]] constexpr bool operator!=(const intrusive_rc<T>& a, U* b) noexcept {
  return a.get() != b;
}
/// Whether both point to the same object.
template <class T, class U>
[[nodiscard]] constexpr bool operator==(T* a, const intrusive_rc<U>& b) noexcept {
  return a == b.get();
}
/// Whether they point to different objects.
template <class T, class U>
[[nodiscard]] constexpr bool operator!=(T* a, const intrusive_rc<U>& b) noexcept {
  return a != b.get();
}
/// Whether it is null.
template <class T>
[[nodiscard]] constexpr bool operator==(const intrusive_rc<T>& a, std::nullptr_t) noexcept {
  return a.get() == nullptr;
}
/// Whether it is not null.
template <class T>
[[nodiscard]] constexpr bool operator!=(const intrusive_rc<T>& a, std::nullptr_t) noexcept {
  return a.get() != nullptr;
}
/// Whether it is null.
template <class T>
[[nodiscard]] constexpr bool operator==(std::nullptr_t, const intrusive_rc<T>& a) noexcept {
  return a.get() == nullptr;
}
/// Whether it is not null.
template <class T>
[[nodiscard]] constexpr bool operator!=(std::nullptr_t, const intrusive_rc<T>& a) noexcept {
  return a.get() != nullptr;
}

namespace detail {
/// A total order of addresses, also where the built-in `<` gives none; `std::less` is in a large
/// header.
template <class T, class U>
bool address_less(T* a, U* b) noexcept {
  using common = std::common_type_t<T*, U*>;
  return reinterpret_cast<std::uintptr_t>(static_cast<common>(a)) <
         reinterpret_cast<std::uintptr_t>(static_cast<common>(b));
}
}  // namespace detail

/// By address.
template <class T, class U>
[[nodiscard]] bool operator<(const intrusive_rc<T>& a, const intrusive_rc<U>& b) noexcept {
  return detail::address_less(a.get(), b.get());
}
/// By address.
template <class T, class U>
[[nodiscard]] bool operator<(const intrusive_rc<T>& a, U* b) noexcept {
  return detail::address_less(a.get(), b);
}
/// By address.
template <class T, class U>
[[nodiscard]] bool operator<(T* a, const intrusive_rc<U>& b) noexcept {
  return detail::address_less(a, b.get());
}

/// Prints the address.
template <class Char, class CharTraits, class T>
std::basic_ostream<Char, CharTraits>& operator<<(std::basic_ostream<Char, CharTraits>& out,
                                                 const intrusive_rc<T>& p) {
  return out << p.get();
}

/// For `boost::hash`: that of the address.
template <class T>
[[nodiscard]] std::size_t hash_value(const intrusive_rc<T>& p) noexcept {
  return std::hash<T*>()(p.get());
}

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

/// The hash of the address: equal to that of the raw pointer.
template <class T>
struct std::hash<slamgc::intrusive_rc<T>> {
  /// The hash of the address.
  [[nodiscard]] std::size_t operator()(const slamgc::intrusive_rc<T>& p) const noexcept {
    return std::hash<T*>()(p.get());
  }
};
