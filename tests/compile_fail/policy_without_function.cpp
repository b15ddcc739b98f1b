// expect-error: slamgc: the counter policy needs load, add, subtract
#include <cstdint>
#include <slamgc/intrusive_rc.hpp>

struct policy {
  using env = slamgc::std_env;
  struct storage {
    std::uint64_t word = 0;
  };
  static std::uint64_t load(const storage& s) noexcept { return s.word; }
  static std::uint64_t add(storage& s, std::uint64_t d) noexcept { return (s.word += d) - d; }
#ifdef SLAMGC_POSITIVE_CONTROL
  static std::uint64_t subtract(storage& s, std::uint64_t d) noexcept { return add(s, 0 - d); }
#endif
  static bool compare_exchange(storage& s, std::uint64_t& expected, std::uint64_t d) noexcept {
    const bool equal = s.word == expected;
    (equal ? s.word : expected) = equal ? d : s.word;
    return equal;
  }
};

struct keyframe : slamgc::rc_object<keyframe, policy> {};

slamgc::intrusive_rc<keyframe> make() { return slamgc::make_rc<keyframe>(); }
