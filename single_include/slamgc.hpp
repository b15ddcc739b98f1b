// slamgc 0.2.0: the whole library in one file, made by scripts/amalgamate. Do not edit.
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
/// Everything, except mutex_counter.hpp, which exists for comparison, and what a program includes in one place, since
/// `<mutex>` is large: background_reclaimer.hpp, diagnosis/quarantine.hpp, integrations/,
/// adapters/.

// ---- slamgc/anchor.hpp ----
/// @file
/// Handles that keep a small record of their object when it is gone.

#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>

// ---- slamgc/assert.hpp ----
/// @file
/// What slamgc does when it is misused: a replaceable assertion that names the object.

#include <cstdint>
#include <cstdio>
#include <cstdlib>

// ---- slamgc/detail/object_watch.hpp ----
/// @file
/// Where a tool that watches objects is told of them; diagnosis/quarantine.hpp is one.
///
/// In the checked flavour only: there it is one branch for each object that is retired, falls to zero or is destroyed.

// ---- slamgc/flavour.hpp ----
/// @file
/// The two flavours of slamgc: with checks of misuse and without.
///
/// `SLAMGC_DEBUG` chooses: 1 turns the checks on, 0 turns them off. Unless the program says
/// otherwise they are on when `NDEBUG` is not defined, or when the program brings a `SLAMGC_ASSERT`
/// of its own. Layout is the same in both, but for slamgc::borrow, which is for locals. The functions are not, so each flavour lives in an inline
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

/// Of namespace slamgc::runtime: what all flavours and all shared libraries of a process have in common,
/// under `-fvisibility=hidden`, too.
#define SLAMGC_SHARED __attribute__((visibility("default")))

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// The memory of an object whose destructor has run.
struct held_memory {
  static constexpr unsigned char pattern = 0xdd;  // of all bytes but the header's

  void* begin;
  std::size_t size;
  const char* type;
  void* header;  // a new one: who counts a reference to the object is found out by it
  std::size_t header_size;
  bool (*header_is_new)(const void* header) noexcept;
  void (*free)(const held_memory&) noexcept;  // what `delete` does after the destructor
};

class object_watch {
 public:
  using place = std::uint32_t;  // in the program, by its stack; 0: not known

  /// The calling thread is about to drop the last reference to the object.
  virtual void falls_to_zero(const void* object, const char* type) noexcept = 0;
  virtual void retired(const void* object, const char* type) noexcept = 0;
  /// Whether to report that it was retired before.
  virtual bool reports_double_retire() const noexcept = 0;
  /// Memory to free, now or later.
  virtual void hold(const held_memory& memory) noexcept = 0;
  /// The object is destroyed as usual.
  virtual void let_go(const void* object) noexcept = 0;
  /// Whether @p p points into memory that is held.
  virtual bool holds(const void* p) noexcept = 0;
  virtual place here() noexcept = 0;
  /// Prints what is known of the object at @p p, to the standard error stream.
  virtual void print(const void* p, place borrowed) noexcept = 0;

 protected:
  ~object_watch() = default;
};

/// Changed only while no other thread uses objects.
inline object_watch* watch = nullptr;

}  // namespace SLAMGC_SHARED

inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Null, as the compiler knows, in the unchecked flavour. (Were it constexpr, g++ would warn of calls that are never made.)
inline runtime::object_watch* watch() noexcept {
#if SLAMGC_DEBUG
  return runtime::watch;
#else
  return nullptr;
#endif
}

/// Whether the object at @p p was reclaimed and somebody found out in time.
inline bool was_reclaimed(const void* p) noexcept {
  return watch() != nullptr && watch()->holds(p);
}

/// Whether a second retirement is to be reported.
inline bool reports_double_retire() noexcept {
  return watch() != nullptr && watch()->reports_double_retire();
}

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

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
// ---- slamgc/deferred.hpp ----
/// @file
/// The reclaimers that wait: an object is destroyed when nobody can see it any more.

// ---- slamgc/detail/zero_count_table.hpp ----
/// @file
/// The zero-count table: objects that wait until nobody can see them any more.
///
/// **Life of an entry.** An object enters when its count falls to zero or when it is retired at zero,
/// whichever comes first: the change that makes it so also sets `queued`, and the thread whose change set
/// it pushes the object. So each object is in the table at most once, and whoever pushes it owns its link.
/// While it is not queued, the link names the table that it belongs to.
///
/// The collector *notes* the state word of each object that has entered, advances the epoch, and after the
/// grace period *decides*:
///
/// | count | version | the object |
/// |---|---|---|
/// | 0 | as noted | is reclaimed |
/// | 0 | another | enters anew: a pointer may have been borrowed through the reference that came and went |
/// | more | | leaves the table |
///
/// **An object that is reclaimed is out of everybody's sight.** Its count was zero when the word was noted,
/// and no reference was added since (counter.hpp). So every reference had been unlinked before the epoch
/// was advanced, and after the grace period nobody holds a pointer that was borrowed through one
/// (domain.hpp). Without a pointer nobody adds a reference or retires it either.
///
/// **None is lost.** Leaving the table is one compare-and-swap of the whole word, which clears `queued`. A
/// fall to zero or a retirement after it finds the flag clear and pushes the object again; one before it
/// makes the compare-and-swap fail, and the collector decides again.
///
/// Deferred reference counting: Deutsch and Bobrow 1976; *The Garbage Collection Handbook*, 5.3.

// ---- slamgc/reclaim_at_zero.hpp ----
/// @file
/// The default reclaimer: an object is destroyed as soon as its count falls to zero.

// ---- slamgc/detail/header.hpp ----
/// @file
/// The header of an object, and how the rest of the library reaches it and counts references.

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

// ---- slamgc/fwd.hpp ----
/// @file
/// Declarations only: include this where a pointer or a reference to a slamgc type is enough.

