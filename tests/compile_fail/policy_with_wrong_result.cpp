// expect-error: slamgc: the counter policy needs load, add, subtract \(returning std::uint64_t\)
#include <cstdint>
#include <slamgc/intrusive_rc.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
using result = std::uint64_t;
#else
using result = std::uint32_t;  // half of the word is lost
#endif

struct policy {
  using env = slamgc::std_env;
  struct storage {
    std::uint64_t word = 0;
  };
  static std::uint64_t load(const storage& s) noexcept { return s.word; }
  static result add(storage& s, std::uint64_t d) noexcept {
    return static_cast<result>((s.word += d) - d);
  }
  static std::uint64_t subtract(storage& s, std::uint64_t d) noexcept { return (s.word -= d) + d; }
  static bool compare_exchange(storage& s, std::uint64_t& expected, std::uint64_t d) noexcept {
    const bool equal = s.word == expected;
    (equal ? s.word : expected) = equal ? d : s.word;
    return equal;
  }
};

struct keyframe : slamgc::rc_object<keyframe, policy> {};

slamgc::intrusive_rc<keyframe> make() { return slamgc::make_rc<keyframe>(); }
