/// @file
/// What slamgc does when it is misused: a replaceable assertion that names the object.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "detail/object_watch.hpp"
#include "flavour.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// What a failed check knows about the object that was misused.
struct misuse {
  const char* what;         ///< What the program did, as a phrase.
  const char* type;         ///< The object's type, as the compiler spells it.
  const void* object;       ///< The object's address.
  std::uint32_t count;      ///< The reference count that was found.
  std::uint32_t place = 0;  ///< For print_places(): where the pointer was borrowed.
};

/// Prints where *@p m happened, and where its object came to its end, to the standard error stream, if a quarantine is at
/// work (diagnosis/quarantine.hpp); else nothing. For a `SLAMGC_ASSERT` of the program's own.
inline void print_places(const misuse& m) noexcept {
  if (auto* const watch = detail::watch()) watch->print(m.object, m.place);
}

/// Prints @p m to the standard error stream and aborts. The default of `SLAMGC_ASSERT`.
[[noreturn]] inline void abort_on(const misuse& m) noexcept {
  std::fprintf(stderr, "slamgc: %s: object %p of type %s, count %lu\n", m.what, m.object, m.type,
               static_cast<unsigned long>(m.count));
  print_places(m);
  std::abort();
}

namespace detail {

template <class T>
constexpr const char* signature() noexcept {
  return __PRETTY_FUNCTION__;
}

/// The name of T without run-time type information: cut out of the compiler's function signature.
template <class T>
class type_name {
 public:
  static constexpr const char* get() noexcept { return value.text; }

 private:
  static constexpr std::size_t begin() noexcept {
    const char* s = signature<T>();
    std::size_t i = 0;
    while (!(s[i] == 'T' && s[i + 1] == ' ' && s[i + 2] == '=')) ++i;
    return i + 4;
  }
  static constexpr std::size_t size() noexcept {
    const char* s = signature<T>() + begin();
    std::size_t n = 0;
    int depth = 0;  // gcc adds "; Other = ..." after T, clang never does
    while (s[n] != '\0' && !(depth == 0 && (s[n] == ']' || s[n] == ';'))) {
      if (s[n] == '[') ++depth;
      if (s[n] == ']') --depth;
      ++n;
    }
    return n;
  }
  struct buffer {
    char text[size() + 1] = {};
    constexpr buffer() noexcept {
      for (std::size_t i = 0; i != size(); ++i) text[i] = signature<T>()[begin() + i];
    }
  };
  static constexpr buffer value{};
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

/// Checks @p condition in the checked flavour; @p found is a slamgc::misuse.
///
/// Define it before including slamgc to report in another way. It may return: the library then
/// undoes the misuse where it can (a decrement below zero, a second `edit()`), so that nothing that
/// is in use is lost. It must not throw: it runs inside `noexcept` functions.
#ifndef SLAMGC_ASSERT
#if SLAMGC_DEBUG
#define SLAMGC_ASSERT(condition, found) ((condition) ? void() : ::slamgc::abort_on(found))
#else
#define SLAMGC_ASSERT(condition, found) ((void)0)
#endif
#endif
