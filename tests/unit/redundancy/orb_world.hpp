// Keyframes and points in three shapes, with the functions of ORB-SLAM and the hooks in them: ORB-SLAM2 and ORB-SLAM3 with raw pointers,
// ORB-SLAM3 with slamgc's counted members. And the rule as ORB-SLAM3's KeyFrameCulling has it, written without the library.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <slamgc/adapters/orb_slam3.hpp>
#include <slamgc/adapters/orb_slam_redundancy.hpp>
#include <tuple>
#include <utility>
#include <vector>

namespace orb_hooks {

namespace red = slamgc::redundancy;

template <class S>
struct KeyFrame;
template <class S>
struct MapPoint;
template <class S>
using Redundancy = slamgc::orb_slam3::redundancy_hooks<KeyFrame<S>, MapPoint<S>>;

struct KeyPoint {
  int octave;
};

struct OrbSlam2 {
  static constexpr bool two_cameras = false, counted = false;
  using Indices = std::size_t;
  struct Cameras {};
  template <class T>
  using Slots = std::vector<T*>;
  template <class T>
  using Observations = std::map<T*, Indices>;
  template <class T>
  struct KeyFrameBase {};
  template <class T>
  struct MapPointBase {};
};
struct OrbSlam3 : OrbSlam2 {
  static constexpr bool two_cameras = true;
  using Indices = std::tuple<int, int>;
  struct Cameras {
    int NLeft = -1;
    std::vector<KeyPoint> mvKeys, mvKeysRight;
  };
  template <class T>
  using Observations = std::map<T*, Indices>;
};
struct Counted : OrbSlam3 {
  static constexpr bool counted = true;
  template <class T>
  using Slots = slamgc::rc_vector<T>;
  template <class T>
  using Observations = slamgc::rc_map<T, Indices>;
  // The members that the adapter asks for besides.
  template <class T>
  struct KeyFrameBase : slamgc::orb_slam3::keyframe_base<T, int> {
    std::mutex mMutexConnections;
    slamgc::rc_map<T, int> mConnectedKeyFrameWeights;
    slamgc::rc_vector<T> mvpOrderedConnectedKeyFrames;
    std::vector<int> mvOrderedWeights;
    slamgc::rc_slot<T> mpParent;
    slamgc::rc_set<T> mspChildrens, mspLoopEdges;
    int mTcp = 0;
    int GetPose() const { return 0; }
    T* GetParent() const { return mpParent; }
  };
  template <class T>
  struct MapPointBase : slamgc::orb_slam3::map_point_base<T> {
    slamgc::rc_slot<KeyFrame<Counted>> mpRefKF;
    slamgc::rc_slot<T> mpReplaced;
  };
};

// Gives each address again at once, to the next one.
template <class T>
struct Reused {
  static inline bool reuse = false;
  static inline std::vector<void*> blocks;
  static inline int again = 0;
  static void* operator new(std::size_t n) {
    if (blocks.empty()) return ::operator new(n);
    void* const p = blocks.back();
    blocks.pop_back();
    ++again;
    return p;
  }
  static void operator delete(void* p) {
    if (reuse)
      blocks.push_back(p);
    else
      ::operator delete(p);
  }
  static void end_reuse() {
    reuse = false;
    for (void* p : blocks) ::operator delete(p);
    blocks.clear();
    again = 0;
  }
};

template <class S>
struct KeyFrame : S::template KeyFrameBase<KeyFrame<S>>, S::Cameras, Reused<KeyFrame<S>> {
  friend slamgc::orb_slam3::access;

  // Of a frame that has the points, with a second camera from slot left on (-1: without). Or of a file: it is told in PostLoad.
  KeyFrame(const std::vector<int>& octaves, const std::vector<float>& depths, int left,
           const std::vector<MapPoint<S>*>& vpMapPoints, bool bFromFile = false)
      : N(static_cast<int>(octaves.size())), mvDepth(depths) {
    for (int i = 0; i != N; ++i) {
      const KeyPoint key{octaves[static_cast<std::size_t>(i)]};
      if constexpr (S::two_cameras)
        if (left != -1) (i < left ? this->mvKeys : this->mvKeysRight).push_back(key);
      mvKeysUn.push_back(key);
    }
    if constexpr (S::two_cameras) {
      this->NLeft = left;
      // As ORB-SLAM3: the arrays end with the left camera, mvKeysUn is empty.
      if (left != -1) mvKeysUn.clear(), mvDepth.resize(static_cast<std::size_t>(left));
    }
    mvpMapPoints = vpMapPoints;
    if (!bFromFile) Redundancy<S>::add_keyframe(this);
  }
  ~KeyFrame() { Redundancy<S>::remove_keyframe(this); }

