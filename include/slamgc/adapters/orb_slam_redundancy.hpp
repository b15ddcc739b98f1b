/// @file
/// Keyframe culling of ORB-SLAM2 and ORB-SLAM3 without walking observers: one line in each function that changes an observation, a
/// slot or badness, and one in the loop of `LocalMapping::KeyFrameCulling`. docs/redundancy.md has the list.
///
/// With slamgc's reclaiming or without, raw pointers and counted ones alike. Nothing of ORB-SLAM is included here, and its classes
/// are template parameters.
#pragma once

#include <cstddef>
#include <mutex>
#include <tuple>
#include <type_traits>
#include <utility>

#include "../assert.hpp"
#include "../detail/orb_slam_members.hpp"
#include "../redundancy/level_histogram.hpp"
#include "../redundancy/recompute.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// What an index may ask of ORB-SLAM's classes; see redundancy/index.hpp. Which slots are eligible, and their levels, are as
/// docs/redundancy.md says.
template <class KeyFrame, class MapPoint, int Levels>
struct orb_slam_view {
  using keyframe = KeyFrame*;
  using point = MapPoint*;
  using observation = redundancy::observation;
  using members = orb_slam_members;
  static constexpr int levels = Levels;
  bool by_depth;

  auto& keyframe_state(KeyFrame* pKF) const { return pKF->mRedundancy; }
  auto& point_state(MapPoint* pMP) const { return pMP->mRedundancy; }
  auto lock_slots(KeyFrame* pKF) const {
    return std::unique_lock<std::mutex>(members::features_mutex(*pKF));
  }
  auto lock_observations(MapPoint* pMP) const {
    return std::unique_lock<std::mutex>(members::features_mutex(*pMP));
  }
  bool is_null(MapPoint* pMP) const { return pMP == nullptr; }
  bool bad(MapPoint* pMP) const { return members::bad_flag(*pMP); }
  bool find(MapPoint* pMP, KeyFrame* pKF, observation& o) const {
    auto& all = members::observations(*pMP);
    const auto it = all.find(pKF);
    if (it == all.end()) return false;
    o = by_indices(pKF, it->second);
    return true;
  }
  template <class F>
  void observers(MapPoint* pMP, F f) const {
    for (const auto& o : members::observations(*pMP))
      if (!f(o.first, by_indices(o.first, o.second))) return;
  }
  int slots(KeyFrame* pKF) const { return static_cast<int>(pKF->N); }
  MapPoint* slot(KeyFrame* pKF, int i) const {
    auto& all = members::slots(*pKF);
    return at(i) < all.size() ? static_cast<MapPoint*>(all[at(i)]) : nullptr;
  }
  int level(KeyFrame* pKF, int i) const {
    if constexpr (has_two_cameras::value) {
      const int left = pKF->NLeft;
      if (left != -1)
        return i < left ? pKF->mvKeys[at(i)].octave : pKF->mvKeysRight[at(i - left)].octave;
    }
    return pKF->mvKeysUn[at(i)].octave;
  }
  bool eligible(KeyFrame* pKF, int i) const {
    if constexpr (has_two_cameras::value)
      if (pKF->NLeft != -1 && i >= pKF->NLeft) return false;
    return !by_depth || redundancy::eligible_by_depth(pKF->mvDepth[at(i)], pKF->mThDepth);
  }

  // What stands in mObservations: the left index and the right one, or -1; in ORB-SLAM2 there is one.
  template <class Indices>
  observation by_indices(KeyFrame* pKF, const Indices& indices) const {
    int left, right = -1;
    if constexpr (std::is_integral<Indices>::value)
      left = static_cast<int>(indices);
    else
      left = std::get<0>(indices), right = std::get<1>(indices);
    if (right < 0) return {left, level(pKF, left)};
    const int of_right = level(pKF, right);
    if (left < 0) return {-1, of_right};
    const int of_left = level(pKF, left);
    return {left, of_right < of_left ? of_right : of_left};
  }

 private:
  template <class K, class = void>
  struct with_NLeft : std::false_type {};
  template <class K>
  struct with_NLeft<K, std::void_t<decltype(std::declval<K&>().NLeft)>> : std::true_type {};
  // Not before the class is complete.
  using has_two_cameras = with_NLeft<KeyFrame>;
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
};

}  // namespace detail
namespace orb_slam3 {

/// What may read the members of ORB-SLAM's classes; the one of adapters/orb_slam3.hpp.
using access = detail::orb_slam_members;

/// Tells a redundancy::level_histogram what ORB-SLAM changes, and asks it.
///
/// ```
/// using Redundancy = slamgc::orb_slam3::redundancy_hooks<class KeyFrame, class MapPoint>;
///
/// class KeyFrame {
///   friend slamgc::orb_slam3::access;
///   ~KeyFrame() { Redundancy::remove_keyframe(this); }
///   Redundancy::keyframe_state mRedundancy;  // 8 bytes, under this name
/// class MapPoint {
///   friend slamgc::orb_slam3::access;
///   Redundancy::point_state mRedundancy;     // 24 bytes
///
/// void KeyFrame::AddMapPoint(MapPoint *pMP, const size_t &idx) {
///   unique_lock<mutex> lock(mMutexFeatures);
///   Redundancy::set_slot(this, idx, pMP);    // before the change
///   mvpMapPoints[idx] = pMP;
/// }
/// ```
///
/// Each call comes **before** the change it tells of, under the lock of what changes: the keyframe's or the point's
/// `mMutexFeatures`. What cannot be counted ends the program with a message: a hook that is missing somewhere (unknown keyframe,
/// unknown point), a pyramid of more than @p Levels levels, no memory for a loose end.
///
/// Objects may be deleted, and others made at their addresses: the states begin and end with them, and the one other place where a
/// keyframe is named, the loose end of a point, goes with the slot or the observation that it is about. Where slamgc drops a stale
/// slot or observation, slamgc calls these functions itself; see docs/redundancy.md.
///
/// Thread-safety: as redundancy::level_histogram, for any threads under those locks; check() without one. use() is for the
/// time before. One rule per process and pair of types, as ORB-SLAM has one camera (`Frame::fx`).
template <class KeyFrame, class MapPoint, int Levels = 8>
class redundancy_hooks {
  using view = detail::orb_slam_view<KeyFrame, MapPoint, Levels>;
  using index = redundancy::level_histogram<view>;
  using status = redundancy::status;

