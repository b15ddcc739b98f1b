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
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>

#include "assert.hpp"
#include "budget.hpp"
#include "detail/clock.hpp"
#include "detail/domain_state.hpp"
#include "diagnosis/hooks.hpp"
#include "env.hpp"
#include "fwd.hpp"
#include "stats.hpp"

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
