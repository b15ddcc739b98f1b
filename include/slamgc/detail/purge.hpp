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
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>

#include "../counter.hpp"
#include "../fwd.hpp"
#include "clock.hpp"
#include "heap_walk.hpp"
#include "root_list.hpp"
#include "table_base.hpp"
#include "trial_deletion.hpp"

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
