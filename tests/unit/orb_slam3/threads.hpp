// The threads' members that hold keyframes and points, and what the threads do to the map with them. See map.hpp.
#pragma once

#include <cstddef>
#include <list>
#include <mutex>
#include <vector>

#include "map.hpp"

namespace orb_slam3 {

template <class S>
struct Frame {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mvpMapPoints",
           mvpMapPoints);  // its points are used once more: CheckReplacedInLastFrame
    v.edge("mpReferenceKF", mpReferenceKF);
    v.edge("mpLastKeyFrame", mpLastKeyFrame);
  }
  std::vector<MapPoint<S>*> slots() {
    return std::vector<MapPoint<S>*>(mvpMapPoints.begin(), mvpMapPoints.end());
  }

  typename S::template vector<MapPoint<S>> mvpMapPoints;
  typename S::template pointer<KeyFrame<S>> mpReferenceKF{}, mpLastKeyFrame{};
};

template <class S>
class LocalMapping {
  using KF = KeyFrame<S>;

 public:
  void InsertKeyFrame(KF* kf) {
    const lock l(mMutexNewKFs);
    mlNewKeyFrames.push_back(kf);
  }
  bool CheckNewKeyFrames() {
    const lock l(mMutexNewKFs);
    return !mlNewKeyFrames.empty();
  }
  void ProcessNewKeyFrame(Atlas<S>& atlas) {
    {
      const lock l(mMutexNewKFs);
      mpCurrentKeyFrame = *mlNewKeyFrames.begin();
      mlNewKeyFrames.pop_front();
    }
    KF* const kf = mpCurrentKeyFrame;
    const std::vector<MapPoint<S>*> slots = kf->GetMapPointMatches();
    for (std::size_t i = 0; i != slots.size(); ++i) {
      MapPoint<S>* const p = slots[i];
      if (p == nullptr || p->isBad()) continue;  // the slot of a bad point stays
      if (p->IsInKeyFrame(kf))
        mlpRecentAddedMapPoints.push_back(p);
      else
        p->AddObservation(kf, i);
    }
    kf->UpdateConnections();
    atlas.GetCurrentMap()->AddKeyFrame(kf);
  }
  // What is queued is deleted, although others know it already.
  void Release() {
    const lock l(mMutexNewKFs);
    for (KF* const kf : mlNewKeyFrames) S::destroy(kf);
    mlNewKeyFrames.clear();
  }
  void ResetIfRequested() {
    const lock l(mMutexNewKFs);
    mlNewKeyFrames.clear();
    mlpRecentAddedMapPoints.clear();
  }

  template <class Visitor>
  void edges(Visitor& v) {
    {
      const lock l(mMutexNewKFs);
      v.edge("mlNewKeyFrames", mlNewKeyFrames);
    }
    v.edge("mpCurrentKeyFrame", mpCurrentKeyFrame);
    v.edge("mlpRecentAddedMapPoints", mlpRecentAddedMapPoints, on::erase);
  }

  typename S::template registry<typename S::template list<KF>> mlNewKeyFrames;
  typename S::template pointer<KF> mpCurrentKeyFrame{};
  typename S::template list<MapPoint<S>> mlpRecentAddedMapPoints;

 private:
  std::mutex mMutexNewKFs;
};

template <class S>
class LoopClosing {
  using KF = KeyFrame<S>;
  using Point = MapPoint<S>;

 public:
  void InsertKeyFrame(KF* kf) {
    const lock l(mMutexLoopQueue);
    mlpLoopKeyFrameQueue.push_back(kf);
  }
  // Takes one from the queue, and adds it to the database, bad or not.
  void NewDetectCommonRegions(KeyFrameDatabase<S>& database) {
    {
      const lock l(mMutexLoopQueue);
      mpCurrentKF = *mlpLoopKeyFrameQueue.begin();
      mlpLoopKeyFrameQueue.pop_front();
    }
    KF* const kf = mpCurrentKF;
    kf->SetNotErase();
    database.add(kf);
    mpLastCurrentKF = kf;
    kf->SetErase();
  }
  // A loop candidate was found; it has to be found again from the next keyframes.
  void match(KF* current, KF* candidate, const std::vector<Point*>& points) {
    current->SetNotErase();
    candidate->SetNotErase();
    mpLoopLastCurrentKF = current;
    mpLoopMatchedKF = candidate;
    mvpLoopMapPoints.clear();
    mvpLoopMatchedMPs.clear();
    for (Point* const p : points) {
      mvpLoopMapPoints.push_back(p);
      mvpLoopMatchedMPs.push_back(p);
    }
    mnLoopNumCoincidences = 1;
  }
  // The candidate was not found again: both are released.
  void give_up() {
    KF* const last = mpLoopLastCurrentKF;
    KF* const matched = mpLoopMatchedKF;
    last->SetErase();
    matched->SetErase();
    mnLoopNumCoincidences = 0;
    mvpLoopMatchedMPs.clear();
  }
  // The matched points are fused into the current keyframe, bad or not.
  void CorrectLoop(KF* current) {
    for (std::size_t i = 0; i != mvpLoopMatchedMPs.size(); ++i) {
      Point* const matched = mvpLoopMatchedMPs[i];
      if (matched == nullptr) continue;
      Point* const here = current->GetMapPointMatches()[i];
      if (here != nullptr) {
        here->Replace(matched);
      } else {
        current->AddMapPoint(matched, i);
        matched->AddObservation(current, i);
      }
    }
    KF* const other = mpLoopMatchedKF;
    current->AddLoopEdge(other);
    other->AddLoopEdge(current);
  }
  // @p map null: of all maps.
  void ResetIfRequested(Map<S>* map) {
    const lock l(mMutexLoopQueue);
    for (auto i = mlpLoopKeyFrameQueue.begin(); i != mlpLoopKeyFrameQueue.end();) {
      KF* const kf = *i;
      i = map == nullptr || kf->GetMap() == map ? mlpLoopKeyFrameQueue.erase(i) : std::next(i);
    }
    if (!S::adapted) return;
    mpCurrentKF = mpLastCurrentKF = mpLoopLastCurrentKF = mpLoopMatchedKF = mpMergeLastCurrentKF =
        mpMergeMatchedKF = nullptr;
    mnLoopNumCoincidences = 0;
  }

