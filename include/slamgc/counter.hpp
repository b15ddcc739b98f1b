/// @file
/// The state word of an object and the counter policies that change it.
///
/// One 64-bit word per object:
///
///     63 ........ 32   31 ........ 2      1        0
///        version           count       queued  retired
///
/// - count: references that are stored in the graph. From 2^29 on it sticks: the object is never
///   reclaimed, which is a leak, where a wrapped count would be a use after free.
/// - version: how many references were ever added or moved, modulo 2^32. Two snapshots with equal
///   count and version therefore prove that no reference was added, removed or moved in between;
///   every collector's argument stands on this (docs/design.md, "The state word").
/// - flags: `retired` (the program declared the object dead) and `queued` (a collector holds it).
///
/// The flags are below the count, so that neither a carry out of it nor a borrow can touch them: an
/// overflow or an underflow runs into the version. A counter policy says only *how* the word is
/// changed; *what* changes is detail::transitions, the same for all of them.
#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "env.hpp"
#include "fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A snapshot of an object's state word.
struct state_word {
  std::uint64_t bits = 0;  ///< The word itself.

  static constexpr std::uint64_t retired_flag = 1;                       ///< Declared dead.
  static constexpr std::uint64_t queued_flag = 2;                        ///< A collector holds it.
  static constexpr std::uint64_t count_unit = 4;                         ///< One reference.
  static constexpr std::uint64_t version_unit = std::uint64_t{1} << 32;  ///< One change.
  static constexpr std::uint32_t sticky_count = std::uint32_t{1} << 29;  ///< The count sticks here.

  /// References counted now.
  [[nodiscard]] constexpr std::uint32_t count() const noexcept {
    return static_cast<std::uint32_t>(bits) >> 2;
  }
  /// References ever added or moved, modulo 2^32.
  [[nodiscard]] constexpr std::uint32_t version() const noexcept {
    return static_cast<std::uint32_t>(bits >> 32);
  }
  /// Whether the program declared the object dead.
  [[nodiscard]] constexpr bool is_retired() const noexcept { return (bits & retired_flag) != 0; }
  /// Whether a collector holds the object.
  [[nodiscard]] constexpr bool is_queued() const noexcept { return (bits & queued_flag) != 0; }
  /// Whether the count overflowed: it is not exact any more and the object stays for ever.
  [[nodiscard]] constexpr bool is_saturated() const noexcept {
    return (bits & sticky_count * count_unit) != 0;  // the count's highest bit
  }
  /// Whether there are two references or more, and the count is exact: `2 <= count() < sticky_count`.
  [[nodiscard]] constexpr bool is_shared() const noexcept {
    // One comparison of the word's lower half, as each removal of a reference asks this.
    constexpr std::uint32_t two = 2 * count_unit;
    return static_cast<std::uint32_t>(bits) - two < std::uint32_t{sticky_count * count_unit} - two;
  }
  /// Whether no reference was added, removed or moved between the two snapshots (flags may differ).
  [[nodiscard]] constexpr bool same_references(state_word other) const noexcept {
    return ((bits ^ other.bits) & ~(retired_flag | queued_flag)) == 0;
  }
};

