/// @file
/// Places in the program, for reports: stacks of return addresses, each kept once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <map>
#include <vector>
#if __has_include(<execinfo.h>)
#include <execinfo.h>
#define SLAMGC_HAS_EXECINFO 1
#endif

#include "../fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Not thread-safe. A program has few places, so it grows little.
class stacks {
 public:
  static constexpr std::size_t depth = 32;
  using stack = std::array<void*, depth>;  // the innermost first; null behind the last
  using place = std::uint32_t;             // 0: not known

  /// The calling thread's; empty without `<execinfo.h>`.
  static stack here() noexcept {
    stack s{};
#if defined(SLAMGC_HAS_EXECINFO)
    (void)::backtrace(s.data(), static_cast<int>(depth));
#endif
    return s;
  }
  /// Throws std::bad_alloc.
  place add(const stack& s) {
    if (s[0] == nullptr) return 0;
    const auto at = places_.emplace(s, 0).first;
    if (at->second == 0) {
      known_.push_back(&at->first);
      at->second = static_cast<place>(known_.size());
    }
    return at->second;
  }
  /// Throws std::bad_alloc.
  std::vector<void*> frames(place at) const {
    if (at == 0) return {};
    const stack& s = *known_[at - 1];
    return {s.begin(), s.begin() + static_cast<std::ptrdiff_t>(size(s))};
  }
  /// To the standard error stream; nothing if the place is not known.
  void print(const char* what, place at) const noexcept {
    if (at == 0) return;
    std::fprintf(stderr, "slamgc: %s:\n", what);
#if defined(SLAMGC_HAS_EXECINFO)
    std::fflush(stderr);
    const stack& s = *known_[at - 1];
    ::backtrace_symbols_fd(s.data(), static_cast<int>(size(s)), 2);
#endif
  }

 private:
  static std::size_t size(const stack& s) noexcept {
    std::size_t n = 0;
    while (n != depth && s[n] != nullptr) ++n;
    return n;
  }

  std::map<stack, place> places_;
  std::vector<const stack*> known_;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
