/// @file
/// The interface of all redundancy indices: what a program announces, what it may ask, and what its map has to offer.
///
/// **Announce, then change.** A call tells what is about to change, while the map is still as it was; the index reads
/// from the map what was there. If the call does not return `ok`, the index is as it was.
///
/// **Whose locks.** The index has none of its own for points; it relies on the program's. A call that concerns the
/// observations of a point (set_observation, erase_observation, mark_bad, add_point) is made under the lock that guards
/// them, and the change follows under the same lock. A call that concerns the slots of a keyframe (set_slot,
/// clear_slot, add_keyframe, remove_keyframe) is made under the lock that guards them, likewise. The index then takes the
/// locks of the points concerned itself, one at a time: so the lock of a point is never held when that of a keyframe's
/// slots is taken, which is the order of ORB-SLAM3. check() is called without a lock.
///
/// **Why that is enough.** What the index knows about a point (its observers per level, its loose ends) changes only under
/// the lock of that point: calls about one point are in an order, and each computes what it adds to and takes from the
/// counts of a keyframe for each slot that holds the point. Which slots hold it does not come from the keyframes, whose locks
/// the caller may not have, but from the observations and the loose ends, both of which that same lock guards. So each slot
/// contributes exactly its state after the last call about its point. The two counts of a keyframe lie in one atomic word: a reader
/// sees both at one moment, contains each call that happened before, and of one that is under way each slot as it was
/// or as it will be. A slot that goes from one point to another is empty in between.
///
/// **The map.** An index takes a small copyable object of a class of the program, which offers
///
/// ```
/// using keyframe = KeyFrame*;               // or an id; compared by ==
/// using point = MapPoint*;
/// static constexpr int levels = 8;          // of the image pyramid
/// auto& keyframe_state(keyframe) const;     // where the index keeps its own: its type is Index::keyframe_state
/// auto& point_state(point) const;           // likewise; both begin and end with the object
/// auto lock_slots(keyframe) const;          // a guard for what the keyframe's slots hold (recompute alone uses it)
/// auto lock_observations(point) const;      // a guard for the point's observations and for bad()
/// bool is_null(point) const;
/// bool bad(point) const;                    // under lock_observations, as are the next two
/// bool find(point, keyframe, observation&) const;       // whether the keyframe observes the point, and how
/// template <class F> void observers(point, F f) const;  // f(keyframe, observation) for each, until f says false
/// int slots(keyframe) const;                // how many; this and the next two never change
/// int level(keyframe, int slot) const;
/// bool eligible(keyframe, int slot) const;  // by depth; false for slots of a second camera
/// point slot(keyframe, int slot) const;     // under lock_slots
/// ```
#pragma once

#include <cstdint>

#include "../env.hpp"
#include "rule.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace redundancy {

/// What every index keeps in a keyframe, in 8 bytes: whether it is known, and its counts.
template <class Env = std_env>
class keyframe_counts {
 public:
  /// Whether the keyframe was added.
  [[nodiscard]] bool known() const noexcept { return (word_.load(order) & known_flag) != 0; }
  /// Whether the keyframe was removed.
  [[nodiscard]] bool removed() const noexcept { return (word_.load(order) & removed_flag) != 0; }
  /// The keyframe is added; once.
  void set_known() noexcept { word_.fetch_add(known_flag, order); }
  /// The keyframe is removed; once.
  void set_removed() noexcept { word_.fetch_add(removed_flag, order); }
  /// Changes both counts at one moment.
  void add(int eligible, int redundant) noexcept {
    // Modulo 2^64. No count falls below zero: what a slot takes away it had added before, under the same lock. Only those
    // of a removed keyframe may, which nobody reads; hence the flags are the low bits.
    word_.fetch_add((static_cast<std::uint64_t>(std::int64_t{eligible}) << eligible_shift) +
                        (static_cast<std::uint64_t>(std::int64_t{redundant}) << redundant_shift),
                    order);
  }
  /// Both counts at one moment, judged by the rule.
  [[nodiscard]] verdict judge(const rule& r) const noexcept {
    const std::uint64_t word = word_.load(order);
    if ((word & known_flag) == 0) return {status::unknown_keyframe};
    if ((word & removed_flag) != 0) return {status::removed_keyframe};
    const int eligible = static_cast<int>(word >> eligible_shift & count_mask);
    const int redundant = static_cast<int>(word >> redundant_shift & count_mask);
    return {status::ok, r.exceeded(redundant, eligible), eligible, redundant};
  }

