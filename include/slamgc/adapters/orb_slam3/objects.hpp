/// @file
/// Base classes of ORB-SLAM3's KeyFrame, MapPoint and Map, and what a trajectory keeps of keyframes that are gone. See ../orb_slam3.hpp.
#pragma once

#include <cstdint>
#include <optional>

#include "../../anchor.hpp"
#include "../../deferred.hpp"
#include "../../detail/orb_slam_members.hpp"
#include "../../rc_object.hpp"
#include "../../rc_slot.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace orb_slam3 {

/// What may read the members of ORB-SLAM3's classes: `friend slamgc::orb_slam3::access;` in each class that the guide names.
using access = detail::orb_slam_members;

/// What a reclaimed keyframe leaves for the trajectory.
template <class KeyFrame, class Pose>
struct pose_record {
  bool bad = false;                           ///< Whether it was culled; else its map was cleared.
  Pose mTcp{};                                ///< Of a bad one: to its parent.
  Pose Tcw{};                                 ///< Where it was.
  anchor<KeyFrame, pose_record> parent = {};  ///< Its parent, or what that has left.
};

/// Base class of `KeyFrame`. @p Pose is what its GetPose() returns by value: `Sophus::SE3f`.
///
/// ```
/// class KeyFrame : public slamgc::orb_slam3::keyframe_base<KeyFrame, Sophus::SE3f> {
///   friend slamgc::orb_slam3::access;
/// ```
template <class KeyFrame, class Pose>
class keyframe_base : public rc_object<KeyFrame, fetch_add_counter, reclaim_retired>,
                      public enable_anchor<KeyFrame, pose_record<KeyFrame, Pose>> {
 public:
  /// Describes its members, under its locks.
  template <class Visitor>
  void edges(Visitor& v) {
    access::keyframe(v, static_cast<KeyFrame&>(*this));
  }
  /// What it leaves. Takes its locks.
  pose_record<KeyFrame, Pose> record() {
    auto& me = static_cast<KeyFrame&>(*this);
    return {me.isBad(), me.mTcp, me.GetPose(),
            anchor<KeyFrame, pose_record<KeyFrame, Pose>>(me.GetParent())};
  }
  /// Reports call it by its mnId.
  std::uint64_t report_id() const { return static_cast<const KeyFrame&>(*this).mnId; }
};

/// Base class of `MapPoint`.
template <class MapPoint>
class map_point_base : public rc_object<MapPoint, fetch_add_counter, reclaim_retired> {
 public:
  /// Describes its members, under its locks.
  template <class Visitor>
  void edges(Visitor& v) {
    access::map_point(v, static_cast<MapPoint&>(*this));
  }
  /// Reports call it by its mnId.
  std::uint64_t report_id() const { return static_cast<const MapPoint&>(*this).mnId; }
};

/// Base class of `Map`.
template <class Map>
class map_base : public rc_object<Map, fetch_add_counter, reclaim_retired> {
 public:
  /// Describes its members, under its lock.
  template <class Visitor>
  void edges(Visitor& v) {
    access::map(v, static_cast<Map&>(*this));
  }
};

/// An element of `Tracking::mlpReferences`: a keyframe, or what it has left.
///
/// ```
/// std::list<slamgc::orb_slam3::trajectory_reference<KeyFrame, Sophus::SE3f>> mlpReferences;
/// ```
///
/// Thread-safety: that of anchor. walk() and Trw() on a thread that has a `thread` or a `frame`.
template <class KeyFrame, class Pose>
class trajectory_reference {
 public:
  /// Of a keyframe, or none.
  trajectory_reference(KeyFrame* pKF = nullptr) : anchor_(pKF) {}
  /// Of what a slot refers to.
  trajectory_reference(const rc_slot<KeyFrame>& pKF) : anchor_(pKF) {}

  /// Whether there is a keyframe, or was one.
  [[nodiscard]] explicit operator bool() const noexcept { return static_cast<bool>(anchor_); }

  /// From here to the first keyframe that is not bad, through the parents, as ORB-SLAM3's loop
  /// `while (pKF->isBad()) { Trw = Trw * pKF->mTcp; pKF = pKF->GetParent(); }` does, multiplication by multiplication. Null if
  /// there is none, or if its map was cleared and it is gone. O(culled keyframes on the way).
  KeyFrame* walk(Pose& Trw) const {
    return walk([&Trw](const Pose& mTcp) { Trw = Trw * mTcp; }).keyframe;
  }
  /// The same, of which the pose is of no interest.
  [[nodiscard]] KeyFrame* walk() const {
    return walk([](const Pose&) {}).keyframe;
  }
  /// `Trw` after that loop and `Trw = Trw * pKF->GetPose()`; where the keyframe was, if it is gone. @p identity is what the
  /// loop begins with.
  [[nodiscard]] Pose Trw(Pose identity = Pose()) const {
    const end last = walk([&identity](const Pose& mTcp) { identity = identity * mTcp; });
    return last.Tcw ? Pose(identity * *last.Tcw) : identity;
  }

 private:
  using record = pose_record<KeyFrame, Pose>;
  using link = anchor<KeyFrame, record>;
  struct end {
    KeyFrame* keyframe = nullptr;
    std::optional<Pose> Tcw{};
  };

  template <class F>
  end walk(F passes) const {
    link at = anchor_;
    end last;
    while (at) {
      at = at.read(
          [&](KeyFrame& kf) {
            link parent;
            if (kf.isBad()) parent = link(kf.GetParent());
            if (parent)
              passes(kf.mTcp);
            else
              last = {kf.isBad() ? nullptr : &kf, kf.GetPose()};
            return parent;
          },
          [&](const record& r) {
            link parent;
            if (r.bad) parent = r.parent;
            if (parent)
              passes(r.mTcp);
            else
              last.Tcw = r.Tcw;
            return parent;
          });
    }
    return last;
  }

  link anchor_;
};

}  // namespace orb_slam3
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
