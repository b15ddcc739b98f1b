/// @file
/// Redundancy recomputed from the map, for each answer.
#pragma once

#include "index.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace redundancy {

/// Index that keeps nothing and walks the map: each slot of the keyframe, each observer of its point. The rule as it is
/// written, and what ORB-SLAM3 does in every pass of culling, without copying the observations.
///
/// check() costs O(slots x observers), and takes the lock of the slots and within it those of the points.
/// @tparam Map see index.hpp. keyframe_state is keyframe_counts; point_state is not asked for.
template <class Map, class Env = std_env>
class recompute : public index<recompute<Map, Env>, Map> {
  using base = index<recompute<Map, Env>, Map>;

 public:
  using typename base::keyframe;
  using typename base::point;
  using keyframe_state =
      keyframe_counts<Env>;  ///< What a keyframe keeps; its flags alone are used.

  /// An index of the map, by the rule.
  explicit recompute(const Map& map, const rule& r = {}) : base(map, r) {}

 private:
  friend base;
  using base::map_;
  using base::rule_;

  status enter_all(const keyframe&, int) { return status::ok; }
  void forget(const keyframe&) {}
  status point_added(const point&) { return status::ok; }
  status observed(const keyframe&, const point&, const observation*, const observation*) {
    return status::ok;
  }
  void dropped(const point&) {}
  status slot_changed(const keyframe&, int, const point&, const point*) { return status::ok; }

  [[nodiscard]] verdict judge(const keyframe& k) const {
    const verdict kept = this->counts(k).judge(rule_);
    if (kept.result != status::ok) return kept;
    verdict v;
    const auto slots_stay = map_.lock_slots(k);
    const int n = map_.slots(k);
    for (int i = 0; i != n; ++i) {
      const point p = map_.slot(k, i);
      if (map_.is_null(p) || !map_.eligible(k, i)) continue;
      const auto observations_stay = map_.lock_observations(p);
      if (map_.bad(p)) continue;
      ++v.eligible_slots;
      v.redundant_slots += seen_by_others(k, p, this->reach(map_.level(k, i)));
    }
    v.redundant = rule_.exceeded(v.redundant_slots, v.eligible_slots);
    return v;
  }
  [[nodiscard]] bool seen_by_others(const keyframe& k, const point& p, int reach) const {
    int missing = rule_.others;
    if (missing > 0)
      map_.observers(p, [&](const keyframe& other, const observation& o) {
        if (!(other == k) && o.level <= reach) --missing;
        return missing > 0;
      });
    return missing <= 0;
  }
};

}  // namespace redundancy
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
