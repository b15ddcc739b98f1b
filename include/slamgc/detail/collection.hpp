/// @file
/// A domain's collection: one at a time, in as many calls as it takes.
///
/// **States.** *noting*: what has entered the tables is noted, table by table. *waiting*: the epoch was
/// advanced; the grace period is open. *deciding*: it is over; the noted objects are destroyed, or leave, or
/// enter anew. *purging*, between two rounds, if there is reason to (purge.hpp). A call goes on where the last one
/// ended, whichever thread made it. What enters meanwhile belongs to the next round.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "../budget.hpp"
#include "../diagnosis/hooks.hpp"
#include "../env.hpp"
#include "../fwd.hpp"
#include "../stats.hpp"
#include "clock.hpp"
#include "dropped.hpp"
#include "participant.hpp"
#include "purge.hpp"
#include "root_list.hpp"
#include "table_base.hpp"
#include "trial_deletion.hpp"

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