/// slamgc: concurrent memory reclamation for graph-shaped SLAM maps.
namespace slamgc {

/// What a process has once, whatever the flavours of its parts: threads register with a domain, not with a
/// flavour of it.
namespace runtime SLAMGC_SHARED {
struct std_env;
template <class Env>
class domain_state;
}  // namespace SLAMGC_SHARED
using runtime::std_env;

/// Checked and unchecked builds live side by side; see flavour.hpp.
inline namespace SLAMGC_FLAVOUR {

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
struct reclaim_deferred;
struct reclaim_retired;
struct reclaim_by_scan;

template <class T, class Policy = fetch_add_counter, class Reclaimer = reclaim_at_zero>
class rc_object;

template <class T>
class intrusive_rc;
template <class T, class Env = std_env>
class rc_slot;
template <class T, class Env = std_env>
class atomic_rc;
template <class T, class Env = std_env>
class borrow;
template <class T, class Env = std_env>
class enable_weak_rc;
template <class T, class Env = std_env>
class weak_rc;
template <class T, class Record, class Env = std_env>
class enable_anchor;
template <class T, class Record, class Env = std_env>
class anchor;
template <class Container>
class scoped_count;

template <class Env>
class basic_domain;
template <class Env>
class basic_mutator;
template <class Env>
class basic_root;
template <class T>
class retire_set;
class background_reclaimer;

/// What the objects, threads and collectors of a SLAM system share.
using domain = basic_domain<std_env>;
/// Registers a thread with a domain.
using mutator = basic_mutator<std_env>;
/// Tells a domain where references from outside of the graph are.
using root = basic_root<std_env>;

namespace detail {
struct domain_access;
struct mutator_access;
}  // namespace detail

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
template <class Container, class Env = std_env>
class registry;
template <class T, class... Options>
class rc_unordered_set;
template <class T, class Mapped, class... Options>
class rc_unordered_map;

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

namespace slamgc {
namespace runtime SLAMGC_SHARED {

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

  /// As many mutators of a domain at a time have a place of their own in its tables; more share one.
  static constexpr std::size_t mutator_doors = 62;

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

  /// Replaces an element of a standard container if it is @p expected.
  template <class T>
  [[nodiscard]] static bool compare_exchange(T*& element, T* expected, T* desired) noexcept {
    // (2) memory_order_acq_rel: as exchange().
    // (2) memory_order_relaxed: a failure reads nothing that anybody uses.
    return __atomic_compare_exchange_n(&element, &expected, desired, false,
                                       __ATOMIC_ACQ_REL,   // (2)
                                       __ATOMIC_RELAXED);  // (2)
  }
};

}  // namespace SLAMGC_SHARED
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
// ---- slamgc/detail/hold_back.hpp ----
/// @file
/// Destroying an object without freeing its memory.
///
/// `delete` is taken apart: the destructor here, the deallocation function that `delete` would have called later. Which one that
/// is depends on the most derived type. It is known for a type without a virtual destructor; for one that has it, only if the
/// object is exactly that type, by run-time type information. Else, and for a class with a destroying `operator delete` or with one
/// that is not accessible together with its destructor, objects are deleted as usual.

#include <cstring>
#include <new>
#if defined(__cpp_rtti)
#include <typeinfo>
#endif

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
#if SLAMGC_DEBUG
  if (auto* const watch = detail::watch())
    if (detail::hold_back(object, *watch)) return;
#endif
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
/// - `last_link<T>(void*)`, static and `noexcept`, if wanted: the program itself deletes an object, with
///   that link word.
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
// ---- slamgc/detail/described.hpp ----
/// @file
/// What collectors do by means of edges(): find references, sever, purge, report.

// ---- slamgc/dispositions.hpp ----
/// @file
/// What becomes of an edge when its target is retired.
///
/// ```
/// v.edge("mpParent", mpParent);                                        // hold: nothing
/// v.edge("mvpMapPoints", mvpMapPoints, slamgc::on_retire::null);       // the element becomes null
/// v.edge("mObservations", mObservations, slamgc::on_retire::erase);    // the key or element goes
/// v.edge("mvpOrderedConnectedKeyFrames", mvpOrderedConnectedKeyFrames, // so do those that belong to it
///        slamgc::on_retire::erase_with(mvOrderedWeights));
/// v.edge("mNextKF", mNextKF, slamgc::on_retire::bypass([](KeyFrame& retired) {
///          return retired.mNextKF.get();                               // the slot refers to this instead
///        }));
/// v.edge("mObservations", mObservations,                              // somebody is told before
///        slamgc::on_retire::announce(tell, slamgc::on_retire::erase));
/// ```
///
/// An edge of a live object to a retired one is *stale*: the program has declared the target dead and left a
/// reference to it behind. A purge (detail/purge.hpp) finds stale edges and does with each what its description says.

#include <tuple>

namespace slamgc {
namespace on_retire {

/// Nothing: whoever described the edge needs the object, retired or not. The default.
struct hold_edge {};
inline constexpr hold_edge hold{};  ///< See hold_edge.

/// The slot, the element of an rc_vector or the value of an rc_value_map becomes null.
struct null_edge {};
inline constexpr null_edge null{};  ///< See null_edge.

/// The key or element is erased from its container.
struct erase_edge {};
inline constexpr erase_edge erase{};  ///< See erase_edge.

/// As erase_edge, from an rc_vector or rc_list; and so is what stands at the same place in each companion. See
/// erase_with().
template <class... Companions>
struct erase_edge_with {
  std::tuple<Companions&...> companions;  ///< What loses the same elements.
};
/// The element is erased from its rc_vector or rc_list, and with it what stands at the same place in each of
/// @p companions: sequences of the same length, under the same lock. Of another length: nothing happens, and the checked
/// flavour reports it.
template <class... Companions>
erase_edge_with<Companions...> erase_with(Companions&... companions) noexcept {
  return {std::tuple<Companions&...>(companions...)};
}

/// See bypass().
template <class Next>
struct bypass_edge {
  Next next;  ///< What comes after a retired object.
};
/// The slot or element refers to what @p next(retired) returns instead, which may be null; and if that is retired too,
/// to what comes next (in a retired object that is still referred to: at most 64 of them, then null). For chains, whose
/// retired members are to be stepped over. @p next is called with the locks of edges() held; it may do what belongs to it,
/// such as adding the retired keyframe's measurements to those of its neighbour, but must not throw. (Another thread may
/// assign the slot at the same time: then it was called in vain.)
template <class Next>
bypass_edge<Next> bypass(Next next) noexcept {
  return {std::move(next)};
}

/// See announce().
template <class F, class How>
struct announced_edge {
  F f;      ///< Is told.
  How how;  ///< What happens then.
};
/// As @p how, which is null, erase or erase_with; but before a reference to a retired object goes, @p f(retired) is called, with the
/// locks of edges() held and the reference still there. For a program that keeps an index over the member, and tells it of its own
/// changes, too. @p f must not throw and must not change the member; of a sequence that elements are erased from it must not
/// even read it. (An element that another thread assigns without the lock may be announced in vain.) Erasing by key takes a
/// walk then, not a look-up.
template <class F, class How>
announced_edge<F, How> announce(F f, How how) noexcept {
  return {std::move(f), std::move(how)};
}

/// For reports.
constexpr const char* name_of(const hold_edge*) noexcept { return "hold"; }
/// For reports.
constexpr const char* name_of(const null_edge*) noexcept { return "null"; }
/// For reports.
constexpr const char* name_of(const erase_edge*) noexcept { return "erase"; }
/// For reports.
template <class... Companions>
constexpr const char* name_of(const erase_edge_with<Companions...>*) noexcept {
  return "erase";
}
/// For reports.
template <class Next>
constexpr const char* name_of(const bypass_edge<Next>*) noexcept {
  return "bypass";
}
/// For reports.
template <class F, class How>
constexpr const char* name_of(const announced_edge<F, How>*) noexcept {
  return name_of(static_cast<const How*>(nullptr));
}

}  // namespace on_retire
}  // namespace slamgc
// ---- slamgc/detail/edge_member.hpp ----
/// @file
/// How the references in a counted member are read, dropped, and purged of stale ones.

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
  /// If the element refers to @p expected: it refers to @p p, and returns true. Else nothing changes.
  bool compare_exchange(T* expected, T* p) const noexcept {
    detail::add_reference(p);
    const bool done = policy_of<T>::env::compare_exchange(element_, expected, p);
    detail::drop_reference(done ? expected : p);
    return done;
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
namespace detail {

template <class T, class Std, class Reference, class Iterator>
class counted_container;
template <class Member>
struct edge_member;
template <class T, class Std, class Reference, class Iterator>
Reference reference_in(const counted_container<T, Std, Reference, Iterator>&);

struct element_mapped;

template <class How>
struct is_bypass : std::false_type {};
template <class Next>
struct is_bypass<on_retire::bypass_edge<Next>> : std::true_type {};

/// Whether elements are found by their number.
template <class Sequence, class = void>
struct has_index : std::false_type {};
template <class Sequence>
struct has_index<Sequence, std::void_t<decltype(std::declval<Sequence&>()[std::size_t{}])>>
    : std::true_type {};

/// Removes elements from a companion of a purged sequence, in step with it.
template <class Companion>
class companion_cursor {
  using iterator = typename Companion::iterator;
  static constexpr bool by_index = has_index<Companion>::value;

 public:
  explicit companion_cursor(Companion& c) : companion_(c), at_(c.begin()) {}

  void keep() {
    if constexpr (by_index) {
      if (kept_ != seen_) companion_[kept_] = std::move(companion_[seen_]);
      ++kept_;
      ++seen_;
    } else {
      ++at_;
    }
  }
  void remove() {
    if constexpr (by_index)
      ++seen_;
    else
      at_ = companion_.erase(at_);
  }
  void finish() {
    if constexpr (by_index)
      companion_.erase(companion_.begin() + static_cast<std::ptrdiff_t>(kept_), companion_.end());
  }

 private:
  Companion& companion_;
  iterator at_;
  std::size_t kept_ = 0;
  std::size_t seen_ = 0;
};

/// What bypass puts in the place of @p p. Chains of retired objects may be circles; in a retired object that is itself part of a
/// long one, what comes after so many steps is nothing: else a map that died but for one object would take quadratic time.
template <class T, class Next, class Stale>
T* bypassed(T* p, const Next& next, Stale& stale) {
  T* mark = p;
  std::size_t steps = 0;
  std::size_t next_mark = 1;
  do {
    p = next(*p);
    if (p == mark || steps == stale.patience()) return nullptr;
    if (++steps == next_mark) {  // Brent 1980: the mark moves at powers of two
      mark = p;
      next_mark *= 2;
    }
  } while (p != nullptr && stale(p));
  return p;
}

/// Tells @p f of each stale target that it finds; whoever asks drops it then.
template <class F, class Stale>
class announcing {
 public:
  announcing(const F& f, Stale& stale) noexcept : f_(f), stale_(stale) {}

  template <class T>
  bool operator()(T* p) const {
    if (!stale_(p)) return false;
    f_(*p);
    return true;
  }
  bool dropped(bool done) const noexcept { return stale_.dropped(done); }
  /// What is looked up need not be there, and would be announced.
  static bool few(std::size_t) noexcept { return false; }
  template <class T, class G>
  static void each(G) noexcept {}

 private:
  const F& f_;
  Stale& stale_;
};
template <class Member, class F, class How, class Stale>
void purge_announced(Member& member, const on_retire::announced_edge<F, How>& how, Stale& stale) {
  static_assert(!std::is_same<How, on_retire::hold_edge>::value && !is_bypass<How>::value,
                "slamgc: what can be announced is null, erase and erase_with");
  announcing<F, Stale> announced(how.f, stale);
  edge_member<Member>::purge(member, how.how, announced);
}

/// A member that is one reference: `compare_exchange` changes it while other threads may assign it.
template <class Slot>
struct edge_slot {
  template <class F>
  static void each(const Slot& member, F f) {
    if (auto* const p = member.get()) f(p);
  }
  template <class Stale>
  static void purge(Slot& member, on_retire::hold_edge, Stale& stale) {
    each(member, [&](auto* p) { stale.hold(p); });
  }
  template <class Stale>
  static void purge(Slot& member, on_retire::null_edge, Stale& stale) {
    auto* const p = member.get();
    if (p != nullptr && stale(p)) stale.dropped(replace(member, p, decltype(p)(nullptr)));
  }
  template <class Next, class Stale>
  static void purge(Slot& member, const on_retire::bypass_edge<Next>& how, Stale& stale) {
    auto* const p = member.get();
    if (p != nullptr && stale(p))
      stale.dropped(replace(member, p, detail::bypassed(p, how.next, stale)));
  }
  template <class F, class How, class Stale>
  static void purge(Slot& member, const on_retire::announced_edge<F, How>& how, Stale& stale) {
    detail::purge_announced(member, how, stale);
  }
  template <class Disposition, class Stale>
  static void purge(Slot&, const Disposition&, Stale&) {
    static_assert(false_for<Disposition>::value,
                  "slamgc: what can become of a slot is hold, null or bypass");
  }

 private:
  template <class T, class Env>
  static bool replace(rc_slot<T, Env>& slot, T* expected, T* p) {
    return slot.compare_exchange(expected, p);
  }
  template <class T, class Env>
  static bool replace(atomic_rc<T, Env>& slot, T* expected, T* p) {
    return slot.compare_exchange_strong(expected, intrusive_rc<T>(p));
  }
};

/// What all containers have in common.
template <class Container>
struct edge_container {
  using reference = decltype(detail::reference_in(std::declval<const Container&>()));

  template <class F>
  static void each(const Container& member, F f) {
    for (const auto& value : member.raw())
      if (auto* const p = reference()(value)) f(p);
  }
  static void sever(Container& member) noexcept { member.clear(); }
  template <class Stale>
  static void purge(Container& member, on_retire::hold_edge, Stale& stale) {
    each(member, [&](auto* p) { stale.hold(p); });
  }
  template <class F, class How, class Stale>
  static void purge(Container& member, const on_retire::announced_edge<F, How>& how, Stale& stale) {
    detail::purge_announced(member, how, stale);
  }
  template <class Disposition, class Stale>
  static void purge(Container&, const Disposition&, Stale&) {
    static_assert(
        false_for<Disposition>::value,
        "slamgc: this container cannot do that: null is for rc_vector and rc_value_map, bypass "
        "and erase_with for sequences");
  }

 protected:
  /// What `remove_if` asks.
  template <class Stale>
  static auto removes(Stale& stale) {
    return [&stale](auto* p) { return p != nullptr && stale(p) && stale.dropped(true); };
  }
};

/// rc_vector and rc_list.
template <class Container>
struct edge_sequence : edge_container<Container> {
  using edge_container<Container>::purge;

  template <class Stale>
  static void purge(Container& member, on_retire::erase_edge, Stale& stale) {
    member.remove_if(edge_container<Container>::removes(stale));
  }
  template <class... Companions, class Stale>
  static void purge(Container& member, const on_retire::erase_edge_with<Companions...>& how,
                    Stale& stale) {
    if (member.empty()) return;  // some clear the sequence and forget its companions
    const bool in_step = std::apply(
        [&](auto&... c) { return (... && (c.size() == member.size())); }, how.companions);
    SLAMGC_ASSERT(in_step, (misuse{"describes a companion of another length than its sequence",
                                   "companion", &member, 0}));
    if (!in_step) return purge(member, on_retire::hold, stale);
    auto cursors =
        std::apply([](auto&... c) { return std::make_tuple(cursor_of(c)...); }, how.companions);
    const auto gone = edge_container<Container>::removes(stale);
    member.remove_if([&](auto* p) {
      const bool remove = gone(p);
      std::apply([remove](auto&... c) { (..., (remove ? c.remove() : c.keep())); }, cursors);
      return remove;
    });
    std::apply([](auto&... c) { (..., c.finish()); }, cursors);
  }

 private:
  template <class Companion>
  static companion_cursor<Companion> cursor_of(Companion& c) {
    return companion_cursor<Companion>(c);
  }
};

/// Containers whose elements can be replaced one by one.
template <class Stale, class Element>
void purge_element(Element element, on_retire::null_edge, Stale& stale) {
  auto* const p = element.get();
  if (p != nullptr && stale(p)) stale.dropped(element.compare_exchange(p, nullptr));
}
template <class Stale, class Next, class Element>
void purge_element(Element element, const on_retire::bypass_edge<Next>& how, Stale& stale) {
  auto* const p = element.get();
  if (p != nullptr && stale(p))
    stale.dropped(element.compare_exchange(p, detail::bypassed(p, how.next, stale)));
}

/// Sets and maps.
template <class Container>
struct edge_keyed : edge_container<Container> {
  using edge_container<Container>::purge;
  using typename edge_container<Container>::reference;

  template <class Stale>
  static void purge(Container& member, on_retire::erase_edge, Stale& stale) {
    using pointer = decltype(reference()(*member.raw().begin()));
    using target = std::remove_cv_t<std::remove_pointer_t<pointer>>;
    // By look-up, where that is less work than a walk. What a purge knows are objects, not derived ones.
    if constexpr (!std::is_same<reference, element_mapped>::value &&
                  std::is_same<target, object_of<target>>::value) {
      if (stale.few(member.size())) {
        stale.template each<target>([&](target* p) {
          const auto at = member.find(p);
          if (at == member.end() || reference()(*at) != p)
            return false;  // or just an equivalent one
          member.erase(at);
          return true;
        });
        return;
      }
    }
    const auto gone = edge_container<Container>::removes(stale);
    for (auto i = member.raw().begin(); i != member.raw().end();) {
      if (gone(reference()(*i)))
        i = member.erase(i);
      else
        ++i;
    }
  }
};

template <class Member>
struct edge_member {
  static_assert(
      false_for<Member>::value,
      "slamgc: an edge is an rc_slot, an atomic_rc or a counted container; an intrusive_rc is "
      "none, since moving it tells nobody, and a raw pointer is not counted");
};
template <class T, class Env>
struct edge_member<rc_slot<T, Env>> : edge_slot<rc_slot<T, Env>> {
  static void sever(rc_slot<T, Env>& member) noexcept { member = nullptr; }
};
template <class T, class Env>
struct edge_member<atomic_rc<T, Env>> : edge_slot<atomic_rc<T, Env>> {
  static void sever(atomic_rc<T, Env>& member) noexcept { member = nullptr; }
};
template <class T, class... Options>
struct edge_member<rc_vector<T, Options...>> : edge_sequence<rc_vector<T, Options...>> {
  using edge_sequence<rc_vector<T, Options...>>::purge;

  template <class Stale>
  static void purge(rc_vector<T, Options...>& member, on_retire::null_edge how, Stale& stale) {
    for (std::size_t i = 0; i != member.size(); ++i) detail::purge_element(member[i], how, stale);
  }
  template <class Next, class Stale>
  static void purge(rc_vector<T, Options...>& member, const on_retire::bypass_edge<Next>& how,
                    Stale& stale) {
    for (std::size_t i = 0; i != member.size(); ++i) detail::purge_element(member[i], how, stale);
  }
};
template <class T, class... Options>
struct edge_member<rc_list<T, Options...>> : edge_sequence<rc_list<T, Options...>> {};
template <class T, class... Options>
struct edge_member<rc_set<T, Options...>> : edge_keyed<rc_set<T, Options...>> {};
template <class T, class M, class... Options>
struct edge_member<rc_map<T, M, Options...>> : edge_keyed<rc_map<T, M, Options...>> {};
template <class K, class T, class... Options>
struct edge_member<rc_value_map<K, T, Options...>> : edge_keyed<rc_value_map<K, T, Options...>> {
  using edge_keyed<rc_value_map<K, T, Options...>>::purge;

  template <class Stale>
  static void purge(rc_value_map<K, T, Options...>& member, on_retire::null_edge how,
                    Stale& stale) {
    for (const auto& value : member.raw())
      if (value.second != nullptr && stale(value.second))
        detail::purge_element(member.at(value.first), how, stale);
  }
};
template <class T, class... Options>
struct edge_member<rc_unordered_set<T, Options...>> : edge_keyed<rc_unordered_set<T, Options...>> {
};
template <class T, class M, class... Options>
struct edge_member<rc_unordered_map<T, M, Options...>>
    : edge_keyed<rc_unordered_map<T, M, Options...>> {};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/detail/purge.hpp ----
/// @file
/// The purge: what the program left of references to retired objects is dropped.
///
/// ORB-SLAM3 marks a keyframe as bad and takes it out of most places, not out of all: covisibility keys are not symmetric,
/// neighbours in time keep it, a fused point stays in slots. Such *stale edges* keep retired objects for ever: they are
/// *stuck*. A purge walks the live objects from the roots (heap_walk.hpp) and does with each edge to a stuck object what the
/// edge's disposition says (dispositions.hpp), under the locks that its edges() takes. All stuck objects in one walk.
///
/// **When.** Trial deletion excludes a candidate that is referred to from elsewhere. A purge is due if, since the last one
/// began, such a candidate has appeared or a reference to one was added or moved (its version). Else the last purge has seen
/// all references to it, and those that are left are held or not described. That is true unless an edge moved past the walk:
/// so if the references that a purge has seen do not add up to the count, or if some edges() threw, it is due again after 1, 2,
/// 4, ..., 1024, 1024, ... calls. And it rests after the last one, as long as the call's budget asks for: a map in which something is
/// always stuck is not walked through all the time.
///
/// **Edges of stuck objects** are purged, too. Else a retired keyframe that one member of a thread holds would keep the next one
/// that is retired, and that one the next: one old reference, and nothing would be reclaimed any more. What the program needs
/// of a retired object that it still uses, such as the parent that its pose is relative to, is for its edges() to hold.
///
/// **Why it is safe**: a purge drops references as the program could at any time. It holds no lock of the library, and
/// destroys nothing. Between its begin and its end no object is destroyed at all.
///
/// Each step visits one object: its edges are the longest that a lock of the program is held. O(live objects + edges);
/// stuck objects are looked up in keyed containers.

#include <algorithm>
#include <chrono>

// ---- slamgc/detail/clock.hpp ----
/// @file
/// Time, apart from env.hpp because `<chrono>` and `<thread>` are large.

#include <thread>

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// The time of an environment: real, unless it specialises this.
template <class Env>
struct clock_of {
  using time_point = std::chrono::steady_clock::time_point;

  static time_point now() noexcept { return std::chrono::steady_clock::now(); }

  /// Lets other threads run for about @p time; zero is a yield.
  static void pause(std::chrono::nanoseconds time) noexcept {
    if (time.count() == 0)
      std::this_thread::yield();
    else
      std::this_thread::sleep_for(time);
  }
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
// ---- slamgc/detail/heap_walk.hpp ----
/// @file
/// A walk over the live objects of a domain, from its roots along the described edges.
///
/// **Safe without counting.** Objects are destroyed by collectors alone, one of which is at work at a time, and this
/// one destroys nothing from the begin of a walk to its end: so each object that was met through an edge exists until then,
/// whatever mutators do to its edges meanwhile. (An object that the program itself deletes must never have been stored in an
/// edge or a root: those are retired.)
///
/// **What it meets.** An object is met if a path leads to it all the time. While mutators move edges about, one may be
/// missed; those who walk say what that means to them.
///
/// Each step visits one object, so that a walk can be done in slices. O(objects + edges) in all; eight bytes for each
/// object, at a load of at most one half, while it lasts.

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// A set of addresses, or a map from addresses to small values. Out of memory it stays as it is.
template <class Entry>
class address_table {
  static_assert(std::is_trivially_copyable<Entry>::value, "is moved by plain copies");

 public:
  address_table() noexcept = default;
  ~address_table() { clear(); }
  address_table(const address_table&) = delete;
  address_table& operator=(const address_table&) = delete;

  std::size_t size() const noexcept { return size_; }
  bool reserve(std::size_t entries) noexcept {
    std::size_t slots = 64;
    while (slots < 2 * entries) slots *= 2;
    return slots <= slots_ || rehash(slots);
  }
  /// The entry with this key, or null.
  Entry* find(const void* key) const noexcept {
    if (size_ == 0) return nullptr;
    Entry* const e = place_of(key);
    return e->key == key ? e : nullptr;
  }
  /// Adds an entry, unless there is one with its key. Null: no memory; else `added` says which.
  Entry* add(const Entry& entry, bool& added) noexcept {
    if (2 * size_ >= slots_ && !rehash(slots_ == 0 ? 64 : 2 * slots_)) return nullptr;
    Entry* const e = place_of(entry.key);
    added = e->key != entry.key;
    if (added) {
      *e = entry;
      ++size_;
    }
    return e;
  }
  template <class F>
  void each(F f) const {
    for (std::size_t i = 0; i != slots_; ++i)
      if (entries_[i].key != nullptr) f(entries_[i]);
  }
  void clear() noexcept {
    std::free(entries_);
    entries_ = nullptr;
    slots_ = size_ = 0;
  }

 private:
  Entry* place_of(const void* key) const noexcept {
    // Fibonacci hashing (Knuth, TAOCP 6.4): objects of one type lie at equal distances.
    std::size_t i = static_cast<std::size_t>(
        ((reinterpret_cast<std::uintptr_t>(key) >> 3) * UINT64_C(0x9e3779b97f4a7c15)) >> 20);
    for (;; ++i) {
      Entry& e = entries_[i & (slots_ - 1)];
      if (e.key == key || e.key == nullptr) return &e;
    }
  }
  bool rehash(std::size_t slots) noexcept {
    // Zero as the system hands it out: large tables cost nothing until they are used.
    auto* const fresh = static_cast<Entry*>(std::calloc(slots, sizeof(Entry)));
    if (fresh == nullptr) return false;
    Entry* const old = entries_;
    const std::size_t old_slots = slots_;
    entries_ = fresh;
    slots_ = slots;
    for (std::size_t i = 0; i != old_slots; ++i)
      if (old[i].key != nullptr) *place_of(old[i].key) = old[i];
    std::free(old);
    return true;
  }

  Entry* entries_ = nullptr;
  std::size_t slots_ = 0;
  std::size_t size_ = 0;
};

/// A stack. Out of memory it stays as it is.
template <class Item>
class growing_stack {
  static_assert(std::is_trivially_copyable<Item>::value, "is moved by plain copies");

 public:
  growing_stack() noexcept = default;
  ~growing_stack() { clear(); }
  growing_stack(const growing_stack&) = delete;
  growing_stack& operator=(const growing_stack&) = delete;

  bool empty() const noexcept { return size_ == 0; }
  bool push(const Item& item) noexcept {
    if (size_ == room_) {
      const std::size_t room = room_ == 0 ? 256 : 2 * room_;
      void* const more = std::realloc(items_, room * sizeof(Item));
      if (more == nullptr) return false;
      items_ = static_cast<Item*>(more);
      room_ = room;
    }
    items_[size_++] = item;
    return true;
  }
  Item pop() noexcept { return items_[--size_]; }
  void clear() noexcept {
    std::free(items_);
    items_ = nullptr;
    size_ = room_ = 0;
  }

 private:
  Item* items_ = nullptr;
  std::size_t size_ = 0;
  std::size_t room_ = 0;
};

template <class Env>
class purge;
template <class Env>
class trial_deletion;
template <class Env>
class edge_sink;

/// What a walk can do with an object, or with a root, of some type that describes its edges. False if edges() threw.
template <class Env>
struct described_operations {
  bool (*purge_by_collector)(void* described, purge<Env>& with);
  /// By the thread that owns a root.
  bool (*purge_by_owner)(void* described);
  bool (*report)(void* described, edge_sink<Env>& to);
  /// Makes suspects of what it refers to.
  bool (*suspect)(void* described, trial_deletion<Env>& trial);
  /// Records its references to candidates.
  bool (*record)(void* described, trial_deletion<Env>& trial);
};

/// What an edge refers to.
template <class Env>
struct edge_target {
  void* object;
  const char* type;
  std::uint64_t word;
  const described_operations<Env>*
      described;                            // null: its type describes no edges, or does not defer
  std::uint64_t (*id)(const void* object);  // null: its type has no report_id()
};

/// Takes what a collector knows, for reports.
template <class Env>
class edge_sink {
 public:
  /// A described reference of an object or a root.
  virtual void edge(const char* name, const char* disposition, const edge_target<Env>& target) = 0;
  /// An object that waits in a table.
  virtual void waiting(const edge_target<Env>& object) = 0;

 protected:
  ~edge_sink() = default;
};

/// The objects that a walk has met and has still to visit.
template <class Env>
class heap_walk {
 public:
  using operations = described_operations<Env>;
  struct item {
    void* object;
    const operations* type;
  };

  bool reserve(std::size_t objects) noexcept { return met_.reserve(objects); }
  /// An object was met. It is visited unless it was met before.
  void meet(void* object, const operations& type) noexcept {
    bool added = false;
    if (met_.add({object}, added) == nullptr || (added && !pending_.push({object, &type})))
      out_of_memory_ = true;
  }
  /// Is never visited.
  void exclude(void* object) noexcept {
    bool ignored;
    if (met_.add({object}, ignored) == nullptr) out_of_memory_ = true;
  }
  void fail() noexcept { out_of_memory_ = true; }
  bool at_end() const noexcept { return pending_.empty(); }
  item next() noexcept { return pending_.pop(); }
  bool out_of_memory() const noexcept { return out_of_memory_; }
  void clear() noexcept {
    met_.clear();
    pending_.clear();
    out_of_memory_ = false;
  }

 private:
  struct entry {
    const void* key;
  };
  address_table<entry> met_;
  growing_stack<item> pending_;
  bool out_of_memory_ = false;
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
// ---- slamgc/detail/root_list.hpp ----
/// @file
/// The roots of a domain, and how a collector visits them while others come and go.
///
/// **States** of a place in the list: *free*; *rooted*, from the root's constructor to its destructor; *held*, while a
/// collector is in its edges(). The collector goes from rooted to held and back; the root's destructor from rooted to
/// free, for which it waits while it is held. Places are used again and freed with the domain's state. A root that belongs
/// to a mutator is not visited by the collector.

// ---- slamgc/detail/participant.hpp ----
/// @file
/// How a thread takes part in a domain: as a mutator, or as the collector at work.

namespace slamgc {
namespace runtime SLAMGC_SHARED {

inline constexpr std::size_t cache_line = 64;

template <class Env>
struct table_door;
template <class Env>
struct root_place;

/// A registered thread, as collectors see it. Records are used again and freed with the domain's state
/// only, so a collector reads them without a lock.
template <class Env>
struct alignas(cache_line) mutator_record {
  static constexpr std::uint64_t offline = 0;

  typename Env::template atomic<std::uint64_t> epoch{offline};
  typename Env::template atomic<bool> taken{true};
  typename Env::template atomic<const char*> name{nullptr};
  mutator_record* next = nullptr;
  std::size_t door = 0;
};

/// One part of a thread in a domain, known to that thread alone.
template <class Env>
struct participant {
  participant* outer;
  domain_state<Env>* domain;
  mutator_record<Env>* record;  // null: the collector
  std::size_t door;             // which door of each table is its own; 0: none
  bool online;
  bool never_reclaim;
  std::uint64_t number = 0;            // no other part of the thread ever has it
  std::uint64_t passed = 0;            // which of the thread's quiescent states was its last
  table_door<Env>* pending = nullptr;  // its doors with a chain to publish
  root_place<Env>* roots = nullptr;    // that it owns
  std::uint64_t purged = 0;            // the last purge that it has joined

  /// Whether it keeps what enters a table in a chain of its own, which it publishes later.
  bool keeps_chains() const noexcept { return door != 0 && may_borrow(); }

  /// Whether pointers may be borrowed: the collector's destructors, too, read what their objects refer to.
  bool may_borrow() const noexcept { return online || record == nullptr; }

  /// What was borrowed before is not valid any more; for the checks of borrow.hpp.
  void pass_quiescent_state() noexcept;

  /// Drops the stale edges of the roots that it owns, if a purge has begun since the last time.
  void join_purge() noexcept;
  /// Makes what entered tables visible to the collector.
  void publish() noexcept {
    for (; pending != nullptr; pending = pending->next_pending) pending->publish();
  }
};

/// The parts of one thread, the innermost first.
template <class Env>
struct participants {
  participant<Env>* innermost;
  std::uint64_t current;  // the number of the innermost; 0: none
  std::uint64_t last;     // the last number that was given
  std::uint64_t quiescent_states;

  static participants& of_this_thread() noexcept {
    return Env::template thread_record<participants>();
  }

  /// The innermost that may borrow, or null.
  static participant<Env>* borrower() noexcept {
    participant<Env>* p = of_this_thread().innermost;
    while (p != nullptr && !p->may_borrow()) p = p->outer;
    return p;
  }
  /// Whether some part of the thread in @p domain holds for @p condition.
  template <class Condition>
  static bool any_in(const domain_state<Env>& domain, Condition condition) noexcept {
    for (participant<Env>* p = of_this_thread().innermost; p != nullptr; p = p->outer)
      if (p->domain == &domain && condition(*p)) return true;
    return false;
  }
};

template <class Env>
void participant<Env>::pass_quiescent_state() noexcept {
  passed = ++participants<Env>::of_this_thread().quiescent_states;
}

/// Makes @p part one of the calling thread's, its innermost at first, from begin() to end(). They may end in
/// any order: a `thread_local` mutator outlives automatic ones that were made before it.
template <class Env>
class participation {
 public:
  explicit participation(participant<Env>& part, bool at_once = true) noexcept : part_(part) {
    if (at_once) begin();
  }
  ~participation() { end(); }
  participation(const participation&) = delete;
  participation& operator=(const participation&) = delete;

  void begin() noexcept {
    auto& all = participants<Env>::of_this_thread();
    part_.outer = all.innermost;
    part_.number = ++all.last;
    all.innermost = &part_;
    all.current = part_.number;
    has_begun_ = true;
  }
  void end() noexcept {
    if (!has_begun_) return;
    has_begun_ = false;
    auto& all = participants<Env>::of_this_thread();
    participant<Env>** at = &all.innermost;
    while (*at != nullptr && *at != &part_) at = &(*at)->outer;
    if (*at != nullptr) *at = part_.outer;
    all.current = all.innermost != nullptr ? all.innermost->number : 0;
  }

 private:
  participant<Env>& part_;
  bool has_begun_ = false;
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc

namespace slamgc {
namespace runtime SLAMGC_SHARED {

template <class Env>
struct root_place {
  enum : std::uint32_t { free, rooted, held };
  typename Env::template atomic<std::uint32_t> state{free};
  const char* name = nullptr;
  void* described = nullptr;
  const described_operations<Env>* operations = nullptr;
  enum : std::uint32_t { no, wanted, begun };
  typename Env::template atomic<std::uint32_t> suspicion{no};  // collect_cycles()
  bool owned = false;                                          // by a mutator
  participant<Env>* owner = nullptr;                           // that mutator, while it exists
  root_place* next = nullptr;
  root_place* next_of_owner = nullptr;

  bool is_suspected() const noexcept {
    return suspicion.load(std::memory_order_relaxed) != no;  // (31) what matters is under `held`.
  }
  /// By the collector: whether it is wanted.
  bool begin_suspicion() noexcept {
    if (!is_suspected()) return false;
    suspicion.store(begun, std::memory_order_relaxed);  // (31)
    return true;
  }
  /// Unless it was wanted again meanwhile.
  void end_suspicion() noexcept {
    std::uint32_t expected = begun;
    suspicion.compare_exchange_strong(expected, no, std::memory_order_relaxed,  // (31)
                                      std::memory_order_relaxed);               // (31)
  }
  void join(participant<Env>& of) noexcept {
    owner = &of;
    next_of_owner = of.roots;
    of.roots = this;
  }
  void leave() noexcept {
    if (owner == nullptr) return;
    root_place** at = &owner->roots;
    while (*at != this) at = &(*at)->next_of_owner;
    *at = next_of_owner;
    owner = nullptr;
  }
};

template <class Env>
class root_list {
 public:
  using place = root_place<Env>;

  root_list() noexcept = default;
  ~root_list() {
    place* p = first_.load(std::memory_order_relaxed);  // (31) alone here.
    while (p != nullptr) {
      place* const next = p->next;
      delete p;
      p = next;
    }
  }
  root_list(const root_list&) = delete;
  root_list& operator=(const root_list&) = delete;

  /// A place that is not free, and not rooted yet. Throws std::bad_alloc.
  place& take() {
    for (place* p = first_.load(std::memory_order_acquire); p != nullptr; p = p->next) {  // (31)
      std::uint32_t state = place::free;
      // (31) acquire: its last user has finished with it.
      if (p->state.compare_exchange_strong(state, place::held, std::memory_order_acquire,
                                           std::memory_order_relaxed))  // (31)
        return *p;
    }
    place* const made = new place;
    made->state.store(place::held, std::memory_order_relaxed);  // (31) nobody else knows it.
    place* first = first_.load(std::memory_order_relaxed);      // (31) a guess.
    do {
      made->next = first;
    } while (!first_.compare_exchange_weak(
        first, made, std::memory_order_release,  // (31) publishes the place to who walks the list.
        std::memory_order_relaxed));             // (31) a guess.
    return *made;
  }
  static void put(place& p) noexcept {
    p.suspicion.store(place::no, std::memory_order_relaxed);  // (31) of its last user.
    p.state.store(place::rooted, std::memory_order_release);  // (31) its content, to visit().
  }
  /// Waits while a collector is in its edges().
  static void remove(place& p) noexcept {
    std::uint32_t state = place::rooted;
    // (31) acquire: what the collector did in there is over; release: to take().
    while (!p.state.compare_exchange_weak(state, place::free, std::memory_order_acq_rel,
                                          std::memory_order_relaxed)) {  // (31)
      state = place::rooted;
      clock_of<Env>::pause(std::chrono::nanoseconds(0));
    }
  }
  void want_suspicion(place& p) noexcept {
    p.suspicion.store(place::wanted, std::memory_order_relaxed);  // (31)
    suspicions_.fetch_add(1, std::memory_order_release);          // (31) so that the wish is seen.
  }
  /// Whether one was wanted since the last time.
  bool any_suspected() noexcept {
    const std::uint64_t now = suspicions_.load(std::memory_order_acquire);  // (31)
    return now != std::exchange(suspicions_seen_, now);
  }
  /// Calls f(place) for each root; for those of mutators, too, if @p all. By a collector. A root that ends meanwhile is
  /// left out.
  template <class F>
  void visit(F f, bool all = false) {
    for (place* p = first_.load(std::memory_order_acquire); p != nullptr; p = p->next) {  // (31)
      std::uint32_t state = place::rooted;
      // (31) acquire: sees its content.
      if (!p->state.compare_exchange_strong(state, place::held, std::memory_order_acquire,
                                            std::memory_order_relaxed))  // (31)
        continue;
      if (all || !p->owned) f(*p);
      p->state.store(place::rooted, std::memory_order_release);  // (31) to remove() and take().
    }
  }

 private:
  typename Env::template atomic<place*> first_{nullptr};
  typename Env::template atomic<std::uint64_t> suspicions_{0};
  std::uint64_t suspicions_seen_ = 0;  // the collector's
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
// ---- slamgc/detail/table_base.hpp ----
/// @file
/// What all zero-count tables have in common, whatever the type of their objects.

// ---- slamgc/stats.hpp ----
/// @file
/// What a domain can say about itself, as plain numbers.

#include <vector>

namespace slamgc {

/// Numbers of the objects of one type in one domain.
struct type_stats {
  const char* type = "";        ///< The type, as the compiler spells it.
  std::size_t object_size = 0;  ///< Bytes of one object, without what it allocates itself.
  std::uint64_t created = 0;    ///< Objects made so far.
  std::uint64_t live = 0;       ///< Objects that exist now.
  std::uint64_t retired = 0;    ///< Objects declared dead so far; see retire().
  std::uint64_t reclaimed = 0;  ///< Objects destroyed by collectors so far.
  std::uint64_t stuck = 0;      ///< Retired objects with described edges that others refer to now.
  std::uint64_t backlog = 0;    ///< Objects that wait for a collector now.

  /// Bytes of the objects that exist now, without what they allocate themselves.
  [[nodiscard]] std::uint64_t live_bytes() const noexcept { return live * object_size; }
  /// Bytes of the objects destroyed by collectors so far, without what they had allocated themselves.
  [[nodiscard]] std::uint64_t reclaimed_bytes() const noexcept { return reclaimed * object_size; }
};

/// Numbers of one registered thread.
struct mutator_stats {
  const char* name = "";  ///< The name it registered with.
  bool online = false;    ///< Whether it may hold borrowed pointers.
  bool delays = false;    ///< Whether the open grace period waits for it.
};

/// Whom reclamation waits for.
struct delay {
  const char* oldest = nullptr;  ///< Who holds the open grace period up, the longest; null: nobody.
  std::chrono::nanoseconds age{0};  ///< For how long it has held it up.
  std::uint64_t backlog = 0;        ///< Objects that wait.
};

/// Numbers of one domain.
struct domain_stats {
  std::vector<type_stats> types;                ///< One for each type of which an object was made.
  std::vector<mutator_stats> mutators;          ///< One for each registered thread.
  delay delayed;                                ///< Whom reclamation waits for.
  std::uint64_t grace_periods = 0;              ///< Grace periods begun so far, by collecting.
  std::chrono::nanoseconds longest_collect{0};  ///< Longest call of collect() so far.
  std::uint64_t refused_collects = 0;  ///< Calls on threads that declared never to reclaim.

  /// The sum of one number over all types.
  [[nodiscard]] std::uint64_t total(std::uint64_t type_stats::*number) const noexcept {
    std::uint64_t sum = 0;
    for (const type_stats& t : types) sum += t.*number;
    return sum;
  }
  /// Bytes of the objects of all types that exist now, without what they allocate themselves.
  [[nodiscard]] std::uint64_t live_bytes() const noexcept {
    std::uint64_t sum = 0;
    for (const type_stats& t : types) sum += t.live_bytes();
    return sum;
  }
};

}  // namespace slamgc

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// How much one call of collect() may still do.
template <class Env>
class work_limit {
 public:
  using clock = clock_of<Env>;
  using time_point = typename clock::time_point;

  work_limit(std::size_t objects, std::chrono::nanoseconds time, time_point now) noexcept
      : objects_(objects),
        timed_(time < std::chrono::hours(1000000)),  // more could overflow the deadline
        last_(now),
        deadline_(timed_ ? now + time : now) {
    (void)next_check();
  }

  /// Called after each object; false when the limit is reached. The clock costs as much as freeing a
  /// small object, so it is read at growing distances as long as objects are quick to handle.
  bool spend() noexcept {
    if (until_check_ <= 1) return next_check();
    --until_check_;
    return true;
  }

  /// Other objects follow, which may be slower: the clock is read after the first of them.
  void other_objects() noexcept {
    if (!timed_) return;
    objects_ += until_check_ - 1;
    until_check_ = 1;
    stride_ = 1;
  }

 private:
  bool next_check() noexcept {
    if (timed_ && stride_ != 0) {
      const time_point now = clock::now();
      if (now >= deadline_) return false;
      const bool quick = now - last_ < std::chrono::microseconds(20);
      stride_ = quick ? (stride_ < longest_stride ? 2 * stride_ : stride_) : 1;
      last_ = now;
    } else {
      stride_ = 1;
    }
    until_check_ = timed_ && stride_ < objects_ ? stride_ : objects_;
    objects_ -= until_check_;
    return until_check_ != 0;
  }

  /// So many objects that suddenly are slow may be too many.
  static constexpr std::size_t longest_stride = 16;

  std::size_t objects_;
  bool timed_;
  time_point last_;
  time_point deadline_;
  std::size_t stride_ = 0;
  std::size_t until_check_ = 0;
};

/// Where objects of one type enter the table of a domain, with the numbers of who enters there.
///
/// Door 0 is shared. Each other door belongs to one participant, who alone writes its numbers and its
/// chain; what it pushes goes to the chain first, and to the collector when it publishes that.
template <class Env>
struct alignas(cache_line) table_door {
  using number = typename Env::template atomic<std::uint64_t>;
  using link = typename Env::template atomic<void*>;

  link first{nullptr};  // what the collector may take: a stack through the objects' links
  number created{0};
  number ended{0};
  number retired{0};
  number entered{0};
  void* chain = nullptr;      // the owner's: its newest object
  link* chain_end = nullptr;  // the link of its oldest
  table_door* next_pending = nullptr;

  /// Puts a chain of objects on the stack. Lock-free.
  void push(void* newest, link& end) noexcept {
    void* below = first.load(std::memory_order_relaxed);  // (11) a guess.
    do {
      end.store(below, std::memory_order_relaxed);  // (11)
      // (11) release: publishes the links, and what was done to the objects, to take().
    } while (!first.compare_exchange_weak(below, newest, std::memory_order_release,
                                          std::memory_order_relaxed));  // (11)
  }
  /// All that is on the stack.
  void* take() noexcept {
    // (11) relaxed: only whether there is something; acquire: sees the links of all that were pushed.
    if (first.load(std::memory_order_relaxed) == nullptr) return nullptr;
    return first.exchange(nullptr, std::memory_order_acquire);  // (11)
  }
  void publish() noexcept {
    push(chain, *chain_end);
    chain = nullptr;
  }
};

template <class Env>
class trial_deletion;
template <class Env>
class side_block;
template <class Env>
struct described_operations;
template <class Env>
class edge_sink;

/// The part of a domain's zero-count table for objects of one type; see zero_count_table.hpp.
template <class Env>
class table_base {
 public:
  using door = table_door<Env>;
  static constexpr std::size_t shared_door = 0;
  static constexpr std::size_t collectors_door = 1;
  static constexpr std::size_t first_of_mutators = 2;
  static constexpr std::size_t doors = first_of_mutators + Env::mutator_doors;

  table_base(domain_state<Env>& d, const void* t, const char* name, std::size_t size,
             bool blocks) noexcept
      : domain(d), type(t), type_name(name), object_size(size), has_blocks(blocks) {}
  virtual ~table_base() = default;
  table_base(const table_base&) = delete;
  table_base& operator=(const table_base&) = delete;

  /// Notes the words of the objects that have entered, before a grace period. What finds no memory is noted the next
  /// time. By the collector; false if the limit came first.
  virtual bool note(work_limit<Env>& limit, std::size_t& noted) noexcept = 0;
  /// Decides on the objects that are noted, after it. By the collector; false if the limit came first.
  virtual bool decide(work_limit<Env>& limit, std::size_t& reclaimed) noexcept = 0;

  // For trial deletion (trial_deletion.hpp), by the collector, of a candidate:

  virtual std::uint64_t word_of(const void* object) const noexcept = 0;
  virtual const described_operations<Env>& operations() const noexcept = 0;
  /// Records each reference to a candidate. False if edges() threw.
  virtual bool walk(void* object, trial_deletion<Env>& trial) noexcept = 0;
  /// Drops all references. False if edges() threw.
  virtual bool sever(void* object) noexcept = 0;
  /// The block of an object to which there may be weak handles, or null.
  virtual side_block<Env>* block_of(void* object) const noexcept = 0;
  /// Whether the word has the references that were noted: by a read-modify-write, which a lock() that it does not see
  /// does see (decision.hpp).
  virtual bool seal(void* object, std::uint64_t noted) noexcept = 0;
  virtual void destroy(void* object) noexcept = 0;
  /// It was a suspect: is retired, and stays.
  virtual void condemn(void* object) noexcept = 0;
  /// It was a suspect: is none any more.
  virtual void leave(void* object) noexcept = 0;

  // For reports, by whoever excludes collectors:

  /// Reports one object.
  virtual void report(const void* object, edge_sink<Env>& to) const = 0;
  /// Reports the objects that have entered and are no candidates; of those that a mutator has not published yet only if
  /// the mutators' threads @p stand_still.
  virtual void report_waiting(edge_sink<Env>& to, bool stand_still) const = 0;

  domain_state<Env>& domain;
  const void* const type;
  const char* const type_name;
  const std::size_t object_size;
  const bool has_blocks;  // whether there may be weak handles to objects of the type
  table_base* next = nullptr;

  /// The calling thread's door, and its part in this domain if it has one.
  door& my_door(participant<Env>*& me) noexcept {
    me = participants<Env>::of_this_thread().innermost;
    if (me != nullptr && me->domain != &domain) me = nullptr;
    return doors_[me != nullptr ? me->door : shared_door];
  }
  bool is_shared(const door& d) const noexcept { return &d == &doors_[shared_door]; }

  /// Adds to a number of a door: of the shared one, or of the calling thread's.
  void add(door& at, typename door::number door::*number, std::uint64_t n = 1) noexcept {
    if (is_shared(at))
      // (26) release: what a thread without a mutator did to its object comes before the end of the table.
      (at.*number).fetch_add(n, std::memory_order_release);
    else
      add(at.*number, n);
  }

  std::uint64_t sum(typename door::number door::*number) const noexcept {
    std::uint64_t total = 0;
    for (const door& d : doors_) total += (d.*number).load(std::memory_order_relaxed);  // (12)
    return total;
  }
  std::uint64_t live() const noexcept {
    std::uint64_t ended = 0;
    for (const door& d : doors_)
      ended += d.ended.load(
          std::memory_order_acquire);  // (26) who finds the last one gone may free this.
    return sum(&door::created) - ended;
  }
  std::uint64_t reclaimed() const noexcept {
    return reclaimed_.load(std::memory_order_relaxed);  // (12)
  }
  /// Candidates.
  std::uint64_t stuck() const noexcept { return stuck_.load(std::memory_order_relaxed); }  // (12)
  type_stats stats() const noexcept {
    type_stats s;
    s.type = type_name;
    s.object_size = object_size;
    s.created = sum(&door::created);
    s.live = live();
    s.retired = sum(&door::retired);
    s.reclaimed = reclaimed();
    s.stuck = stuck();
    s.backlog = backlog();
    return s;
  }
  /// Objects that wait, if nobody changes it meanwhile; never less than none.
  std::uint64_t backlog() const noexcept {
    const std::uint64_t left = left_.load(std::memory_order_relaxed);  // (12)
    const std::uint64_t entered = sum(&door::entered);
    return entered > left ? entered - left : 0;
  }

 protected:
  /// For a number that the calling thread alone writes.
  static void add(typename door::number& number, std::uint64_t n) noexcept {
    number.store(number.load(std::memory_order_relaxed) + n, std::memory_order_relaxed);  // (12)
  }

  door doors_[doors];
  // The collector's:
  typename door::number reclaimed_{0};
  typename door::number left_{0};
  typename door::number stuck_{0};

 public:
  type_stats told;  // what hooks know; behind the doors, whose offsets the instructions depend on
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
// ---- slamgc/detail/trial_deletion.hpp ----
/// @file
/// Trial deletion: retired objects that nothing but each other refers to.
///
/// The *candidates* are retired objects that are still referred to. A round of trial deletion
/// 1. *begins*: notes the state word of each candidate;
/// 2. *records*, for each candidate, its references to candidates, by a walk of its edges, and counts those that
///    each of them has from candidates;
/// 3. *excludes* each candidate that has others, and what is recorded to be reached from it;
/// 4. after a grace period that began after 2, *checks* the words of all that are left: one that has changed is
///    excluded, as in 3;
/// 5. if there are weak handles to what is left: decides (decision.hpp), and waits for another grace period;
/// 6. *severs* what is left, and destroys it.
///
/// **What is left is out of everybody's sight**: docs/design.md, "Cycles". There, too, is why 3 and 4 must not walk the
/// edges a second time.
///
/// Each phase can stop after any object and goes on in the next call. No thread ever waits for it, but for the locks
/// of the program that edges() takes. Linear in the edges of the candidates; no recursion.
///
/// Trial deletion: Christopher 1984; Bacon and Rajan 2001; *The Garbage Collection Handbook*, 5.5. The use of versions in
/// place of a second, synchronous walk is ours.

// ---- slamgc/detail/candidate.hpp ----
/// @file
/// What a round of trial deletion knows: candidates, and the references between them.

namespace slamgc {
namespace runtime SLAMGC_SHARED {

template <class Env>
struct candidate;

/// The references that a round has recorded, one candidate's after the other's.
template <class Env>
class edge_list {
  struct block {
    static constexpr std::uint32_t size = 1023;
    block* next = nullptr;
    candidate<Env>* targets[size];
  };

 public:
  /// Of a reference, or the end.
  class place {
   public:
    candidate<Env>* next() noexcept {
      if (index_ == block::size) {
        block_ = block_->next;
        index_ = 0;
      }
      return block_->targets[index_++];
    }

   private:
    friend class edge_list;
    block* block_;
    std::uint32_t index_;
  };

  edge_list() noexcept { clear(); }
  ~edge_list() {
    clear();
    delete first_.next;
  }
  edge_list(const edge_list&) = delete;
  edge_list& operator=(const edge_list&) = delete;

  place end() const noexcept { return end_; }
  /// False if there is no memory.
  bool add(candidate<Env>& target) noexcept {
    if (end_.index_ == block::size) {
      if (end_.block_->next == nullptr) end_.block_->next = new (std::nothrow) block;
      if (end_.block_->next == nullptr) return false;
      end_.block_ = end_.block_->next;
      end_.index_ = 0;
    }
    end_.block_->targets[end_.index_++] = &target;
    return true;
  }
  /// Keeps the memory of one block.
  void clear() noexcept {
    if (block* const kept = first_.next) {
      while (block* const more = kept->next) {
        kept->next = more->next;
        delete more;
      }
    }
    end_.block_ = &first_;
    end_.index_ = block::size;  // the first one holds nothing
  }

 private:
  block first_;
  place end_;
};

/// A retired object that is still referred to, or a suspect. Its link names this, with a mark in the lowest bit, which no
/// other value of a link has.
template <class Env>
struct candidate {
  void* object;  // null: unused
  table_base<Env>* table;
  std::uint64_t noted;
  typename edge_list<Env>::place first_edge;  // of those recorded
  candidate* next_marked;                     // also: the next unused one
  std::uint32_t edges;                        // how many
  std::uint32_t inner;                        // references from candidates
  std::uint32_t held;                         // references that the last purge saw and left
  std::uint32_t purged_version;               // when that began
  bool fresh;                                 // not in a round yet
  bool live;                                  // excluded
  bool suspect;                               // not retired: it is in this round only
  bool purged;                                // a purge has looked for its stale edges
  std::chrono::nanoseconds since;             // it became one, by the clock of collections

  static void* link_to(candidate* c) noexcept {
    return static_cast<char*>(static_cast<void*>(c)) + 1;
  }
  static candidate* of_link(void* link) noexcept {
    if ((reinterpret_cast<std::uintptr_t>(link) & 1) == 0) return nullptr;
    return static_cast<candidate*>(static_cast<void*>(static_cast<char*>(link) - 1));
  }
};

/// All candidates, in blocks: each phase goes through them in the order of memory. Blocks without candidates are freed.
template <class Env>
class candidate_list {
  struct block {
    static constexpr std::size_t size = 255;
    static constexpr std::size_t ahead = 8;
    block* next = nullptr;
    candidate<Env>* unused = nullptr;
    std::size_t used = 0;
    candidate<Env> candidates[size + ahead];  // the last ones are never used
  };

 public:
  /// Goes through the candidates.
  class cursor {
   public:
    /// The next one, or null.
    candidate<Env>* next() noexcept {
      for (; block_ != nullptr; block_ = block_->next, index_ = 0) {
        while (index_ != block::size) {
          candidate<Env>& c = block_->candidates[index_++];
          // Objects lie anywhere: their words arrive while others are worked on.
          __builtin_prefetch((&c)[block::ahead].object);
          if (c.object != nullptr) return &c;
        }
      }
      return nullptr;
    }

   private:
    friend class candidate_list;
    block* block_ = nullptr;
    std::size_t index_ = 0;
  };

  candidate_list() noexcept = default;
  ~candidate_list() {
    while (first_ != nullptr) delete std::exchange(first_, first_->next);
  }
  candidate_list(const candidate_list&) = delete;
  candidate_list& operator=(const candidate_list&) = delete;

  cursor begin() const noexcept {
    cursor c;
    c.block_ = first_;
    return c;
  }
  /// An unused one, or null if there is no memory.
  candidate<Env>* add() noexcept {
    while (room_ != nullptr && room_->unused == nullptr) room_ = room_->next;
    if (room_ == nullptr && !grow()) return nullptr;
    candidate<Env>* const c = room_->unused;
    room_->unused = c->next_marked;
    ++room_->used;
    return c;
  }
  /// Removes the one that @p at came to last.
  void remove(cursor& at) noexcept {
    candidate<Env>& c = at.block_->candidates[at.index_ - 1];
    c.object = nullptr;
    c.next_marked = at.block_->unused;
    at.block_->unused = &c;
    --at.block_->used;
  }
  /// Frees what remove() has left empty, but one block.
  void trim() noexcept {
    bool keep = true;
    for (block** at = &first_; *at != nullptr;) {
      if ((*at)->used == 0 && !std::exchange(keep, false))
        delete std::exchange(*at, (*at)->next);
      else
        at = &(*at)->next;
    }
    room_ = first_;
  }

 private:
  bool grow() noexcept {
    block* const more = new (std::nothrow) block;
    if (more == nullptr) return false;
    for (std::size_t i = 0; i != block::ahead; ++i)
      more->candidates[block::size + i].object = nullptr;
    for (std::size_t i = block::size; i-- != 0;) {
      more->candidates[i].object = nullptr;
      more->candidates[i].next_marked = more->unused;
      more->unused = &more->candidates[i];
    }
    more->next = first_;
    first_ = room_ = more;
    return true;
  }

  block* first_ = nullptr;
  block* room_ = nullptr;  // before it no block has room, or all blocks are full
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
// ---- slamgc/detail/decision.hpp ----
/// @file
/// How a collector decides that objects die while weak handles lead to them: one decision for a whole set.
///
/// **States.** A side block is *alive*, *in decision n*, or *dead*; dead is for ever. A domain has one *decision word*:
/// a number, and whether that decision is open, vetoed, or dead. The collector
/// 1. opens decision n;
/// 2. for each object of the set that has a block: *marks* the block with n, *seals* the object's word (a
///    read-modify-write that changes nothing and finds it as it was noted), and makes the record;
/// 3. *commits*: open becomes dead, by compare-and-swap. If a word had changed, or somebody vetoed, the marks are taken
///    back and nothing has happened;
/// 4. makes the blocks dead, one by one;
/// 5. destroys the objects after another grace period.
///
/// Who *locks* a handle finds the block not dead, adds a reference, and looks at the block again: alive is success; in an
/// open decision, a *veto* is; a dead decision is failure, and the reference is removed again. Nobody ever waits.
///
/// The argument: docs/design.md, "Weak handles and anchors".

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// The decision word of a domain.
template <class Env>
class decision {
 public:
  enum class outcome { survives, dies, unknown };
  static constexpr std::uint64_t step = 4;  // numbers are multiples of it, from the first one on

  // The collector's:

  void open() noexcept {
    number_ += step;
    // (27) release: who finds this decision finds the marks of those before it taken back.
    word_.store(number_ | is_open, std::memory_order_release);
  }
  std::uint64_t number() const noexcept { return number_; }
  /// False if somebody vetoed.
  bool commit() noexcept {
    std::uint64_t expected = number_ | is_open;
    // (27) release: the records are made; relaxed: a veto tells nothing else.
    return word_.compare_exchange_strong(expected, number_ | is_dead, std::memory_order_release,
                                         std::memory_order_relaxed);  // (27)
  }

  // Of who has added a reference, and found the object in decision n:

  /// What that decision says; unknown if it is over.
  outcome veto(std::uint64_t n) noexcept {
    std::uint64_t found = n | is_open;
    // (27) acquire: who comes too late sees the records, or the marks taken back. (A veto needs no order; g++ wants that of
    // success to be no weaker.)
    if (word_.compare_exchange_strong(found, n | is_vetoed, std::memory_order_acquire,
                                      std::memory_order_acquire))  // (27)
      return outcome::survives;
    if (found == (n | is_vetoed)) return outcome::survives;
    return found == (n | is_dead) ? outcome::dies : outcome::unknown;
  }

 private:
  static constexpr std::uint64_t is_open = 0;
  static constexpr std::uint64_t is_vetoed = 1;
  static constexpr std::uint64_t is_dead = 2;

  typename Env::template atomic<std::uint64_t> word_{0};
  std::uint64_t number_ = 0;
};

/// What is left of an object for its weak handles, as collectors see it.
template <class Env>
class side_block {
 public:
  explicit side_block(const void* owner) noexcept : owner_(owner) {}
  virtual ~side_block() = default;
  side_block(const side_block&) = delete;
  side_block& operator=(const side_block&) = delete;

  /// The object, for as long as the caller may touch it.
  const void* owner() const noexcept { return owner_; }
  bool is_dead() const noexcept {
    // (28) acquire: sees the record.
    return state_.load(std::memory_order_acquire) == dead;
  }
  /// Of who has added a reference to the object, after it had found the block not dead: whether that counts.
  bool survives() const noexcept {
    for (;;) {
      // (28) acquire: sees whose decision it is in, and the record.
      const std::uint64_t now = state_.load(std::memory_order_acquire);
      if (now == alive) return true;
      if (now == dead) return false;
      // (28) the mark published it.
      switch (judge_.load(std::memory_order_relaxed)->veto(now)) {
        case decision<Env>::outcome::survives:
          return true;
        case decision<Env>::outcome::dies:
          return false;
        case decision<Env>::outcome::unknown:  // the block says how it ended
          break;
      }
    }
  }

  // The collector's:

  void mark(decision<Env>& by) noexcept {
    judge_.store(&by, std::memory_order_relaxed);  // (28) published by the mark.
    // (28) release: publishes the judge, and that the decision is open.
    state_.store(by.number(), std::memory_order_release);
  }
  void unmark() noexcept {
    state_.store(alive, std::memory_order_relaxed);  // (28) nothing is read through it.
  }
  bool is_marked() const noexcept {
    const std::uint64_t now = state_.load(std::memory_order_relaxed);  // (28) its own mark.
    return now != alive && now != dead;
  }
  /// For ever. A grace period later nobody but the collector touches the object.
  void expire() noexcept {
    state_.store(dead, std::memory_order_release);  // (28) publishes the record.
  }
  /// Makes the record of an object that is about to die.
  virtual void bury() noexcept {}

  /// A reference came and went while the collector looked at the object, which may have been a lock(). Who is patient for
  /// ever lets a handle that is polled keep its object for ever.
  void disturbed() noexcept {
    if (is_dead() || ++disturbed_ != patience) return;
    bury();
    expire();
  }
  /// The object was found referred to.
  void undisturbed() noexcept { disturbed_ = 0; }

  static constexpr unsigned patience = 4;

 private:
  static constexpr std::uint64_t alive = 0;
  static constexpr std::uint64_t dead = 1;

  const void* const owner_;
  typename Env::template atomic<decision<Env>*> judge_{nullptr};
  typename Env::template atomic<std::uint64_t> state_{alive};
  unsigned disturbed_ = 0;
};

/// Decides on one object, whose word @p sealed looks at. Returns whether it dies.
template <class Env, class Sealed>
bool decide_alone(decision<Env>& by, side_block<Env>& block, Sealed sealed) noexcept {
  by.open();
  block.mark(by);
  bool dies = sealed();
  if (dies) {
    block.bury();
    dies = by.commit();
  }
  if (dies)
    block.expire();
  else
    block.unmark();
  return dies;
}

}  // namespace SLAMGC_SHARED
}  // namespace slamgc

namespace slamgc {
namespace runtime SLAMGC_SHARED {

template <class Env>
class trial_deletion {
 public:
  using candidate_type = candidate<Env>;
  using limit_type = work_limit<Env>;

  trial_deletion() noexcept = default;
  trial_deletion(const trial_deletion&) = delete;
  trial_deletion& operator=(const trial_deletion&) = delete;

  /// The new candidate, with its word now, or null if there is no memory.
  candidate_type* add(void* object, table_base<Env>& table, std::uint64_t word) noexcept {
    candidate_type* const c = all_.add();
    if (c == nullptr) return nullptr;
    *c = {object, &table, word, edges_.end(), nullptr,     0,     0,
          0,      0,      true, true,         suspecting_, false, now_};
    any_blocks_ = any_blocks_ || table.has_blocks;
    return c;
  }
  /// A call of collect() begins: candidates that it finds date from @p now.
  void begin_call(std::chrono::nanoseconds now) noexcept { now_ = now; }
  /// Calls f(candidate) for each candidate, while nobody collects.
  template <class F>
  void each(F f) const {
    auto at = all_.begin();
    while (const candidate_type* const c = at.next()) f(*c);
  }
  /// Steps 1 to 3, before the grace period. False if the limit came first.
  bool find(limit_type& limit) noexcept {
    if (phase_ == phase::expired) start(phase::severing);  // after the grace period that follows
    if (phase_ == phase::idle) {
      changed_ = false;
      left_ = 0;
      start(phase::beginning);
    }
    if (phase_ == phase::beginning) {
      const bool all = go_through(limit, [this](candidate_type& c) {
        // A new one was noted when it was added: a while ago is as good.
        const std::uint64_t now = c.fresh ? c.noted : c.table->word_of(c.object);
        changed_ = changed_ || c.fresh || !same_references(now, c.noted);
        c.noted = now;
        c.inner = 0;
        c.fresh = c.live = false;
        ++left_;
      });
      if (!all) return false;
      // Only what changes the word of a candidate can make one unreachable. Who had counted a reference and not
      // stored it yet will have done so after a grace period: so one more round after the last change. A round with suspects
      // comes to its end, even if no root has any: else the suspicion would last.
      const bool worth_it = changed_ || unsettled_ || suspecting_;
      // After a purge, too: owners of roots join it at their next quiescent state.
      unsettled_ = changed_ || std::exchange(purged_, false);
      start(worth_it ? phase::recording : phase::idle);
    }
    if (phase_ == phase::recording) {
      const bool all = go_through(limit, [this](candidate_type& c) {
        walked_ = &c;
        c.first_edge = edges_.end();
        c.edges = 0;
        if (!out_of_memory_ && !c.table->walk(c.object, *this)) has_thrown(c);
      });
      if (out_of_memory_) return give_up();
      if (!all) return false;
      if (suspecting_) {
        walked_ = nullptr;
        roots_->visit([this](const root_place<Env>& root) {
          if (root.is_suspected()) root.operations->record(root.described, *this);
        });
        if (out_of_memory_) return give_up();
      }
      start(phase::excluding);
    }
    if (phase_ == phase::excluding) {
      const bool all = go_through(limit, [this](candidate_type& c) {
        if (c.inner != state_word{c.noted}.count()) mark(c);
      });
      if (!all || !exclude_marked(limit)) return false;
      start(left_ != 0 ? phase::checking : suspecting_ ? phase::resolving : phase::idle);
    }
    return true;
  }
  /// Whether find() has left something for decide().
  bool found() const noexcept { return phase_ >= phase::checking; }
  /// Whether find() has to be called again after a grace period.
  bool unsettled() const noexcept { return unsettled_; }

  runtime::decision<Env>& decision() noexcept { return decision_; }

  /// Steps 4 to 6, after the grace period. False if the limit came first.
  bool decide(limit_type& limit, std::size_t& reclaimed) noexcept {
    if (phase_ == phase::checking) {
      const bool all = go_through(limit, [this](candidate_type& c) {
        if (c.live || same_references(c.table->word_of(c.object), c.noted)) return;
        disturbed(c);
        mark(c);
      });
      if (!all || !exclude_marked(limit)) return false;
      if (any_blocks_ && !suspecting_) decision_.open();
      decided_ = true;
      marked_blocks_ = false;
      start(suspecting_ ? phase::resolving : any_blocks_ ? phase::deciding : phase::severing);
    }
    if (phase_ == phase::resolving && !resolve(limit)) return false;
    if (!expire_blocks(limit)) return false;
    if (phase_ == phase::expired) return true;
    if (phase_ == phase::severing) {
      const bool all = go_through(limit, [this](candidate_type& c) {
        if (!c.live && !c.table->sever(c.object)) has_thrown(c);
      });
      // What could not be severed stays, with what it refers to.
      if (!all || !exclude_marked(limit)) return false;
      start(phase::destroying);
    }
    if (phase_ == phase::destroying) {
      while (candidate_type* const c = next()) {
        if (c->live) continue;
        c->table->destroy(c->object);
        ++reclaimed;
        all_.remove(at_);
        if (!limit.spend()) return false;
      }
      all_.trim();
      phase_ = phase::idle;
    }
    return true;
  }

  /// Whether a candidate is referred to from elsewhere in a way that no purge has seen yet.
  bool unpurged() const noexcept { return unpurged_; }
  /// Whether some edges() threw in the last round: another one may find more, although no word changes.
  bool threw() const noexcept { return threw_; }
  /// Calls f(candidate) for each candidate, before a purge. Another round will see what it changes, a grace period later.
  template <class F>
  void begin_purge(F f) noexcept {
    unpurged_ = false;
    unsettled_ = purged_ = true;
    auto at = all_.begin();
    while (candidate_type* const c = at.next()) {
      c->purged = !c->fresh;  // else the references from candidates are not known yet
      c->purged_version = state_word{c->table->word_of(c->object)}.version();
      c->held = 0;
      f(*c);
    }
  }

  /// For walks: the candidate that is walked refers to this one.
  void record(candidate_type& target) noexcept {
    if (out_of_memory_ || !edges_.add(target)) {
      out_of_memory_ = true;
      return;
    }
    if (walked_ != nullptr) ++walked_->edges;
    ++target.inner;
  }

  /// Makes candidates, for one round, of what the suspected roots refer to: the references of those roots count as inner
  /// ones then, and what is found is not destroyed but retired. By the collector, between two rounds.
  void suspect(root_list<Env>& roots) noexcept {
    if (phase_ != phase::idle || !roots.any_suspected()) return;
    roots_ = &roots;
    suspecting_ = true;
    roots.visit([this](root_place<Env>& root) {
      if (root.begin_suspicion()) root.operations->suspect(root.described, *this);
    });
  }

 private:
  enum class phase {
    idle,
    beginning,
    recording,
    excluding,
    checking,
    resolving,
    deciding,
    unmarking,
    expiring,
    expired,
    severing,
    destroying
  };
  static bool same_references(std::uint64_t a, std::uint64_t b) noexcept {
    return state_word{a}.same_references({b});
  }
  void start(phase p) noexcept {
    phase_ = p;
    at_ = all_.begin();
    if (p != phase::recording) return;
    edges_.clear();
    threw_ = false;
  }
  candidate_type* next() noexcept { return at_.next(); }
  /// Calls f(candidate) for each that is left in this phase. False if the limit came first.
  template <class F>
  bool go_through(limit_type& limit, F f) noexcept {
    auto at = at_;  // in registers
    bool more = true;
    while (more) {
      candidate_type* const c = at.next();
      if (c == nullptr) break;
      f(*c);
      more = limit.spend();
    }
    at_ = at;
    return more;
  }
  void mark(candidate_type& c) noexcept {
    if (c.live) return;
    c.live = true;
    --left_;
    if (phase_ <= phase::excluding && !c.suspect &&
        (!c.purged || c.purged_version != state_word{c.noted}.version()))
      unpurged_ = true;
    c.next_marked = marked_;
    marked_ = &c;
  }
  void has_thrown(candidate_type& c) noexcept {
    threw_ = true;
    mark(c);
  }
  /// Marks what the marked ones refer to. False if the limit came first.
  bool exclude_marked(limit_type& limit) noexcept {
    while (candidate_type* const c = marked_) {
      marked_ = c->next_marked;
      auto edge = c->first_edge;
      for (std::size_t i = 0; i != c->edges; ++i) mark(*edge.next());
      if (!limit.spend()) return false;
    }
    return true;
  }
  /// Step 5: one decision for all that is left. False if the limit came first.
  bool expire_blocks(limit_type& limit) noexcept {
    if (phase_ == phase::deciding) {
      while (candidate_type* const c = decided_ ? next() : nullptr) {
        side_block<Env>* const side = block_of(*c);
        if (side != nullptr) {
          marked_blocks_ = true;
          side->mark(decision_);
          decided_ = c->table->seal(c->object, c->noted);
          if (decided_) side->bury();
        }
        if (!limit.spend()) return false;
      }
      decided_ = decided_ && (!marked_blocks_ || decision_.commit());
      start(!marked_blocks_ ? phase::severing : decided_ ? phase::expiring : phase::unmarking);
    }
    if (phase_ == phase::expiring || phase_ == phase::unmarking) {
      while (candidate_type* const c = next()) {
        side_block<Env>* const side = block_of(*c);
        if (side != nullptr && side->is_marked()) {
          if (phase_ == phase::expiring) {
            side->expire();
          } else {
            side->unmark();
            if (!same_references(c->table->word_of(c->object), c->noted)) disturbed(*c);
          }
        }
        if (!limit.spend()) return false;
      }
      // What made the decision fail has changed a word: there will be another round.
      phase_ = phase_ == phase::expiring ? phase::expired : phase::idle;
    }
    return true;
  }
  /// Of a candidate that nothing else refers to, if weak handles may lead to it.
  static side_block<Env>* block_of(const candidate_type& c) noexcept {
    if (c.live || !c.table->has_blocks) return nullptr;
    side_block<Env>* const side = c.table->block_of(c.object);
    return side != nullptr && !side->is_dead() ? side : nullptr;
  }
  static void disturbed(candidate_type& c) noexcept {
    if (!state_word{c.noted}.is_retired())
      return;  // only what is retired may expire while it is referred to
    if (side_block<Env>* const side = block_of(c)) side->disturbed();
  }
  /// Without memory this round finds nothing; another one will.
  bool give_up() noexcept {
    marked_ = nullptr;
    out_of_memory_ = false;
    unsettled_ = true;
    auto at = all_.begin();
    while (candidate_type* const c = at.next()) c->live = true;
    start(suspecting_ ? phase::resolving : phase::idle);
    return true;
  }
  /// The end of a round with suspects: what was found is retired, the rest leaves.
  bool resolve(limit_type& limit) noexcept {
    while (candidate_type* const c = next()) {
      if (c->suspect && (!c->live || state_word{c->table->word_of(c->object)}.is_retired())) {
        c->table->condemn(c->object);
        c->suspect = false;
        c->fresh = true;
      }
      if (c->suspect) {
        c->table->leave(c->object);
        all_.remove(at_);
      }
      if (!limit.spend()) return false;
    }
    all_.trim();
    suspecting_ = false;
    unsettled_ = true;  // what was found among the retired ones was only left out
    roots_->visit([](root_place<Env>& root) { root.end_suspicion(); });
    start(phase::idle);
    return true;
  }
  phase phase_ = phase::idle;
  bool out_of_memory_ = false;
  bool changed_ = false;
  bool unsettled_ = false;
  bool unpurged_ = false;
  bool threw_ = false;          // some edges(), in the last round
  bool purged_ = false;         // since the last round began
  bool any_blocks_ = false;     // some candidate's type has them
  bool marked_blocks_ = false;  // in this decision
  bool decided_ = false;        // so far, that all die
  runtime::decision<Env> decision_;
  candidate_list<Env> all_;
  typename candidate_list<Env>::cursor at_;  // in this phase
  candidate_type* walked_ = nullptr;
  edge_list<Env> edges_;
  std::size_t left_ = 0;              // candidates of this round that are not excluded
  candidate_type* marked_ = nullptr;  // excluded, not walked yet
  bool suspecting_ = false;
  root_list<Env>* roots_ = nullptr;
  std::chrono::nanoseconds now_{0};
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc

namespace slamgc {
namespace runtime SLAMGC_SHARED {

template <class Env>
class purge {
 public:
  using clock = clock_of<Env>;

  /// A retired object that is still referred to.
  struct stuck {
    const void* key;
    candidate<Env>* entry;
  };

  /// Whether there is reason to begin one.
  bool due(const trial_deletion<Env>& trial) const noexcept {
    return !at_work_ && !gave_up_ && !rests_ && (trial.unpurged() || retry_in_ == 1);
  }
  /// A call of collect() begins, at @p now, in which a purge rests for @p rest times the time that the last one took. If it is
  /// @p thorough, nothing is put off.
  void begin_call(const trial_deletion<Env>& trial, typename clock::time_point now, unsigned rest,
                  bool thorough) noexcept {
    rest_ = rest;
    rests_ = now - ended_ < rest * took_;
    if (retry_in_ == 0 && trial.threw()) retry_in_ = 2;
    if (retry_in_ > 1) retry_in_ = thorough || gave_up_ ? 1 : retry_in_ - 1;
    gave_up_ = false;
  }
  /// Goes on, or begins. False if the limit came first.
  bool run(root_list<Env>& roots, trial_deletion<Env>& trial, std::size_t live_objects,
           work_limit<Env>& limit) noexcept {
    if (!at_work_) took_ = {};
    const auto begin = clock::now();
    const bool done = walk(roots, trial, live_objects, limit);
    ended_ = clock::now();
    took_ += ended_ - begin;
    rests_ = rest_ != 0;
    return done;
  }

  // For visitors:

  stuck* find(const void* object) const noexcept { return stuck_.find(object); }
  std::size_t stuck_objects() const noexcept { return stuck_.size(); }
  template <class F>
  void each_stuck(F f) const {
    stuck_.each(f);
  }
  void meet(void* object, const described_operations<Env>& type) noexcept {
    walk_.meet(object, type);
  }
  void dropped() noexcept { dropped_.fetch_add(1, std::memory_order_relaxed); }  // (12)

  // For reports:

  /// Grows when one begins: owners of roots look.
  std::uint64_t number() const noexcept { return number_.load(std::memory_order_relaxed); }  // (12)
  std::uint64_t walks() const noexcept { return walks_.load(std::memory_order_relaxed); }    // (12)
  std::uint64_t stale_edges() const noexcept {
    return dropped_.load(std::memory_order_relaxed);  // (12)
  }

 private:
  bool walk(root_list<Env>& roots, trial_deletion<Env>& trial, std::size_t live_objects,
            work_limit<Env>& limit) noexcept {
    if (!at_work_) {
      at_work_ = true;
      number_.fetch_add(1, std::memory_order_relaxed);  // (12)
      all_seen_ = !trial.threw();
      if (!walk_.reserve(live_objects)) return give_up();
      trial.begin_purge([this](candidate<Env>& c) {
        bool ignored = false;
        if (stuck_.add({c.object, &c}, ignored) == nullptr) walk_.fail();
        if (c.fresh)  // may be garbage: trial deletion comes first
          walk_.exclude(c.object);
        else
          walk_.meet(c.object, c.table->operations());
      });
      roots.visit([this](const root_place<Env>& root) {
        all_seen_ = root.operations->purge_by_collector(root.described, *this) && all_seen_;
      });
    }
    while (!walk_.at_end() && !walk_.out_of_memory()) {
      const auto item = walk_.next();
      all_seen_ = item.type->purge_by_collector(item.object, *this) && all_seen_;
      if (!limit.spend()) return false;
    }
    if (walk_.out_of_memory()) return give_up();
    bool explained = all_seen_ || stuck_.size() == 0;
    stuck_.each([&](const stuck& s) {
      const candidate<Env>& c = *s.entry;
      const std::uint32_t count = state_word{c.table->word_of(c.object)}.count();
      explained = explained && (c.fresh || count <= c.held);
    });
    retry_after_ = explained ? 0 : retry_after_ == 0 ? 1 : std::min(2 * retry_after_, longest);
    retry_in_ = explained ? 0 : retry_after_ + 1;
    walks_.fetch_add(1, std::memory_order_relaxed);  // (12)
    finish();
    return true;
  }
  /// The next call tries again; meanwhile there may be memory to reclaim.
  bool give_up() noexcept {
    gave_up_ = true;
    retry_in_ = 2;
    finish();
    return true;
  }
  void finish() noexcept {
    stuck_.clear();
    walk_.clear();
    at_work_ = false;
  }

  static constexpr std::uint64_t longest = 1024;

  bool at_work_ = false;
  bool all_seen_ = true;  // no edges() threw
  bool gave_up_ = false;  // in this call, for want of memory
  bool rests_ = false;    // in this call
  unsigned rest_ = 0;     // of this call's budget
  typename clock::time_point ended_{};
  std::chrono::nanoseconds took_{0};  // the last one, or this one so far
  std::uint64_t retry_after_ = 0;
  std::uint64_t retry_in_ = 0;  // calls; 1: now; 0: never
  address_table<stuck> stuck_;
  heap_walk<Env> walk_;
  typename Env::template atomic<std::uint64_t> number_{0};
  typename Env::template atomic<std::uint64_t> walks_{0};
  typename Env::template atomic<std::uint64_t> dropped_{0};
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// A visitor that does nothing: whether a type has edges().
struct edge_probe {
  template <class Member, class Disposition = on_retire::hold_edge>
  void edge(const char*, Member&, const Disposition& = {}) {}
};
template <class T, class = void>
struct has_edges : std::false_type {};
template <class T>
struct has_edges<T, std::void_t<decltype(std::declval<T&>().edges(std::declval<edge_probe&>()))>>
    : std::true_type {};

/// Stands for a type that describes none.
struct no_edges {
  template <class Visitor>
  void edges(Visitor&) {}
};

template <class T>
class zero_count_table;

/// Whether collectors walk through objects of this type.
template <class T>
struct is_described : std::bool_constant<is_deferred<T>::value && has_edges<T>::value> {};

/// Visits the edges. False if edges() threw.
template <class T, class Visitor>
bool visit_edges(T& described, Visitor& visitor) noexcept {
#if defined(__cpp_exceptions)
  try {
    described.edges(visitor);
    return true;
  } catch (...) {
    return false;
  }
#else
  described.edges(visitor);
  return true;
#endif
}

/// A visitor that calls f(p) for each reference.
template <class F>
struct reference_visitor {
  F f;

  template <class Member, class Disposition = on_retire::hold_edge>
  void edge(const char*, Member& member, const Disposition& = {}) {
    edge_member<std::remove_const_t<Member>>::each(member, f);
  }
};
/// A visitor that drops all references.
struct severing_visitor {
  template <class Member, class Disposition = on_retire::hold_edge>
  void edge(const char*, Member& member, const Disposition& = {}) {
    edge_member<Member>::sever(member);
  }
};

/// What is stale to a purge: what it found stuck when it began.
template <class Env>
class stale_to_collector {
 public:
  stale_to_collector(runtime::purge<Env>& p, bool holder_is_stuck) noexcept
      : purge_(p), holder_is_stuck_(holder_is_stuck) {}

  template <class T>
  bool operator()(T* p) const noexcept {
    return find(p) != nullptr;
  }
  /// A reference to p stays.
  template <class T>
  void hold(T* p) const noexcept {
    if (const auto* const s = find(p)) ++s->entry->held;
  }
  /// A stale reference was dropped, if it was @p done.
  bool dropped(bool done) const noexcept {
    if (done) purge_.dropped();
    return done;
  }
  /// How many retired objects to step over.
  std::size_t patience() const noexcept {
    return holder_is_stuck_ ? 64 : static_cast<std::size_t>(-1);
  }
  /// Whether it is better to look up what is stuck than to walk n elements.
  bool few(std::size_t n) const noexcept { return purge_.stuck_objects() * 8 < n; }
  /// Calls f(p) for each stuck T; f returns whether it dropped it.
  template <class T, class F>
  void each(F f) const {
    purge_.each_stuck([&](const auto& s) {
      if (s.entry->table->type == &type_key<T>) dropped(f(static_cast<T*>(s.entry->object)));
    });
  }

 private:
  template <class T>
  auto find(T* p) const noexcept {
    return purge_.find(static_cast<const object_of<T>*>(p));
  }
  runtime::purge<Env>& purge_;
  const bool holder_is_stuck_;
};

/// What is stale to the owner of a root, who knows nothing of purges: what is retired.
struct stale_to_owner {
  template <class T>
  bool operator()(T* p) const noexcept {
    return transitions<policy_of<T>>::load(access::header_of(*p).state).is_retired();
  }
  template <class T>
  void hold(T*) const noexcept {}
  bool dropped(bool done) const noexcept { return done; }
  std::size_t patience() const noexcept { return static_cast<std::size_t>(-1); }
  bool few(std::size_t) const noexcept { return false; }
  template <class T, class F>
  void each(F) const noexcept {}
};

/// Whether a type says by which number reports call its objects.
template <class T, class = void>
struct has_report_id : std::false_type {};
template <class T>
struct has_report_id<
    T, std::void_t<decltype(static_cast<std::uint64_t>(std::declval<const T&>().report_id()))>>
    : std::true_type {};
template <class T>
std::uint64_t report_id_of(const void* object) {
  return static_cast<std::uint64_t>(static_cast<const T*>(object)->report_id());
}

template <class Described, class Env>
struct operations_on {
  static const runtime::described_operations<Env> table;

  static bool purge_by_collector(void* described, runtime::purge<Env>& with) {
    purging_visitor visitor{with, with.find(described) != nullptr};
    return detail::visit_edges(*static_cast<Described*>(described), visitor);
  }
  static bool purge_by_owner(void* described) {
    owner_visitor visitor;
    return detail::visit_edges(*static_cast<Described*>(described), visitor);
  }
  static bool report(void* described, runtime::edge_sink<Env>& to) {
    reporting_visitor visitor{to};
    return detail::visit_edges(*static_cast<Described*>(described), visitor);
  }
  static bool suspect(void* described, runtime::trial_deletion<Env>& trial) {
    const auto make = [&trial](auto* p) {
      using target = object_of<std::remove_pointer_t<decltype(p)>>;
      if constexpr (is_described<target>::value)
        zero_count_table<target>::suspect(const_cast<target&>(static_cast<const target&>(*p)));
      (void)trial;
    };
    reference_visitor<decltype(make)> visitor{make};
    return detail::visit_edges(*static_cast<Described*>(described), visitor);
  }
  static bool record(void* described, runtime::trial_deletion<Env>& trial) {
    const auto record_one = [&trial](auto* p) {
      using target = object_of<std::remove_pointer_t<decltype(p)>>;
      if constexpr (is_described<target>::value) {
        // (11) only the collector stores what names a candidate.
        void* const link = access::header_of(*p).link.load(std::memory_order_relaxed);
        if (auto* const c = runtime::candidate<Env>::of_link(link)) trial.record(*c);
      }
      (void)trial;
    };
    reference_visitor<decltype(record_one)> visitor{record_one};
    return detail::visit_edges(*static_cast<Described*>(described), visitor);
  }
  static const runtime::described_operations<Env>* if_described() noexcept {
    if constexpr (is_described<Described>::value) return &table;
    return nullptr;
  }
  /// What reports say of an object.
  static runtime::edge_target<Env> target(const Described& object) noexcept {
    std::uint64_t (*id)(const void*) = nullptr;
    if constexpr (has_report_id<Described>::value) id = &report_id_of<Described>;
    return {const_cast<Described*>(&object), type_name<Described>::get(),
            transitions<policy_of<Described>>::load(access::header_of(object).state).bits,
            if_described(), id};
  }

 private:
  struct purging_visitor {
    runtime::purge<Env>& with;
    const bool is_stuck;

    template <class Member, class Disposition = on_retire::hold_edge>
    void edge(const char*, Member& member, const Disposition& how = {}) {
      using ops = edge_member<Member>;
      stale_to_collector<Env> stale(with, is_stuck);
      ops::purge(member, how, stale);
      ops::each(member, [this](auto* p) {
        using target = object_of<std::remove_pointer_t<decltype(p)>>;
        if constexpr (is_described<target>::value)
          with.meet(const_cast<target*>(static_cast<const target*>(p)),
                    operations_on<target, Env>::table);
      });
    }
  };
  struct owner_visitor {
    template <class Member, class Disposition = on_retire::hold_edge>
    void edge(const char*, Member& member, const Disposition& how = {}) {
      stale_to_owner stale;
      edge_member<Member>::purge(member, how, stale);
    }
  };
  struct reporting_visitor {
    runtime::edge_sink<Env>& to;

    template <class Member, class Disposition = on_retire::hold_edge>
    void edge(const char* name, Member& member, const Disposition& = {}) {
      edge_member<std::remove_const_t<Member>>::each(member, [&](auto* p) {
        using target = object_of<std::remove_pointer_t<decltype(p)>>;
        to.edge(name, on_retire::name_of(static_cast<Disposition*>(nullptr)),
                operations_on<target, Env>::target(*p));
      });
    }
  };
};
template <class Described, class Env>
const runtime::described_operations<Env> operations_on<Described, Env>::table = {
    &purge_by_collector, &purge_by_owner, &report, &suspect, &record};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/detail/domain_state.hpp ----
/// @file
/// What outlives a domain: its epoch, the records of its mutators, and its tables.

// ---- slamgc/detail/collection.hpp ----
/// @file
/// A domain's collection: one at a time, in as many calls as it takes.
///
/// **States.** *noting*: what has entered the tables is noted, table by table. *waiting*: the epoch was
/// advanced; the grace period is open. *deciding*: it is over; the noted objects are destroyed, or leave, or
/// enter anew. *purging*, between two rounds, if there is reason to (purge.hpp). A call goes on where the last one
/// ended, whichever thread made it. What enters meanwhile belongs to the next round.

// ---- slamgc/budget.hpp ----
/// @file
/// What a call that collects may do, and what it did.

namespace slamgc {

/// How much one call of collect() may do. It stops at whichever it reaches first, after the object it is
/// at: one destructor is the smallest unit of time.
struct budget {
  /// Objects to handle. One that is reclaimed is handled twice: noted, and after the grace period destroyed.
  std::size_t objects = static_cast<std::size_t>(-1);
  std::chrono::nanoseconds time = std::chrono::nanoseconds::max();  ///< Time.
  /// No purge begins until this many times as long as the last one took has passed since its end. A purge walks through all live
  /// objects, for however few that are stuck: with 15 it takes a sixteenth of the caller's time at most, however large the
  /// map is, and what is stuck waits. 0: one begins whenever there is reason to.
  unsigned purge_rest = 0;
};

/// What a call of collect() did.
struct collected {
  /// How it ended.
  enum class outcome {
    done,     ///< Nothing is left that could be reclaimed now.
    waiting,  ///< The rest waits until each mutator has passed a quiescent state.
    partial,  ///< The budget is used up.
    busy,     ///< Another thread is collecting, or this one further up the stack; nothing was done.
    refused,  ///< The thread declared that it never reclaims; nothing was done.
  };
  outcome result = outcome::done;  ///< How it ended.
  std::size_t reclaimed = 0;       ///< Objects destroyed.
};

/// Why drain() or synchronize() ended.
enum class waited {
  done,       ///< What was waited for has happened.
  timed_out,  ///< A mutator did not pass a quiescent state in time.
  /// The calling thread is an online mutator of the domain, or collects, and would wait for itself; or it is online and never
  /// reclaims. (Two threads, each an online mutator of the domain that the other one waits for, wait for ever: go offline
  /// in all domains first.)
  refused,
};

}  // namespace slamgc
// ---- slamgc/diagnosis/hooks.hpp ----
/// @file
/// What a domain tells a profiler.

namespace slamgc {

/// One call of collect() that was not refused: a slice of a domain's collection.
struct slice_stats {
  using time_point = std::chrono::steady_clock::time_point;  ///< When something was.

  collected did;                     ///< What the call returns.
  time_point begin;                  ///< When it began.
  std::chrono::nanoseconds took{0};  ///< How long it took.
  std::uint64_t grace_periods = 0;   ///< Grace periods that began in it.
  delay delayed;                     ///< Whom the domain waits for at its end.
};

/// What a domain calls while it collects: derive from this, override what is wanted, and install() it.
///
/// All functions are called in collect(), on the thread that collects, one at a time for one domain. They must not throw, and
/// must not collect, count or retire. They may read stats() of the domain.
///
/// Without hooks a call of collect() has one branch more. With hooks it sums up the numbers of all types, twice
/// at most: O(types + mutators), as stats().
class collector_hooks {
 public:
  using time_point = slice_stats::time_point;  ///< When something was.

  virtual ~collector_hooks() = default;

  /// A slice begins.
  virtual void slice_begins(time_point) noexcept {}
  /// The grace period with this number, which was open when the slice began, is over. Told before the slice ends; that it is
  /// over was found at @p when.
  virtual void grace_period_closed(std::uint64_t /*number*/, time_point /*when*/) noexcept {}
  /// The slice ends while the grace period with this number is open, since @p when. (Those that begin and end within one slice are
  /// in its numbers only.)
  virtual void grace_period_opened(std::uint64_t /*number*/, time_point /*when*/) noexcept {}
  /// The numbers of one type at the end of the slice, if they are others than at the end of the last one; @p reclaimed objects of
  /// the type were destroyed since then. The type's name stays valid, at its address.
  virtual void objects(const type_stats& /*now*/, std::uint64_t /*reclaimed*/) noexcept {}
  /// The slice ends.
  virtual void slice_ended(const slice_stats&) noexcept {}
};

}  // namespace slamgc
// ---- slamgc/detail/dropped.hpp ----
/// @file
/// What cleared registries held, on its way to the collector.

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// The content of a registry that was cleared. Its references are still counted: clearing is an unlinking that the
/// collector completes.
template <class Env>
class dropped_base {
 public:
  virtual ~dropped_base() = default;
  /// Retires and drops the objects one by one. By the collector; false if the limit came first.
  virtual bool drop(work_limit<Env>& limit) noexcept = 0;

 private:
  template <class>
  friend class dropped_list;
  dropped_base* next_ = nullptr;
};

/// Filled by any thread, emptied by the collector. Lock-free.
template <class Env>
class dropped_list {
 public:
  dropped_list() noexcept = default;
  ~dropped_list() {
    take();
    while (taken_ != nullptr) delete_first();
  }
  dropped_list(const dropped_list&) = delete;
  dropped_list& operator=(const dropped_list&) = delete;

  void push(dropped_base<Env>& content) noexcept {
    dropped_base<Env>* below = first_.load(std::memory_order_relaxed);  // (32) a guess.
    do {
      content.next_ = below;
      // (32) release: publishes the content to take().
    } while (!first_.compare_exchange_weak(below, &content, std::memory_order_release,
                                           std::memory_order_relaxed));  // (32)
  }
  /// What waits, in registries that were cleared. By whoever excludes collectors.
  std::size_t waiting() const noexcept {
    std::size_t n = 0;
    for (const auto* p = taken_; p != nullptr; p = p->next_) ++n;
    for (auto* p = first_.load(std::memory_order_seq_cst); p != nullptr; p = p->next_) ++n;
    return n;
  }
  /// Drops all that was pushed before. By the collector; false if the limit came first.
  bool drop_all(work_limit<Env>& limit) noexcept {
    for (;;) {
      if (taken_ == nullptr) take();
      if (taken_ == nullptr) return true;
      if (!taken_->drop(limit)) return false;
      delete_first();
    }
  }

 private:
  void take() noexcept {
    // (32) relaxed: whether there is something, which the grace period orders where it matters.
    if (first_.load(std::memory_order_relaxed) == nullptr) return;
    taken_ = first_.exchange(nullptr, std::memory_order_acquire);  // (32) sees the content.
  }
  void delete_first() noexcept {
    dropped_base<Env>* const next = taken_->next_;
    delete taken_;
    taken_ = next;
  }

  typename Env::template atomic<dropped_base<Env>*> first_{nullptr};
  dropped_base<Env>* taken_ = nullptr;  // the collector's
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc

namespace slamgc {
namespace runtime SLAMGC_SHARED {

template <class Env>
class collection {
 public:
  using outcome = collected::outcome;
  using domain = domain_state<Env>;

  /// @p thorough: what could be put off is not.
  collected collect(domain& of, const budget& limit, bool thorough = false) noexcept {
    if (!begin_turn()) return {outcome::busy, 0};
    const auto begin = clock::now();
    purge_.begin_call(trial_, begin, limit.purge_rest, thorough);
    trial_.begin_call(begin.time_since_epoch());
    const collected done =
        hooks_ == nullptr ? slice(of, limit, begin) : told_slice(of, limit, begin);
    const std::int64_t took = std::chrono::nanoseconds(clock::now() - begin).count();
    if (took > longest_.load(std::memory_order_relaxed))  // (12)
      longest_.store(took, std::memory_order_relaxed);    // (12)
    end_turn();
    return done;
  }
  /// Calls f(the collector) while nobody else collects: nothing is destroyed meanwhile but by @p f, which must not throw.
  /// False: somebody collects.
  template <class F>
  bool take_turn(domain& of, F f) noexcept {
    if (!begin_turn()) return false;
    as_collector(of, f);
    end_turn();
    return true;
  }
  void refuse() noexcept { refused_.fetch_add(1, std::memory_order_relaxed); }  // (12)

  void on_backlog(std::uint64_t limit, void (*hook)(const delay&, void*), void* context) noexcept {
    backlog_limit_ = limit;
    backlog_hook_ = hook;
    backlog_context_ = context;
  }

  void install(domain& of, collector_hooks* hooks) noexcept {
    hooks_ = hooks;
    for (table* t = of.tables(); t != nullptr; t = t->next) {
      t->told = t->stats();
      t->told.object_size = 0;  // of no type: they are told the next time
    }
  }

  trial_deletion<Env>& trial() noexcept { return trial_; }
  root_list<Env>& roots() noexcept { return roots_; }
  void drop(dropped_base<Env>& content) noexcept { dropped_.push(content); }
  const dropped_list<Env>& dropped() const noexcept { return dropped_; }
  const purge<Env>& purging() const noexcept { return purge_; }

  // ---- reports

  /// The grace period that is waited for, or 0.
  std::uint64_t open() const noexcept { return open_.load(std::memory_order_relaxed); }  // (12)
  std::uint64_t grace_periods() const noexcept {
    return grace_periods_.load(std::memory_order_relaxed);  // (12)
  }
  std::chrono::nanoseconds longest() const noexcept {
    return std::chrono::nanoseconds(longest_.load(std::memory_order_relaxed));  // (12)
  }
  std::uint64_t refused() const noexcept {
    return refused_.load(std::memory_order_relaxed);  // (12)
  }
  delay delayed(const domain& of) const noexcept {
    delay now;
    const std::uint64_t target = open();
    if (const auto* const oldest = of.oldest(target)) {
      now.oldest = oldest->name.load(std::memory_order_relaxed);                             // (12)
      now.age = time() - std::chrono::nanoseconds(opened_.load(std::memory_order_relaxed));  // (12)
    }
    now.backlog = backlog(of);
    return now;
  }

 private:
  using clock = clock_of<Env>;
  using table = table_base<Env>;
  enum class phase { noting, waiting, deciding, purging };
  /// More than it takes from a purge, and from the decision on handles, to the next object.
  static constexpr unsigned most_in_vain = 16;

  bool begin_turn() noexcept {
    // (21) acquire: sees what the last collector left behind.
    return !collecting_.exchange(true, std::memory_order_acquire);
  }
  void end_turn() noexcept {
    // (21) release: to the next collector.
    collecting_.store(false, std::memory_order_release);
  }
  template <class F>
  static void as_collector(domain& of, F f) noexcept {
    for (auto* p = participants<Env>::of_this_thread().innermost; p != nullptr; p = p->outer)
      if (p->domain == &of) p->publish();
    participant<Env> me{nullptr, &of, nullptr, table::collectors_door, false, false};
    const participation<Env> taking_part(me);
    me.pass_quiescent_state();
    f(me);
  }

  collected slice(domain& of, const budget& limit, typename clock::time_point begin) noexcept {
    collected done;
    as_collector(of, [&](participant<Env>& me) {
      work_limit<Env> work(limit.objects, limit.time, begin);
      done.result = limit.objects == 0 ? outcome::partial : run(of, me, work, done.reclaimed);
      me.publish();
    });
    return done;
  }

  /// The same, with hooks.
  __attribute__((noinline)) collected told_slice(domain& of, const budget& limit,
                                                 typename clock::time_point begin) noexcept {
    const std::uint64_t before = grace_periods();
    const bool was_open = open() != 0;
    hooks_->slice_begins(begin);
    slice_stats told;
    told.did = slice(of, limit, begin);
    told.begin = begin;
    told.grace_periods = grace_periods() - before;
    const bool others = told.grace_periods != 0;
    if (was_open && (others || open() == 0)) hooks_->grace_period_closed(before, begin);
    if (others && open() != 0) {
      const std::chrono::nanoseconds when(opened_.load(std::memory_order_relaxed));  // (12)
      hooks_->grace_period_opened(grace_periods(), typename clock::time_point(when));
    }
    for (table* t = of.tables(); t != nullptr; t = t->next) {
      const type_stats now = t->stats();
      if (same_numbers(now, t->told)) continue;
      hooks_->objects(now, now.reclaimed - t->told.reclaimed);
      t->told = now;
    }
    told.delayed = delayed(of);
    told.took = clock::now() - begin;
    hooks_->slice_ended(told);
    return told.did;
  }
  static bool same_numbers(const type_stats& a, const type_stats& b) noexcept {
    return a.object_size == b.object_size && a.created == b.created && a.live == b.live &&
           a.retired == b.retired && a.reclaimed == b.reclaimed && a.stuck == b.stuck &&
           a.backlog == b.backlog;
  }

  outcome run(domain& of, participant<Env>& me, work_limit<Env>& work,
              std::size_t& reclaimed) noexcept {
    bool found_nothing = false;
    std::size_t reclaimed_before = reclaimed;
    unsigned in_vain = 0;  // rounds
    for (;;) {
      if (phase_ == phase::purging) {
        if (!purge_.run(roots_, trial_, live(of), work)) return outcome::partial;
        phase_ = phase::noting;
      }
      if (phase_ == phase::noting) {
        if (!dropped_.drop_all(work)) return outcome::partial;
        me.publish();
        if (batch_ == nullptr) {
          at_ = batch_ = of.tables();
          noted_ = 0;
        }
        for (; at_ != nullptr; at_ = at_->next)
          if (!at_->note(work, noted_)) return outcome::partial;
        trial_.suspect(roots_);
        // What entered and is not noted is in a chain of a mutator, which publishes it at the latest when
        // the grace period is over.
        if (!trial_.find(work)) return outcome::partial;
        if (noted_ == 0 && !trial_.found() && !trial_.unsettled() && backlog(of) == 0) {
          batch_ = nullptr;
          if (!purge_.due(trial_)) return outcome::done;
          phase_ = phase::purging;
          continue;
        }
        open_grace_period(of);
        phase_ = phase::waiting;
      }
      if (phase_ == phase::waiting) {
        if (of.behind(target_) != nullptr) {
          if (backlog_hook_ != nullptr && backlog(of) > backlog_limit_)
            backlog_hook_(delayed(of), backlog_context_);
          return outcome::waiting;
        }
        open_.store(0, std::memory_order_relaxed);  // (12)
        at_ = batch_;
        phase_ = phase::deciding;
      }
      // Before trial deletion decides: what a mutator cleared before its quiescent state is unlinked then.
      if (!dropped_.drop_all(work)) return outcome::partial;
      const bool tried = trial_.found() || trial_.unsettled();
      if (!trial_.decide(work, reclaimed)) return outcome::partial;
      for (; at_ != nullptr; at_ = at_->next)
        if (!at_->decide(work, reclaimed)) return outcome::partial;
      batch_ = nullptr;
      phase_ = purge_.due(trial_) ? phase::purging : phase::noting;
      // For a thread that is about to push something; one that was at work when the round began has done so.
      if (noted_ == 0 && !tried && phase_ == phase::noting && std::exchange(found_nothing, true))
        return outcome::waiting;
      // For memory; or for threads without a mutator, which change what is tried all the time.
      in_vain = noted_ == 0 && reclaimed == reclaimed_before ? in_vain + 1 : 0;
      if (in_vain == most_in_vain) return outcome::waiting;
      reclaimed_before = reclaimed;
    }
  }

  void open_grace_period(domain& of) noexcept {
    grace_periods_.fetch_add(1, std::memory_order_relaxed);    // (12)
    opened_.store(time().count(), std::memory_order_relaxed);  // (12)
    target_ = of.advance();
    open_.store(target_, std::memory_order_relaxed);  // (12)
  }

  static std::uint64_t backlog(const domain& of) noexcept {
    std::uint64_t sum = 0;
    for (const table* t = of.tables(); t != nullptr; t = t->next) sum += t->backlog();
    return sum;
  }
  static std::size_t live(const domain& of) noexcept {
    std::uint64_t sum = 0;
    for (const table* t = of.tables(); t != nullptr; t = t->next) sum += t->live();
    return static_cast<std::size_t>(sum);
  }
  static std::chrono::nanoseconds time() noexcept { return clock::now().time_since_epoch(); }

  typename Env::template atomic<bool> collecting_{false};
  // For reports:
  typename Env::template atomic<std::uint64_t> open_{0};
  typename Env::template atomic<std::int64_t> opened_{0};
  typename Env::template atomic<std::uint64_t> grace_periods_{0};
  typename Env::template atomic<std::int64_t> longest_{0};
  typename Env::template atomic<std::uint64_t> refused_{0};
  // Of the thread that collects:
  phase phase_ = phase::noting;
  table* batch_ = nullptr;  // the tables of this round, from the newest
  table* at_ = nullptr;     // the next one
  trial_deletion<Env> trial_;
  purge<Env> purge_;
  root_list<Env> roots_;
  dropped_list<Env> dropped_;
  std::size_t noted_ = 0;  // objects in this round
  std::uint64_t target_ = 0;
  std::uint64_t backlog_limit_ = 0;
  void (*backlog_hook_)(const delay&, void*) = nullptr;
  void* backlog_context_ = nullptr;
  collector_hooks* hooks_ = nullptr;
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// See domain.hpp for the argument. Freed when neither the domain, nor a mutator, nor an object needs it.
template <class Env>
class domain_state {
 public:
  using record = mutator_record<Env>;
  using table = table_base<Env>;
  template <class T>
  using atomic = typename Env::template atomic<T>;

  domain_state() noexcept = default;
  domain_state(const domain_state&) = delete;
  domain_state& operator=(const domain_state&) = delete;

  // ---- who needs it: made with one reference, the domain's

  void retain() noexcept {
    references_.fetch_add(1, std::memory_order_relaxed);  // (22) the caller has one already.
  }
  void release() noexcept {
    // (22) release: my use of the state is over; acquire: so are all others'.
    if (references_.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    // Objects that are left name their table. They stay as they are, and so does it.
    for (table* t = tables(); t != nullptr; t = t->next)
      if (t->live() != 0) return;
    delete this;
  }

  // ---- mutators

  /// Takes a record that nobody uses, or makes one. Throws std::bad_alloc.
  record& enter(const char* name) {
    for (record* r = records_.load(std::memory_order_acquire); r != nullptr; r = r->next) {  // (14)
      // (15) acquire: the record's last owner has finished with it, and with its doors.
      if (!r->taken.exchange(true, std::memory_order_acquire)) {
        r->name.store(name, std::memory_order_relaxed);  // (12)
        return *r;
      }
    }
    record* const made = new record;
    const std::size_t before = records_made_.fetch_add(1, std::memory_order_relaxed);  // (12)
    made->door =
        before < Env::mutator_doors ? table::first_of_mutators + before : table::shared_door;
    made->name.store(name, std::memory_order_relaxed);  // (12)
    push(records_, made);
    return *made;
  }
  void leave(record& r) noexcept {
    r.taken.store(false, std::memory_order_release);  // (15)
  }
  /// Before the thread reads any pointer.
  void go_online(record& r) noexcept {
    // (16) release: the collector may read this in place of the 0 (18) that it replaces, by the record's last
    // owner even; relaxed would take the release of that 0 back. The epoch itself is a guess.
    r.epoch.store(epoch_.load(std::memory_order_relaxed), std::memory_order_release);
    // (16) acq_rel: of this and the collector's advance (17), the later one sees the earlier: this one what
    // was unlinked, or that one the record.
    epoch_.fetch_add(0, std::memory_order_acq_rel);
  }
  /// After the thread gave all its borrowed pointers up.
  static void go_offline(record& r) noexcept {
    // (18) release: what it did with borrowed pointers comes before their reclamation (20).
    r.epoch.store(record::offline, std::memory_order_release);
  }
  bool quiescent(record& r) noexcept {
    // (19) acquire: sees whatever was unlinked before the collector wrote this epoch (17).
    const std::uint64_t now = epoch_.load(std::memory_order_acquire);
    // (12) relaxed: nobody else writes the record.
    if (r.epoch.load(std::memory_order_relaxed) == now) return false;
    r.epoch.store(now, std::memory_order_release);  // (18)
    return true;
  }

  // ---- grace periods

  /// Begins a grace period: what was unlinked before it cannot be read by a mutator that has seen it.
  std::uint64_t advance() noexcept {
    // (17) release: publishes what was unlinked before to (19) and (16); acquire: sees the records of all
    // who went online before (16).
    return epoch_.fetch_add(1, std::memory_order_acq_rel) + 1;
  }
  /// The first record that the grace period of @p target waits for, or null: it is over.
  const record* behind(std::uint64_t target) const noexcept {
    for (const record* r = records_.load(std::memory_order_acquire); r != nullptr;  // (14)
         r = r->next) {
      // (20) acquire: what the mutator did before its quiescent state (18) is over.
      const std::uint64_t at = r->epoch.load(std::memory_order_acquire);
      if (at != record::offline && at < target) return r;
    }
    return nullptr;
  }
  /// Of those, the one that has passed no quiescent state for the longest time.
  const record* oldest(std::uint64_t target) const noexcept {
    const record* found = nullptr;
    for (const record* r = first_record(); r != nullptr; r = r->next) {
      const std::uint64_t at = r->epoch.load(std::memory_order_relaxed);  // (12)
      if (at == record::offline || at >= target) continue;
      found = r;
      target = at;
    }
    return found;
  }
  const record* first_record() const noexcept {
    return records_.load(std::memory_order_acquire);  // (14)
  }

  // ---- tables

  table* find(const void* type) const noexcept {
    for (table* t = tables(); t != nullptr; t = t->next)
      if (t->type == type) return t;
    return nullptr;
  }
  /// Two threads may add one for the same type at once: both serve.
  void add(table& made) noexcept { push(tables_, &made); }
  table* tables() const noexcept { return tables_.load(std::memory_order_acquire); }  // (14)

  runtime::collection<Env> collection;

 private:
  ~domain_state() {
    for (table* t = tables(); t != nullptr;) {
      table* const next = t->next;
      delete t;
      t = next;
    }
    for (record* r = records_.load(std::memory_order_relaxed); r != nullptr;) {  // (14) alone here.
      record* const next = r->next;
      delete r;
      r = next;
    }
  }
  template <class Node>
  static void push(atomic<Node*>& list, Node* made) noexcept {
    Node* first = list.load(std::memory_order_relaxed);  // (14) a guess.
    do {
      made->next = first;
    } while (!list.compare_exchange_weak(
        first, made, std::memory_order_release,  // (14) publishes the node to who walks the list.
        std::memory_order_relaxed));             // (14) a guess.
  }

  alignas(cache_line) atomic<std::uint64_t> epoch_{1};
  alignas(cache_line) atomic<record*> records_{nullptr};
  atomic<table*> tables_{nullptr};
  atomic<std::size_t> records_made_{0};
  atomic<std::size_t> references_{1};
};

template <class Env>
void participant<Env>::join_purge() noexcept {
  const std::uint64_t now = domain->collection.purging().number();
  if (now == purged) return;
  purged = now;
  for (const root_place<Env>* root = roots; root != nullptr; root = root->next_of_owner)
    root->operations->purge_by_owner(root->described);
}

/// The state of the default domain: made on first use, never destroyed.
template <class Env>
domain_state<Env>& default_state() {
  static domain_state<Env>& forever = *new domain_state<Env>;
  return forever;
}

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
// ---- slamgc/detail/note_list.hpp ----
/// @file
/// A queue whose memory can run out without harm.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Filled by one thread, then emptied in the same order, then filled again. The first few notes fit into
/// the list itself, so that work goes on when there is no memory. Blocks are freed as they are emptied, all
/// but one.
template <class Note>
class note_list {
 public:
  note_list() noexcept { start_over(); }
  ~note_list() {
    delete kept_;
    while (near_.next != nullptr) delete unlink_first();
  }
  note_list(const note_list&) = delete;
  note_list& operator=(const note_list&) = delete;

  [[nodiscard]] bool empty() const noexcept { return taken_ == added_; }

  /// False if there is no memory: nothing has changed then.
  [[nodiscard]] bool add(const Note& note) noexcept {
    if (added_ == room_ && !grow()) return false;
    *added_++ = note;
    return true;
  }

  /// A note that take() may return a few calls later, for a prefetch; or one that was taken long ago, or null.
  const Note* soon() const noexcept { return filled_ - taken_ > 8 ? taken_ + 8 : nullptr; }

  /// Calls f(note) for each note, the oldest first.
  template <class F>
  void each(F f) const {
    const link* at = &near_;
    const Note* note = taken_;
    const Note* end = filled_;
    // Where notes are taken from is the first block that there is, near or far.
    if (in_far_block_) at = near_.next;
    for (;;) {
      if (at == last_) end = added_;
      for (; note != end; ++note) f(*note);
      if (at == last_) return;
      at = at->next;
      note = static_cast<const far_block*>(at)->notes;
      end = note + far_size;
    }
  }

  /// Takes the oldest; not of an empty list.
  Note take() noexcept {
    if (taken_ == filled_) next_block();
    const Note note = *taken_++;
    if (taken_ == added_) start_over();
    return note;
  }

 private:
  struct far_block;
  struct link {
    far_block* next = nullptr;
  };
  template <std::size_t Size>
  struct block : link {
    Note notes[Size]{};
  };
  static constexpr std::size_t near_size = 32;
  static constexpr std::size_t far_size = 1023;
  struct far_block : block<far_size> {};

  __attribute__((noinline)) bool grow() noexcept {
    far_block* const more = kept_ != nullptr ? kept_ : new (std::nothrow) far_block{};
    if (more == nullptr) return false;
    kept_ = nullptr;
    more->next = nullptr;
    last_->next = more;
    last_ = more;
    added_ = more->notes;
    room_ = more->notes + far_size;
    return true;
  }
  /// The notes that are taken now are used up, and there are others.
  __attribute__((noinline)) void next_block() noexcept {
    if (in_far_block_) free_first();
    in_far_block_ = true;
    taken_ = near_.next->notes;
    filled_ = taken_ + far_size;
  }
  void start_over() noexcept {
    while (near_.next != nullptr) free_first();
    last_ = &near_;
    taken_ = added_ = near_.notes;
    filled_ = room_ = near_.notes + near_size;
    in_far_block_ = false;
  }
  far_block* unlink_first() noexcept {
    far_block* const first = near_.next;
    near_.next = first->next;
    return first;
  }
  void free_first() noexcept {
    far_block* const first = unlink_first();
    delete kept_;
    kept_ = first;
  }

  Note* taken_;
  Note* filled_;  // the end of the block that notes are taken from
  Note* added_;
  Note* room_;  // the end of the block that notes are added to
  link* last_;
  far_block* kept_ = nullptr;
  bool in_far_block_;
  block<near_size> near_;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/detail/side_block.hpp ----
/// @file
/// Side blocks: what weak handles and anchors refer to.
///
/// A block is a counted object. The object that it belongs to has one reference to it, each handle another; so it
/// outlives the object as long as a handle needs it. A chain of blocks, whose records refer to each other, is destroyed
/// without recursion, as any counted objects are.

#include <memory>

// ---- slamgc/intrusive_rc.hpp ----
/// @file
/// The counted pointer for locals, parameters and roots.

#include <iosfwd>
#include <typeindex>  // the smallest header with std::hash

// ---- slamgc/rc_object.hpp ----
/// @file
/// The base class of every counted object.

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
    if constexpr (detail::has_last_link<Reclaimer, T>::value) {
      void* const link = header_.link.load(std::memory_order_relaxed);  // (8)
      if (link == &header_) return;
      SLAMGC_ASSERT(!state().is_queued(), (misuse{"deletes an object that a collector holds",
                                                  detail::type_name<T>::get(), this, 0}));
      if (!state().is_queued()) Reclaimer::template last_link<T>(link);
    }
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

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

template <class Env>
class counted_block
    : public rc_object<counted_block<Env>, basic_fetch_add_counter<Env>, reclaim_at_zero>,
      public runtime::side_block<Env> {
 public:
  using runtime::side_block<Env>::side_block;
};

/// The part of an object that knows its block. A copy of the object is another object.
template <class T, class Env>
class block_owner {
 public:
  using block = counted_block<Env>;

  /// Null if nobody has made a weak handle yet.
  block* slamgc_block() const noexcept {
    return block_.load(std::memory_order_acquire);  // (29) sees the block that another thread made.
  }
  /// Throws std::bad_alloc, the first time.
  block& get_or_make() const {
    if (block* const made = slamgc_block()) return *made;
    intrusive_rc<block> mine = make_rc<block>(this);
    block* found = nullptr;
    // (29) release: publishes the block; acquire: sees that of who came first.
    if (!block_.compare_exchange_strong(found, mine.get(), std::memory_order_release,
                                        std::memory_order_acquire))  // (29)
      return *found;
    return *mine.detach();
  }

 protected:
  block_owner() noexcept = default;
  explicit block_owner(intrusive_rc<block> mine) noexcept : block_(mine.detach()) {}
  ~block_owner() {
    // (29) nobody else has the object any more.
    if (block* const mine = block_.load(std::memory_order_relaxed)) {
      mine->expire();
      drop_reference(mine);
    }
  }
  block_owner(const block_owner&) = delete;
  block_owner& operator=(const block_owner&) = delete;

 private:
  mutable typename Env::template atomic<block*> block_{nullptr};
};

/// The owner in T, found as base_of() finds the base class: void if there is none, or if there are several.
template <class T, class Env>
block_owner<T, Env> owner_in(const block_owner<T, Env>*);
void owner_in(...);
template <class T>
using owner_type = decltype(detail::owner_in(static_cast<const T*>(nullptr)));
template <class T>
struct has_block : std::bool_constant<!std::is_void<owner_type<T>>::value> {};

/// The owner in *p, which has to be that of the class that derives from rc_object.
template <class Env, class T>
const block_owner<object_of<T>, Env>& owner_of(const T& p) noexcept {
  using object = object_of<T>;
  static_assert(
      std::is_same<owner_type<object>, block_owner<object, Env>>::value,
      "slamgc: the class that derives from rc_object must also derive publicly, and once, from "
      "enable_weak_rc or enable_anchor, with the environment of its counter policy");
  static_assert(
      std::is_same<Env, typename policy_of<T>::env>::value,
      "slamgc: enable_weak_rc and enable_anchor take the environment of the counter policy");
  return p;
}

/// The object with a reference of the caller's own, or null. By an online mutator.
template <class Object, class Env>
Object* lock(const runtime::side_block<Env>& block) noexcept {
  if (block.is_dead()) return nullptr;
  const auto* const owner = static_cast<const block_owner<Object, Env>*>(block.owner());
  auto* const object = const_cast<Object*>(static_cast<const Object*>(owner));
  transitions<policy_of<Object>>::increment_before_look(access::header_of(*object).state);
  if (block.survives()) return object;
  drop_reference(object);
  return nullptr;
}

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

template <class T>
class zero_count_table final : public runtime::table_base<typename policy_of<T>::env> {
  using env = typename policy_of<T>::env;
  using base = runtime::table_base<env>;
  using policy = policy_of<T>;
  using typename base::door;
  using candidate = runtime::candidate<env>;

 public:
  explicit zero_count_table(runtime::domain_state<env>& of) noexcept
      : base(of, &type_key<T>, slamgc::detail::type_name<T>::get(), sizeof(T),
             has_block<T>::value) {}

  /// The table of T in @p domain, or null.
  static zero_count_table* find(const runtime::domain_state<env>& domain) noexcept {
    return static_cast<zero_count_table*>(domain.find(&type_key<T>));
  }
  /// The table of T in @p domain. Throws std::bad_alloc, the first time.
  static zero_count_table& in(runtime::domain_state<env>& domain) {
    zero_count_table* found = find(domain);
    if (found == nullptr) {
      found = new zero_count_table(domain);
      domain.add(*found);
    }
    return *found;
  }
  /// The table of an object that is not queued.
  static zero_count_table* of(const T& object) noexcept {
    auto& link = access::header_of(object).link;
    // (13) stored by the object's constructor, or before it left the table.
    return static_cast<zero_count_table*>(link.load(std::memory_order_relaxed));
  }

  /// Takes in an object whose `queued` flag the caller has just set. Lock-free; never allocates.
  void push(T* object) noexcept {
    runtime::participant<env>* me;
    door& at = this->my_door(me);
    push(object, at, me);
  }
  /// The same, where the caller knows the door.
  void push(T* object, door& at, runtime::participant<env>* me) noexcept {
    auto& link = access::header_of(*object).link;
    base::add(at, &door::entered);
    if (me == nullptr || !me->keeps_chains()) {
      at.push(object, link);
      return;
    }
    link.store(at.chain, std::memory_order_relaxed);  // (11)
    if (at.chain == nullptr) {
      at.chain_end = &link;
      at.next_pending = me->pending;
      me->pending = &at;
    }
    at.chain = object;
  }

  bool note(runtime::work_limit<env>& limit, std::size_t& noted) noexcept override {
    for (;;) {
      while (taken_ != nullptr) {
        auto& header = access::header_of(*taken_);
        void* const below = header.link.load(std::memory_order_relaxed);  // (11)
        const std::uint64_t word = policy::load(header.state);
        if (is_candidate(word)) {
          if (!become_candidate(taken_, word)) return true;
          base::add(this->left_, 1);
        } else {
          if (!notes_.add({taken_, word})) return true;
          ++noted;
        }
        taken_ = static_cast<T*>(below);
        if (!limit.spend()) return false;
      }
      if (at_door_ == base::doors) break;
      taken_ = static_cast<T*>(this->doors_[at_door_++].take());
    }
    at_door_ = 0;
    return true;
  }

  std::uint64_t word_of(const void* object) const noexcept override {
    return policy::load(access::header_of(*static_cast<const T*>(object)).state);
  }
  runtime::side_block<env>* block_of(void* object) const noexcept override {
    if constexpr (has_block<T>::value)
      return owner_of<env>(*static_cast<const T*>(object)).slamgc_block();
    else
      return nullptr;
  }
  bool seal(void* object, std::uint64_t noted) noexcept override {
    auto& state = access::header_of(*static_cast<T*>(object)).state;
    std::uint64_t now = policy::load(state);
    do {
      if (!state_word{now}.same_references({noted})) return false;
    } while (!policy::compare_exchange(state, now, now));
    return true;
  }
  const runtime::described_operations<env>& operations() const noexcept override {
    return operations_on<std::conditional_t<has_edges<T>::value, T, no_edges>, env>::table;
  }
  bool walk(void* object, runtime::trial_deletion<env>& trial) noexcept override {
    if constexpr (has_edges<T>::value) return operations_on<T, env>::record(object, trial);
    return true;
  }
  bool sever(void* object) noexcept override {
    severing_visitor visitor;
    if constexpr (has_edges<T>::value)
      return detail::visit_edges(*static_cast<T*>(object), visitor);
    return true;
  }
  void destroy(void* object) noexcept override {
    destroy_object(static_cast<T*>(object));
    base::add(this->stuck_, std::uint64_t{0} - 1);
    base::add(this->reclaimed_, 1);
    base::add(this->doors_[base::collectors_door].ended, 1);
  }

  /// Makes a candidate of an object that is neither queued nor retired: see trial_deletion::suspect.
  static void suspect(T& object) noexcept {
    auto& header = access::header_of(object);
    std::uint64_t now = policy::load(header.state);
    do {
      const state_word w{now};
      if (w.is_queued() || w.is_retired() || w.is_saturated()) return;
    } while (!policy::compare_exchange(header.state, now, now | state_word::queued_flag));
    zero_count_table* const mine = of(object);
    if (!mine->become_candidate(&object, now)) mine->leave_table(object);
  }
  void condemn(void* object) noexcept override {
    auto& state = access::header_of(*static_cast<T*>(object)).state;
    std::uint64_t now = policy::load(state);
    do {
      if (state_word{now}.is_retired()) return;
    } while (!policy::compare_exchange(state, now, now | state_word::retired_flag));
    base::add(this->doors_[base::collectors_door].retired, 1);
  }
  void leave(void* object) noexcept override {
    base::add(this->stuck_, std::uint64_t{0} - 1);
    leave_table(*static_cast<T*>(object));
  }

  void report(const void* object, runtime::edge_sink<env>& to) const override {
    to.waiting(operations_on<T, env>::target(*static_cast<const T*>(object)));
  }
  void report_waiting(runtime::edge_sink<env>& to, bool stand_still) const override {
    const auto report_stack = [&](const void* newest) {
      for (auto* at = static_cast<const T*>(newest); at != nullptr;) {
        report(at, to);
        // Collectors alone take from a stack, and who pushes to it writes only links of its own.
        at = static_cast<const T*>(access::header_of(*at).link.load(std::memory_order_seq_cst));
      }
    };
    for (const door& d : this->doors_) {
      report_stack(d.first.load(std::memory_order_seq_cst));
      if (stand_still) report_stack(d.chain);
    }
    report_stack(taken_);
    notes_.each([&](const entry& e) { report(e.object, to); });
  }

  bool decide(runtime::work_limit<env>& limit, std::size_t& reclaimed) noexcept override {
    std::size_t left = 0;
    std::size_t destroyed = 0;
    bool more = true;
    limit.other_objects();
    for (; more && !notes_.empty(); more = limit.spend()) {
      if (const entry* const soon = notes_.soon()) __builtin_prefetch(soon->object, 1);
      const entry e = notes_.take();
      ++left;
      if (!is_dead(e) || !has_expired(e)) continue;
      // The destructor may do anything, push objects of this type included.
      destroy_object(e.object);
      ++destroyed;
    }
    base::add(this->left_, left);
    base::add(this->reclaimed_, destroyed);
    base::add(this->doors_[base::collectors_door].ended, destroyed);
    reclaimed += destroyed;
    return more;
  }

 private:
  struct entry {
    T* object;
    std::uint64_t noted;
  };

  /// Else the object is where it belongs afterwards.
  bool is_dead(const entry& e) noexcept {
    auto& header = access::header_of(*e.object);
    std::uint64_t now = policy::load(header.state);
    for (;;) {
      const state_word w{now};
      if (w.count() == 0) {
        if (w.same_references({e.noted})) return true;
        if (auto* const block = this->block_of(e.object)) block->disturbed();
        push(e.object);
        return false;
      }
      if (is_candidate(now)) {
        if (!become_candidate(e.object, now)) push(e.object);
        return false;
      }
      if (auto* const block = this->block_of(e.object)) block->undisturbed();
      if (clear_queued(header, now)) return false;
    }
  }

  /// Clears `queued`, or pushes the object.
  void leave_table(T& object) noexcept {
    auto& header = access::header_of(object);
    std::uint64_t now = policy::load(header.state);
    do {
      const state_word w{now};
      if (w.is_retired() || (w.count() == 0 && reclaimer_of<T>::at_zero)) {
        push(&object);
        return;
      }
    } while (!clear_queued(header, now));
  }
  /// The object leaves, or @p now is its word.
  template <class Header>
  bool clear_queued(Header& header, std::uint64_t& now) noexcept {
    // (13) published by clearing the flag: compare_exchange (6) releases.
    header.link.store(this, std::memory_order_relaxed);
    return policy::compare_exchange(header.state, now, now & ~state_word::queued_flag);
  }

  /// Whether no weak handle leads to the object any more, which is dead otherwise. Else they expire now, unless
  /// somebody locks one; and the object enters anew.
  bool has_expired(const entry& e) noexcept {
    auto* const block = this->block_of(e.object);
    if (block == nullptr || block->is_dead()) return true;
    if (!runtime::decide_alone(this->domain.collection.trial().decision(), *block,
                               [&] { return seal(e.object, e.noted); }) &&
        state_word{word_of(e.object)}.count() == 0)
      block->disturbed();
    push(e.object);
    return false;
  }

  /// Retired, described, and still referred to: in place of leaving, it is tried.
  static constexpr bool is_candidate(std::uint64_t word) noexcept {
    return has_edges<T>::value && state_word{word}.count() != 0 && state_word{word}.is_retired();
  }
  /// False if there is no memory.
  bool become_candidate(T* object, std::uint64_t word) noexcept {
    auto* const c = this->domain.collection.trial().add(object, *this, word);
    if (c == nullptr) return false;
    // (11) read by collectors alone.
    access::header_of(*object).link.store(candidate::link_to(c), std::memory_order_relaxed);
    base::add(this->stuck_, 1);
    return true;
  }

  // The collector's:
  note_list<entry> notes_;
  T* taken_ = nullptr;       // what is left of a door's stack
  std::size_t at_door_ = 0;  // the next door
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/domain.hpp ----
/// @file
/// Domains: what objects, threads and collectors share; grace periods; collecting.
///
/// **States.** The domain has an epoch, a number that only grows. Each mutator has a record: 0 while it
/// is offline, else an epoch that it read at its last quiescent state.
///
/// **Grace period.** A collector advances the epoch to `g`. The grace period is over when each record is
/// 0 or at least `g`.
///
/// **Argument.** Let a reference be unlinked before the collector advances the epoch. A mutator with a
/// record of `g` or more has *read* that epoch, which the collector wrote after the unlinking: what the
/// mutator reads from then on cannot be the unlinked pointer, and what it had borrowed before, it gave
/// up. A mutator that was offline when the collector looked changes the epoch, by a read-modify-write,
/// before it reads anything: either after the collector's advance, and it sees the unlinking; or before
/// it, and the collector, whose advance is a read-modify-write too, sees its record. So when the grace
/// period is over nobody has a pointer that was borrowed through the unlinked reference.
///
/// Quiescent-state-based reclamation: Hart, McKenney, Brown and Walpole 2007. Orders:
/// docs/memory-model.md.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// What objects, threads and collectors share: one per SLAM system.
///
/// An object belongs to the domain that is current on the thread that makes it: that of its innermost
/// mutator, or default_domain() on a thread that has none. While destructors run in collect(), the current
/// domain is the one that collects.
///
/// Thread-safety: unless they say otherwise, operations may be called by any thread at any time. None waits for a
/// grace period except synchronize() and drain(). After fork() the child has the mutators of threads that it does
/// not have: it must not use the domain.
template <class Env>
class basic_domain {
 public:
  /// An empty domain. Throws std::bad_alloc.
  basic_domain() : state_(new runtime::domain_state<Env>) {}
  /// Reclaims what nobody can see. If objects are left, their number and types are printed to the
  /// standard error stream; they stay valid, and are not reclaimed any more. No other thread may be
  /// collecting; mutators may outlive it.
  ~basic_domain() {
    if (!never_reclaims()) {
      const collected last = state_->collection.collect(*state_, {}, true);
      SLAMGC_ASSERT(last.result != outcome::busy,
                    (misuse{"ends a domain that is being collected", "domain", this, 0}));
      (void)last;
    }
    for (table* t = state_->tables(); t != nullptr; t = t->next)
      if (const std::uint64_t live = t->live())
        std::fprintf(stderr, "slamgc: a domain ends while %llu objects of type %s exist\n",
                     static_cast<unsigned long long>(live), t->type_name);
    state_->release();
  }
  basic_domain(const basic_domain&) = delete;
  basic_domain& operator=(const basic_domain&) = delete;

  /// Reclaims, within @p limit, what nobody can see any more. Never waits.
  ///
  /// Destructors run on the calling thread, outside of any lock; they may retire, make and count objects, and
  /// call collect(), which does nothing then. One thread collects at a time. Objects that enter while a grace period
  /// is open wait for the next one. O(objects handled + types + mutators).
  collected collect(budget limit = {}) noexcept { return collect(limit, false); }

  /// Waits for a grace period: afterwards nobody holds a pointer that was borrowed through a reference
  /// which was unlinked before.
  [[nodiscard]] waited synchronize(
      std::chrono::nanoseconds timeout = std::chrono::nanoseconds::max()) noexcept {
    if (is_online() || is_collecting()) return waited::refused;
    const std::uint64_t target = state_->advance();
    return wait(timeout, [&] { return state_->behind(target) == nullptr; });
  }

  /// Collects until nothing waits any more, and waits for the grace periods that this takes.
  [[nodiscard]] waited drain(
      std::chrono::nanoseconds timeout = std::chrono::nanoseconds::max()) noexcept {
    if (is_online() || is_collecting()) return waited::refused;
    bool refused = false;
    const auto begin = clock::now();
    // A pass ends when a call has nothing left to do; only the call that begins it is thorough, or it would begin anew for ever what
    // takes a grace period. The first may only have ended what an earlier call began; the last reclaims nothing.
    bool begins = true;
    bool whole = false;
    std::size_t reclaimed = 0;
    const waited result = wait(timeout, [&] {
      for (;;) {
        budget left;
        left.time = timeout - std::min<std::chrono::nanoseconds>(timeout, clock::now() - begin);
        const collected did = collect(left, begins);
        refused = did.result == outcome::refused;
        begins = did.result == outcome::done;
        reclaimed += did.reclaimed;
        if (refused) return true;
        if (!begins) return false;
        if (whole && reclaimed == 0) return true;
        whole = true;
        reclaimed = 0;
      }
    });
    return refused ? waited::refused : result;
  }

  /// The numbers of now. Exact while no thread changes them. Throws std::bad_alloc. O(types + mutators).
  [[nodiscard]] domain_stats stats() const {
    domain_stats all;
    for (table* t = state_->tables(); t != nullptr; t = t->next) all.types.push_back(t->stats());
    const auto& collection = state_->collection;
    for (auto* r = state_->first_record(); r != nullptr; r = r->next) {
      if (!r->taken.load(std::memory_order_relaxed)) continue;            // (12)
      const std::uint64_t at = r->epoch.load(std::memory_order_relaxed);  // (12)
      mutator_stats m;
      m.name = r->name.load(std::memory_order_relaxed);  // (12)
      m.online = at != record::offline;
      m.delays = m.online && at < collection.open();
      all.mutators.push_back(m);
    }
    all.delayed = collection.delayed(*state_);
    all.grace_periods = collection.grace_periods();
    all.longest_collect = collection.longest();
    all.refused_collects = collection.refused();
    return all;
  }

  /// Whom reclamation waits for, and how much. Allocates nothing. O(types + mutators).
  [[nodiscard]] delay delayed() const noexcept { return state_->collection.delayed(*state_); }

  /// Calls @p hook in collect(), on its thread, whenever it ends because it waits for a mutator while more
  /// than @p limit objects wait. It must not throw. Not to be called while another thread collects.
  void on_backlog(std::uint64_t limit, void (*hook)(const delay&, void* context),
                  void* context = nullptr) noexcept {
    state_->collection.on_backlog(limit, hook, context);
  }

  /// Calls @p hooks in collect() from now on; null: nobody. They must outlive the domain, or be replaced before. Not to be called
  /// while another thread collects.
  void install(collector_hooks* hooks) noexcept { state_->collection.install(*state_, hooks); }

 private:
  using outcome = collected::outcome;
  using clock = runtime::clock_of<Env>;
  using table = runtime::table_base<Env>;
  using record = runtime::mutator_record<Env>;
  using participant = runtime::participant<Env>;
  using participants = runtime::participants<Env>;

  friend struct detail::domain_access;
  explicit basic_domain(runtime::domain_state<Env>& shared) noexcept : state_(&shared) {}

  collected collect(const budget& limit, bool thorough) noexcept {
    if (never_reclaims()) {
      SLAMGC_ASSERT(false, (misuse{"collects on a thread that never reclaims", "domain", this, 0}));
      state_->collection.refuse();
      return {outcome::refused, 0};
    }
    return state_->collection.collect(*state_, limit, thorough);
  }
  bool is_online() const noexcept {
    return participants::any_in(*state_, [](const participant& p) { return p.online; });
  }
  bool is_collecting() const noexcept {
    return participants::any_in(*state_, [](const participant& p) { return p.record == nullptr; });
  }
  static bool never_reclaims() noexcept {
    for (auto* p = participants::of_this_thread().innermost; p != nullptr; p = p->outer)
      if (p->never_reclaim && p->online) return true;
    return false;
  }

  template <class Condition>
  static waited wait(std::chrono::nanoseconds timeout, Condition condition) noexcept {
    constexpr std::chrono::nanoseconds longest_pause = std::chrono::milliseconds(1);
    constexpr std::chrono::nanoseconds step{100};
    const auto begin = clock::now();
    for (std::chrono::nanoseconds pause{0}; !condition(); pause += pause / 2 + step) {
      if (clock::now() - begin >= timeout) return waited::timed_out;
      if (pause > longest_pause) pause = longest_pause;
      clock::pause(pause);
    }
    return waited::done;
  }

  runtime::domain_state<Env>* const state_;
};

namespace detail {

struct domain_access {
  template <class Env>
  static runtime::domain_state<Env>& state_of(const basic_domain<Env>& domain) noexcept {
    return *domain.state_;
  }
  template <class Env>
  static basic_domain<Env>& shared() {
    static basic_domain<Env>& forever = *new basic_domain<Env>(runtime::default_state<Env>());
    return forever;
  }
};

}  // namespace detail

/// The domain of threads that have no mutator. Made on first use, never destroyed: the destructors of
/// static objects may use it. One per process, in shared libraries too, unless one of them is loaded by `dlopen`
/// with RTLD_LOCAL or linked with -Bsymbolic: those need a domain that is handed to them.
template <class Env>
[[nodiscard]] basic_domain<Env>& basic_default_domain() {
  return detail::domain_access::shared<Env>();
}
/// The default domain of ordinary programs.
[[nodiscard]] inline domain& default_domain() { return basic_default_domain<std_env>(); }

namespace detail {

/// The domain of the thread's innermost mutator, or the default one.
template <class Env>
runtime::domain_state<Env>& current_domain() {
  const auto* const me = runtime::participants<Env>::of_this_thread().innermost;
  return me != nullptr ? *me->domain : domain_access::state_of(basic_default_domain<Env>());
}

}  // namespace detail

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

namespace detail {

/// Where new objects of T on this thread belong, as it was found the last time.
template <class T>
struct current_place {
  using env = typename policy_of<T>::env;

  std::uint64_t key;  // of the thread's innermost part, and one more
  zero_count_table<T>* table;
  runtime::table_door<env>* door;

  /// Throws std::bad_alloc, the first time in a domain.
  static const current_place& get() {
    current_place& last = env::template thread_record<current_place>();
    const runtime::participants<env>& now = runtime::participants<env>::of_this_thread();
    if (__builtin_expect(last.key != now.current + 1, false)) last.find(now);
    return last;
  }

 private:
  __attribute__((noinline)) void find(const runtime::participants<env>& now) {
    table = &zero_count_table<T>::in(detail::current_domain<env>());
    runtime::participant<env>* ignored;
    door = &table->my_door(ignored);
    key = now.current + 1;
  }
};

/// The table of T in the domain of the thread's innermost part, if there are both: for who must not throw.
template <class T>
zero_count_table<T>* known_table() noexcept {
  const auto* const me =
      runtime::participants<typename policy_of<T>::env>::of_this_thread().innermost;
  return me != nullptr ? zero_count_table<T>::find(*me->domain) : nullptr;
}

/// Whether the calling thread may have borrowed from @p domain: it takes part there, or borrows nowhere.
template <class Env>
bool may_borrow_from(const runtime::domain_state<Env>& domain) noexcept {
  using all = runtime::participants<Env>;
  return all::borrower() == nullptr ||
         all::any_in(domain, [](const runtime::participant<Env>&) { return true; });
}

/// What both reclaimers do. `AtZero`: an object that was not retired is reclaimed, too.
template <bool AtZero>
struct deferred : deferred_base {
  static constexpr bool at_zero = AtZero;

  /// Removes a reference. An object that nobody refers to waits for a collector. Lock-free; never
  /// allocates, destroys or fails.
  template <class T>
  static void release(T* object) noexcept {
    using policy = policy_of<T>;
    auto& state = access::header_of(*object).state;
    std::uint64_t now = policy::load(state);
    while (state_word{now}.is_shared())  // the most frequent case, and short
      if (policy::compare_exchange(state, now, now - state_word::count_unit)) return;
    release_last(object, now);
  }

  /// The table of the object's type in the current domain. Throws std::bad_alloc, the first time.
  template <class T>
  static void* first_link() {
    const auto& here = current_place<T>::get();
    here.table->add(*here.door, &runtime::table_door<typename policy_of<T>::env>::created);
    return here.table;
  }
  /// The program itself deletes an object, which has to be in no table.
  template <class T>
  static void last_link(void* table) noexcept {
    using env = typename policy_of<T>::env;
    auto& mine = *static_cast<zero_count_table<T>*>(table);
    runtime::participant<env>* ignored;
    mine.add(mine.my_door(ignored), &runtime::table_door<env>::ended);
  }

  /// Nothing is destroyed while a count changes, so there is nothing to hold back.
  template <class T>
  struct scope {
    scope() noexcept {}  ///< Does nothing.
  };

 private:
  /// Removes what may be the last reference. @p now was the object's word.
  template <class T>
  __attribute__((noinline)) static void release_last(T* object, std::uint64_t now) noexcept {
    using policy = policy_of<T>;
    auto& state = access::header_of(*object).state;
    for (;;) {
      const state_word w{now};
      SLAMGC_ASSERT(w.count() != 0,
                    (misuse_of(object, "removes a reference that was never counted")));
      if (w.count() == 0 || w.is_saturated()) return;
      // Not afterwards: it may be gone then.
      if (w.count() == 1 && watch() != nullptr) watch()->falls_to_zero(object, type_name<T>::get());
      // The fall to zero and `queued` are one change. Between two, a collector could bring the object through
      // the table and free it, and this thread, if it is no mutator, would touch it afterwards.
      const bool enters = w.count() == 1 && !w.is_queued() && (AtZero || w.is_retired());
      const std::uint64_t then =
          now - state_word::count_unit + (enters ? state_word::queued_flag : 0);
      if (policy::compare_exchange(state, now, then)) {
        if (enters) zero_count_table<T>::of(*object)->push(object);
        return;
      }
    }
  }
};

}  // namespace detail

/// Reclaimer: an object whose count falls to zero is destroyed by a collector of its domain, once no
/// mutator can have a borrowed pointer to it, unless a reference was added meanwhile. So is an object
/// that was retired and that nobody refers to.
struct reclaim_deferred : detail::deferred<true> {};

/// Reclaimer: as reclaim_deferred, but only what was retired is destroyed (ORB-SLAM's `isBad`). An object
/// that nobody refers to and that was not retired stays.
///
/// With mutators, this is the retire set of the thesis (chapter 4.3): retire() puts the object into the set,
/// and collect() at the end of culling is the scan.
struct reclaim_retired : detail::deferred<false> {};

/// Declares *p dead: it is destroyed once its count is zero and no mutator can have a borrowed
/// pointer to it. Objects that were never counted, too. Returns false if it was retired before or is null,
/// and does nothing then.
///
/// By an online mutator of the object's domain, or by a thread that keeps a counted reference and is no mutator of
/// another domain only, which is reported unless the object waits already. (If it does, it counts in stats() as retired
/// in the domain of the calling thread's mutator, or not at all.) Lock-free; never allocates or destroys.
template <class T>
bool retire(T* p) noexcept {
  static_assert(detail::is_deferred<T>::value,
                "slamgc: only objects with a deferred reclaimer can be retired");
  using policy = detail::policy_of<T>;
  using env = typename policy::env;
  using object = detail::object_of<T>;
  if (p == nullptr) return false;
  auto* const target = const_cast<object*>(static_cast<const object*>(p));
  if (detail::was_reclaimed(target)) {
    SLAMGC_ASSERT(
        false, (misuse{"retires an object that was reclaimed", detail::type_name<T>::get(), p, 0}));
    return false;
  }
  auto& state = detail::access::header_of(*target).state;
  std::uint64_t now = policy::load(state);
  for (;;) {
    const state_word w{now};
    SLAMGC_ASSERT(!(w.is_retired() && detail::reports_double_retire()),
                  (detail::misuse_of(target, "retires an object that was retired before")));
    if (w.is_retired()) return false;
    // With described edges it is a candidate for trial deletion, whoever refers to it.
    const bool enters = !w.is_queued() && (w.count() == 0 || detail::has_edges<object>::value);
    // Of an object that is queued the link names no table. It is counted as one of the thread's domain, which is
    // its own unless the thread lives by a counted reference.
    auto* const table = w.is_queued() ? detail::known_table<object>()
                                      : detail::zero_count_table<object>::of(*target);
    const std::uint64_t then =
        now | state_word::retired_flag | (enters ? state_word::queued_flag : 0);
    if (!policy::compare_exchange(state, now, then)) continue;
    if (detail::watch() != nullptr)
      detail::watch()->retired(target, detail::type_name<object>::get());
    if (table == nullptr) return true;
    SLAMGC_ASSERT(detail::may_borrow_from(table->domain),
                  (misuse{"retires an object of another domain than the thread's",
                          detail::type_name<T>::get(), p, w.count()}));
    runtime::participant<env>* me;
    auto& door = table->my_door(me);
    table->add(door, &runtime::table_door<env>::retired);
    if (enters) table->push(target, door, me);
    return true;
  }
}

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/rc_slot.hpp ----
/// @file
/// The counted pointer for members: an edge of the graph.

// ---- slamgc/detail/counted_member.hpp ----
/// @file
/// What all counted members have in common: in the checked flavour, a watcher of the thread hears of each.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Hears where counted members begin and end on one thread: see diagnosis/check_description.hpp.
class member_watcher {
 public:
  virtual void made(void* member, const char* type) noexcept = 0;
  virtual void ended(const void* member) noexcept = 0;

  /// The calling thread's, or null.
  static member_watcher*& current() noexcept { return std_env::thread_record<place>().watcher; }

 protected:
  ~member_watcher() = default;

 private:
  struct place {
    member_watcher* watcher;
  };
};

/// Base class of counted members, without any size. @p Name is what reports call its type. In the unchecked flavour there is
/// nothing to it.
template <class Name>
class counted_member {
#if SLAMGC_DEBUG
 protected:
  constexpr counted_member() noexcept {
    if (__builtin_is_constant_evaluated()) return;  // a static object
    if (auto* const watcher = member_watcher::current())
      watcher->made(this, type_name<Name>::get());
  }
  ~counted_member() {
    if (auto* const watcher = member_watcher::current()) watcher->ended(this);
  }
  counted_member(const counted_member&) = delete;
  counted_member& operator=(const counted_member&) = delete;
#endif
};

/// Finds that base.
struct member_access {
  template <class Name>
  static const void* address(const counted_member<Name>& member) noexcept {
    return &member;
  }
  template <class Member>
  static const void* of(const Member& member) noexcept {
    return address(member);
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

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
class rc_slot : private detail::counted_member<rc_slot<T, Env>> {
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
  /// If it refers to @p expected: refers to @p p and returns true. Else nothing changes.
  bool compare_exchange(T* expected, T* p) noexcept {
    detail::add_reference(p);
    // (10) as replace(): a failure reads nothing that anybody uses.
    const bool done = p_.compare_exchange_strong(expected, p, std::memory_order_acq_rel,
                                                 std::memory_order_relaxed);  // (10)
    detail::drop_reference(done ? expected : p);
    return done;
  }
  /// For a function that takes a `T*&`, as an argument of its call: a plain pointer, which the slot refers to when this ends.
  class edit_scope {
   public:
    explicit edit_scope(rc_slot& slot) noexcept : slot_(slot), p_(slot.get()) {}  ///< See edit().
    ~edit_scope() { slot_ = p_; }                                                 ///< Stores it.
    edit_scope(const edit_scope&) = delete;
    edit_scope& operator=(const edit_scope&) = delete;
    operator T*&() noexcept { return p_; }  ///< The pointer.

   private:
    rc_slot& slot_;
    T* p_;
  };
  /// See edit_scope. What other threads store meanwhile is overwritten.
  [[nodiscard]] edit_scope edit() & noexcept { return edit_scope(*this); }
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
  friend struct detail::member_access;

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

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// A side block with room for the record. Does not depend on T until an object is buried.
template <class T, class Record, class Env>
class record_block final : public counted_block<Env> {
 public:
  using counted_block<Env>::counted_block;

  void bury() noexcept override {
    const auto* const owner = static_cast<const block_owner<T, Env>*>(this->owner());
    bury(const_cast<T&>(static_cast<const T&>(*owner)));
  }
  void bury(T& object) noexcept {
    record_.reset();  // of an earlier decision, which was vetoed
    record_.emplace(object.record());
  }
  /// Of a dead block.
  const Record& record() const noexcept { return *record_; }
  /// Of an object that nobody buried.
  void lose_record() noexcept { record_.emplace(); }

 private:
  std::optional<Record> record_;
};

}  // namespace detail

/// Base class of objects that leave a record, beside rc_object:
///
/// ```
/// class KeyFrame : public slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
///                  public slamgc::enable_anchor<KeyFrame, PoseRecord> {
///  public:
///   PoseRecord record() { return {mnId, mTcp, slamgc::anchor<KeyFrame, PoseRecord>(mpParent)}; }
/// ```
///
/// `record()` is called by a collector when nobody can see the object any more but by handles, before it and what dies with it loses an
/// edge; more than once, if somebody locks the object at the last moment. That thread may use the object at the same time, and so may
/// others if it expires while it is referred to (weak_rc): record() takes the program's locks of what they may change, as
/// edges() does. It must not throw, and should be quick. Weak handles to these objects work, too.
///
/// Adds one pointer; each object has a side block with room for the record, which is allocated with it, so that its end needs
/// no memory. A copy of an object has a block of its own; assignment leaves it alone.
///
/// A program that itself deletes an object to which there are anchors says bury() first, in the class's destructor at the
/// latest, and that no thread uses it then. If it does not, that is reported, and the record is `Record()`.
///
/// @tparam T      The class that derives from rc_object, with reclaim_deferred or reclaim_retired.
/// @tparam Record What `T::record()` returns; default constructible and movable. It may hold anchors, to a parent or a
///                predecessor, but not in a circle: records are counted, and nobody looks for cycles among them.
/// @tparam Env    The environment of T's counter policy.
template <class T, class Record, class Env>
class enable_anchor : public detail::block_owner<T, Env> {
 protected:
  /// Allocates the block. Throws std::bad_alloc.
  enable_anchor() : detail::block_owner<T, Env>(make_block()) {
    static_assert(detail::is_deferred<T>::value,
                  "slamgc: anchors need a deferred reclaimer: another thread could destroy the "
                  "object before it is read");
  }
  /// A copy is a new object.
  enable_anchor(const enable_anchor&) : enable_anchor() {}
  /// Anchors refer to the object, not to its value: nothing changes.
  enable_anchor& operator=(const enable_anchor&) noexcept { return *this; }
  /// Reports if anchors are left and there is no record.
  ~enable_anchor() {
    block& mine = my_block();
    if (mine.is_dead()) return;
    SLAMGC_ASSERT(mine.use_count() == 1,
                  (misuse{"deletes an object that anchors refer to, without bury()",
                          detail::type_name<T>::get(), this, mine.use_count() - 1}));
    mine.lose_record();
  }

  /// For an object that the program itself deletes: makes its record now, and lets its handles expire. Nothing
  /// happens if it has one already.
  void bury() noexcept {
    block& mine = my_block();
    if (mine.is_dead()) return;
    mine.bury(static_cast<T&>(*this));
    mine.expire();
  }

 private:
  using block = detail::record_block<T, Record, Env>;
  friend class anchor<T, Record, Env>;

  intrusive_rc<detail::counted_block<Env>> make_block() const {
    return intrusive_rc<detail::counted_block<Env>>(
        new block(static_cast<const detail::block_owner<T, Env>*>(this)));
  }
  block& my_block() const noexcept { return static_cast<block&>(*this->slamgc_block()); }
};

/// Refers to an object without keeping it, and to the record that it leaves when it is reclaimed.
///
/// Whoever reads it gets one of the two. The records of objects that die together are all there before one of them loses
/// an edge, and records may hold anchors themselves: a chain of them keeps each hop, in whatever order the objects go.
/// `sizeof(anchor<T, Record>) == sizeof(T*)`. For expiry see weak_rc.
///
/// Thread-safety: as `std::shared_ptr`: different anchors by any threads at any time; one that somebody changes needs the
/// program's lock. A record does not change. All operations are lock-free and O(1).
template <class T, class Record, class Env>
class anchor {
 public:
  using element_type = T;      ///< What it refers to.
  using record_type = Record;  ///< What is left of it.

  /// Null: refers to nothing.
  constexpr anchor() noexcept = default;
  /// Null: refers to nothing.
  constexpr anchor(std::nullptr_t) noexcept {}
  /// Refers to @p p. By an online mutator of the object's domain, or who holds a counted reference.
  explicit anchor(T* p) noexcept
      : block_(p != nullptr ? detail::owner_of<Env>(*p).slamgc_block() : nullptr) {
    static_assert(
        std::is_base_of<enable_anchor<T, Record, Env>, T>::value,
        "slamgc: an anchor<T, Record> refers to a T that derives from enable_anchor<T, Record>");
  }
  /// Refers to the same object.
  anchor(const intrusive_rc<T>& p) noexcept : anchor(p.get()) {}
  /// Refers to the same object.
  anchor(const rc_slot<T, Env>& p) noexcept : anchor(p.get()) {}

  /// Whether it refers to an object or a record.
  [[nodiscard]] explicit operator bool() const noexcept { return block_ != nullptr; }

  /// Calls `on_object(T&)`, and keeps the object meanwhile; or `on_record(const Record&)`, if the object has expired.
  /// Returns what they return. On an online mutator of the object's domain. Not of a null anchor.
  template <class OnObject, class OnRecord>
  std::common_type_t<std::invoke_result_t<OnObject, T&>,
                     std::invoke_result_t<OnRecord, const Record&>>
  read(OnObject&& on_object, OnRecord&& on_record) const {
    SLAMGC_ASSERT(block_ != nullptr,
                  (misuse{"reads a null anchor", detail::type_name<T>::get(), nullptr, 0}));
    if (const intrusive_rc<T> object = lock()) return std::forward<OnObject>(on_object)(*object);
    return std::forward<OnRecord>(on_record)(my_block().record());
  }
  /// A reference to the object, or null if it has expired. On an online mutator of the object's domain.
  [[nodiscard]] intrusive_rc<T> lock() const noexcept {
    SLAMGC_ASSERT(block_ == nullptr || runtime::participants<Env>::borrower() != nullptr,
                  (misuse{"reads an anchor on a thread that is no online mutator",
                          detail::type_name<T>::get(), block_.get(), 0}));
    if (block_ == nullptr) return nullptr;
    return intrusive_rc<T>(detail::lock<T>(*block_), false);
  }
  /// The record, or null while the object has not expired. Valid as long as an anchor to it exists. By any thread.
  [[nodiscard]] const Record* record() const noexcept {
    return block_ != nullptr && block_->is_dead() ? &my_block().record() : nullptr;
  }

  /// Becomes null.
  void reset() noexcept { block_.reset(); }
  /// Exchanges two anchors.
  void swap(anchor& other) noexcept { block_.swap(other.block_); }

  /// Whether both refer to the same object, dead or alive, or both are null.
  [[nodiscard]] friend bool operator==(const anchor& a, const anchor& b) noexcept {
    return a.block_ == b.block_;
  }
  /// Whether they refer to different objects.
  [[nodiscard]] friend bool operator!=(const anchor& a, const anchor& b) noexcept {
    return a.block_ != b.block_;
  }

 private:
  const detail::record_block<T, Record, Env>& my_block() const noexcept {
    return static_cast<const detail::record_block<T, Record, Env>&>(*block_);
  }

  intrusive_rc<detail::counted_block<Env>> block_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/atomic_rc.hpp ----
/// @file
/// A counted member that hands out references of the reader's own.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Like rc_slot, plus load(), which returns a counted reference, and compare-and-exchange: what
/// `std::atomic<std::shared_ptr<T>>` is, without a lock.
///
/// Only for objects with a deferred reclaimer, and load() and compare-and-exchange only on online mutators
/// of the object's domain: that the pointer read is still an object when it is counted, is what the grace
/// period is for. (A counted load by a plain load and an increment; the price elsewhere is a hazard pointer
/// or a lock.)
///
/// Thread-safety: any thread at any time. All operations are lock-free and O(1).
template <class T, class Env>
class atomic_rc : private detail::counted_member<atomic_rc<T, Env>> {
 public:
  using value_type = intrusive_rc<T>;  ///< What load() returns.

  /// Null.
  constexpr atomic_rc() noexcept = default;
  /// Takes over the reference of @p p.
  explicit atomic_rc(intrusive_rc<T> p) noexcept : p_(moved(p.detach())) {}
  /// Removes the reference.
  ~atomic_rc() { store(nullptr); }
  atomic_rc(const atomic_rc&) = delete;
  atomic_rc& operator=(const atomic_rc&) = delete;

  /// A reference to what it refers to now. On an online mutator.
  [[nodiscard]] intrusive_rc<T> load() const noexcept {
    check_borrower();
    return intrusive_rc<T>(get());
  }
  /// The pointer: borrowed.
  [[nodiscard]] T* get() const noexcept {
    return p_.load(std::memory_order_acquire);  // (23) sees the object that (24) published.
  }
  /// Takes over the reference of @p p.
  void store(intrusive_rc<T> p) noexcept { (void)exchange(std::move(p)); }
  /// Takes over the reference of @p p.
  atomic_rc& operator=(intrusive_rc<T> p) noexcept {
    store(std::move(p));
    return *this;
  }
  /// Takes over the reference of @p p and returns the old one.
  [[nodiscard]] intrusive_rc<T> exchange(intrusive_rc<T> p) noexcept {
    // (24) as rc_slot's exchange (10).
    return adopted(p_.exchange(moved(p.detach()), std::memory_order_acq_rel));
  }
  /// If it refers to @p expected: takes over the reference of @p desired and returns true. Else writes what
  /// it refers to, borrowed, into @p expected, and drops @p desired. On an online mutator.
  bool compare_exchange_strong(T*& expected, intrusive_rc<T> desired) noexcept {
    return compare_exchange(expected, std::move(desired), [this](T*& e, T* d) {
      return p_.compare_exchange_strong(e, d, std::memory_order_acq_rel,  // (24)
                                        std::memory_order_acquire);       // (23)
    });
  }
  /// The same, but it may fail although it refers to @p expected: for loops.
  bool compare_exchange_weak(T*& expected, intrusive_rc<T> desired) noexcept {
    return compare_exchange(expected, std::move(desired), [this](T*& e, T* d) {
      return p_.compare_exchange_weak(e, d, std::memory_order_acq_rel,  // (24)
                                      std::memory_order_acquire);       // (23)
    });
  }

 private:
  friend struct detail::member_access;

  template <class Exchange>
  static bool compare_exchange(T*& expected, intrusive_rc<T> desired, Exchange exchange) noexcept {
    check_borrower();
    T* const old = expected;
    if (!exchange(expected, moved(desired.get()))) return false;
    (void)desired.detach();
    (void)adopted(old);
    return true;
  }
  static T* moved(T* p) noexcept {
    detail::move_reference(p);
    return p;
  }
  static intrusive_rc<T> adopted(T* p) noexcept { return intrusive_rc<T>(moved(p), false); }
  static void check_borrower() noexcept {
    static_assert(
        detail::is_deferred<T>::value,
        "slamgc: what an atomic_rc refers to needs a deferred reclaimer: another thread could "
        "destroy it before load() has counted it");
    SLAMGC_ASSERT(runtime::participants<Env>::borrower() != nullptr,
                  (misuse{"reads an atomic_rc on a thread that is no online mutator",
                          detail::type_name<T>::get(), nullptr, 0}));
  }

  typename Env::template atomic<T*> p_{nullptr};
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/borrow.hpp ----
/// @file
/// A borrowed pointer that checks itself.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A local `T*` that says that it is borrowed: `slamgc::borrow<KeyFrame> pKF = mpReferenceKF;`.
///
/// In the checked flavour each use checks that the thread is an online mutator, the same as when the pointer
/// was borrowed, and that it has passed no quiescent state since. (Destructors that a collector runs may borrow, too.) On a
/// thread with several mutators that is the innermost online one, whatever the object's domain. In the unchecked flavour it is a pointer and
/// nothing else. For locals and parameters only: it is larger in the checked flavour.
///
/// Thread-safety: it belongs to the thread that made it. Every use is O(mutators of the thread).
template <class T, class Env>
class borrow {
 public:
  using element_type = T;  ///< What it points to.

  /// Borrows @p p now; null may be borrowed by any thread.
  borrow(T* p = nullptr) noexcept : p_(p) {
#if SLAMGC_DEBUG
    const auto* me = runtime::participants<Env>::borrower();
    SLAMGC_ASSERT(p == nullptr || me != nullptr,
                  (misuse{"borrows on a thread that is no online mutator",
                          detail::type_name<T>::get(), p, 0}));
    passed_ = me != nullptr ? me->passed : 0;
    if (auto* const watch = detail::watch()) {
      SLAMGC_ASSERT(!watch->holds(p), (misuse{"borrows an object that was reclaimed",
                                              detail::type_name<T>::get(), p, 0}));
      place_ = watch->here();
    }
#endif
  }
  /// Borrows what @p from, a slot or an element of a container, refers to now.
  template <class U, class = std::enable_if_t<std::is_convertible<const U&, T*>::value &&
                                              !std::is_same<U, borrow>::value>>
  borrow(const U& from) noexcept : borrow(static_cast<T*>(from)) {}
  /// Copies borrow what the original borrowed, since then.
  borrow(const borrow&) noexcept = default;
  /// Copies borrow what the original borrowed, since then.
  borrow& operator=(const borrow&) noexcept = default;

  /// The pointer.
  [[nodiscard]] T* get() const noexcept {
    check();
    return p_;
  }
  /// The pointer.
  operator T*() const noexcept { return get(); }
  /// The object.
  T& operator*() const noexcept { return *get(); }
  /// The object.
  T* operator->() const noexcept { return get(); }

 private:
#if SLAMGC_DEBUG
  void check() const noexcept {
    if (p_ == nullptr) return;
    const auto* me = runtime::participants<Env>::of_this_thread().innermost;
    while (me != nullptr && !(me->may_borrow() && me->passed == passed_)) me = me->outer;
    SLAMGC_ASSERT(me != nullptr, (misuse{"uses a borrowed pointer after a quiescent state",
                                         detail::type_name<T>::get(), p_, 0, place_}));
  }
  std::uint64_t passed_;
  std::uint32_t place_ = 0;  // in the program, for reports
#else
  void check() const noexcept {}
#endif
  T* p_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/containers/rc_list.hpp ----
/// @file
/// A list of counted references.

#include <initializer_list>
#include <list>

// ---- slamgc/detail/counted_container.hpp ----
/// @file
/// What all counted containers share: reading, and the ways in which counts follow a change.

// ---- slamgc/detail/edit_scope.hpp ----
/// @file
/// Editing the plain container inside a counted one.

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

template <class Std, class = void>
struct is_contiguous : std::false_type {};
template <class Std>
struct is_contiguous<Std, std::void_t<decltype(std::declval<Std&>().data())>> : std::true_type {};

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
class counted_container : private counted_member<Std> {
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
  counted_container(const counted_container& other) : counted_member<Std>(), std_(other.std_) {
    add_all();
  }
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
  /// Removes all references, a sequence's last one first, and keeps the capacity. One by one, since moving the whole away would copy
  /// a comparator, which may throw. A vector's places become null first: pop_back() would write its end for each.
  void clear_content() noexcept {
    if (std_.empty()) return;
    const counted_scope<T> until_final;
    if constexpr (is_contiguous<Std>::value) {
      for (auto at = std_.rbegin(); at != std_.rend(); ++at)
        detail::drop_reference(std::exchange(*at, nullptr));
      std_.clear();
    } else {
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

  friend struct container_access;
  friend struct member_access;
  Std std_;
};

/// For registries, which take the content out without touching each reference.
struct container_access {
  template <class T, class Std, class Reference, class Iterator>
  static Std& content_of(counted_container<T, Std, Reference, Iterator>& c) noexcept {
    return c.std_;
  }
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
/// allocation throws, nothing has changed. What is assigned may not be a member of an object that this vector alone keeps, unless
/// the thread is a mutator of the object's domain.
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
  /// Removes the elements for which @p gone(p) holds; the others keep their order. Calls it once for each element, in
  /// order. Returns how many were removed. O(size).
  template <class Predicate>
  size_type remove_if(Predicate gone) {
    const detail::counted_scope<T> until_final;
    size_type kept = 0;
    for (size_type i = 0; i != std_.size(); ++i) {
      if (gone(std_[i])) continue;
      if (kept != i) std::swap(std_[kept], std_[i]);
      ++kept;
    }
    const size_type removed = std_.size() - kept;
    while (std_.size() != kept) pop_back();
    return removed;
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
  /// Calls @p f with each of the first @p n places that is to change, and with what comes there.
  template <class F>
  void for_each_change(size_type n, const std_vector& content, F f) noexcept {
    constexpr size_type block = 32;
    T** const to = std_.data();
    T* const* const from = content.data();
    for (size_type i = 0; i != n;) {
      const size_type end = n - i < block ? n : i + block;
      // As most of a local map from one frame to the next.
      if (std::equal(to + i, to + end, from + i)) {
        i = end;
        continue;
      }
      for (; i != end; ++i)
        if (to[i] != from[i]) f(to[i], from[i]);
    }
  }
  /// In place where the capacity suffices: no allocation, and no count for what stays. What comes is
  /// counted before anything is uncounted: the same object may go here and come there.
  void assign_pointers(const std_vector& content) {
    if (&content == &std_) return;
    std_.reserve(content.size());
    // Not read again once references go: unless the thread is a mutator, that may be the end of who owns the content.
    const size_type size = content.size(), common = std_.size() < size ? std_.size() : size;
    // What goes waits here, so that one pass finds all changes; of more than these a second one finds the rest.
    constexpr size_type room = 256;
    T* gone[room];
    size_type n = 0;
    for_each_change(common, content, [&](T*& place, T* comes) {
      detail::add_reference(comes);
      if (n != room) gone[n++] = std::exchange(place, comes);
    });
    std_.insert(std_.end(), content.begin() + static_cast<std::ptrdiff_t>(common), content.end());
    add_from(common, size - common);
    const detail::counted_scope<T> until_final;
    for (size_type i = 0; i != n; ++i) detail::drop_reference(gone[i]);
    if (n == room)
      for_each_change(common, content, [](T*& place, T* comes) {
        detail::drop_reference(std::exchange(place, comes));
      });
    erase(std_.begin() + static_cast<std::ptrdiff_t>(size), std_.end());
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/edges.hpp ----
/// @file
/// Describing the edges of an object: what a collector needs to know to find cycles.
///
/// ```
/// struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
///   template <class Visitor>
///   void edges(Visitor& v) {
///     {
///       const std::lock_guard<std::mutex> lock(mMutexFeatures);
///       v.edge("mvpMapPoints", mvpMapPoints, slamgc::on_retire::null);
///     }
///     const std::lock_guard<std::mutex> lock(mMutexConnections);
///     v.edge("mpParent", mpParent);
///     for (auto& list : mvGrid) v.edge("mvGrid", list);
///   }
/// ```
///
/// One function per type names each counted member once. It takes the program's own locks, since other threads may
/// change the members meanwhile; it may be called on any thread that collects, at any time while the object exists; it
/// must not change, count or destroy anything itself. It should not throw: while it does, the object and what it refers to
/// live on. Edges do not lead into another domain. collect() must not be called under a lock that an edges() takes. A member
/// that is left out, or named twice, makes objects live on that nobody needs; it never makes one die too early.
///
/// The third argument is what becomes of the edge when its target is retired (dispositions.hpp); what is not an object but
/// holds counted references describes them in the same way (root.hpp).

// ---- slamgc/mutator.hpp ----
/// @file
/// Threads that hold borrowed pointers.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// How a mutator registers.
struct mutator_options {
  bool online = true;          ///< Begins online; else with its first online_scope.
  bool never_reclaim = false;  ///< Real-time thread: collect() is refused while it is online.
  /// Used by several threads, one after the other, each with an online_scope of its own; between them it is offline.
  bool roaming = false;
};

/// Registers the calling thread with a domain, for as long as it exists.
///
/// While it is online the thread may hold borrowed pointers: what it read from slots and containers stays
/// valid until its next quiescent(). It must call that regularly, at a point where it holds none, such as
/// the end of its loop; or go offline. Its end, by an exception too, delays nobody and loses nothing.
///
/// Made, used and destroyed by one thread, unless it is roaming. A thread may have several, also of different domains. Registering is
/// O(records ever in use at once); everything else is O(1), plus one compare-and-swap for each type of which objects entered the
/// table since the last quiescent state.
template <class Env>
class basic_mutator {
 public:
  using options = mutator_options;  ///< How it registers.

  /// Registers with @p to. @p name is shown in reports; it has to stay valid, as a string literal does.
  /// Throws std::bad_alloc.
  basic_mutator(basic_domain<Env>& to, const char* name, options how = {})
      : record_(detail::domain_access::state_of(to).enter(name != nullptr ? name : "")),
        me_{nullptr,          &detail::domain_access::state_of(to), &record_, record_.door, false,
            how.never_reclaim},
        roaming_(how.roaming),
        taking_part_(me_, !how.roaming) {
    SLAMGC_ASSERT(!(how.roaming && how.online),
                  (misuse{"makes a roaming mutator that is online", "mutator", this, 0}));
    me_.domain->retain();
    if (how.online && !roaming_) go_online();
  }
  /// Registers with default_domain().
  explicit basic_mutator(const char* name, options how = {})
      : basic_mutator(basic_default_domain<Env>(), name, how) {}
  /// The thread holds no borrowed pointer any more.
  ~basic_mutator() {
    SLAMGC_ASSERT(((roaming_ && !me_.online) || is_of_this_thread()),
                  (misuse{"ends a mutator on another thread than its own", "mutator", this, 0}));
    if (me_.online) go_offline();
    while (me_.roots != nullptr) me_.roots->leave();
    me_.domain->leave(record_);
    me_.domain->release();
  }
  basic_mutator(const basic_mutator&) = delete;
  basic_mutator& operator=(const basic_mutator&) = delete;

  /// The thread holds no borrowed pointer now. A few loads and stores of its own memory in the common case, and one
  /// that others see when a grace period has begun since the last call. Ignored while offline.
  void quiescent() noexcept {
    SLAMGC_ASSERT(me_.online, (misuse{"is quiescent while offline", "mutator", this, 0}));
    if (!me_.online) return;
    me_.publish();
    const bool first_since_a_grace_period_began = me_.domain->quiescent(record_);
    gave_up_borrowed();
    if (first_since_a_grace_period_began && me_.roots != nullptr) me_.join_purge();
  }
  /// Whether the thread may hold borrowed pointers now.
  [[nodiscard]] bool is_online() const noexcept { return me_.online; }

  /// The thread holds no borrowed pointer while this exists: for waits, sleeps, and long computations on
  /// pinned objects.
  class offline_scope {
   public:
    /// Goes offline, if it is not.
    explicit offline_scope(basic_mutator& m) noexcept : mutator_(m), was_online_(m.is_online()) {
      if (was_online_) m.go_offline();
    }
    /// Goes online again, if it was.
    ~offline_scope() {
      if (was_online_) mutator_.go_online();
    }
    offline_scope(const offline_scope&) = delete;
    offline_scope& operator=(const offline_scope&) = delete;

   private:
    basic_mutator& mutator_;
    const bool was_online_;
  };
  /// The thread may hold borrowed pointers while this exists: for a thread that belongs to the caller and
  /// is offline in between, one scope per frame.
  class online_scope {
   public:
    /// Goes online, if it is not.
    explicit online_scope(basic_mutator& m) noexcept : mutator_(m), was_online_(m.is_online()) {
      SLAMGC_ASSERT(!was_online_ || m.is_of_this_thread(),
                    (misuse{"uses a mutator on two threads", "mutator", &m, 0}));
      if (!was_online_) m.go_online();
    }
    /// Goes offline again, if it was.
    ~online_scope() {
      if (!was_online_) mutator_.go_offline();
    }
    online_scope(const online_scope&) = delete;
    online_scope& operator=(const online_scope&) = delete;

   private:
    basic_mutator& mutator_;
    const bool was_online_;
  };

 private:
  friend struct detail::mutator_access;

  bool is_of_this_thread() const noexcept {
    return runtime::participants<Env>::any_in(
        *me_.domain, [this](const runtime::participant<Env>& p) { return &p == &me_; });
  }
  void go_online() noexcept {
    if (roaming_) taking_part_.begin();
    me_.domain->go_online(record_);
    me_.online = true;
    gave_up_borrowed();
    if (me_.roots != nullptr) me_.join_purge();  // one that it has missed
  }
  void go_offline() noexcept {
    if (me_.roots != nullptr) me_.join_purge();
    me_.online = false;
    me_.publish();
    me_.domain->go_offline(record_);
    if (roaming_) taking_part_.end();
  }
  /// Only the checks of borrow.hpp want to know.
  void gave_up_borrowed() noexcept {
#if SLAMGC_DEBUG
    me_.pass_quiescent_state();
#endif
  }

  runtime::mutator_record<Env>& record_;
  runtime::participant<Env> me_;
  const bool roaming_;
  runtime::participation<Env> taking_part_;
};

namespace detail {

struct mutator_access {
  template <class Env>
  static runtime::participant<Env>& part_of(basic_mutator<Env>& m) noexcept {
    return m.me_;
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/pin.hpp ----
/// @file
/// Counting what a slow reader needs, so that it can go offline.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Keeps one object. A mutator that needs few objects for a long time pins them, goes offline, and delays
/// nobody.
template <class T>
using pin = intrusive_rc<T>;

/// Keeps a set of objects:
///
/// ```
/// const slamgc::pin_set<KeyFrame> keyframes = pMap->GetAllKeyFrames();
/// const slamgc::mutator::offline_scope offline(mutator);
/// optimise(keyframes);  // ten seconds; whatever is culled meanwhile is reclaimed, but for these
/// ```
template <class T>
using pin_set = rc_vector<T>;

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/registry.hpp ----
/// @file
/// Registries: containers that own the life of what they hold, and the death of a whole map.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// What a registry held when it was cleared: the collector retires and drops it, one by one.
template <class T, class Std, class Reference>
class dropped_content final : public runtime::dropped_base<typename policy_of<T>::env> {
 public:
  explicit dropped_content(Std&& content) noexcept : content_(std::move(content)) {}

  bool drop(runtime::work_limit<typename policy_of<T>::env>& limit) noexcept override {
    while (!content_.empty()) {
      T* gone;
      if constexpr (ends_with_pop_back<Std>::value) {
        gone = Reference()(content_.back());
        content_.pop_back();
      } else {
        gone = Reference()(*content_.begin());
        content_.erase(content_.begin());
      }
      slamgc::retire(gone);
      detail::drop_reference(gone);
      if (!limit.spend()) return false;
    }
    return true;
  }

 private:
  Std content_;
};

}  // namespace detail

/// A counted container that owns the life of its objects: what it holds when it is cleared or destroyed is retired.
/// `registry<rc_set<KeyFrame>>` in the place of ORB-SLAM3's `Map::mspKeyFrames` makes of `Map::clear`, which forgets a whole
/// map, the death of that map.
///
/// clear() and the destructor take O(1), whatever the size: they hand the container over to the domain, whose collectors retire
/// and drop its objects in slices. (If there is no memory for that, if moving the container could throw, or if its allocator has
/// a state, it is done at once, object by object.) Until then the references stay counted. Taking single objects out, by erase() and the like, retires
/// nothing. Not copied, assigned or moved as a whole.
///
/// Belongs to the domain that it is given, or that is current on the thread that makes it, as objects do. It has to be that of
/// its objects: what a registry of another domain held when it was cleared is reclaimed only after that domain has been collected.
/// Thread-safety and costs: otherwise those of @p Container.
template <class Container, class Env>
class registry : public Container {
 public:
  using Container::Container;
  /// Empty. Throws std::bad_alloc.
  registry() = default;
  /// Empty, of the domain @p of. Throws std::bad_alloc.
  explicit registry(basic_domain<Env>& of)
      : state_(retained(detail::domain_access::state_of(of))) {}
  registry(const registry&) = delete;
  registry& operator=(const registry&) = delete;
  /// Retires what it holds. O(1).
  ~registry() {
    clear();
    state_.release();
  }

  /// Retires what it holds, and becomes empty. O(1).
  void clear() noexcept {
    using content = typename Container::std_type;
    using to_pointer = typename detail::edge_container<Container>::reference;
    using object =
        std::remove_pointer_t<decltype(to_pointer()(*std::declval<const content&>().begin()))>;
    static_assert(detail::is_deferred<object>::value,
                  "slamgc: what a registry holds needs a deferred reclaimer");
    content& mine = detail::container_access::content_of(*this);
    if (mine.empty()) return;
    // What an allocator with a state refers to may end with the registry.
    if constexpr (std::is_nothrow_move_constructible<content>::value &&
                  std::allocator_traits<
                      typename Container::allocator_type>::is_always_equal::value) {
      using batch = detail::dropped_content<object, content, to_pointer>;
      if (auto* const dropped = new (std::nothrow) batch(std::move(mine))) {
        mine.clear();
        state_.collection.drop(*dropped);
        return;
      }
    }
    retire_all();
    Container::clear();
  }

 private:
  friend struct detail::edge_member<registry>;

  void retire_all() noexcept {
    detail::edge_container<Container>::each(*this, [](auto* p) { slamgc::retire(p); });
  }
  static runtime::domain_state<Env>& retained(runtime::domain_state<Env>& state) noexcept {
    state.retain();
    return state;
  }

  runtime::domain_state<Env>& state_ = retained(detail::current_domain<Env>());
};

/// Retires all that these registries hold: the death of a whole map. O(registries).
template <class... Registries>
void drop_map(Registries&... registries) noexcept {
  (..., registries.clear());
}

namespace detail {

template <class Container, class Env>
struct edge_member<registry<Container, Env>> : edge_member<Container> {
  /// At once: what else dies with it must not be referred to from elsewhere.
  static void sever(registry<Container, Env>& member) noexcept {
    member.retire_all();
    edge_member<Container>::sever(member);
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/retire_set.hpp ----
/// @file
/// The thesis's collector: a set of dead objects that is scanned.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Reclaimer: counts, and destroys nothing. Objects go through a retire_set.
struct reclaim_by_scan {
  /// Removes a reference.
  template <class T>
  static void release(T* object) noexcept {
    (void)uncount_reference(object);
  }
  /// New objects are linked to nothing.
  template <class T>
  static void* first_link() noexcept {
    return nullptr;
  }
  /// Nothing is to be done for an object that the program deletes; one that is in a set is reported.
  template <class T>
  static void last_link(void*) noexcept {}
  /// Nothing is destroyed while a count changes.
  template <class T>
  struct scope {
    scope() noexcept {}  ///< Does nothing.
  };
};

/// Objects that the program declared dead, until a scan finds their count at zero (thesis, chapter 4.3).
///
/// It knows of no mutators, so **every pointer that a thread uses has to be counted, and counted under the
/// lock of the slot it was read from** (scoped_count); and every container has to be counted. Then a zero
/// count means that no slot holds the pointer and no thread can get it. With one uncounted local it does not:
///
///     mapping                              tracking
///     pMP = pKF->mvpMapPoints[3]  (count 1)
///                                          pMP->SetBadFlag(): leaves all slots  (count 0)
///                                          retire_set.insert(pMP); scan()       destroyed
///     pMP->GetWorldPos()                   <- use after free
///
/// For raw locals use reclaim_retired with mutators.
///
/// Thread-safety: all operations by any thread at any time. insert() is lock-free; none allocates.
template <class T>
class retire_set {
 public:
  /// Empty.
  retire_set() noexcept = default;
  /// Scans once more; what is still counted is left alone: it is the program's again.
  ~retire_set() {
    (void)scan();
    // (25) acquire: sees the links that push() wrote.
    T* left = first_.exchange(nullptr, std::memory_order_acquire);
    while (left != nullptr) {
      auto& header = detail::access::header_of(*left);
      left = static_cast<T*>(header.link.load(std::memory_order_relaxed));  // (25)
      std::uint64_t now = policy::load(header.state);
      while (!policy::compare_exchange(header.state, now, now & ~state_word::queued_flag)) {
      }
    }
  }
  retire_set(const retire_set&) = delete;
  retire_set& operator=(const retire_set&) = delete;

  /// Declares *object dead. Returns false if it was dead already, since it is in a set once, or is null. O(1).
  bool insert(T* object) noexcept {
    static_assert(std::is_same<detail::reclaimer_of<T>, reclaim_by_scan>::value,
                  "slamgc: objects of a retire_set need the reclaimer reclaim_by_scan");
    if (object == nullptr) return false;
    auto& state = detail::access::header_of(*object).state;
    std::uint64_t now = policy::load(state);
    do {
      if (state_word{now}.is_retired()) return false;
    } while (!policy::compare_exchange(state, now,
                                       now | state_word::retired_flag | state_word::queued_flag));
    if (detail::watch() != nullptr) detail::watch()->retired(object, detail::type_name<T>::get());
    push(object);
    return true;
  }

  /// Destroys the objects in the set whose count is zero; returns how many. Destructors run on this
  /// thread, outside of any lock, and may insert. O(size).
  std::size_t scan() noexcept {
    std::size_t destroyed = 0;
    // (25) acquire: sees the links that push() wrote.
    T* object = first_.exchange(nullptr, std::memory_order_acquire);
    while (object != nullptr) {
      auto& header = detail::access::header_of(*object);
      T* const next = static_cast<T*>(header.link.load(std::memory_order_relaxed));  // (25)
      if (state_word{policy::load(header.state)}.count() == 0) {
        destroy_object(object);
        ++destroyed;
      } else {
        push(object);
      }
      object = next;
    }
    return destroyed;
  }

  /// Whether no object waits; another thread may change it at once.
  [[nodiscard]] bool empty() const noexcept {
    return first_.load(std::memory_order_relaxed) == nullptr;  // (25) nothing is read through it.
  }

 private:
  using policy = detail::policy_of<T>;

  void push(T* object) noexcept {
    auto& link = detail::access::header_of(*object).link;
    T* below = first_.load(std::memory_order_relaxed);  // (25)
    do {
      link.store(below, std::memory_order_relaxed);  // (25)
      // (25) release: publishes the links to scan().
    } while (!first_.compare_exchange_weak(below, object, std::memory_order_release,
                                           std::memory_order_relaxed));  // (25)
  }

  typename policy::env::template atomic<T*> first_{nullptr};
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
// ---- slamgc/root.hpp ----
/// @file
/// Roots: where references from outside the graph are, for those who look for stale edges and for reports.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Tells a domain of a part of the program that keeps counted references: a registry, a queue, the members of a thread.
///
/// ```
/// struct Map {
///   template <class Visitor>
///   void edges(Visitor& v) {
///     const std::lock_guard<std::mutex> lock(mMutexMap);
///     v.edge("mspKeyFrames", mspKeyFrames, slamgc::on_retire::erase);
///   }
///   std::mutex mMutexMap;
///   slamgc::rc_set<KeyFrame> mspKeyFrames;
///   slamgc::root root_{"Map", *this};  // last: ends first
/// };
/// ```
///
/// The part describes its references as an object does its edges (edges.hpp). Purges start here: what no path of described edges
/// leads to from a root is not purged of stale edges. Nothing else depends on roots: what they refer to is counted.
///
/// Thread-safety: made and ended by any thread at any time. Without an owner, edges() is called by whichever thread collects, and
/// takes the program's locks; the root's end waits for such a call, so it must not come under one of these locks. With an
/// owner, edges() is called by the owner's thread alone, at its quiescent states and when it goes offline or online, and needs no lock;
/// the root is made and ended by that thread. Made in O(roots ever at once).
template <class Env>
class basic_root {
 public:
  /// A root of @p of. @p described has `template <class V> void edges(V&)` and stays where it is; @p name
  /// stays valid, as a string literal does. Throws std::bad_alloc.
  template <class Described>
  basic_root(basic_domain<Env>& of, const char* name, Described& described)
      : state_(detail::domain_access::state_of(of)), place_(state_.collection.roots().take()) {
    put(name, described);
  }
  /// A root of the domain that is current on the calling thread: where the objects that it makes belong.
  template <class Described>
  basic_root(const char* name, Described& described)
      : state_(detail::current_domain<Env>()), place_(state_.collection.roots().take()) {
    put(name, described);
  }
  /// A root of @p owner's domain that only the owner's thread touches.
  template <class Described>
  basic_root(basic_mutator<Env>& owner, const char* name, Described& described)
      : state_(*detail::mutator_access::part_of(owner).domain),
        place_(state_.collection.roots().take()) {
    place_.join(detail::mutator_access::part_of(owner));
    put(name, described);
  }
  /// Waits while a collector is in edges().
  ~basic_root() {
    place_.leave();
    runtime::root_list<Env>::remove(place_);
    state_.release();
  }
  /// Asks the domain's collections to find, among the objects that this root refers to, those that nothing else needs:
  /// referred to by this root, by one another, and by other roots for which the same was asked, and by nobody else. They are
  /// *retired*; so a purge takes them out of the root, if its description says so, and they are reclaimed.
  ///
  /// For a registry that lists all objects of a graph: a safety net for what the program dropped and forgot to retire. (Not
  /// for one that is the only thing that keeps a map, such as ORB-SLAM3's `Map::mspKeyFrames` while no thread holds any of
  /// them.) Returns at once. It takes O(objects of the root + their edges) of collect(), in slices but for the root's own
  /// containers, and two grace periods. Objects with a pin, or in a container that no edges() describes, stay. Not for a root
  /// with an owner: it does nothing there.
  void collect_cycles() noexcept {
    if (!place_.owned) state_.collection.roots().want_suspicion(place_);
  }

  basic_root(const basic_root&) = delete;
  basic_root& operator=(const basic_root&) = delete;

 private:
  template <class Described>
  void put(const char* name, Described& described) noexcept {
    static_assert(detail::has_edges<Described>::value,
                  "slamgc: a root needs `template <class V> void edges(V& v)`");
    state_.retain();
    place_.name = name;
    place_.described = &described;
    place_.operations = &detail::operations_on<Described, Env>::table;
    place_.owned = place_.owner != nullptr;
    runtime::root_list<Env>::put(place_);
  }

  runtime::domain_state<Env>& state_;
  runtime::root_place<Env>& place_;
};

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
#define SLAMGC_VERSION_MINOR 2
/// Changes with corrections.
#define SLAMGC_VERSION_PATCH 0
// ---- slamgc/weak_rc.hpp ----
/// @file
/// Handles that do not keep their object.

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Base class of objects that weak handles may refer to, beside rc_object:
///
/// ```
/// class KeyFrame : public slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
///                  public slamgc::enable_weak_rc<KeyFrame> {
/// ```
///
/// Adds one pointer. The first weak handle to an object allocates its side block, of 56 bytes on 64-bit systems. A copy of an
/// object has no weak handles; assignment leaves them alone. Types without it pay nothing.
///
/// A program that itself deletes an object says that no thread uses it, not by a weak handle either; handles that
/// are left expire.
///
/// @tparam T   The class that derives from rc_object, with reclaim_deferred or reclaim_retired.
/// @tparam Env The environment of its counter policy.
template <class T, class Env>
class enable_weak_rc : public detail::block_owner<T, Env> {
 protected:
  /// No weak handle yet.
  enable_weak_rc() noexcept {
    static_assert(
        detail::is_deferred<T>::value,
        "slamgc: weak handles need a deferred reclaimer: another thread could destroy the "
        "object before lock() has counted it");
  }
  /// A copy is a new object.
  enable_weak_rc(const enable_weak_rc&) noexcept : enable_weak_rc() {}
  /// Handles refer to the object, not to its value: nothing changes.
  enable_weak_rc& operator=(const enable_weak_rc&) noexcept { return *this; }
  ~enable_weak_rc() = default;
};

/// Refers to an object without keeping it: what `std::weak_ptr` is. `sizeof(weak_rc<T>) == sizeof(T*)`.
///
/// A plain pointer says nothing about identity across quiescent states, because addresses are used again. A weak handle
/// does: handles are equal if they refer to the same object, for ever, also after it is gone.
///
/// **Expiry.** The handles of an object expire all at once, and for ever, when a collector has found that nobody can see the
/// object but by weak handles; those of objects that only refer to each other expire by one decision: if one of them is locked
/// in time, all live on. While a counted reference exists, handles have not expired, with one exception. A *retired* object
/// (or one that is found at a count of zero again and again) that is disturbed in 4 rounds of collection, by references that come
/// and go, expires although it may still be referred to: otherwise a thread that polls lock() could keep it for ever.
///
/// Thread-safety: as `std::shared_ptr`: different handles by any threads at any time; one handle that somebody
/// changes needs the program's lock. All operations are lock-free and O(1).
template <class T, class Env>
class weak_rc {
 public:
  using element_type = T;  ///< What it refers to.

  /// Null: refers to nothing, and is expired.
  constexpr weak_rc() noexcept = default;
  /// Null: refers to nothing, and is expired.
  constexpr weak_rc(std::nullptr_t) noexcept {}
  /// Refers to @p p. By an online mutator of the object's domain, or who holds a counted reference. Throws
  /// std::bad_alloc, if it is the object's first.
  explicit weak_rc(T* p) : block_(p != nullptr ? block_of(*p) : nullptr) {}
  /// Refers to the same object.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  weak_rc(const intrusive_rc<U>& p) : weak_rc(static_cast<T*>(p.get())) {}
  /// Refers to the same object.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value>>
  weak_rc(const rc_slot<U, Env>& p) : weak_rc(static_cast<T*>(p.get())) {}
  /// Refers to the same object, as its base or as const.
  template <class U, class = std::enable_if_t<std::is_convertible<U*, T*>::value &&
                                              !std::is_same<U, T>::value>>
  weak_rc(const weak_rc<U, Env>& other) noexcept : block_(other.block_) {}

  /// A reference to the object, or null if it has expired. On an online mutator of the object's domain.
  ///
  /// What it returns is counted as any other reference. A pointer taken from it is borrowed.
  [[nodiscard]] intrusive_rc<T> lock() const noexcept {
    SLAMGC_ASSERT(block_ == nullptr || runtime::participants<Env>::borrower() != nullptr,
                  (misuse{"locks a weak handle on a thread that is no online mutator",
                          detail::type_name<T>::get(), block_.get(), 0}));
    if (block_ == nullptr) return nullptr;
    using object = detail::object_of<T>;
    return intrusive_rc<T>(static_cast<T*>(detail::lock<object>(*block_)), false);
  }
  /// Whether lock() will return null, now and for ever. False says nothing about later.
  [[nodiscard]] bool expired() const noexcept { return block_ == nullptr || block_->is_dead(); }

  /// Becomes null.
  void reset() noexcept { block_.reset(); }
  /// Exchanges two handles.
  void swap(weak_rc& other) noexcept { block_.swap(other.block_); }

  /// Whether both refer to the same object, dead or alive, or both are null.
  template <class U>
  [[nodiscard]] bool owner_equal(const weak_rc<U, Env>& other) const noexcept {
    return block_ == other.block_;
  }
  /// An order of objects, dead or alive, which stays the same as long as handles to them exist.
  template <class U>
  [[nodiscard]] bool owner_before(const weak_rc<U, Env>& other) const noexcept {
    return block_ < other.block_;
  }
  /// A hash that goes with owner_equal().
  [[nodiscard]] std::size_t owner_hash() const noexcept {
    return std::hash<const void*>()(block_.get());
  }

 private:
  using block = detail::counted_block<Env>;
  template <class U, class OtherEnv>
  friend class weak_rc;

  static intrusive_rc<block> block_of(const T& p) {
    return intrusive_rc<block>(&detail::owner_of<Env>(p).get_or_make());
  }

  intrusive_rc<block> block_;
};

/// Exchanges two handles.
template <class T, class Env>
void swap(weak_rc<T, Env>& a, weak_rc<T, Env>& b) noexcept {
  a.swap(b);
}
/// Whether both refer to the same object, dead or alive, or both are null.
template <class T, class U, class Env>
[[nodiscard]] bool operator==(const weak_rc<T, Env>& a, const weak_rc<U, Env>& b) noexcept {
  return a.owner_equal(b);
}
/// Whether they refer to different objects.
template <class T, class U, class Env>
[[nodiscard]] bool operator!=(const weak_rc<T, Env>& a, const weak_rc<U, Env>& b) noexcept {
  return !a.owner_equal(b);
}
/// An order of objects, dead or alive.
template <class T, class U, class Env>
[[nodiscard]] bool operator<(const weak_rc<T, Env>& a, const weak_rc<U, Env>& b) noexcept {
  return a.owner_before(b);
}

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

/// The hash of the object's identity, which its end does not change.
template <class T, class Env>
struct std::hash<slamgc::weak_rc<T, Env>> {
  /// The hash of the object's identity.
  [[nodiscard]] std::size_t operator()(const slamgc::weak_rc<T, Env>& w) const noexcept {
    return w.owner_hash();
  }
};
