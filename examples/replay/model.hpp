// Keyframes and points with those members and locks of ORB-SLAM3 that refer to each other, in a scheme (schemes.hpp).
//
// Written from facts about ORB-SLAM3: names of classes and members are its own, the code is this project's. Each function is a step
// of a session, or what a thread reads; the members' descriptions are those of docs/orb-slam3-cases.md.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <mutex>
#include <slamgc/slamgc.hpp>
#include <utility>
#include <vector>

#include "footprint.hpp"
#include "ledger.hpp"

namespace replay {

namespace on = slamgc::on_retire;
using lock = std::lock_guard<std::mutex>;

template <class S>
class MapPoint;
template <class S>
class KeyFrame;

// What a function works on: as the scheme has it.
template <class S, class T>
using local = typename S::template local<T>;
template <class S, class T>
using owning_vector = std::vector<T, typename S::template allocator<T>>;
template <class S, class T>
using locals = owning_vector<S, local<S, T>>;

// Copies up to most elements of a container, under the lock that its caller holds.
template <class S, class T, class Container>
locals<S, T> copied(const Container& from, std::size_t most = static_cast<std::size_t>(-1)) {
  locals<S, T> to;
  to.reserve(std::min(most, from.size()));
  for (const auto& element : from) {
    if (to.size() == most) break;
    to.push_back(S::template local_of<T>(element));
  }
  return to;
}

// What a culled keyframe leaves, for the trajectory.
template <class S>
struct pose_record {
  long id = -1;
  typename S::template reference<KeyFrame<S>, pose_record> parent{};
};

// Functions that only read are not inlined, as in ORB-SLAM3, where they have files of their own: so the schemes' instructions
// differ by what the schemes do.
template <class S>
class KeyFrame : public mortal<kind::keyframe>,
                 public S::template object<KeyFrame<S>>,
                 public S::template leaves_record<KeyFrame<S>, pose_record<S>> {
  using Point = MapPoint<S>;

 public:
  KeyFrame(long id, const std::vector<std::uint8_t>& octaves)
      : mnId(id), mvOctaves(octaves), own(static_cast<std::uint64_t>(id), octaves.size()) {
    mvpMapPoints.resize(octaves.size());
  }

  // ---- covisibility

  void AddConnection(KeyFrame* kf, int weight) {
    this->used();
    const lock l(mMutexConnections);
    mConnectedKeyFrameWeights[kf] = weight;
  }
  void EraseConnection(KeyFrame* kf) {
    this->used();
    const lock l(mMutexConnections);
    mConnectedKeyFrameWeights.erase(kf);
  }
  // Asks each neighbour whether it is bad; so each has to exist.
  void UpdateBestCovisibles() {
    this->used();
    owning_vector<S, std::pair<int, local<S, KeyFrame>>> good;
    {
      const lock l(mMutexConnections);
      good.reserve(mConnectedKeyFrameWeights.size());
      for (const auto& entry : mConnectedKeyFrameWeights)
        good.emplace_back(entry.second, S::template local_of<KeyFrame>(entry.first));
    }
    const auto bad = [](const auto& entry) { return S::raw(entry.second)->isBad(); };
    good.erase(std::remove_if(good.begin(), good.end(), bad), good.end());
    std::sort(good.begin(), good.end(), [](const auto& a, const auto& b) {
      return a.first != b.first ? a.first > b.first
                                : S::raw(a.second)->mnId < S::raw(b.second)->mnId;
    });
    locals<S, KeyFrame> sorted;
    std::vector<int> weights;
    for (auto& entry : good) {
      weights.push_back(entry.first);
      sorted.push_back(std::move(entry.second));
    }
    const lock l(mMutexConnections);
    S::assign(mvpOrderedConnectedKeyFrames, sorted);
    mvOrderedWeights = std::move(weights);
  }
  [[gnu::noinline]] locals<S, KeyFrame> GetBestCovisibilityKeyFrames(std::size_t most) {
    this->used();
    const lock l(mMutexConnections);
    return copied<S, KeyFrame>(mvpOrderedConnectedKeyFrames, most);
  }
  std::size_t Connections() {
    this->used();
    const lock l(mMutexConnections);
    return mConnectedKeyFrameWeights.size();
  }

  // ---- points

  void AddMapPoint(Point* p, std::size_t i) {
    this->used();
    const lock l(mMutexFeatures);
    mvpMapPoints[i] = p;
  }
  // With nulls: the index is the feature's.
  [[gnu::noinline]] locals<S, Point> GetMapPointMatches() {
    this->used();
    const lock l(mMutexFeatures);
    return copied<S, Point>(mvpMapPoints);
  }

  // ---- spanning tree, loops, time

  void ChangeParent(KeyFrame* kf) {
    this->used();
    const lock l(mMutexConnections);
    mpParent = kf;
  }
  void AddChild(KeyFrame* kf) {
    this->used();
    const lock l(mMutexConnections);
    mspChildrens.insert(kf);
  }
  void EraseChild(KeyFrame* kf) {
    this->used();
    const lock l(mMutexConnections);
    mspChildrens.erase(kf);
  }
  void AddLoopEdge(KeyFrame* kf) {
    this->used();
    const lock l(mMutexConnections);
    mspLoopEdges.insert(kf);
  }
  void AddMergeEdge(KeyFrame* kf) {
    this->used();
    const lock l(mMutexConnections);
    mspMergeEdges.insert(kf);
  }
  // ORB-SLAM3 takes no lock here; then it could not be counted by most schemes.
  void Link(KeyFrame* previous, KeyFrame* next) {
    this->used();
    const lock l(mMutexConnections);
    mPrevKF = previous;
    mNextKF = next;
  }
  [[gnu::noinline]] local<S, KeyFrame> GetParent() {
    this->used();
    const lock l(mMutexConnections);
    return S::template local_of<KeyFrame>(mpParent);
  }
  [[gnu::noinline]] locals<S, KeyFrame> GetChilds() {
    this->used();
    const lock l(mMutexConnections);
    return copied<S, KeyFrame>(mspChildrens);
  }

  // ---- life

  void SetBadFlag() {
    this->used();
    this->marked();
    const lock l(mMutexConnections);
    mbBad = true;
  }
  [[gnu::noinline]] bool isBad() {
    this->used();
    const lock l(mMutexConnections);
    return mbBad;
  }
  // As if it were deleted: its counted references end.
  void bury() {
    {
      const lock l(mMutexConnections);
      mConnectedKeyFrameWeights.clear();
      mvpOrderedConnectedKeyFrames.clear();
      mvOrderedWeights.clear();
    }
    this->die();
  }
  pose_record<S> record() {
    const lock l(mMutexConnections);
    return {mnId, S::template reference_to<KeyFrame, pose_record<S>>(S::plain(mpParent))};
  }

  template <class Visitor>
  void edges(Visitor& v) {
    {
      const lock l(mMutexFeatures);
      v.edge("mvpMapPoints", mvpMapPoints, on::null);
    }
    const lock l(mMutexConnections);
    v.edge("mConnectedKeyFrameWeights", mConnectedKeyFrameWeights, on::erase);
    v.edge("mvpOrderedConnectedKeyFrames", mvpOrderedConnectedKeyFrames,
           on::erase_with(mvOrderedWeights));
    if (mbBad)  // its pose is relative to this one
      v.edge("mpParent", mpParent);
    else
      v.edge("mpParent", mpParent, on::bypass([this](KeyFrame& bad) {
               KeyFrame* const next = bad.mpParent;
               if (next != nullptr && next != this) next->AddChild(this);
               return next;
             }));
    v.edge("mspChildrens", mspChildrens, on::erase);
    v.edge("mspLoopEdges", mspLoopEdges, on::erase);
    v.edge("mspMergeEdges", mspMergeEdges, on::erase);
    v.edge("mPrevKF", mPrevKF, on::bypass([](KeyFrame& bad) { return S::plain(bad.mPrevKF); }));
    v.edge("mNextKF", mNextKF, on::bypass([](KeyFrame& bad) { return S::plain(bad.mNextKF); }));
  }

  const long mnId;
  const std::vector<std::uint8_t> mvOctaves;
  const keyframe_footprint own;

  typename S::template vector<Point> mvpMapPoints;
  typename S::template chosen_map<KeyFrame, int> mConnectedKeyFrameWeights;
  typename S::template chosen_vector<KeyFrame> mvpOrderedConnectedKeyFrames;
  std::vector<int> mvOrderedWeights;
  typename S::template pointer<KeyFrame> mpParent{}, mPrevKF{}, mNextKF{};
  typename S::template set<KeyFrame> mspChildrens, mspLoopEdges, mspMergeEdges;
  bool mbBad = false, inserted = false;

 private:
  std::mutex mMutexFeatures, mMutexConnections;
};

template <class S>
class MapPoint : public mortal<kind::point>, public S::template object<MapPoint<S>> {
  using Frame = KeyFrame<S>;