  template <class Visitor>
  void edges(Visitor& v) {
    {
      const lock l(mMutexLoopQueue);
      v.edge("mlpLoopKeyFrameQueue", mlpLoopKeyFrameQueue, on::erase);
    }
    v.edge("mpCurrentKF", mpCurrentKF);
    v.edge("mpLastCurrentKF", mpLastCurrentKF);
    v.edge("mpLoopLastCurrentKF", mpLoopLastCurrentKF);
    v.edge("mpLoopMatchedKF", mpLoopMatchedKF);
    v.edge("mpMergeLastCurrentKF", mpMergeLastCurrentKF);
    v.edge("mpMergeMatchedKF", mpMergeMatchedKF);
    v.edge("mvpLoopMatchedMPs", mvpLoopMatchedMPs, on::null);  // an index is a keypoint
    v.edge("mvpLoopMapPoints", mvpLoopMapPoints, on::erase);
    v.edge("mvpMergeConnectedKFs", mvpMergeConnectedKFs, on::erase);
  }

  typename S::template list<KF> mlpLoopKeyFrameQueue;
  typename S::template pointer<KF> mpCurrentKF{}, mpLastCurrentKF{}, mpLoopLastCurrentKF{},
      mpLoopMatchedKF{}, mpMergeLastCurrentKF{}, mpMergeMatchedKF{};
  typename S::template vector<Point> mvpLoopMatchedMPs, mvpLoopMapPoints;
  typename S::template vector<KF> mvpMergeConnectedKFs;
  int mnLoopNumCoincidences = 0;

 private:
  std::mutex mMutexLoopQueue;
};

template <class S>
class Tracking {
  using KF = KeyFrame<S>;
  using Point = MapPoint<S>;

 public:
  using Reference = typename S::template reference<KF, PoseRecord<S>>;

  // For each frame, for ever, its reference keyframe; and its pose to that.
  void add_to_trajectory(const Pose& to_reference) {
    mlpReferences.push_back(Reference(static_cast<KF*>(mpReferenceKF)));
    mlRelativeFramePoses.push_back(to_reference);
  }
  // From bad keyframe to parent, until one is good.
  std::vector<Pose> SaveTrajectory() {
    std::vector<Pose> poses;
    auto pose = mlRelativeFramePoses.begin();
    for (const Reference& reference : mlpReferences) {
      Pose to_world;
      if constexpr (S::adapted) {
        for (Reference at = reference; at;)
          at = at.read(
              [&](KF& kf) {
                const bool bad = kf.isBad();
                to_world = to_world * (bad ? kf.mTcp : kf.mTcw);
                return bad ? Reference(kf.GetParent()) : Reference();
              },
              [&](const PoseRecord<S>& culled) {
                to_world = to_world * culled.mTcp;
                return culled.parent;
              });
      } else {
        KF* kf = reference;
        for (; kf->isBad(); kf = kf->GetParent()) to_world = to_world * kf->mTcp;
        to_world = to_world * kf->mTcw;
      }
      poses.push_back(*pose++ * to_world);
    }
    return poses;
  }

