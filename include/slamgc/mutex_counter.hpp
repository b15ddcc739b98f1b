/// @file
/// The counter policy with a mutex, apart from the others because `<mutex>` is a large header.
#pragma once

#include <mutex>

#include "counter.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Counter policy: a mutex around plain arithmetic, as in the thesis (chapter 4.3).
///
/// It exists for comparison. The mutex lies in the object: with libstdc++ on 64-bit machines the
/// header grows from 16 to 56 bytes. The mutex is a leaf: nothing is called while it is held.
template <class Env, class Mutex>
struct basic_mutex_counter {
  /// The environment.
  using env = Env;
  /// Holds the word and its mutex.
  struct storage {
    mutable Mutex mutex;                               ///< Guards word.
    typename basic_unsync_counter<Env>::storage word;  ///< The word.
  };
  /// The word now.
  [[nodiscard]] static std::uint64_t load(const storage& s) noexcept {
    const std::lock_guard<Mutex> lock(s.mutex);
    return plain::load(s.word);
  }
  /// Adds @p delta; returns the word before.
  static std::uint64_t add(storage& s, std::uint64_t delta) noexcept {
    const std::lock_guard<Mutex> lock(s.mutex);
    return plain::add(s.word, delta);
  }
  /// Subtracts @p delta; returns the word before.
  static std::uint64_t subtract(storage& s, std::uint64_t delta) noexcept {
    const std::lock_guard<Mutex> lock(s.mutex);
    return plain::subtract(s.word, delta);
  }
  /// Replaces @p expected by @p desired, or learns the word.
  static bool compare_exchange(storage& s, std::uint64_t& expected,
                               std::uint64_t desired) noexcept {
    const std::lock_guard<Mutex> lock(s.mutex);
    return plain::compare_exchange(s.word, expected, desired);
  }

 private:
  using plain = basic_unsync_counter<Env>;
};

/// Counter policy: a mutex per object (the thesis's third scheme).
using mutex_counter = basic_mutex_counter<std_env, std::mutex>;

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
