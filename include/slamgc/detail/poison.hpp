/// @file
/// Whether memory that is held back was written to; with AddressSanitizer, nobody may touch it.
#pragma once

#include <cstddef>
#if defined(__SANITIZE_ADDRESS__)
#define SLAMGC_HAS_ASAN 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SLAMGC_HAS_ASAN 1
#endif
#endif
#if defined(SLAMGC_HAS_ASAN)
#include <sanitizer/asan_interface.h>
#endif

#include "../fwd.hpp"
#include "object_watch.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

inline void poison(const runtime::held_memory& m) noexcept {
#if defined(SLAMGC_HAS_ASAN)
  __asan_poison_memory_region(m.begin, m.size);
#else
  (void)m;
#endif
}
inline void unpoison(const runtime::held_memory& m) noexcept {
#if defined(SLAMGC_HAS_ASAN)
  __asan_unpoison_memory_region(m.begin, m.size);
#else
  (void)m;
#endif
}

/// The offset of the first byte that was written, or the size.
inline std::size_t first_damage(const runtime::held_memory& m) noexcept {
  const auto* const bytes = static_cast<const unsigned char*>(m.begin);
  const auto header = static_cast<std::size_t>(static_cast<const unsigned char*>(m.header) - bytes);
  unpoison(m);
  std::size_t i = 0;
  while (i != m.size) {
    if (i == header) {
      if (!m.header_is_new(m.header)) break;
      i += m.header_size;
    } else {
      if (bytes[i] != m.pattern) break;
      ++i;
    }
  }
  poison(m);
  return i;
}

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