  // The frame that was the current one becomes the last one; its successor matches these.
  void Track(const std::vector<Point*>& matches) {
    CheckReplacedInLastFrame();
    mCurrentFrame.mvpMapPoints.clear();
    for (Point* const p : matches) mCurrentFrame.mvpMapPoints.push_back(p);
    mCurrentFrame.mpReferenceKF = static_cast<KF*>(mpReferenceKF);
    mCurrentFrame.mpLastKeyFrame = static_cast<KF*>(mpLastKeyFrame);
    mLastFrame.mvpMapPoints.clear();
    for (Point* const p : matches) mLastFrame.mvpMapPoints.push_back(p);
    mLastFrame.mpReferenceKF = static_cast<KF*>(mpReferenceKF);
    mLastFrame.mpLastKeyFrame = static_cast<KF*>(mpLastKeyFrame);
  }
  // One hop along mpReplaced: needs the replaced point and its successor.
  void CheckReplacedInLastFrame() {
    for (std::size_t i = 0; i != mLastFrame.mvpMapPoints.size(); ++i) {
      Point* const p = mLastFrame.mvpMapPoints[i];
      if (p == nullptr) continue;
      Point* const by = p->GetReplaced();
      if (by == nullptr) continue;
      by->used();
      mLastFrame.mvpMapPoints[i] = by;
    }
  }
  void UpdateLocalMap(const std::vector<KF*>& keyframes) {
    mvpLocalKeyFrames.clear();
    mvpLocalMapPoints.clear();
    for (KF* const kf : keyframes) {
      mvpLocalKeyFrames.push_back(kf);
      for (Point* const p : kf->GetMapPointMatches())
        if (p != nullptr && !p->isBad()) mvpLocalMapPoints.push_back(p);
    }
  }
  // Takes the current frame's slots. The chain in time is made whatever the sensor is.
  auto CreateNewKeyFrame(long id, std::vector<std::size_t> words, Map<S>* map,
                         KeyFrameDatabase<S>* database) {
    const auto made =
        S::template make<KF>(id, mCurrentFrame.slots(), std::move(words), map, database);
    KF* const kf = made;
    if (KF* const last = mpLastKeyFrame) {
      last->used();
      kf->mPrevKF = last;
      last->mNextKF = kf;
    }
    mpReferenceKF = kf;
    mpLastKeyFrame = kf;
    mCurrentFrame.mpReferenceKF = kf;
    return made;
  }
  // What a frame does with the members that it keeps: each has to exist.
  void use_members() {
    for (KF* const kf : {static_cast<KF*>(mpReferenceKF), static_cast<KF*>(mpLastKeyFrame),
                         static_cast<KF*>(mCurrentFrame.mpReferenceKF),
                         static_cast<KF*>(mLastFrame.mpReferenceKF)})
      if (kf != nullptr) kf->GetParent();
    for (Point* const p : mvpLocalMapPoints)
      if (p != nullptr) p->isBad();
    for (KF* const kf : mvpLocalKeyFrames)
      if (kf != nullptr) kf->isBad();
  }
  // What Reset, ResetActiveMap and CreateMapInAtlas have in common. The rest stays as it is.
  void forget_frames() {
    mCurrentFrame = Frame<S>();
    mLastFrame = Frame<S>();
    mpReferenceKF = nullptr;
    mpLastKeyFrame = nullptr;
  }

  template <class Visitor>
  void edges(Visitor& v) {
    mCurrentFrame.edges(v);
    mLastFrame.edges(v);
    v.edge("mpReferenceKF", mpReferenceKF);
    v.edge("mpLastKeyFrame", mpLastKeyFrame);
    v.edge("mvpLocalKeyFrames", mvpLocalKeyFrames, on::erase);
    v.edge("mvpLocalMapPoints", mvpLocalMapPoints, on::erase);
  }

  Frame<S> mCurrentFrame, mLastFrame;
  typename S::template pointer<KF> mpReferenceKF{}, mpLastKeyFrame{};
  typename S::template vector<KF> mvpLocalKeyFrames;
  typename S::template vector<Point> mvpLocalMapPoints;
  std::list<Reference> mlpReferences;
  std::list<Pose> mlRelativeFramePoses;
};

// FrameDrawer's and System's members, which the tracking thread fills.
template <class S>
struct Outputs {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mTrackedMapPoints", mTrackedMapPoints, on::null);  // an index is a keypoint
    v.edge("mvpLocalMap", mvpLocalMap, on::erase);
  }
  typename S::template vector<MapPoint<S>> mTrackedMapPoints, mvpLocalMap;
};

// A snapshot of a whole map that is worked on for minutes, by a thread of its own.
template <class S>
class GlobalBundleAdjustment {
 public:
  void begin(Map<S>* map) {
    of_.clear();
    keyframes_.clear();
    points_.clear();
    of_.push_back(map);
    for (KeyFrame<S>* const kf : map->GetAllKeyFrames()) keyframes_.push_back(kf);
    for (MapPoint<S>* const p : map->GetAllMapPoints()) points_.push_back(p);
  }
  // Writes poses back to what has not gone bad.
  std::size_t write_back() {
    std::size_t written = 0;
    for (Map<S>* const map : of_) map->GetInitKFid();
    for (KeyFrame<S>* const kf : keyframes_) written += !kf->isBad();
    for (MapPoint<S>* const p : points_) written += !p->isBad();
    return written;
  }
  void end() {
    of_.clear();
    keyframes_.clear();
    points_.clear();
  }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("of", of_);
    v.edge("vpKFs", keyframes_);
    v.edge("vpMPs", points_);
  }

 private:
  typename S::template snapshot<Map<S>> of_;
  typename S::template snapshot<KeyFrame<S>> keyframes_;
  typename S::template snapshot<MapPoint<S>> points_;
};

}  // namespace orb_slam3