  bool isBad() const { return mbBad; }
  void PostLoad() { Redundancy<S>::add_keyframe(this); }
  void AddMapPoint(MapPoint<S>* pMP, std::size_t idx) {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    Redundancy<S>::set_slot(this, idx, pMP);
    mvpMapPoints[idx] = pMP;
  }
  void EraseMapPointMatch(std::size_t idx) {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    Redundancy<S>::clear_slot(this, idx);
    mvpMapPoints[idx] = nullptr;
  }
  void SetBadFlag() {
    for (MapPoint<S>* pMP : Points())
      if (pMP != nullptr) pMP->EraseObservation(this);
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    Redundancy<S>::remove_keyframe(this);
    mbBad = true;
  }
  std::vector<MapPoint<S>*> Points() {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    return std::vector<MapPoint<S>*>(mvpMapPoints.begin(), mvpMapPoints.end());
  }
  int Octave(int i) const {
    const auto at = static_cast<std::size_t>(i);
    if constexpr (S::two_cameras)
      if (this->NLeft != -1)
        return i < this->NLeft
                   ? this->mvKeys[at].octave
                   : this->mvKeysRight[at - static_cast<std::size_t>(this->NLeft)].octave;
    return mvKeysUn[at].octave;
  }
  int Left() const {
    if constexpr (S::two_cameras) return this->NLeft == -1 ? N : this->NLeft;
    return N;
  }

  const int N;
  const unsigned long mnId = 0;
  std::vector<KeyPoint> mvKeysUn;
  std::vector<float> mvDepth;
  const float mThDepth = 5;
  typename Redundancy<S>::keyframe_state mRedundancy;

 private:
  bool mbBad = false;
  typename S::template Slots<MapPoint<S>> mvpMapPoints;
  std::mutex mMutexFeatures;
};

template <class S>
struct MapPoint : S::template MapPointBase<MapPoint<S>>, Reused<MapPoint<S>> {
  friend slamgc::orb_slam3::access;
  using Indices = typename S::Indices;

  bool isBad() const { return mbBad; }
  void AddObservation(KeyFrame<S>* pKF, int idx) {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    Indices indexes{};
    if constexpr (S::two_cameras) {
      const auto it = mObservations.find(pKF);
      indexes = it != mObservations.end() ? Indices(it->second) : Indices(-1, -1);
      (idx < pKF->Left() ? std::get<0>(indexes) : std::get<1>(indexes)) = idx;
    } else {
      indexes = static_cast<std::size_t>(idx);
    }
    Redundancy<S>::set_observation(pKF, this, indexes);
    mObservations[pKF] = indexes;
  }
  void EraseObservation(KeyFrame<S>* pKF) {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    Redundancy<S>::erase_observation(pKF, this);
    mObservations.erase(pKF);
  }
  // The slots follow.
  std::map<KeyFrame<S>*, Indices> MarkBad() {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    Redundancy<S>::mark_bad(this);
    mbBad = true;
    std::map<KeyFrame<S>*, Indices> obs;
    for (const auto& [pKF, indexes] : mObservations) obs.emplace(pKF, indexes);
    mObservations.clear();
    return obs;
  }
  void SetBadFlag() {
    for (const auto& [pKF, indexes] : MarkBad())
      for (const int idx : Slots(indexes)) pKF->EraseMapPointMatch(static_cast<std::size_t>(idx));
  }
  void Replace(MapPoint* pMP) {
    for (const auto& [pKF, indexes] : MarkBad())
      for (const int idx : Slots(indexes)) {
        if (pMP->Observations().count(pKF) == 0) {
          pKF->AddMapPoint(pMP, static_cast<std::size_t>(idx));
          pMP->AddObservation(pKF, idx);
        } else {
          pKF->EraseMapPointMatch(static_cast<std::size_t>(idx));
        }
      }
  }
  std::map<KeyFrame<S>*, Indices> Observations() {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    std::map<KeyFrame<S>*, Indices> obs;
    for (const auto& [pKF, indexes] : mObservations) obs.emplace(pKF, indexes);
    return obs;
  }
  void PostLoad(const std::map<KeyFrame<S>*, Indices>& obs) {
    for (const auto& [pKF, indexes] : obs) mObservations[pKF] = indexes;
    Redundancy<S>::add_point(this);
  }
  static std::vector<int> Slots(const Indices& indexes) {
    std::vector<int> slots;
    if constexpr (S::two_cameras) {
      if (std::get<0>(indexes) != -1) slots.push_back(std::get<0>(indexes));
      if (std::get<1>(indexes) != -1) slots.push_back(std::get<1>(indexes));
    } else {
      slots.push_back(static_cast<int>(indexes));
    }
    return slots;
  }

  const unsigned long mnId = 0;
  typename Redundancy<S>::point_state mRedundancy;

 private:
  bool mbBad = false;
  typename S::template Observations<KeyFrame<S>> mObservations;
  std::mutex mMutexFeatures;
};

// The rule: eligible slots and redundant ones.
template <class S>
std::pair<int, int> walk(KeyFrame<S>& kf, bool by_depth, int others) {
  std::pair<int, int> n;
  if (kf.isBad()) return n;
  const auto points = kf.Points();
  for (int i = 0; i != kf.Left(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (points[at] == nullptr || points[at]->isBad()) continue;
    if (by_depth && (kf.mvDepth[at] > kf.mThDepth || kf.mvDepth[at] < 0)) continue;
    ++n.first;
    int better = 0;
    for (const auto& [pKFi, indexes] : points[at]->Observations()) {
      if (pKFi == &kf) continue;
      int level = 8;
      for (const int idx : MapPoint<S>::Slots(indexes)) level = std::min(level, pKFi->Octave(idx));
      better += level <= kf.Octave(i) + 1;
    }
    n.second += better >= others;
  }
  return n;
}

}  // namespace orb_hooks
