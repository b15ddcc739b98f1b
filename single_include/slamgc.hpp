// slamgc 0.1.0: the whole library in one file, made by scripts/amalgamate. Do not edit.
//
// MIT License
//
// Copyright (c) 2026 the slamgc authors
//
// Permission is hereby granted, free of charge, to any person obtaining a copy
// of this software and associated documentation files (the "Software"), to deal
// in the Software without restriction, including without limitation the rights
// to use, copy, modify, merge, publish, distribute, sublicense, and/or sell
// copies of the Software, and to permit persons to whom the Software is
// furnished to do so, subject to the following conditions:
//
// The above copyright notice and this permission notice shall be included in all
// copies or substantial portions of the Software.
//
// THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR
// IMPLIED, INCLUDING BUT NOT LIMITED TO THE WARRANTIES OF MERCHANTABILITY,
// FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE
// AUTHORS OR COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER
// LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE, ARISING FROM,
// OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE
// SOFTWARE.

#pragma once

// ---- slamgc/slamgc.hpp ----
/// @file
/// Everything, except mutex_counter.hpp: that one exists for comparison, and `<mutex>` is large.

// ---- slamgc/containers/rc_list.hpp ----
/// @file
/// A list of counted references.

#include <initializer_list>
#include <list>
#include <utility>

// ---- slamgc/detail/counted_container.hpp ----
/// @file
/// What all counted containers share: reading, and the ways in which counts follow a change.

#include <cstddef>
#include <memory>
#include <type_traits>

// ---- slamgc/fwd.hpp ----
/// @file
/// Declarations only: include this where a pointer or a reference to a slamgc type is enough.

// ---- slamgc/flavour.hpp ----
/// @file
/// The two flavours of slamgc: with checks of misuse and without.
///
/// `SLAMGC_DEBUG` chooses: 1 turns the checks on, 0 turns them off. Unless the program says
/// otherwise they are on when `NDEBUG` is not defined, or when the program brings a `SLAMGC_ASSERT`
/// of its own. Layout is the same in both. The functions are not, so each flavour lives in an inline
/// namespace of its own, and a program that links both holds two sets of slamgc's functions. (A class
/// of the program's own that two files see in two flavours is still two definitions of one class: they
/// agree in layout, which is what programs rely on, and not to the letter of the one-definition rule.) A program that brings a `SLAMGC_ASSERT` brings it in every
/// file of the checked flavour.

#ifndef SLAMGC_DEBUG
#if !defined(NDEBUG) || defined(SLAMGC_ASSERT)
#define SLAMGC_DEBUG 1
#else
#define SLAMGC_DEBUG 0
#endif
#endif

#if SLAMGC_DEBUG
#define SLAMGC_FLAVOUR checked
#else
#define SLAMGC_FLAVOUR unchecked
#endif