 public:
  explicit MapPoint(long id) : mnId(id) {}

  void AddObservation(Frame* kf, std::size_t i) {
    this->used();
    const lock l(mMutexFeatures);
    if (mObservations.empty()) {
      mpRefKF = kf;
      own.best = kf->own.mDescriptors[i];
    }
    mObservations[kf] = i;
  }
  void EraseObservation(Frame* kf) {
    this->used();
    const lock l(mMutexFeatures);
    mObservations.erase(kf);
    if (S::plain(mpRefKF) == kf) mpRefKF = first_observer();
  }
  [[gnu::noinline]] owning_vector<S, std::pair<local<S, Frame>, std::size_t>> GetObservations() {
    this->used();
    owning_vector<S, std::pair<local<S, Frame>, std::size_t>> all;
    const lock l(mMutexFeatures);
    all.reserve(mObservations.size());
    for (const auto& entry : mObservations) {
      auto kf = S::template local_of<Frame>(entry.first);
      if (S::raw(kf) != nullptr)
        all.emplace_back(std::move(kf), entry.second);  // a weak one may have gone
    }
    return all;
  }
  [[gnu::noinline]] std::size_t Observations() {
    this->used();
    const lock l(mMutexFeatures);
    return mObservations.size();
  }
  [[gnu::noinline]] local<S, MapPoint> GetReplaced() {
    this->used();
    const lock l(mMutexFeatures);
    return S::template local_of<MapPoint>(mpReplaced);
  }
  void Replace(MapPoint* by) {
    this->used();
    const lock l(mMutexFeatures);
    mpReplaced = by;
  }
  void SetBadFlag() {
    this->used();
    this->marked();
    const lock l(mMutexFeatures);
    mbBad = true;
  }
  // As if it were deleted: its counted references end.
  void bury() {
    {
      const lock l(mMutexFeatures);
      mObservations.clear();
    }
    this->die();
  }
  [[gnu::noinline]] bool isBad() {
    this->used();
    const lock l(mMutexFeatures);
    const lock m(mMutexPos);
    return mbBad;
  }
  [[gnu::noinline]] descriptor GetDescriptor() {
    this->used();
    const lock l(mMutexFeatures);
    return own.best;
  }
  [[gnu::noinline]] std::array<float, 3> GetWorldPos() {
    this->used();
    const lock l(mMutexPos);
    return own.mWorldPos;
  }

  template <class Visitor>
  void edges(Visitor& v) {
    const lock l(mMutexFeatures);
    v.edge("mObservations", mObservations, on::erase);  // before mpRefKF, which is one of them
    v.edge("mpRefKF", mpRefKF, on::bypass([this](Frame&) { return first_observer(); }));
    v.edge("mpReplaced", mpReplaced);
  }

  const long mnId;
  point_footprint own;
  long mnTrackReferenceForFrame = -1;  // tracking's own
  typename S::template observations<Frame> mObservations;
  typename S::template up_pointer<Frame> mpRefKF{};
  typename S::template pointer<MapPoint> mpReplaced{};
  bool mbBad = false, inserted = false;

 private:
  Frame* first_observer() {
    Frame* first = nullptr;
    for (const auto& entry : mObservations) {
      Frame* const kf = S::plain(entry.first);
      if (kf != nullptr && (first == nullptr || kf->mnId < first->mnId)) first = kf;
    }
    return first;
  }

  std::mutex mMutexFeatures, mMutexPos;
};

}  // namespace replay
