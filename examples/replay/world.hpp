// One map in a scheme, and what the steps of a session do to it.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "map.hpp"
#include "session.hpp"

namespace replay {

// What tracking keeps from frame to frame.
template <class S>
struct tracking_members {
  typename S::template vector<MapPoint<S>> mLastFrame_mvpMapPoints;
  typename S::template frame_vector<KeyFrame<S>> mvpLocalKeyFrames;
  typename S::template frame_vector<MapPoint<S>> mvpLocalMapPoints;
  typename S::template pointer<KeyFrame<S>> mpReferenceKF{};
  // One for each frame, for ever.
  owning_vector<S, typename S::template reference<KeyFrame<S>, pose_record<S>>> mlpReferences;

  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mLastFrame.mvpMapPoints", mLastFrame_mvpMapPoints);  // the next frame starts from them
    v.edge("mpReferenceKF", mpReferenceKF);
  }
};

template <class S>
class world : public S::owner {
 public:
  using Frame = KeyFrame<S>;
  using Point = MapPoint<S>;

  world(typename S::program& p, const session& s)
      : program(p),
        of(s),
        keyframes(static_cast<std::size_t>(s.keyframes)),
        points(static_cast<std::size_t>(s.points)),
        map_root_(p, "Map", map),
        database_root_(p, "KeyFrameDatabase", database) {}
  world(const world&) = delete;
  world& operator=(const world&) = delete;

  Frame* keyframe(int id) { return id < 0 ? nullptr : S::raw(keyframes[at(id)]); }
  Point* point(int id) { return id < 0 ? nullptr : S::raw(points[at(id)]); }

  // Those that change the map. Those of a frame or an iteration are the thread's own matter.
  __attribute__((noinline)) void apply(const step& x) {
    using k = step_kind;
    switch (x.kind) {
      case k::make_keyframe:
        keyframes[at(x.a)] = program.template make<Frame>(x.a, of.octaves[at(x.a)]);
        break;
      case k::insert_keyframe:
        keyframe(x.a)->inserted = true;
        map.AddKeyFrame(keyframe(x.a));
        break;
      case k::make_point:
        points[at(x.a)] = program.template make<Point>(x.a);
        break;
      case k::insert_point:
        point(x.a)->inserted = true;
        map.AddMapPoint(point(x.a));
        break;
      case k::observe:
        point(x.b)->AddObservation(keyframe(x.a), at(x.c));
        break;
      case k::unobserve:
        point(x.b)->EraseObservation(keyframe(x.a));
        break;
      case k::set_slot:
        keyframe(x.a)->AddMapPoint(point(x.c), at(x.b));
        break;
      case k::clear_slot:
        keyframe(x.a)->AddMapPoint(nullptr, at(x.b));
        break;
      case k::connect:
        keyframe(x.a)->AddConnection(keyframe(x.b), x.c);
        break;
      case k::disconnect:
        keyframe(x.a)->EraseConnection(keyframe(x.b));
        break;
      case k::order:
        keyframe(x.a)->UpdateBestCovisibles();
        break;
      case k::parent:
        keyframe(x.a)->ChangeParent(keyframe(x.b));
        break;
      case k::add_child:
        keyframe(x.a)->AddChild(keyframe(x.b));
        break;
      case k::erase_child:
        keyframe(x.a)->EraseChild(keyframe(x.b));
        break;
      case k::loop_edge:
        keyframe(x.a)->AddLoopEdge(keyframe(x.b));
        break;
      case k::merge_edge:
        keyframe(x.a)->AddMergeEdge(keyframe(x.b));
        break;
      case k::temporal:
        keyframe(x.a)->Link(keyframe(x.b), keyframe(x.c));
        break;
      case k::database_add:
        database.add(keyframe(x.a));
        break;
      case k::database_erase:
        database.erase(keyframe(x.a));
        break;
      case k::replace:
        point(x.a)->Replace(point(x.b));
        break;
      case k::mark_keyframe:
        keyframe(x.a)->SetBadFlag();
        map.EraseKeyFrame(keyframe(x.a));
        break;
      case k::mark_point:
        point(x.a)->SetBadFlag();
        map.EraseMapPoint(point(x.a));
        break;
      case k::retire_keyframe:
        program.retire(keyframe(x.a));
        break;
      case k::retire_point:
        program.retire(point(x.a));
        break;
      case k::release_keyframe:
        S::release(keyframes[at(x.a)]);
        break;
      case k::release_point:
        S::release(points[at(x.a)]);
        break;
      default:
        break;
    }
  }

  // The last frame is over, and so is what tracking kept for the next one.
  void end_tracking() {
    tracker.mLastFrame_mvpMapPoints.clear();
    tracker.mvpLocalKeyFrames.clear();
    tracker.mvpLocalMapPoints.clear();
    tracker.mpReferenceKF = nullptr;
  }
  // System::Reset: everything is forgotten. By a thread that takes part, when no other one runs.
  void reset() {
    for (auto& kf : keyframes)
      if (S::raw(kf) != nullptr && !S::raw(kf)->inserted) program.retire(S::raw(kf));
    for (auto& p : points)
      if (S::raw(p) != nullptr && !S::raw(p)->inserted) program.retire(S::raw(p));
    database.clear();
    map.clear();
    tracker.mlpReferences.clear();
    end_tracking();
    S::drop_all(keyframes);
    S::drop_all(points);
  }

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  typename S::program& program;
  const session& of;
  // Whoever makes an object owns it until it is marked and the session names it no more: the pointers that the recorded
  // program had in queues, frames and functions.
  owning_vector<S, typename S::template handle<Frame>> keyframes;
  owning_vector<S, typename S::template handle<Point>> points;
  Map<S> map;
  KeyFrameDatabase<S> database;
  tracking_members<S> tracker;

 private:
  typename S::program::template root<Map<S>> map_root_;
  typename S::program::template root<KeyFrameDatabase<S>> database_root_;
};

}  // namespace replay