/// slamgc: concurrent memory reclamation for graph-shaped SLAM maps.
namespace slamgc {
/// Checked and unchecked builds live side by side; see flavour.hpp.
inline namespace SLAMGC_FLAVOUR {

struct std_env;

template <class Env>
struct basic_fetch_add_counter;
template <class Env>
struct basic_cas_counter;
template <class Env>
struct basic_unsync_counter;
template <class Env, class Mutex>
struct basic_mutex_counter;

/// Counter policy: one atomic add per change. The default, and the fastest.
using fetch_add_counter = basic_fetch_add_counter<std_env>;
/// Counter policy: a compare-and-swap loop per change (the thesis's fourth scheme).
using cas_counter = basic_cas_counter<std_env>;
/// Counter policy: plain arithmetic, for objects that one thread alone ever touches.
using unsync_counter = basic_unsync_counter<std_env>;

struct reclaim_at_zero;

template <class T, class Policy = fetch_add_counter, class Reclaimer = reclaim_at_zero>
class rc_object;

template <class T>
class intrusive_rc;
template <class T, class Env = std_env>
class rc_slot;
template <class Container>
class scoped_count;

// The trailing parameters are those of the standard container (allocator, comparator, hash), with
// its defaults.
template <class T, class... Options>
class rc_vector;
template <class T, class... Options>
class rc_list;
template <class T, class... Options>
class rc_set;
template <class T, class Mapped, class... Options>
class rc_map;
template <class Key, class T, class... Options>
class rc_value_map;
template <class T, class... Options>
class rc_unordered_set;
template <class T, class Mapped, class... Options>
class rc_unordered_map;

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/detail/edit_scope.hpp ----
/// @file
/// Editing the plain container inside a counted one.

#include <vector>

// ---- slamgc/detail/header.hpp ----
/// @file
/// The header of an object, and how the rest of the library reaches it and counts references.

#include <cstdint>

// ---- slamgc/assert.hpp ----
/// @file
/// What slamgc does when it is misused: a replaceable assertion that names the object.

#include <cstdio>
#include <cstdlib>

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// What a failed check knows about the object that was misused.
struct misuse {
  const char* what;     ///< What the program did, as a phrase.
  const char* type;     ///< The object's type, as the compiler spells it.
  const void* object;   ///< The object's address.
  std::uint32_t count;  ///< The reference count that was found.
};

/// Prints @p m to the standard error stream and aborts. The default of `SLAMGC_ASSERT`.
[[noreturn]] inline void abort_on(const misuse& m) noexcept {
  std::fprintf(stderr, "slamgc: %s: object %p of type %s, count %lu\n", m.what, m.object, m.type,
               static_cast<unsigned long>(m.count));
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
// ---- slamgc/counter.hpp ----
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

// ---- slamgc/env.hpp ----
/// @file
/// The environment: everything atomic and everything per thread that slamgc uses.
///
/// Every header takes these from an `Env` parameter, which users never see. Another environment
/// runs the same headers under a weak-memory model checker or under a scheduler that injects yields
/// (tests/support). This is the only file that names `std::atomic`.

#include <atomic>

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// The environment of ordinary programs.
struct std_env {
  /// Atomic variable.
  template <class T>
  using atomic = std::atomic<T>;

  /// The calling thread's own record of type @p Record, made on first use and zero at first.
  ///
  /// Trivial types only: their storage stays valid while the thread's other thread-local objects
  /// are destroyed.
  template <class Record>
  [[nodiscard]] static Record& thread_record() noexcept {
    static_assert(std::is_trivially_destructible<Record>::value,
                  "slamgc: a thread record must outlive every other thread-local object");
    static thread_local Record record{};
    return record;
  }

  /// Reads an element of a standard container that others may assign at the same time, without lock.
  template <class T>
  [[nodiscard]] static T* load(T* const& element) noexcept {
    // (1) memory_order_acquire: sees the object that exchange (2) published.
    return __atomic_load_n(&element, __ATOMIC_ACQUIRE);
  }

  /// Replaces an element of a standard container; each old pointer is handed to exactly one caller.
  template <class T>
  [[nodiscard]] static T* exchange(T*& element, T* desired) noexcept {
    // (2) memory_order_acq_rel: publishes *desired to load (1) and to the next exchange, and sees
    // what the exchange that stored the old pointer published.
    return __atomic_exchange_n(&element, desired, __ATOMIC_ACQ_REL);
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

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
  [[nodiscard]] constexpr bool is_saturated() const noexcept { return count() >= sticky_count; }
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

  /// A reference changes its place: the count stays, the version does not. An addition, but by
  /// subtract, since that releases: who finds the new version must find the old place empty.
  static void move(storage& s) noexcept {
    Policy::subtract(s, std::uint64_t{0} - state_word::version_unit);
  }

  /// Returns the word before.
  static state_word decrement(storage& s) noexcept {
    const state_word before{Policy::subtract(s, state_word::count_unit)};
    // One comparison for all rare cases, the caller's included: 0 and 1 wrap to huge numbers.
    if (__builtin_expect(before.count() - 2 >= state_word::sticky_count - 2, false)) {
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

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Holds destruction back while a container of T changes; see reclaim_at_zero::scope.
template <class T>
using counted_scope = typename reclaimer_of<T>::template scope<object_of<T>>;

/// The edit scopes that a thread has open; kept in the checked flavour only.
struct open_edit {
  const void* container;
  open_edit* outer;
};
struct edit_record {
  open_edit* innermost;
};

/// Hands out the plain container and counts, at its end, what was changed.
///
/// What was put in is counted at the end only: it must be kept by something else until then (under a
/// deferred collector: the thread passes no quiescent state). What was taken out stays counted until
/// then. One scope per container at a time, and no other change of it meanwhile; a second scope is
/// reported in the checked flavour, and leaves the counting to the first.
template <class T, class Std, class Reference>
class edit_scope {
 public:
  /// Notes what the container refers to, in memory of its allocator. Throws what the allocation
  /// throws, and nothing has changed.
  explicit edit_scope(Std& content)
      : content_(content), before_(content.get_allocator()), scope_{&content, nullptr} {
    before_.reserve(content.size());
    for (const auto& value : content) before_.push_back(Reference()(value));
    check_in();
  }
  /// Counts what came, uncounts what went: O(size) comparisons, and two counts per change. Neither
  /// allocates nor throws.
  ~edit_scope() {
    if (!check_out()) return;
    // Pair the references then and now by position: where a pair is equal nothing is to be done, and
    // any other pairing would give the same counts.
    std::size_t i = 0;
    for (const auto& value : content_) {
      T* const now = Reference()(value);
      if (i >= before_.size() || before_[i] != now) detail::add_reference(now);
      ++i;
    }
    i = 0;
    for (const auto& value : content_) {
      if (i == before_.size()) break;
      T* const now = Reference()(value);
      if (before_[i] == now) before_[i] = nullptr;
      ++i;
    }
    for (T* p : before_) detail::drop_reference(p);
  }
  edit_scope(const edit_scope&) = delete;
  edit_scope& operator=(const edit_scope&) = delete;

  /// The plain container, valid until the scope ends.
  [[nodiscard]] Std& get() const& noexcept { return content_; }
  /// Refused: a reference that is kept would outlive the scope. Name the scope.
  Std& get() const&& = delete;
  /// The plain container, valid until the scope ends.
  [[nodiscard]] operator Std&() const noexcept { return content_; }
  /// The plain container, valid until the scope ends.
  [[nodiscard]] Std& operator*() const& noexcept { return content_; }
  /// Refused: a reference that is kept would outlive the scope. Name the scope.
  Std& operator*() const&& = delete;
  /// The plain container, valid until the scope ends.
  [[nodiscard]] Std* operator->() const noexcept { return &content_; }

 private:
#if SLAMGC_DEBUG
  static edit_record& open() noexcept {
    return policy_of<T>::env::template thread_record<edit_record>();
  }
  void check_in() noexcept {
    for (const open_edit* e = open().innermost; e != nullptr; e = e->outer) {
      if (e->container != &content_) continue;
      scope_.container = nullptr;
      SLAMGC_ASSERT(false, (misuse{"edits a container that is being edited", type_name<T>::get(),
                                   &content_, 0}));
    }
    scope_.outer = open().innermost;
    open().innermost = &scope_;
  }
  /// Returns whether this scope has to count.
  bool check_out() noexcept {
    open_edit** link = &open().innermost;
    while (*link != &scope_ && *link != nullptr) link = &(*link)->outer;
    if (*link != nullptr) *link = scope_.outer;
    return scope_.container != nullptr;
  }
#else
  static void check_in() noexcept {}
  static bool check_out() noexcept { return true; }
#endif

  // First, so that it ends last. Nothing is destroyed on this thread while it edits: what one scope
  // takes out, another may put in.
  const counted_scope<T> until_final_;
  Std& content_;
  std::vector<
      T*, typename std::allocator_traits<typename Std::allocator_type>::template rebind_alloc<T*>>
      before_;
  open_edit scope_;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

template <class Std, class = void>
struct ends_with_pop_back : std::false_type {};
template <class Std>
struct ends_with_pop_back<Std, std::void_t<decltype(std::declval<Std&>().pop_back())>>
    : std::true_type {};

/// A standard container of raw pointers whose references are counted.
///
/// Invariant, outside of member functions and of an edit scope: each occurrence of a pointer in
/// `std_` is one counted reference. Member functions keep it in this order, so that it survives every
/// exception: change the container as far as it can throw; count what came; unlink what goes; uncount
/// it, with a Reclaimer::scope open until the container has its final state.
///
/// @tparam T         Counted object.
/// @tparam Std       `std::vector<T*>` or another standard container.
/// @tparam Reference Stateless function object: the `T*` of a `Std::value_type`.
/// @tparam Iterator  What begin() and the like return: `Std::iterator` where it cannot write a counted
///                   pointer, `Std::const_iterator` where it could.
template <class T, class Std, class Reference, class Iterator = typename Std::iterator>
class counted_container {
  static_assert(
      !std::is_pointer<T>::value,
      "slamgc: name the object, not the pointer: rc_vector<KeyFrame>, rc_map<KeyFrame, int>");

 public:
  using std_type = Std;                                   ///< Container inside.
  using value_type = typename Std::value_type;            ///< As in Std.
  using allocator_type = typename Std::allocator_type;    ///< As in Std.
  using size_type = typename Std::size_type;              ///< As in Std.
  using difference_type = typename Std::difference_type;  ///< As in Std.
  using const_reference = typename Std::const_reference;  ///< As in Std.
  using const_pointer = typename Std::const_pointer;      ///< As in Std.
  using iterator = Iterator;                              ///< Cannot change a reference.
  using const_iterator = typename Std::const_iterator;    ///< As in Std.

  /// Whether moving cannot throw. It can with allocators that may differ, also with those that a
  /// standard container would hand over: a counted container keeps its own.
  static constexpr bool nothrow_move =
      std::allocator_traits<allocator_type>::is_always_equal::value &&
      std::is_nothrow_move_assignable<Std>::value;

  /// The container of raw pointers, for reading: costs nothing and counts nothing.
  [[nodiscard]] const Std& raw() const noexcept { return std_; }
  /// The container of raw pointers, for reading, without being asked.
  [[nodiscard]] operator const Std&() const noexcept { return std_; }

  /// As in Std.
  [[nodiscard]] iterator begin() noexcept { return std_.begin(); }
  /// As in Std.
  [[nodiscard]] iterator end() noexcept { return std_.end(); }
  /// As in Std.
  [[nodiscard]] const_iterator begin() const noexcept { return std_.begin(); }
  /// As in Std.
  [[nodiscard]] const_iterator end() const noexcept { return std_.end(); }
  /// As in Std.
  [[nodiscard]] const_iterator cbegin() const noexcept { return std_.begin(); }
  /// As in Std.
  [[nodiscard]] const_iterator cend() const noexcept { return std_.end(); }
  /// As in Std.
  [[nodiscard]] bool empty() const noexcept { return std_.empty(); }
  /// As in Std.
  [[nodiscard]] size_type size() const noexcept { return std_.size(); }
  /// As in Std.
  [[nodiscard]] size_type max_size() const noexcept { return std_.max_size(); }
  /// As in Std.
  [[nodiscard]] allocator_type get_allocator() const noexcept { return std_.get_allocator(); }

  /// A scope that hands out the plain container to code that insists on `std::vector<T*>&`, and
  /// counts what that changed when it ends; see edit_scope. O(size), and one allocation at its begin.
  [[nodiscard]] edit_scope<T, Std, Reference> edit() & {
    return edit_scope<T, Std, Reference>(std_);
  }

  /// Same elements.
  [[nodiscard]] friend bool operator==(const counted_container& a, const counted_container& b) {
    return a.std_ == b.std_;
  }
  /// Same elements.
  [[nodiscard]] friend bool operator==(const counted_container& a, const Std& b) {
    return a.std_ == b;
  }
  /// Same elements.
  [[nodiscard]] friend bool operator==(const Std& a, const counted_container& b) {
    return a == b.std_;
  }
  /// Other elements.
  [[nodiscard]] friend bool operator!=(const counted_container& a, const counted_container& b) {
    return a.std_ != b.std_;
  }
  /// Other elements.
  [[nodiscard]] friend bool operator!=(const counted_container& a, const Std& b) {
    return a.std_ != b;
  }
  /// Other elements.
  [[nodiscard]] friend bool operator!=(const Std& a, const counted_container& b) {
    return a != b.std_;
  }

 protected:
  counted_container() = default;
  explicit counted_container(const Std& content) : std_(content) { add_all(); }
  explicit counted_container(Std&& content) noexcept : std_(std::move(content)) { add_all(); }
  counted_container(const counted_container& other) : std_(other.std_) { add_all(); }
  counted_container(counted_container&& other) noexcept
      : std_((other.move_all(), std::move(other.std_))) {
    other.std_.clear();
  }
  counted_container& operator=(const counted_container& other) {
    if (this != &other) assign_content(Std(other.std_, std_.get_allocator()));
    return *this;
  }
  counted_container& operator=(counted_container&& other) noexcept(nothrow_move) {
    assign_moved(other);
    return *this;
  }
  ~counted_container() { clear_content(); }

  /// The references of @p content replace those of this container, which keeps its allocator.
  void assign_content(Std&& content) {
    const counted_scope<T> until_final;
    Std next(std::move(content), std_.get_allocator());
    std_.swap(next);
    add_all();
    drop_all(next);
  }
  /// Moves the references of @p other here; it becomes empty.
  void assign_moved(counted_container& other) {
    if (this == &other) return;
    const counted_scope<T> until_final;
    other.move_all();
    Std next(std::move(other.std_), std_.get_allocator());
    other.std_.clear();
    std_.swap(next);
    drop_all(next);
  }
  /// Exchanges the references of two containers: O(size), as each of them changes its place.
  void swap_content(counted_container& other) noexcept {
    if (this == &other) return;
    move_all();
    other.move_all();
    std_.swap(other.std_);
  }
  /// Removes all references and keeps the capacity. One by one, since moving the whole away would copy
  /// a comparator, which may throw.
  void clear_content() noexcept {
    if (std_.empty()) return;
    const counted_scope<T> until_final;
    do {
      T* gone;
      if constexpr (ends_with_pop_back<Std>::value) {
        gone = reference_of(std_.back());
        std_.pop_back();
      } else {
        gone = reference_of(*std_.begin());
        std_.erase(std_.begin());
      }
      detail::drop_reference(gone);
    } while (!std_.empty());
  }

  static T* reference_of(const value_type& value) noexcept { return Reference()(value); }
  static void add(const value_type& value) noexcept { detail::add_reference(reference_of(value)); }
  static void add_all(const Std& content) noexcept {
    for (const value_type& value : content) add(value);
  }
  void add_all() const noexcept { add_all(std_); }
  void move_all() const noexcept {
    for (const value_type& value : std_) detail::move_reference(reference_of(value));
  }
  static void drop_all(const Std& content) noexcept {
    for (const value_type& value : content) detail::drop_reference(reference_of(value));
  }

  Std std_;
};

/// Only for iterators: what can be read and advanced.
template <class Input>
using if_iterator = decltype(*std::declval<Input&>(), ++std::declval<Input&>());

/// Reference of a container whose elements are pointers.
struct element_itself {
  template <class T>
  T* operator()(T* const& element) const noexcept {
    return element;
  }
};
/// Reference of a map whose keys are counted.
struct element_key {
  template <class T, class Mapped>
  T* operator()(const std::pair<T* const, Mapped>& element) const noexcept {
    return element.first;
  }
};
/// Reference of a map whose mapped values are counted.
struct element_mapped {
  template <class Key, class T>
  T* operator()(const std::pair<const Key, T*>& element) const noexcept {
    return element.second;
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::list<T*, Options...>` whose elements are counted references: `std::list<KeyFrame*>`
/// becomes `rc_list<KeyFrame>`. `T` may be incomplete where the member is declared.
///
/// Iterators are those of the standard list, so loops over `std::list<KeyFrame*>::iterator` stay as
/// they are. Such an iterator could write an element uncounted: **write with replace(), never
/// through the iterator**.
///
/// Each operation costs what it costs in the standard list, plus one change of a count per reference
/// that comes or goes; swap, move and splice count each element. If an allocation or a comparison
/// throws, every count still equals the references in the list.
///
/// Thread-safety: that of the standard list.
template <class T, class... Options>
class rc_list
    : public detail::counted_container<T, std::list<T*, Options...>, detail::element_itself> {
  using std_list = std::list<T*, Options...>;
  using base = detail::counted_container<T, std_list, detail::element_itself>;

 public:
  using reverse_iterator = typename std_list::reverse_iterator;              ///< As in Std.
  using const_reverse_iterator = typename std_list::const_reverse_iterator;  ///< As in Std.
  using typename base::allocator_type;
  using typename base::const_iterator;
  using typename base::const_reference;
  using typename base::iterator;
  using typename base::size_type;

  /// Empty.
  rc_list() = default;
  /// Empty, with an allocator.
  explicit rc_list(const allocator_type& allocator) : base(std_list(allocator)) {}
  /// The elements of @p content.
  rc_list(const std_list& content) : base(content) {}
  /// Takes @p content over.
  rc_list(std_list&& content) noexcept : base(std::move(content)) {}
  /// The elements listed.
  rc_list(std::initializer_list<T*> list) : base(std_list(list)) {}
  /// @p n times @p p.
  explicit rc_list(size_type n, T* p = nullptr) : base(std_list(n, p)) {}
  /// The elements of a range of pointers.
  template <class Input, class = detail::if_iterator<Input>>
  rc_list(Input first, Input last) : base(std_list(first, last)) {}
  /// Counts each element.
  rc_list(const rc_list&) = default;
  /// Leaves @p other empty. O(size): each reference changes its place.
  rc_list(rc_list&& other) noexcept = default;
  ~rc_list() = default;

  /// Counts what comes before it uncounts what goes. Strong guarantee.
  rc_list& operator=(const rc_list& other) = default;
  /// Leaves @p other empty. O(size): each reference changes its place.
  rc_list& operator=(rc_list&& other) = default;
  /// Counts what comes before it uncounts what goes. Strong guarantee.
  rc_list& operator=(const std_list& content) {
    if (&content != &std_) this->assign_content(std_list(content, std_.get_allocator()));
    return *this;
  }
  /// Counts what comes before it uncounts what goes.
  rc_list& operator=(std_list&& content) noexcept(base::nothrow_move) {
    this->assign_content(std::move(content));
    return *this;
  }
  /// Strong guarantee.
  rc_list& operator=(std::initializer_list<T*> list) {
    return *this = std_list(list, std_.get_allocator());
  }
  /// As in Std. Strong guarantee.
  void assign(size_type n, T* p) { *this = std_list(n, p, std_.get_allocator()); }
  /// As in Std. Strong guarantee.
  template <class Input, class = detail::if_iterator<Input>>
  void assign(Input first, Input last) {
    *this = std_list(first, last, std_.get_allocator());
  }
  /// As in Std. Strong guarantee.
  void assign(std::initializer_list<T*> list) { *this = list; }

  /// The first element.
  [[nodiscard]] const_reference front() const noexcept { return std_.front(); }
  /// The last element.
  [[nodiscard]] const_reference back() const noexcept { return std_.back(); }
  /// As in Std.
  [[nodiscard]] reverse_iterator rbegin() noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] reverse_iterator rend() noexcept { return std_.rend(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rbegin() const noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rend() const noexcept { return std_.rend(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator crbegin() const noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator crend() const noexcept { return std_.rend(); }

  /// The element at @p at refers to @p p: what `*at = p` is in the standard list.
  void replace(iterator at, T* p) noexcept {
    detail::add_reference(p);
    detail::drop_reference(std::exchange(*at, p));
  }
  /// As in Std.
  void push_back(T* p) { insert(std_.end(), p); }
  /// As in Std.
  void push_front(T* p) { insert(std_.begin(), p); }
  /// As in Std.
  const_reference emplace_back(T* p = nullptr) { return *insert(std_.end(), p); }
  /// As in Std.
  const_reference emplace_front(T* p = nullptr) { return *insert(std_.begin(), p); }
  /// As in Std.
  void pop_back() noexcept { erase(--std_.end()); }
  /// As in Std.
  void pop_front() noexcept { erase(std_.begin()); }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, T* p) {
    const iterator inserted = std_.insert(at, p);
    detail::add_reference(p);
    return inserted;
  }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, size_type n, T* p) {
    return insert_list(at, std_list(n, p, std_.get_allocator()));
  }
  /// As in Std. Strong guarantee.
  template <class Input, class = detail::if_iterator<Input>>
  iterator insert(const_iterator at, Input first, Input last) {
    return insert_list(at, std_list(first, last, std_.get_allocator()));
  }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, std::initializer_list<T*> list) {
    return insert(at, list.begin(), list.end());
  }
  /// As in Std.
  iterator emplace(const_iterator at, T* p) { return insert(at, p); }
  /// As in Std.
  iterator erase(const_iterator at) noexcept {
    const detail::counted_scope<T> until_final;
    T* const gone = *at;
    const iterator next = std_.erase(at);
    detail::drop_reference(gone);
    return next;
  }
  /// As in Std.
  iterator erase(const_iterator first, const_iterator last) noexcept {
    const detail::counted_scope<T> until_final;
    while (first != last) first = erase(first);
    return std_.erase(first, first);
  }
  /// As in Std.
  void resize(size_type n, T* p = nullptr) {
    const detail::counted_scope<T> until_final;
    while (std_.size() > n) pop_back();
    if (std_.size() < n) insert(std_.end(), n - std_.size(), p);
  }
  /// As in Std.
  void clear() noexcept { this->clear_content(); }
  /// Exchanges the elements of two lists: O(size), as each reference changes its place.
  void swap(rc_list& other) noexcept { this->swap_content(other); }
  /// Exchanges the elements of two lists: O(size), as each reference changes its place.
  friend void swap(rc_list& a, rc_list& b) noexcept { a.swap(b); }

  /// As in Std. O(other.size()): each reference changes its place. Into itself: nothing happens.
  void splice(const_iterator at, rc_list& other) noexcept {
    if (this == &other) return;
    other.move_all();
    std_.splice(at, other.std_);
  }
  /// As in Std.
  void splice(const_iterator at, rc_list& other, const_iterator element) noexcept {
    if (this != &other) detail::move_reference(*element);
    std_.splice(at, other.std_, element);
  }
  /// As in Std. O(distance): each reference changes its place.
  void splice(const_iterator at, rc_list& other, const_iterator first,
              const_iterator last) noexcept {
    if (this != &other)
      for (const_iterator i = first; i != last; ++i) detail::move_reference(*i);
    std_.splice(at, other.std_, first, last);
  }
  /// As in Std; returns how many were removed.
  size_type remove(T* p) noexcept {
    return remove_if([p](T* element) noexcept { return element == p; });
  }
  /// As in Std; returns how many were removed.
  template <class Predicate>
  size_type remove_if(Predicate predicate) {
    const detail::counted_scope<T> until_final;
    size_type removed = 0;
    for (const_iterator i = std_.begin(); i != std_.end();) {
      if (predicate(*i)) {
        i = erase(i);
        ++removed;
      } else {
        ++i;
      }
    }
    return removed;
  }
  /// As in Std; returns how many were removed.
  size_type unique() {
    return unique([](T* a, T* b) noexcept { return a == b; });
  }
  /// As in Std; returns how many were removed.
  template <class Same>
  size_type unique(Same same) {
    const detail::counted_scope<T> until_final;
    size_type removed = 0;
    for (const_iterator i = std_.begin(); i != std_.end();) {
      const_iterator next = i;
      ++next;
      if (next == std_.cend() || !same(*i, *next)) {
        i = next;
      } else {
        erase(next);
        ++removed;
      }
    }
    return removed;
  }
  /// As in Std. O(other.size()) counts: each reference changes its place.
  template <class... Compare>
  void merge(rc_list& other, Compare... compare) {
    if (this == &other) return;
    other.move_all();
    std_.merge(other.std_, compare...);
  }
  /// As in Std.
  template <class... Compare>
  void sort(Compare... compare) {
    std_.sort(compare...);
  }
  /// As in Std.
  void reverse() noexcept { std_.reverse(); }

 private:
  using base::std_;

  iterator insert_list(const_iterator at, std_list&& content) noexcept {
    base::add_all(content);
    const iterator first = content.empty() ? std_.erase(at, at) : content.begin();
    std_.splice(at, content);
    return first;
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/containers/rc_map.hpp ----
/// @file
/// A map whose keys are counted references.

#include <map>

// ---- slamgc/detail/counted_associative.hpp ----
/// @file
/// What counted sets and maps share: everything that inserts and erases.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// A set or map whose references are counted. `Derived` is the public container.
///
/// Each operation costs what it costs in the standard container, plus one change of a count per
/// reference that comes or goes; assignment, swap and move count each element. If an allocation, a
/// comparison or a hash throws, every count still equals the references in the container.
template <class Derived, class T, class Std, class Reference,
          class Iterator = typename Std::iterator>
class counted_associative : public counted_container<T, Std, Reference, Iterator> {
  using base = counted_container<T, Std, Reference, Iterator>;

 public:
  using key_type = typename Std::key_type;  ///< As in Std.
  using typename base::const_iterator;
  using typename base::iterator;
  using typename base::size_type;
  using typename base::value_type;

  /// Empty.
  counted_associative() = default;
  /// Empty, with an allocator.
  explicit counted_associative(const typename base::allocator_type& allocator)
      : base(Std(allocator)) {}
  /// The elements of @p content.
  counted_associative(const Std& content) : base(content) {}
  /// Takes @p content over, with its comparator, hash and allocator.
  counted_associative(Std&& content) noexcept : base(std::move(content)) {}
  /// The elements listed.
  counted_associative(std::initializer_list<value_type> list) : base(Std(list)) {}
  /// The elements of a range of pointers, or of pairs.
  template <class Input, class = if_iterator<Input>>
  counted_associative(Input first, Input last) : base(Std(first, last)) {}
  /// Counts each element.
  counted_associative(const counted_associative&) = default;
  /// Leaves @p other empty. O(size): each reference changes its place.
  counted_associative(counted_associative&& other) noexcept = default;
  ~counted_associative() = default;

  /// Counts what comes before it uncounts what goes. Strong guarantee.
  counted_associative& operator=(const counted_associative& other) = default;
  /// Leaves @p other empty. O(size): each reference changes its place.
  counted_associative& operator=(counted_associative&& other) = default;
  /// Counts what comes before it uncounts what goes. Strong guarantee.
  counted_associative& operator=(const Std& content) {
    if (&content != &std_) this->assign_content(Std(content, std_.get_allocator()));
    return *this;
  }
  /// Counts what comes before it uncounts what goes.
  counted_associative& operator=(Std&& content) noexcept(base::nothrow_move) {
    this->assign_content(std::move(content));
    return *this;
  }
  /// Counts what comes before it uncounts what goes. Strong guarantee.
  counted_associative& operator=(std::initializer_list<value_type> list) {
    Std content(std_, std_.get_allocator());  // with this comparator or hash
    content = list;
    this->assign_content(std::move(content));
    return *this;
  }

  /// As in Std.
  std::pair<iterator, bool> insert(const value_type& value) { return counted(std_.insert(value)); }
  /// As in Std.
  std::pair<iterator, bool> insert(value_type&& value) {
    return counted(std_.insert(std::move(value)));
  }
  /// As in Std; so `std::inserter` works.
  iterator insert(const_iterator hint, const value_type& value) {
    const size_type before = std_.size();
    return counted(std_.insert(hint, value), before);
  }
  /// As in Std; so `std::inserter` works.
  iterator insert(const_iterator hint, value_type&& value) {
    const size_type before = std_.size();
    return counted(std_.insert(hint, std::move(value)), before);
  }
  /// As in Std. If it throws, the elements before are in.
  template <class Input, class = if_iterator<Input>>
  void insert(Input first, Input last) {
    for (; first != last; ++first) insert(*first);
  }
  /// As in Std. If it throws, the elements before are in.
  void insert(std::initializer_list<value_type> list) { insert(list.begin(), list.end()); }
  /// As in Std.
  template <class... Args>
  std::pair<iterator, bool> emplace(Args&&... args) {
    return counted(std_.emplace(std::forward<Args>(args)...));
  }
  /// As in Std.
  template <class... Args>
  iterator emplace_hint(const_iterator hint, Args&&... args) {
    const size_type before = std_.size();
    return counted(std_.emplace_hint(hint, std::forward<Args>(args)...), before);
  }

  /// As in Std.
  iterator erase(const_iterator at) {
    const counted_scope<T> until_final;
    return unlink(at);
  }
  /// As in Std.
  iterator erase(const_iterator first, const_iterator last) {
    const counted_scope<T> until_final;
    while (first != last) first = unlink(first);
    return std_.erase(first, first);
  }
  /// As in Std.
  size_type erase(const key_type& key) {
    const auto at = std_.find(key);
    if (at == std_.end()) return 0;
    erase(const_iterator(at));
    return 1;
  }
  /// As in Std.
  void clear() noexcept { this->clear_content(); }
  /// Exchanges the elements of two containers: O(size), as each reference changes its place.
  void swap(Derived& other) noexcept { this->swap_content(other); }
  /// Exchanges the elements of two containers: O(size), as each reference changes its place.
  friend void swap(Derived& a, Derived& b) noexcept { a.swap(b); }

  /// As in Std: takes over the elements whose keys are not here. O(other.size()) counts: a reference
  /// may change its place. If a comparison throws in here, libstdc++ terminates, and before version
  /// 12 also if a hash does.
  void merge(Derived& other) {
    counted_associative& from = other;
    if (this == &from) return;
    from.move_all();
    std_.merge(from.std_);
  }

  /// As in Std.
  [[nodiscard]] iterator find(const key_type& key) { return std_.find(key); }
  /// As in Std.
  [[nodiscard]] const_iterator find(const key_type& key) const { return std_.find(key); }
  /// As in Std.
  [[nodiscard]] size_type count(const key_type& key) const { return std_.count(key); }
  /// Whether there is such a key.
  [[nodiscard]] bool contains(const key_type& key) const { return std_.find(key) != std_.end(); }
  /// As in Std.
  [[nodiscard]] std::pair<iterator, iterator> equal_range(const key_type& key) {
    return std_.equal_range(key);
  }
  /// As in Std.
  [[nodiscard]] std::pair<const_iterator, const_iterator> equal_range(const key_type& key) const {
    return std_.equal_range(key);
  }

 protected:
  using base::std_;

  /// Counts the element if it is new.
  std::pair<iterator, bool> counted(std::pair<typename Std::iterator, bool> inserted) noexcept {
    if (inserted.second) base::add(*inserted.first);
    return inserted;
  }

 private:
  iterator counted(typename Std::iterator inserted, size_type size_before) noexcept {
    if (std_.size() != size_before) base::add(*inserted);
    return inserted;
  }
  iterator unlink(const_iterator at) {
    T* const gone = base::reference_of(*at);
    const iterator next = std_.erase(at);
    detail::drop_reference(gone);
    return next;
  }
};

/// What only ordered sets and maps have.
template <class Derived, class T, class Std, class Reference,
          class Iterator = typename Std::iterator>
class counted_ordered : public counted_associative<Derived, T, Std, Reference, Iterator> {
  using base = counted_associative<Derived, T, Std, Reference, Iterator>;

 public:
  using key_compare = typename Std::key_compare;                        ///< As in Std.
  using value_compare = typename Std::value_compare;                    ///< As in Std.
  using const_reverse_iterator = typename Std::const_reverse_iterator;  ///< As in Std.
  using reverse_iterator =
      std::conditional_t<std::is_same<Iterator, typename Std::iterator>::value,
                         typename Std::reverse_iterator,
                         const_reverse_iterator>;  ///< Cannot change a reference.
  using typename base::const_iterator;
  using typename base::iterator;
  using typename base::key_type;

  using base::base;
  using base::operator=;

  /// Empty.
  counted_ordered() = default;
  /// Empty, with a comparator.
  explicit counted_ordered(const key_compare& compare) : base(Std(compare)) {}

  /// As in Std.
  [[nodiscard]] reverse_iterator rbegin() noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] reverse_iterator rend() noexcept { return std_.rend(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rbegin() const noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rend() const noexcept { return std_.rend(); }
  /// As in Std.
  [[nodiscard]] iterator lower_bound(const key_type& key) { return std_.lower_bound(key); }
  /// As in Std.
  [[nodiscard]] const_iterator lower_bound(const key_type& key) const {
    return std_.lower_bound(key);
  }
  /// As in Std.
  [[nodiscard]] iterator upper_bound(const key_type& key) { return std_.upper_bound(key); }
  /// As in Std.
  [[nodiscard]] const_iterator upper_bound(const key_type& key) const {
    return std_.upper_bound(key);
  }
  /// As in Std.
  [[nodiscard]] key_compare key_comp() const { return std_.key_comp(); }
  /// As in Std.
  [[nodiscard]] value_compare value_comp() const { return std_.value_comp(); }

 protected:
  using base::std_;
};

/// What only hashed sets and maps have.
template <class Derived, class T, class Std, class Reference,
          class Iterator = typename Std::iterator>
class counted_hashed : public counted_associative<Derived, T, Std, Reference, Iterator> {
  using base = counted_associative<Derived, T, Std, Reference, Iterator>;

 public:
  using hasher = typename Std::hasher;        ///< As in Std.
  using key_equal = typename Std::key_equal;  ///< As in Std.
  using typename base::size_type;

  using base::base;
  using base::operator=;

  /// Empty.
  counted_hashed() = default;
  /// Empty, with at least @p buckets buckets.
  explicit counted_hashed(size_type buckets) : base(Std(buckets)) {}

  /// As in Std.
  [[nodiscard]] size_type bucket_count() const noexcept { return std_.bucket_count(); }
  /// As in Std.
  [[nodiscard]] float load_factor() const noexcept { return std_.load_factor(); }
  /// As in Std.
  [[nodiscard]] float max_load_factor() const noexcept { return std_.max_load_factor(); }
  /// As in Std.
  void max_load_factor(float factor) { std_.max_load_factor(factor); }
  /// As in Std.
  void rehash(size_type buckets) { std_.rehash(buckets); }
  /// As in Std.
  void reserve(size_type elements) { std_.reserve(elements); }
  /// As in Std: takes over the elements whose keys are not here. O(other.size()) counts: a reference
  /// may change its place.
  void merge(Derived& other) {
    // A standard merge that has to grow the table may lose the element in hand.
    std_.reserve(std_.size() + other.size());
    base::merge(other);
  }
  /// As in Std.
  [[nodiscard]] hasher hash_function() const { return std_.hash_function(); }
  /// As in Std.
  [[nodiscard]] key_equal key_eq() const { return std_.key_eq(); }

 protected:
  using base::std_;
};

/// Access by key to a map whose keys are counted: the mapped values are plain.
template <class Base>
class counted_key_map : public Base {
 public:
  using mapped_type = typename Base::std_type::mapped_type;  ///< As in Std.
  using typename Base::const_iterator;
  using typename Base::iterator;
  using typename Base::key_type;
  using typename Base::size_type;

  using Base::Base;
  using Base::operator=;

  /// As in Std: makes the element if there is none.
  mapped_type& operator[](const key_type& key) { return this->try_emplace(key).first->second; }
  /// As in Std. Throws std::out_of_range.
  [[nodiscard]] mapped_type& at(const key_type& key) { return std_.at(key); }
  /// As in Std. Throws std::out_of_range.
  [[nodiscard]] const mapped_type& at(const key_type& key) const { return std_.at(key); }
  /// As in Std.
  template <class... Args>
  std::pair<iterator, bool> try_emplace(const key_type& key, Args&&... args) {
    return this->counted(std_.try_emplace(key, std::forward<Args>(args)...));
  }
  /// As in Std.
  template <class Value>
  std::pair<iterator, bool> insert_or_assign(const key_type& key, Value&& value) {
    return this->counted(std_.insert_or_assign(key, std::forward<Value>(value)));
  }

 protected:
  using Base::std_;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::map<T*, Mapped, Options...>` whose keys are counted references:
/// `std::map<KeyFrame*, int>` becomes `rc_map<KeyFrame, int>`. `T` may be incomplete where the member
/// is declared. Iterators are those of the standard map, so loops over
/// `std::map<KeyFrame*, int>::iterator` stay as they are.
///
/// Thread-safety: that of the standard map. See detail::counted_associative for costs and errors.
template <class T, class Mapped, class... Options>
class rc_map : public detail::counted_key_map<
                   detail::counted_ordered<rc_map<T, Mapped, Options...>, T,
                                           std::map<T*, Mapped, Options...>, detail::element_key>> {
  using base = detail::counted_key_map<detail::counted_ordered<
      rc_map<T, Mapped, Options...>, T, std::map<T*, Mapped, Options...>, detail::element_key>>;

 public:
  using base::base;
  using base::operator=;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/containers/rc_set.hpp ----
/// @file
/// A set of counted references.

#include <set>

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::set<T*, Options...>` whose elements are counted references. `T` may be incomplete where
/// the member is declared. Iterators are those of the standard set.
///
/// Thread-safety: that of the standard set. See detail::counted_associative for costs and errors.
template <class T, class... Options>
class rc_set : public detail::counted_ordered<rc_set<T, Options...>, T, std::set<T*, Options...>,
                                              detail::element_itself> {
  using base = detail::counted_ordered<rc_set<T, Options...>, T, std::set<T*, Options...>,
                                       detail::element_itself>;

 public:
  using base::base;
  using base::operator=;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/containers/rc_unordered_map.hpp ----
/// @file
/// A hashed map whose keys are counted references.

#include <unordered_map>

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::unordered_map<T*, Mapped, Options...>` whose keys are counted references. `T` may be
/// incomplete where the member is declared. Iterators are those of the standard map.
///
/// Thread-safety: that of the standard map. See detail::counted_associative for costs and errors.
template <class T, class Mapped, class... Options>
class rc_unordered_map
    : public detail::counted_key_map<
          detail::counted_hashed<rc_unordered_map<T, Mapped, Options...>, T,
                                 std::unordered_map<T*, Mapped, Options...>, detail::element_key>> {
  using base = detail::counted_key_map<
      detail::counted_hashed<rc_unordered_map<T, Mapped, Options...>, T,
                             std::unordered_map<T*, Mapped, Options...>, detail::element_key>>;

 public:
  using base::base;
  using base::operator=;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/containers/rc_unordered_set.hpp ----
/// @file
/// A hashed set of counted references.

#include <unordered_set>

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::unordered_set<T*, Options...>` whose elements are counted references. `T` may be
/// incomplete where the member is declared. Iterators are those of the standard set.
///
/// Thread-safety: that of the standard set. See detail::counted_associative for costs and errors.
template <class T, class... Options>
class rc_unordered_set
    : public detail::counted_hashed<rc_unordered_set<T, Options...>, T,
                                    std::unordered_set<T*, Options...>, detail::element_itself> {
  using base = detail::counted_hashed<rc_unordered_set<T, Options...>, T,
                                      std::unordered_set<T*, Options...>, detail::element_itself>;

 public:
  using base::base;
  using base::operator=;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/containers/rc_value_map.hpp ----
/// @file
/// A map whose mapped values are counted references.

// ---- slamgc/detail/element_ref.hpp ----
/// @file
/// An element of a counted container, as an expression that can be read and assigned.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// What `v[i]` is where `v` is an rc_vector: reads like a `T*`, and counts when it is assigned.
///
/// Assignment is an atomic exchange, as in rc_slot: two threads that assign one element each release
/// another old pointer, even where the program forgot its lock. Not for keeping: like any reference
/// to an element it dies with the next change of the container's size, and `auto p = v[i];` copies
/// the reference, not the pointer.
template <class T>
class element_ref {
 public:
  /// Refers to @p element.
  explicit element_ref(T*& element) noexcept : element_(element) {}
  /// Refers to the same element.
  element_ref(const element_ref&) noexcept = default;

  /// The pointer, borrowed: for a reader that does not hold the lock of the container.
  [[nodiscard]] T* get() const noexcept { return policy_of<T>::env::load(element_); }
  /// The pointer, borrowed, under the lock of the container: a plain read.
  [[nodiscard]] operator T*() const noexcept { return element_; }
  /// The object's members. Not for null.
  [[nodiscard]] T* operator->() const noexcept { return *this; }
  /// The object. Not for null.
  [[nodiscard]] T& operator*() const noexcept { return *static_cast<T*>(*this); }

  /// The element refers to @p p.
  const element_ref& operator=(T* p) const noexcept {
    detail::add_reference(p);
    detail::drop_reference(policy_of<T>::env::exchange(element_, p));
    return *this;
  }
  /// The element refers to what @p other refers to now.
  element_ref& operator=(const element_ref& other) noexcept {
    *this = other.get();
    return *this;
  }
  /// Exchanges the pointers of two elements.
  friend void swap(element_ref a, element_ref b) noexcept {
    T* const from_a = a.get();
    detail::add_reference(from_a);  // it is in neither element for a moment
    a = b.get();
    b = from_a;
    detail::drop_reference(from_a);
  }

 private:
  T*& element_;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::map<Key, T*, Options...>` whose mapped values are counted references:
/// `std::map<long, MapPoint*>` becomes `rc_value_map<long, MapPoint>`. `T` may be incomplete where
/// the member is declared.
///
/// Iterators are the standard map's const iterators, since the others could write a value uncounted;
/// `m[key] = p` writes and counts.
///
/// Thread-safety: that of the standard map. See detail::counted_associative for costs and errors.
template <class Key, class T, class... Options>
class rc_value_map
    : public detail::counted_ordered<rc_value_map<Key, T, Options...>, T,
                                     std::map<Key, T*, Options...>, detail::element_mapped,
                                     typename std::map<Key, T*, Options...>::const_iterator> {
  using base = detail::counted_ordered<rc_value_map<Key, T, Options...>, T,
                                       std::map<Key, T*, Options...>, detail::element_mapped,
                                       typename std::map<Key, T*, Options...>::const_iterator>;

 public:
  using mapped_type = T*;  ///< As in the standard map.
  using typename base::iterator;
  using typename base::key_type;

  using base::base;
  using base::operator=;

  /// The value at @p key, to read or to assign; makes a null one if there is none.
  detail::element_ref<T> operator[](const key_type& key) {
    return detail::element_ref<T>(this->std_[key]);
  }
  /// The value at @p key, to read or to assign. Throws std::out_of_range.
  [[nodiscard]] detail::element_ref<T> at(const key_type& key) {
    return detail::element_ref<T>(this->std_.at(key));
  }
  /// The value at @p key. Throws std::out_of_range.
  [[nodiscard]] T* at(const key_type& key) const { return this->std_.at(key); }
  /// As in the standard map.
  std::pair<iterator, bool> try_emplace(const key_type& key, T* p = nullptr) {
    return this->counted(this->std_.try_emplace(key, p));
  }
  /// As in the standard map.
  std::pair<iterator, bool> insert_or_assign(const key_type& key, T* p) {
    const std::pair<typename base::std_type::iterator, bool> done = this->std_.try_emplace(key, p);
    if (!done.second) detail::element_ref<T>(done.first->second) = p;
    return this->counted(done);
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/containers/rc_vector.hpp ----
/// @file
/// A vector of counted references.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::vector<T*, Options...>` whose elements are counted references: `std::vector<MapPoint*>`
/// becomes `rc_vector<MapPoint>`. `T` may be incomplete where the member is declared.
///
/// Reading costs what it costs in the standard vector. Iterators are the const iterators of the
/// standard vector, since the others could write an element uncounted; `v[i] = p` writes and counts,
/// and `edit()` hands out the plain vector for the rest.
///
/// Each operation costs what it costs in the standard vector, plus one change of a count per
/// reference that comes or goes; swap and move count each element. Strong guarantee: if an
/// allocation throws, nothing has changed.
///
/// Thread-safety: that of the standard vector. Moreover several threads may assign elements, `v[i] = p`,
/// and read them by `v.load(i)` at once, without a lock, while none changes the vector as a whole.
template <class T, class... Options>
class rc_vector
    : public detail::counted_container<T, std::vector<T*, Options...>, detail::element_itself,
                                       typename std::vector<T*, Options...>::const_iterator> {
  using std_vector = std::vector<T*, Options...>;
  using base = detail::counted_container<T, std_vector, detail::element_itself,
                                         typename std_vector::const_iterator>;

 public:
  using reference = detail::element_ref<T>;  ///< Reads like a `T*`, counts when assigned.
  using const_reverse_iterator = typename std_vector::const_reverse_iterator;  ///< As in Std.
  using reverse_iterator = const_reverse_iterator;  ///< Cannot change a reference.
  using typename base::allocator_type;
  using typename base::const_iterator;
  using typename base::const_reference;
  using typename base::iterator;
  using typename base::size_type;

  /// Empty.
  rc_vector() = default;
  /// Empty, with an allocator.
  explicit rc_vector(const allocator_type& allocator) : base(std_vector(allocator)) {}
  /// The elements of @p content.
  rc_vector(const std_vector& content) : base(content) {}
  /// Takes @p content over.
  rc_vector(std_vector&& content) noexcept : base(std::move(content)) {}
  /// The elements listed.
  rc_vector(std::initializer_list<T*> list) : base(std_vector(list)) {}
  /// @p n times @p p.
  explicit rc_vector(size_type n, T* p = nullptr) : base(std_vector(n, p)) {}
  /// The elements of a range of pointers.
  template <class Input, class = detail::if_iterator<Input>>
  rc_vector(Input first, Input last) : base(std_vector(first, last)) {}
  /// Counts each element.
  rc_vector(const rc_vector&) = default;
  /// Leaves @p other empty. O(size): each reference changes its place.
  rc_vector(rc_vector&& other) noexcept = default;
  ~rc_vector() = default;

  /// Strong guarantee. Elements that stay the same are not counted anew.
  rc_vector& operator=(const rc_vector& other) { return *this = other.std_; }
  /// Leaves @p other empty. O(size): each reference changes its place.
  rc_vector& operator=(rc_vector&& other) noexcept(base::nothrow_move) {
    this->assign_moved(other);
    return *this;
  }
  /// Strong guarantee. Elements that stay the same are not counted anew.
  rc_vector& operator=(const std_vector& content) {
    assign_pointers(content);
    return *this;
  }
  /// Strong guarantee. Elements that stay the same are not counted anew.
  rc_vector& operator=(std_vector&& content) {
    if (content.capacity() > std_.capacity())
      this->assign_content(std::move(content));
    else
      assign_pointers(content);
    return *this;
  }
  /// Strong guarantee.
  rc_vector& operator=(std::initializer_list<T*> list) {
    return *this = std_vector(list, std_.get_allocator());
  }
  /// As in Std. Strong guarantee.
  void assign(size_type n, T* p) { *this = std_vector(n, p, std_.get_allocator()); }
  /// As in Std. Strong guarantee.
  template <class Input, class = detail::if_iterator<Input>>
  void assign(Input first, Input last) {
    *this = std_vector(first, last, std_.get_allocator());
  }
  /// As in Std. Strong guarantee.
  void assign(std::initializer_list<T*> list) { *this = list; }

  /// The element, to read or to assign.
  [[nodiscard]] reference operator[](size_type i) noexcept { return reference(std_[i]); }
  /// The element.
  [[nodiscard]] const_reference operator[](size_type i) const noexcept { return std_[i]; }
  /// The element, for a reader that does not hold the lock under which others assign elements.
  [[nodiscard]] T* load(size_type i) const noexcept {
    return detail::policy_of<T>::env::load(std_[i]);
  }
  /// The element, to read or to assign. Throws std::out_of_range.
  [[nodiscard]] reference at(size_type i) { return reference(std_.at(i)); }
  /// The element. Throws std::out_of_range.
  [[nodiscard]] const_reference at(size_type i) const { return std_.at(i); }
  /// The first element, to read or to assign.
  [[nodiscard]] reference front() noexcept { return reference(std_.front()); }
  /// The first element.
  [[nodiscard]] const_reference front() const noexcept { return std_.front(); }
  /// The last element, to read or to assign.
  [[nodiscard]] reference back() noexcept { return reference(std_.back()); }
  /// The last element.
  [[nodiscard]] const_reference back() const noexcept { return std_.back(); }
  /// The elements, for reading.
  [[nodiscard]] T* const* data() const noexcept { return std_.data(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rbegin() const noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rend() const noexcept { return std_.rend(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator crbegin() const noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator crend() const noexcept { return std_.rend(); }

  /// As in Std.
  [[nodiscard]] size_type capacity() const noexcept { return std_.capacity(); }
  /// As in Std.
  void reserve(size_type n) { std_.reserve(n); }
  /// As in Std.
  void shrink_to_fit() { std_.shrink_to_fit(); }
  /// As in Std: new elements are @p p.
  void resize(size_type n, T* p = nullptr) {
    if (n < std_.size()) {
      erase(std_.begin() + static_cast<std::ptrdiff_t>(n), std_.end());
    } else {
      const size_type old = std_.size();
      std_.resize(n, p);
      add_from(old, n - old);
    }
  }
  /// As in Std.
  void push_back(T* p) {
    std_.push_back(p);
    detail::add_reference(p);
  }
  /// As in Std.
  reference emplace_back(T* p = nullptr) {
    push_back(p);
    return back();
  }
  /// As in Std.
  void pop_back() noexcept {
    T* const gone = std_.back();
    std_.pop_back();
    detail::drop_reference(gone);
  }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, T* p) {
    const iterator inserted = std_.insert(at, p);
    detail::add_reference(p);
    return inserted;
  }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, size_type n, T* p) {
    const iterator inserted = std_.insert(at, n, p);
    add_from(index_of(inserted), n);
    return inserted;
  }
  /// As in Std. Strong guarantee: the range is read before anything changes.
  template <class Input, class = detail::if_iterator<Input>>
  iterator insert(const_iterator at, Input first, Input last) {
    const std_vector content(first, last, std_.get_allocator());
    const iterator inserted = std_.insert(at, content.begin(), content.end());
    add_from(index_of(inserted), content.size());
    return inserted;
  }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, std::initializer_list<T*> list) {
    return insert(at, list.begin(), list.end());
  }
  /// As in Std.
  iterator emplace(const_iterator at, T* p) { return insert(at, p); }
  /// As in Std.
  iterator erase(const_iterator at) noexcept {
    T* const gone = *at;
    const size_type index = index_of(at);
    const detail::counted_scope<T> until_final;
    std_.erase(at);
    detail::drop_reference(gone);
    return std_.begin() + static_cast<std::ptrdiff_t>(index);
  }
  /// As in Std.
  iterator erase(const_iterator first, const_iterator last) noexcept {
    const detail::counted_scope<T> until_final;
    const auto n = last - first;
    const auto from = std_.begin() + (first - std_.cbegin());
    // Unlink before uncounting: what goes moves to the end, what stays keeps its order.
    for (auto to = from, stays = from + n; stays != std_.end(); ++to, ++stays)
      std::swap(*to, *stays);
    for (auto i = n; i != 0; --i) pop_back();
    return from;
  }
  /// As in Std: keeps the capacity.
  void clear() noexcept { this->clear_content(); }
  /// Exchanges the elements of two vectors: O(size), as each reference changes its place.
  void swap(rc_vector& other) noexcept { this->swap_content(other); }
  /// Exchanges the elements of two vectors: O(size), as each reference changes its place.
  friend void swap(rc_vector& a, rc_vector& b) noexcept { a.swap(b); }

 private:
  using base::std_;

  size_type index_of(const_iterator at) const noexcept {
    return static_cast<size_type>(at - std_.cbegin());
  }
  void add_from(size_type index, size_type n) noexcept {
    for (size_type i = index; i != index + n; ++i) detail::add_reference(std_[i]);
  }
  /// In place where the capacity suffices: no allocation, and no count for what stays. What comes is
  /// counted before anything is uncounted: the same object may go here and come there.
  void assign_pointers(const std_vector& content) {
    if (&content == &std_) return;
    std_.reserve(content.size());
    const size_type common = std_.size() < content.size() ? std_.size() : content.size();
    for (size_type i = 0; i != common; ++i)
      if (std_[i] != content[i]) detail::add_reference(content[i]);
    std_.insert(std_.end(), content.begin() + static_cast<std::ptrdiff_t>(common), content.end());
    add_from(common, content.size() - common);
    const detail::counted_scope<T> until_final;
    for (size_type i = 0; i != common; ++i)
      if (std_[i] != content[i]) detail::drop_reference(std::exchange(std_[i], content[i]));
    erase(std_.begin() + static_cast<std::ptrdiff_t>(content.size()), std_.end());
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/intrusive_rc.hpp ----
/// @file
/// The counted pointer for locals, parameters and roots.

#include <iosfwd>
#include <typeindex>  // the smallest header with std::hash

// ---- slamgc/rc_object.hpp ----
/// @file
/// The base class of every counted object.

// ---- slamgc/reclaim_at_zero.hpp ----
/// @file
/// The default reclaimer: an object is destroyed as soon as its count falls to zero.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// For reclaimers: uncounts a reference to @p object and returns its state word as it was before.
///
/// Wait-free under `fetch_add_counter`. Uncounting what was never counted is reported and undone.
template <class T>
state_word uncount_reference(T* object) noexcept {
  const state_word before = detail::transitions<detail::policy_of<T>>::decrement(
      detail::access::header_of(*object).state);
  SLAMGC_ASSERT(before.count() != 0,
                (detail::misuse_of(object, "removes a reference that was never counted")));
  return before;
}

/// For reclaimers: runs the destructor and returns the memory, as `delete` does.
///
/// References that are made to the object meanwhile are reported.
template <class T>
void destroy_object(T* object) noexcept {
  detail::mark_dying(object);
  delete object;
}

namespace detail {

/// Objects of one type that the thread has yet to destroy, linked through their headers.
struct doomed_list {
  void* first;
  doomed_list* next;
  void (*destroy_first)(doomed_list&) noexcept;
};

/// What one thread has yet to destroy. Objects know nothing of their type at run time, so there is a
/// list per type.
struct doomed_record {
  doomed_list* lists;
  unsigned scopes;
};

template <class T>
struct doomed_list_of : doomed_list {};

}  // namespace detail

/// Reclaimer: destroys an object when its count falls to zero, on the thread that brought it there.
///
/// Iterative: an object whose last reference goes while another is being destroyed waits in a list
/// of the thread, so that a chain of a million objects needs no more stack than one. Destructors run
/// on the thread that drops the last reference and under the locks it holds; a collector that defers
/// is for programs that cannot have that. An object that is referred to again while it waits stays.
///
/// It is also the example of the concept. A reclaimer is a type with
/// - `release(T*)`, static and `noexcept`: a reference to the object was unlinked. Uncounts it (with
///   uncount_reference, or with a transition of its own) and decides what becomes of an object that
///   nobody refers to; that one's link word is the reclaimer's. It destroys with destroy_object.
/// - `first_link<T>()`, static: the link word of a new object. May throw.
/// - `scope<T>`: a container keeps one while it changes; no destructor may run inside, so that none
///   meets a half-changed container.
struct reclaim_at_zero {
  /// Removes a reference; destroys the object if it was the last. Never allocates. Amortised O(1).
  template <class T>
  static void release(T* object) noexcept {
    // Not touched any more if it is queued: the thread that has it may destroy it at once.
    const state_word before = slamgc::uncount_reference(object);
    if (before.count() == 1 && !before.is_queued()) destroy_later(object);
  }

  /// New objects are linked to nothing.
  template <class T>
  static void* first_link() noexcept {
    return nullptr;
  }

  /// While a thread has one, nothing is destroyed on it; the end of the outermost one makes up for it.
  template <class T>
  class scope {
   public:
    /// Holds destruction back.
    scope() noexcept : thread_(record()) { ++thread_.scopes; }
    /// Lets it happen, if this is the outermost scope.
    ~scope() {
      if (thread_.scopes == 1)
        while (thread_.lists != nullptr) thread_.lists->destroy_first(*thread_.lists);
      --thread_.scopes;
    }
    scope(const scope&) = delete;
    scope& operator=(const scope&) = delete;

   private:
    static detail::doomed_record& record() noexcept {
      return detail::policy_of<T>::env::template thread_record<detail::doomed_record>();
    }
    detail::doomed_record& thread_;
  };

 private:
  template <class T>
  using word = detail::transitions<detail::policy_of<T>>;

  template <class T>
  static void destroy_later(T* object) noexcept {
    using env = typename detail::policy_of<T>::env;
    auto& header = detail::access::header_of(*object);
    if (!word<T>::enqueue(header.state)) return;
    const scope<T> until_listed;
    auto& list = env::template thread_record<detail::doomed_list_of<T>>();
    if (list.first == nullptr) {
      auto& thread = env::template thread_record<detail::doomed_record>();
      list.destroy_first = &destroy_first<T>;
      list.next = thread.lists;
      thread.lists = &list;
    }
    // (8) the list belongs to this thread.
    header.link.store(list.first, std::memory_order_relaxed);
    list.first = object;
  }

  template <class T>
  static void destroy_first(detail::doomed_list& list) noexcept {
    T* object = static_cast<T*>(list.first);
    auto& header = detail::access::header_of(*object);
    // (8) the list belongs to this thread.
    list.first = header.link.load(std::memory_order_relaxed);
    if (list.first == nullptr) {  // this list is the thread's first, see ~scope
      using env = typename detail::policy_of<T>::env;
      env::template thread_record<detail::doomed_record>().lists = list.next;
    }
    // A destructor that ran meanwhile may have referred to the object again.
    if (!word<T>::dequeue_if_referred_to(header.state)) slamgc::destroy_object(object);
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Base class of counted objects: `class KeyFrame : public slamgc::rc_object<KeyFrame>`.
///
/// Adds a header of 16 bytes (56 with `mutex_counter`): the state word and a link by which a
/// collector queues the object without allocating. It adds no virtual function, no operator new or
/// delete, and asks for no more than the alignment of a pointer. A copy of an object is a new object
/// with a count of zero; assignment leaves both counts alone.
///
/// An object made by plain `new` has a count of zero and is nobody's: it belongs to the program
/// until its first reference is stored.
///
/// @tparam T         The class that derives from this one. It is deleted as a `T`, so classes
///                   derived from `T` need a virtual destructor there.
/// @tparam Policy    How the count is changed; see basic_fetch_add_counter for the concept.
/// @tparam Reclaimer What happens when the count falls to zero; see reclaim_at_zero
///                   for the concept.
///
/// Thread-safety: counts may be changed by any thread at any time, except under `unsync_counter`.
template <class T, class Policy, class Reclaimer>
class rc_object {
  static_assert(detail::has_storage<Policy>::value,
                "slamgc: the counter policy needs the types `env` and `storage` (default "
                "constructible); see basic_fetch_add_counter in slamgc/counter.hpp");
  static_assert(
      !detail::has_storage<Policy>::value || detail::has_word_operations<Policy>::value,
      "slamgc: the counter policy needs load, add, subtract (returning std::uint64_t) and "
      "compare_exchange (returning bool); see basic_fetch_add_counter in "
      "slamgc/counter.hpp");

 public:
  /// References to this object that are counted now; more than 2^29 mean that the count overflowed.
  ///
  /// When it returns 1 to the holder of that one reference, everything that was done under the other
  /// references happened before: the object may be changed without a lock.
  [[nodiscard]] std::uint32_t use_count() const noexcept { return state().count(); }

  /// A snapshot of the state word.
  [[nodiscard]] state_word state() const noexcept {
    return detail::transitions<Policy>::load(header_.state);
  }

  /// For `boost::intrusive_ptr<T>`, which can hold these objects too: adds a reference.
  friend void intrusive_ptr_add_ref(const T* p) noexcept { detail::add_reference(p); }
  /// For `boost::intrusive_ptr<T>`, which can hold these objects too: removes a reference.
  friend void intrusive_ptr_release(const T* p) noexcept { detail::drop_reference(p); }

 protected:
  /// Starts with a count of zero.
  rc_object() noexcept(noexcept(Reclaimer::template first_link<T>())) {
    // (8) nobody else knows the object yet.
    header_.link.store(Reclaimer::template first_link<T>(), std::memory_order_relaxed);
  }
  /// A copy is a new object: it starts with a count of zero.
  rc_object(const rc_object&) noexcept(noexcept(rc_object())) : rc_object() {}
  /// References belong to the object, not to its value: nothing changes.
  rc_object& operator=(const rc_object&) noexcept { return *this; }
  /// Checks that nobody refers to the object.
  ~rc_object() {
    SLAMGC_ASSERT(use_count() == 0, (misuse{"destroys an object that is still referred to",
                                            detail::type_name<T>::get(), this, use_count()}));
  }

 private:
  friend struct detail::access;
  mutable detail::header<Policy> header_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

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
// ---- slamgc/rc_slot.hpp ----
/// @file
/// The counted pointer for members: an edge of the graph.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Counted pointer for a member of an object: what was `KeyFrame* mpParent;` becomes
/// `slamgc::rc_slot<KeyFrame> mpParent;`, and the code that uses it stays.
///
/// Reading is a load and gives a borrowed pointer, exactly as a raw member does. Assignment is an
/// atomic exchange, unless the pointer is there already: several threads may assign one slot without a
/// lock, and each old pointer is released once. It is as large as a pointer; `T` may be incomplete where the member is declared.
///
/// Thread-safety: any thread may read or assign at any time. A pointer that was *read* is safe to use
/// or to count only while something else keeps the object: a lock under which all writers assign, a
/// reference of the reader's own, or a grace period. Copying, moving and swapping read the other
/// slot, so the same holds for them. All operations are O(1), apart from a destructor that the last
/// reference sets off.
template <class T, class Env>
class rc_slot {
  static_assert(!std::is_pointer<T>::value,
                "slamgc: write rc_slot<KeyFrame>, not rc_slot<KeyFrame*>");

 public:
  /// What it points to.
  using element_type = T;

  /// Null.
  constexpr rc_slot() noexcept = default;
  /// Null. A template, so that `NULL` is taken as a pointer.
  template <class Null, class = std::enable_if_t<std::is_same<Null, std::nullptr_t>::value>>
  constexpr rc_slot(Null) noexcept {}
  /// Refers to @p p. Explicit, so that `condition ? slot : pointer` stays a pointer.
  explicit rc_slot(T* p) noexcept : p_((detail::add_reference(p), p)) {}
  /// Refers to the same object as @p p, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  explicit rc_slot(const intrusive_rc<U>& p) noexcept : rc_slot(static_cast<T*>(p.get())) {}
  /// Takes over the reference of @p p, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  explicit rc_slot(intrusive_rc<U>&& p) noexcept : p_(moved(p.detach())) {}
  /// Another reference to the same object.
  rc_slot(const rc_slot& other) noexcept : rc_slot(other.get()) {}
  /// Moves the reference here; @p other becomes null.
  rc_slot(rc_slot&& other) noexcept : p_(moved(other.replace(nullptr))) {}
  /// Removes the reference.
  ~rc_slot() { detail::drop_reference(replace(nullptr)); }

  /// Refers to @p p. Costs a load if it does already: references that are set in every frame mostly do.
  rc_slot& operator=(T* p) noexcept {
    if (get() == p) return *this;
    detail::add_reference(p);
    detail::drop_reference(replace(p));
    return *this;
  }
  /// Refers to the same object as @p other.
  rc_slot& operator=(const rc_slot& other) noexcept { return *this = other.get(); }
  /// Moves the reference here; @p other becomes null.
  rc_slot& operator=(rc_slot&& other) noexcept {
    detail::drop_reference(replace(moved(other.replace(nullptr))));
    return *this;
  }
  /// Refers to the same object as @p p, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  rc_slot& operator=(const intrusive_rc<U>& p) noexcept {
    return *this = static_cast<T*>(p.get());
  }
  /// Takes over the reference of @p p, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  rc_slot& operator=(intrusive_rc<U>&& p) noexcept {
    detail::drop_reference(replace(moved(p.detach())));
    return *this;
  }

  /// The pointer: borrowed.
  [[nodiscard]] T* get() const noexcept {
    return p_.load(std::memory_order_acquire);  // (9) sees the object that (10) published.
  }
  /// The pointer: borrowed.
  [[nodiscard]] operator T*() const noexcept { return get(); }
  /// The object's members. Not for a null slot.
  [[nodiscard]] T* operator->() const noexcept { return get(); }
  /// The object. Not for a null slot.
  [[nodiscard]] T& operator*() const noexcept { return *get(); }

  /// Refers to @p p and gives the old reference to the caller.
  [[nodiscard]] intrusive_rc<T> exchange(T* p) noexcept {
    detail::add_reference(p);
    return intrusive_rc<T>(moved(replace(p)), false);
  }
  /// Becomes null.
  void reset() noexcept { *this = static_cast<T*>(nullptr); }

  /// Exchanges the references of two slots. No reader of either sees null in between.
  void swap(rc_slot& other) noexcept {
    // Another thread may assign either slot meanwhile: what this one puts away is what it finds.
    T* const mine = get();
    detail::add_reference(mine);
    T* const theirs = moved(other.replace(mine));
    detail::drop_reference(replace(theirs));
  }

 private:
  /// Stores @p p, which is counted already; whatever stood here is the caller's.
  T* replace(T* p) noexcept {
    // (10) release: publishes the object and its count to (9) and (10); acquire: the caller may be
    // the one that destroys the old object, which another thread's (10) published.
    return p_.exchange(p, std::memory_order_acq_rel);
  }
  static T* moved(T* p) noexcept {
    detail::move_reference(p);
    return p;
  }

  typename Env::template atomic<T*> p_{nullptr};
};

/// Whether both point to the same object.
template <class T, class Env, class U>
[[nodiscard]] bool operator==(const rc_slot<T, Env>& a, const intrusive_rc<U>& b) noexcept {
  return a.get() == b.get();
}
/// Whether both point to the same object.
template <class T, class U, class Env>
[[nodiscard]] bool operator==(const intrusive_rc<T>& a, const rc_slot<U, Env>& b) noexcept {
  return a.get() == b.get();
}
/// Whether they point to different objects.
template <class T, class Env, class U>
[[nodiscard]] bool operator!=(const rc_slot<T, Env>& a, const intrusive_rc<U>& b) noexcept {
  return a.get() != b.get();
}
/// Whether they point to different objects.
template <class T, class U, class Env>
[[nodiscard]] bool operator!=(const intrusive_rc<T>& a, const rc_slot<U, Env>& b) noexcept {
  return a.get() != b.get();
}

/// Exchanges the references of two slots.
template <class T, class Env>
void swap(rc_slot<T, Env>& a, rc_slot<T, Env>& b) noexcept {
  a.swap(b);
}

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/scoped_count.hpp ----
/// @file
/// The thesis's way to count what a function uses.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Counts, while it exists, what a container of raw pointers holds: the scheme of the thesis (chapter
/// 4.3, figure 12) for a function that works on a copy of a container.
///
/// ```
/// std::unique_lock<std::mutex> lock(mMutexConnections);
/// const slamgc::scoped_count neighbours(mvpOrderedConnectedKeyFrames.raw());
/// lock.unlock();
/// for (KeyFrame* pKF : neighbours) use(pKF);  // each is kept until the scope ends
/// ```
///
/// **The copy has to be made under the lock of the container it is read from.** Otherwise the last
/// reference may go between reading a pointer and counting it, and the count would come too late.
///
/// Holds sequences and sets of `T*`, and maps with `T*` keys; the content is constant. O(size) counts
/// at both ends. Throws, at the beginning, what copying the container throws. Thread-safety: that of
/// the container.
template <class Container>
class scoped_count {
 public:
  using value_type = typename Container::value_type;          ///< As in Container.
  using const_iterator = typename Container::const_iterator;  ///< As in Container.

  /// Counts what @p content refers to.
  explicit scoped_count(Container content) : content_(std::move(content)) {
    for (const value_type& value : content_) detail::add_reference(reference_of(value));
  }
  /// Uncounts it.
  ~scoped_count() {
    for (const value_type& value : content_) detail::drop_reference(reference_of(value));
  }
  scoped_count(const scoped_count&) = delete;
  scoped_count& operator=(const scoped_count&) = delete;

  /// The container.
  [[nodiscard]] const Container& operator*() const noexcept { return content_; }
  /// The container's members.
  [[nodiscard]] const Container* operator->() const noexcept { return &content_; }
  /// As in Container.
  [[nodiscard]] const_iterator begin() const noexcept { return content_.begin(); }
  /// As in Container.
  [[nodiscard]] const_iterator end() const noexcept { return content_.end(); }

 private:
  template <class T>
  static T* reference_of(T* const& element) noexcept {
    return element;
  }
  template <class T, class Mapped>
  static T* reference_of(const std::pair<T* const, Mapped>& element) noexcept {
    return element.first;
  }

  Container content_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/version.hpp ----
/// @file
/// The version of slamgc. The build reads the numbers from here; they stand nowhere else.

/// Changes with the interface, from 1.0 on.
#define SLAMGC_VERSION_MAJOR 0
/// Changes with additions; before 1.0 also with the interface.
#define SLAMGC_VERSION_MINOR 1
/// Changes with corrections.
#define SLAMGC_VERSION_PATCH 0