 public:
  /// What is kept in a keyframe.
  struct keyframe_state : redundancy::keyframe_counts<> {
    using hooks = redundancy_hooks;  ///< Where slamgc announces what it drops.
  };
  /// What is kept in a point.
  struct point_state : redundancy::point_levels<KeyFrame*, Levels> {
    using hooks = redundancy_hooks;  ///< Where slamgc announces what it drops.
  };

  /// Before the first keyframe, in System's constructor. @p depth: whether slots count by depth, which is what ORB-SLAM does with
  /// any sensor but `MONOCULAR` and `IMU_MONOCULAR`. Without a call: ORB-SLAM3's rule, and they do.
  static void use(const redundancy::rule& rule, bool depth) {
    rule_ = rule;
    by_depth_ = depth;
  }

  /// At the end of KeyFrame's constructor, and of `KeyFrame::PostLoad`. O(slots).
  static void add_keyframe(KeyFrame* pKF) { must(now().add_keyframe(pKF), pKF); }
  /// In `KeyFrame::SetBadFlag`, where mbBad is set; and in ~KeyFrame, for keyframes that end otherwise. A keyframe that is not
  /// known, or removed already, does not matter. O(slots).
  static void remove_keyframe(KeyFrame* pKF) {
    const status s = now().remove_keyframe(pKF);
    if (s != status::unknown_keyframe) must(s, pKF);
  }
  /// In `KeyFrame::AddMapPoint` and `KeyFrame::ReplaceMapPointMatch`. Null clears the slot. O(1) as a rule.
  static void set_slot(KeyFrame* pKF, std::size_t idx, MapPoint* pMP) {
    if (pMP == nullptr) return clear_slot(pKF, idx);
    must(now().set_slot(pKF, static_cast<int>(idx), pMP), pKF);
  }
  /// In both `KeyFrame::EraseMapPointMatch`. Nothing, if the slot is empty. O(1) as a rule.
  static void clear_slot(KeyFrame* pKF, std::size_t idx) {
    const status s = now().clear_slot(pKF, static_cast<int>(idx));
    if (s != status::empty_slot) must(s, pKF);
  }
  /// In `MapPoint::AddObservation`. @p indices is what `mObservations[pKF]` will be. O(log observers); O(observers) if a slot of
  /// another keyframe becomes redundant.
  template <class Indices>
  static void set_observation(KeyFrame* pKF, MapPoint* pMP, const Indices& indices) {
    must(now().set_observation(pKF, pMP, look().by_indices(pKF, indices)), pMP);
  }
  /// In `MapPoint::EraseObservation`. Nothing, if there is none. Costs what set_observation() costs.
  static void erase_observation(KeyFrame* pKF, MapPoint* pMP) {
    const status s = now().erase_observation(pKF, pMP);
    if (s != status::no_observation) must(s, pMP);
  }
  /// In `MapPoint::SetBadFlag` and `MapPoint::Replace`, before mbBad is set and mObservations cleared. O(observers).
  static void mark_bad(MapPoint* pMP) { must(now().mark_bad(pMP), pMP); }
  /// At the end of `MapPoint::PostLoad`, whose observations come from a file. O(observers).
  static void add_point(MapPoint* pMP) { must(now().add_point(pMP), pMP); }

  /// In `LocalMapping::KeyFrameCulling`, in place of the loop over the keyframe's points: `eligible_slots` is nMPs,
  /// `redundant_slots` is nRedundantObservations, and `redundant` whether they are too many for the rule. Both are 0 if the
  /// keyframe has become bad meanwhile. One load.
  [[nodiscard]] static redundancy::verdict check(KeyFrame* pKF) {
    const redundancy::verdict v = now().check(pKF);
    if (v.result != status::removed_keyframe) must(v.result, pKF);
    return v;
  }
  /// The same by a walk through the map, as in ORB-SLAM: to compare, while the hooks are being put in. Takes the locks.
  [[nodiscard]] static redundancy::verdict recompute(KeyFrame* pKF) {
    return redundancy::recompute<view>(look(), rule_).check(pKF);
  }

  /// For slamgc: a slot from @p from on refers to @p retired and is about to be dropped. Under the lock of the slots. Returns the
  /// slot after it.
  static std::size_t drop_slot(KeyFrame& kf, MapPoint& retired, std::size_t from) {
    const auto n = static_cast<std::size_t>(look().slots(&kf));
    while (from < n && look().slot(&kf, static_cast<int>(from)) != &retired) ++from;
    if (from == n) return n;
    clear_slot(&kf, from);
    return from + 1;
  }

 private:
  static view look() noexcept { return {by_depth_}; }
  static index now() noexcept { return index(look(), rule_); }
  template <class T>
  static void must(status s, T* of) {
    if (s != status::ok)
      abort_on(
          {redundancy::name_of(s), detail::type_name<T>::get(), static_cast<const void*>(of), 0});
  }

  inline static redundancy::rule rule_ = redundancy::orb_slam3;
  inline static bool by_depth_ = true;
};

}  // namespace orb_slam3
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