 private:
  static constexpr std::uint64_t known_flag = 1;
  static constexpr std::uint64_t removed_flag = 2;
  static constexpr int eligible_shift = 2;
  static constexpr int redundant_shift = 33;
  static constexpr std::uint64_t count_mask = 0x7fffffff;
  // (70) memory_order_relaxed: one word is all that a reader wants, and what happened before its read it sees in any order;
  // nothing else is published by it. Whoever must not miss a removal reads the flag under a lock that remove_keyframe()
  // takes after setting it.
  static constexpr std::memory_order order = std::memory_order_relaxed;
  typename Env::template atomic<std::uint64_t> word_{0};
};

/// What all indices share: the calls, and the checks of their arguments. Thread-safe as index.hpp says.
///
/// @tparam Scheme the index that derives from it.
/// @tparam Map what the program offers; see index.hpp.
template <class Scheme, class Map>
class index {
 public:
  using keyframe = typename Map::keyframe;  ///< Names a keyframe.
  using point = typename Map::point;        ///< Names a map point.

  index(const index&) = delete;
  index& operator=(const index&) = delete;

  /// Tells of a keyframe, with the slots that it has. Under the lock of its slots. O(slots).
  /// Errors: known_keyframe, level_out_of_range, out_of_memory.
  [[nodiscard]] status add_keyframe(const keyframe& k) {
    if (counts(k).known()) return status::known_keyframe;
    const int n = map_.slots(k);
    for (int i = 0; i != n; ++i)
      if (!has_level(map_.level(k, i))) return status::level_out_of_range;
    const status s = scheme().enter_all(k, n);
    if (s == status::ok) counts(k).set_known();
    return s;
  }

  /// The keyframe is marked bad: it has no verdict any more. Its observations still count for others, until they are
  /// erased; its slots need not be told any more. Under the lock of its slots. O(slots).
  /// Errors: unknown_keyframe. A second time it does nothing.
  [[nodiscard]] status remove_keyframe(const keyframe& k) {
    if (!counts(k).known()) return status::unknown_keyframe;
    if (counts(k).removed()) return status::ok;
    counts(k).set_removed();
    scheme().forget(k);
    return status::ok;
  }

  /// Tells of a point that has observers already, as in a map that was loaded. Under the lock of its observations. A
  /// new point needs no call. O(observers).
  /// Errors: no_point, known_point, level_out_of_range, slot_out_of_range, too_many_observers, out_of_memory.
  [[nodiscard]] status add_point(const point& p) {
    if (map_.is_null(p)) return status::no_point;
    if (map_.bad(p)) return status::ok;
    status s = status::ok;
    map_.observers(p, [&](const keyframe& k, const observation& o) {
      s = check_range(k, o);
      return s == status::ok;
    });
    return s == status::ok ? scheme().point_added(p) : s;
  }

  /// The keyframe is about to observe the point, or to observe it otherwise than now. Under the lock of the point's
  /// observations. Nothing is counted at a bad point. O(log observers); O(observers) if another slot's state changes.
  /// Errors: no_point, unknown_keyframe, level_out_of_range, slot_out_of_range, unknown_point, too_many_observers,
  /// out_of_memory.
  [[nodiscard]] status set_observation(const keyframe& k, const point& p, const observation& o) {
    if (map_.is_null(p)) return status::no_point;
    if (!counts(k).known()) return status::unknown_keyframe;
    const status s = check_range(k, o);
    if (s != status::ok || map_.bad(p)) return s;
    observation before{};
    return scheme().observed(k, p, map_.find(p, k, before) ? &before : nullptr, &o);
  }