/// Counter policy: one atomic read-modify-write per change.
///
/// This is also the example of the concept. A counter policy is a stateless struct with
/// - `env`: the environment, `slamgc::std_env` in a program;
/// - `storage`: holds the word; default-constructed it is zero; neither copied nor moved;
/// - `load(s)`: the word; sees what the changes it reads from had done before (acquire);
/// - `add(s, delta)`, `subtract(s, delta)`: change the word atomically, modulo 2^64, and return the
///   word as it was before; `subtract` also orders everything before it in one thread before
///   everything after it in the thread that later finds zero (acquire and release);
/// - `compare_exchange(s, expected, desired)`: strong; acquire and release; writes what it found
///   into `expected` when it fails.
///
/// All functions are static and `noexcept`. A mistake is reported where the policy is used.
template <class Env>
struct basic_fetch_add_counter {
  /// The environment.
  using env = Env;
  /// Holds the word.
  struct storage {
    typename Env::template atomic<std::uint64_t> word{0};  ///< The word.
  };
  /// The word now.
  [[nodiscard]] static std::uint64_t load(const storage& s) noexcept {
    // (3) pairs with subtract (5): who sees the other references gone sees what was done under them.
    return s.word.load(std::memory_order_acquire);
  }
  /// Adds @p delta; returns the word before.
  static std::uint64_t add(storage& s, std::uint64_t delta) noexcept {
    // (4) publishes nothing by itself: whoever stores the pointer afterwards does (2, 10).
    return s.word.fetch_add(delta, std::memory_order_relaxed);
  }
  /// Subtracts @p delta; returns the word before.
  static std::uint64_t subtract(storage& s, std::uint64_t delta) noexcept {
    // (5) release: my uses of the object come before its end; acquire: so do all others'. Pairs with
    // itself in the thread that finds zero, and with load (3).
    return s.word.fetch_sub(delta, std::memory_order_acq_rel);
  }
  /// Replaces @p expected by @p desired, or learns the word.
  static bool compare_exchange(storage& s, std::uint64_t& expected,
                               std::uint64_t desired) noexcept {
    // (6) as (5) when it succeeds, as (3) when it fails: a collector decides on the word found.
    return s.word.compare_exchange_strong(expected, desired, std::memory_order_acq_rel,
                                          std::memory_order_acquire);  // (6)
  }
};

/// Counter policy: a compare-and-swap loop per change, as in the thesis (chapter 4.4).
///
/// Lock-free, not wait-free: under contention a change may have to be tried again.
template <class Env>
struct basic_cas_counter {
  /// The environment.
  using env = Env;
  /// Holds the word.
  struct storage {
    typename Env::template atomic<std::uint64_t> word{0};  ///< The word.
  };
  /// The word now.
  [[nodiscard]] static std::uint64_t load(const storage& s) noexcept {
    return s.word.load(std::memory_order_acquire);  // (3)
  }
  /// Adds @p delta; returns the word before.
  static std::uint64_t add(storage& s, std::uint64_t delta) noexcept {
    // (7) only a guess: the exchange below decides.
    std::uint64_t found = s.word.load(std::memory_order_relaxed);
    while (!s.word.compare_exchange_weak(found, found + delta,
                                         std::memory_order_relaxed,     // (4)
                                         std::memory_order_relaxed)) {  // (7)
    }
    return found;
  }
  /// Subtracts @p delta; returns the word before.
  static std::uint64_t subtract(storage& s, std::uint64_t delta) noexcept {
    std::uint64_t found = s.word.load(std::memory_order_relaxed);  // (7)
    while (!s.word.compare_exchange_weak(found, found - delta,
                                         std::memory_order_acq_rel,     // (5)
                                         std::memory_order_relaxed)) {  // (7)
    }
    return found;
  }
  /// Replaces @p expected by @p desired, or learns the word.
  static bool compare_exchange(storage& s, std::uint64_t& expected,
                               std::uint64_t desired) noexcept {
    return s.word.compare_exchange_strong(expected, desired,
                                          std::memory_order_acq_rel,   // (6)
                                          std::memory_order_acquire);  // (6)
  }
};

/// Counter policy: plain arithmetic. Only for objects that one thread alone ever touches.
template <class Env>
struct basic_unsync_counter {
  /// The environment.
  using env = Env;
  /// Holds the word.
  struct storage {
    std::uint64_t word = 0;  ///< The word.
  };
  /// The word now.
  [[nodiscard]] static std::uint64_t load(const storage& s) noexcept { return s.word; }
  /// Adds @p delta; returns the word before.
  static std::uint64_t add(storage& s, std::uint64_t delta) noexcept {
    return std::exchange(s.word, s.word + delta);
  }
  /// Subtracts @p delta; returns the word before.
  static std::uint64_t subtract(storage& s, std::uint64_t delta) noexcept {
    return std::exchange(s.word, s.word - delta);
  }
  /// Replaces @p expected by @p desired, or learns the word.
  static bool compare_exchange(storage& s, std::uint64_t& expected,
                               std::uint64_t desired) noexcept {
    if (s.word != expected) {
      expected = s.word;
      return false;
    }
    s.word = desired;
    return true;
  }
};

