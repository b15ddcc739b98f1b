/// @file
/// The reclaimers that wait: an object is destroyed when nobody can see it any more.
#pragma once

#include <cstdint>
#include <type_traits>

#include "assert.hpp"
#include "detail/zero_count_table.hpp"
#include "domain.hpp"
#include "fwd.hpp"
#include "rc_object.hpp"

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
