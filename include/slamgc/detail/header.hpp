/// @file
/// The header of an object, and how the rest of the library reaches it and counts references.
#pragma once

#include <cstdint>
#include <type_traits>

#include "../assert.hpp"
#include "../counter.hpp"
#include "../fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// State word and link. The link belongs to whoever holds the object queued or destroys it.
template <class Policy>
struct header {
  typename Policy::storage state;
  typename Policy::env::template atomic<void*> link{nullptr};
};

template <class T>
struct false_for : std::false_type {};

/// The base class of T, found by overload resolution, so that T needs no nested types.
template <class T, class Policy, class Reclaimer>
rc_object<T, Policy, Reclaimer> base_of(const rc_object<T, Policy, Reclaimer>*);
void base_of(...);

template <class Base>
struct base_traits {
  static_assert(false_for<Base>::value,
                "slamgc: the type must derive publicly, and once, from slamgc::rc_object");
};
template <class T, class P, class R>
struct base_traits<rc_object<T, P, R>> {
  using object = T;
  using policy = P;
  using reclaimer = R;
};

template <class T, class = void>
struct is_complete : std::false_type {};
template <class T>
struct is_complete<T, std::void_t<decltype(sizeof(T))>> : std::true_type {};

template <class T, bool = is_complete<T>::value>
struct traits_of {
  using type = base_traits<decltype(detail::base_of(static_cast<const T*>(nullptr)))>;
};
template <class T>
struct traits_of<T, false> {
  static_assert(false_for<T>::value,
                "slamgc: the type must be complete where references to it are added or removed: "
                "include its header here");
  using type = base_traits<rc_object<T>>;  // no second message that misleads
};

template <class T>
using object_of = typename traits_of<T>::type::object;
template <class T>
using policy_of = typename traits_of<T>::type::policy;
template <class T>
using reclaimer_of = typename traits_of<T>::type::reclaimer;

/// An address for each type.
template <class T>
inline constexpr char type_key = 0;

/// Marks the reclaimers that defer.
struct deferred_base {};
template <class T>
struct is_deferred : std::is_base_of<deferred_base, reclaimer_of<T>> {};

/// Nobody but this file and the collectors reaches into an object.
struct access {
  template <class T>
  static auto& header_of(const T& object) noexcept {
    const rc_object<object_of<T>, policy_of<T>, reclaimer_of<T>>& base = object;
    return base.header_;
  }
};

template <class T>
std::uint32_t count_of(const T* p) noexcept {
  return transitions<policy_of<T>>::load(access::header_of(*p).state).count();
}
template <class T>
misuse misuse_of(const T* p, const char* what) noexcept {
  return {what, type_name<object_of<T>>::get(), p, detail::count_of(p)};
}

/// The link of an object whose destructor runs points to its own header.
template <class T>
void mark_dying(const T* p) noexcept {
  auto& header = access::header_of(*p);
  // (8) read only by the thread that destroys the object, or by a program already in error.
  header.link.store(&header, std::memory_order_relaxed);
}
template <class T>
bool is_dying(const T* p) noexcept {
  auto& header = access::header_of(*p);
  return header.link.load(std::memory_order_relaxed) == &header;  // (8)
}

/// Whether the reclaimer wants to know of objects that the program itself deletes.
template <class Reclaimer, class T, class = void>
struct has_last_link : std::false_type {};
template <class Reclaimer, class T>
struct has_last_link<Reclaimer, T, std::void_t<decltype(Reclaimer::template last_link<T>(nullptr))>>
    : std::true_type {};

/// Counts a new reference to *p; p may be null. Before the reference is published: who sees it then
/// sees the count, too.
template <class T>
void add_reference(T* p) noexcept {
  static_assert(std::is_same<std::remove_cv_t<T>, object_of<T>>::value ||
                    std::has_virtual_destructor<object_of<T>>::value,
                "slamgc: references to a class derived from the one that derives from rc_object "
                "need a virtual destructor there, or the object would be destroyed in part");
  if (p == nullptr) return;
  SLAMGC_ASSERT(!detail::is_dying(p),
                (detail::misuse_of(p, "refers to an object that is being destroyed")));
  transitions<policy_of<T>>::increment(access::header_of(*p).state);
}

/// A reference to *p is about to change its place; p may be null. Before it shows up there: a walk
/// that meets it in both places then finds another version.
template <class T>
void move_reference(T* p) noexcept {
  if (p != nullptr) transitions<policy_of<T>>::move(access::header_of(*p).state);
}

/// Uncounts a reference to *p after it was unlinked; p may be null. The object may be destroyed.
template <class T>
void drop_reference(T* p) noexcept {
  using object = object_of<T>;
  if (p != nullptr) reclaimer_of<T>::release(const_cast<object*>(static_cast<const object*>(p)));
}

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