namespace detail {

template <class P, class = void>
struct has_storage : std::false_type {};
template <class P>
struct has_storage<P, std::void_t<typename P::env, typename P::storage>>
    : std::is_default_constructible<typename P::storage> {};

template <class P, class = void>
struct has_word_operations : std::false_type {};
template <class P>
struct has_word_operations<
    P, std::void_t<decltype(P::load(std::declval<const typename P::storage&>())),
                   decltype(P::add(std::declval<typename P::storage&>(), std::uint64_t{})),
                   decltype(P::subtract(std::declval<typename P::storage&>(), std::uint64_t{})),
                   decltype(P::compare_exchange(std::declval<typename P::storage&>(),
                                                std::declval<std::uint64_t&>(), std::uint64_t{}))>>
    : std::bool_constant<
          std::is_same_v<decltype(P::load(std::declval<const typename P::storage&>())),
                         std::uint64_t> &&
          std::is_same_v<decltype(P::add(std::declval<typename P::storage&>(), std::uint64_t{})),
                         std::uint64_t> &&
          std::is_same_v<decltype(P::subtract(std::declval<typename P::storage&>(),
                                              std::uint64_t{})),
                         std::uint64_t> &&
          std::is_same_v<decltype(P::compare_exchange(std::declval<typename P::storage&>(),
                                                      std::declval<std::uint64_t&>(),
                                                      std::uint64_t{})),
                         bool>> {};

/// What happens to the word when a reference is added, moved or removed, under any policy.
template <class Policy>
struct transitions {
  using storage = typename Policy::storage;

  static state_word load(const storage& s) noexcept { return {Policy::load(s)}; }

  static void increment(storage& s) noexcept {
    const state_word before{Policy::add(s, state_word::version_unit + state_word::count_unit)};
    if (__builtin_expect(before.is_saturated(), false)) saturate(s);
  }

  /// As increment, for who then looks at something that a collector changes before it changes the word: an addition, but
  /// by subtract, since that acquires.
  static void increment_before_look(storage& s) noexcept {
    constexpr std::uint64_t one = state_word::version_unit + state_word::count_unit;
    const state_word before{Policy::subtract(s, std::uint64_t{0} - one)};
    if (before.is_saturated()) saturate(s);
  }

  /// A reference changes its place: the count stays, the version does not. An addition, but by
  /// subtract, since that releases: who finds the new version must find the old place empty.
  static void move(storage& s) noexcept {
    Policy::subtract(s, std::uint64_t{0} - state_word::version_unit);
  }

  /// Returns the word before.
  static state_word decrement(storage& s) noexcept {
    const state_word before{Policy::subtract(s, state_word::count_unit)};
    if (__builtin_expect(!before.is_shared(), false)) {  // all rare cases, the caller's included
      if (before.count() == 0)
        Policy::add(s, state_word::count_unit);
      else if (before.count() != 1)
        saturate(s);
    }
    return before;
  }

  /// Sets `queued`. False if it is set: somebody else has the object.
  static bool enqueue(storage& s) noexcept {
    std::uint64_t found = Policy::load(s);
    do {
      if (state_word{found}.is_queued()) return false;
    } while (!Policy::compare_exchange(s, found, found | state_word::queued_flag));
    return true;
  }

  /// Clears `queued` unless the count is zero; returns whether it was cleared. One change of the whole
  /// word: a fall to zero after it finds `queued` clear, one before it is found.
  static bool dequeue_if_referred_to(storage& s) noexcept {
    std::uint64_t found = Policy::load(s);
    do {
      if (state_word{found}.count() == 0) return false;
    } while (!Policy::compare_exchange(s, found, found & ~state_word::queued_flag));
    return true;
  }

 private:
  /// Puts a count that passed 2^29 into the middle of the sticky range, 2^28 changes away from its
  /// ends, so that changes that race with each other cannot leave it. A count that has fallen below
  /// 2^29 meanwhile is still exact, since nobody moved it yet, and stays.
  __attribute__((noinline, cold)) static void saturate(storage& s) noexcept {
    constexpr std::uint64_t count_field = 0xfffffffc;
    constexpr std::uint64_t middle = std::uint64_t{state_word::sticky_count / 2 * 3} << 2;
    std::uint64_t found = Policy::load(s);
    while (state_word{found}.is_saturated() &&
           !Policy::compare_exchange(s, found, (found & ~count_field) | middle)) {
    }
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