  /// The keyframe is about to observe the point no longer. Under the lock of the point's observations. Costs what
  /// set_observation() costs.
  /// Errors: no_point, unknown_keyframe, no_observation, unknown_point, out_of_memory.
  [[nodiscard]] status erase_observation(const keyframe& k, const point& p) {
    if (map_.is_null(p)) return status::no_point;
    if (!counts(k).known()) return status::unknown_keyframe;
    observation before{};
    if (!map_.find(p, k, before)) return status::no_observation;
    if (map_.bad(p)) return status::ok;
    return scheme().observed(k, p, &before, nullptr);
  }

  /// The point is about to become bad, with all its observations erased: culled, or replaced by another. It never
  /// becomes good again. Under the lock of its observations. O(observers).
  /// Errors: no_point. A second time it does nothing.
  [[nodiscard]] status mark_bad(const point& p) {
    if (map_.is_null(p)) return status::no_point;
    if (!map_.bad(p)) scheme().dropped(p);
    return status::ok;
  }

  /// The slot is about to hold the point, instead of what it holds now. Before or after the observation is told.
  /// Under the lock of the keyframe's slots. O(loose ends of the points), usually O(1).
  /// Errors: no_point, unknown_keyframe, slot_out_of_range, out_of_memory.
  [[nodiscard]] status set_slot(const keyframe& k, int slot, const point& p) {
    if (map_.is_null(p)) return status::no_point;
    if (!counts(k).known()) return status::unknown_keyframe;
    if (slot < 0 || slot >= map_.slots(k)) return status::slot_out_of_range;
    const point old = map_.slot(k, slot);
    if (old == p) return status::ok;
    return change_slot(k, slot, old, &p);
  }

  /// The slot is about to hold nothing. Under the lock of the keyframe's slots. Costs what set_slot() costs.
  /// Errors: unknown_keyframe, slot_out_of_range, empty_slot, out_of_memory.
  [[nodiscard]] status clear_slot(const keyframe& k, int slot) {
    if (!counts(k).known()) return status::unknown_keyframe;
    if (slot < 0 || slot >= map_.slots(k)) return status::slot_out_of_range;
    const point old = map_.slot(k, slot);
    if (map_.is_null(old)) return status::empty_slot;
    return change_slot(k, slot, old, nullptr);
  }

  /// Whether the keyframe is redundant, and why. Without a lock. One load; recompute: O(slots x observers).
  /// Errors: unknown_keyframe, removed_keyframe.
  [[nodiscard]] verdict check(const keyframe& k) const { return scheme().judge(k); }

  /// The rule.
  [[nodiscard]] const rule& used_rule() const noexcept { return rule_; }

 protected:
  /// An index of the map, by the rule.
  index(const Map& map, const rule& r) : map_(map), rule_(r) {}
  ~index() = default;

  /// The counts of a keyframe.
  [[nodiscard]] auto& counts(const keyframe& k) const { return map_.keyframe_state(k); }
  /// The coarsest level at which observers count for a slot of a level.
  [[nodiscard]] int reach(int level) const noexcept {
    return level > Map::levels - 1 - rule_.slack ? Map::levels - 1 : level + rule_.slack;
  }

  Map map_;    ///< What the program offers.
  rule rule_;  ///< The rule.

 private:
  [[nodiscard]] Scheme& scheme() noexcept { return static_cast<Scheme&>(*this); }
  [[nodiscard]] const Scheme& scheme() const noexcept { return static_cast<const Scheme&>(*this); }

  [[nodiscard]] static bool has_level(int level) noexcept {
    return level >= 0 && level < Map::levels;
  }
  [[nodiscard]] status check_range(const keyframe& k, const observation& o) const {
    if (!has_level(o.level)) return status::level_out_of_range;
    if (o.slot < -1 || o.slot >= map_.slots(k)) return status::slot_out_of_range;
    return o.slot >= 0 && o.level > map_.level(k, o.slot) ? status::level_out_of_range : status::ok;
  }
  // A removed keyframe has no slots, and a slot that is not eligible never contributes.
  [[nodiscard]] status change_slot(const keyframe& k, int slot, const point& old, const point* p) {
    if (counts(k).removed() || !map_.eligible(k, slot)) return status::ok;
    return scheme().slot_changed(k, slot, old, p);
  }
};

}  // namespace redundancy
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
