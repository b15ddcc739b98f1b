/// @file
/// Destroying an object without freeing its memory.
///
/// `delete` is taken apart: the destructor here, the deallocation function that `delete` would have called later. Which one that
/// is depends on the most derived type. It is known for a type without a virtual destructor; for one that has it, only if the
/// object is exactly that type, by run-time type information. Else, and for a class with a destroying `operator delete` or with one
/// that is not accessible together with its destructor, objects are deleted as usual.
#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <type_traits>
#if defined(__cpp_rtti)
#include <typeinfo>
#endif

#include "../counter.hpp"
#include "../fwd.hpp"
#include "header.hpp"
#include "object_watch.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Whether T has a member `operator delete` with these parameters.
template <class T, class Parameters, class = void>
struct has_delete : std::false_type {};
template <class T, class... P>
struct has_delete<T, void(P...),
                  std::void_t<decltype(static_cast<void (*)(P...)>(&T::operator delete))>>
    : std::true_type {};

#if defined(__cpp_lib_destroying_delete)
template <class T>
struct has_destroying_delete
    : std::bool_constant<
          has_delete<T, void(T*, std::destroying_delete_t)>::value ||
          has_delete<T, void(T*, std::destroying_delete_t, std::size_t)>::value ||
          has_delete<T, void(T*, std::destroying_delete_t, std::align_val_t)>::value ||
          has_delete<T, void(T*, std::destroying_delete_t, std::size_t, std::align_val_t)>::value> {
};
#else
template <class T>
struct has_destroying_delete : std::false_type {};
#endif

/// The deallocation function of `delete static_cast<T*>(p)`: [expr.delete] in the C++ standard.
template <class T>
void deallocate(void* p) noexcept {
  constexpr bool over_aligned = alignof(T) > __STDCPP_DEFAULT_NEW_ALIGNMENT__;
  constexpr std::align_val_t alignment{alignof(T)};
  constexpr bool plain = has_delete<T, void(void*)>::value;
  constexpr bool sized = has_delete<T, void(void*, std::size_t)>::value;
  constexpr bool aligned = has_delete<T, void(void*, std::align_val_t)>::value;
  constexpr bool both = has_delete<T, void(void*, std::size_t, std::align_val_t)>::value;
  // A member before a global one; one that takes the alignment if that matters, else one that does not; then the one
  // without a size.
  if constexpr (aligned && (over_aligned || !(plain || sized))) {
    T::operator delete(p, alignment);
  } else if constexpr (both && (over_aligned || !(plain || sized))) {
    T::operator delete(p, sizeof(T), alignment);
  } else if constexpr (plain) {
    T::operator delete(p);
  } else if constexpr (sized) {
    T::operator delete(p, sizeof(T));
  } else if constexpr (over_aligned) {
    ::operator delete(p, alignment);
  } else {
#if defined(__cpp_sized_deallocation)
    ::operator delete(p, sizeof(T));
#else
    ::operator delete(p);
#endif
  }
}

/// Whether *object is a T and nothing derived from it, as far as that can be known.
template <class T>
bool is_exactly([[maybe_unused]] const T& object) noexcept {
  if constexpr (std::is_final<T>::value || !std::has_virtual_destructor<T>::value) {
    return true;
  } else {
#if defined(__cpp_rtti)
    return typeid(object) == typeid(T);
#else
    return false;
#endif
  }
}

/// Destroys the object and gives its memory to @p by. False if it is left to the caller, as it was.
template <class T>
bool hold_back(T* object, runtime::object_watch& by) noexcept {
  if constexpr (std::is_destructible<T>::value && !has_destroying_delete<T>::value) {
    if (is_exactly(*object)) {
      using policy = policy_of<T>;
      using header_type = header<policy>;
      // Nothing is added to it, even by a program that goes on after a report.
      constexpr std::uint64_t word = state_word::retired_flag | state_word::queued_flag;
      void* const memory = object;
      void* const place = &access::header_of(*object);
      object->~T();
      std::memset(memory, runtime::held_memory::pattern, sizeof(T));
      auto* const header = new (place) header_type;
      (void)policy::add(header->state, word);
      header->link.store(header, std::memory_order_relaxed);  // (8) as mark_dying
      by.hold({memory, sizeof(T), type_name<T>::get(), header, sizeof(header_type),
               [](const void* of) noexcept {
                 const auto& h = *static_cast<const header_type*>(of);
                 return policy::load(h.state) == word &&
                        h.link.load(std::memory_order_relaxed) == of;  // (8)
               },
               [](const runtime::held_memory& m) noexcept {
                 static_cast<header_type*>(m.header)->~header_type();
                 deallocate<T>(m.begin);
               }});
      return true;
    }
  }
  by.let_go(object);
  return false;
}

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
