// A small map with the classes, members and life-cycle functions of ORB-SLAM3, in a scheme (schemes.hpp).
//
// Written from facts about ORB-SLAM3 v1.0: which members exist, and which of them each function clears or leaves. Names of
// classes and members are ORB-SLAM3's; the code is this project's. Monocular: an observation is one index. What a
// function leaves behind there it leaves behind here.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "schemes.hpp"

namespace orb_slam3 {

namespace on = slamgc::on_retire;
using lock = std::lock_guard<std::mutex>;

template <class S>
class Map;
template <class S>
class MapPoint;
template <class S>
class KeyFrameDatabase;

template <class T>
struct by_id {
  bool operator()(const T* a, const T* b) const { return a->mnId < b->mnId; }
};

// In one dimension: x becomes scale * x + shift.
struct Pose {
  double scale = 1, shift = 0;

  Pose operator*(const Pose& b) const { return {scale * b.scale, scale * b.shift + shift}; }
  Pose inverse() const { return {1 / scale, -shift / scale}; }
  bool operator==(const Pose& b) const { return scale == b.scale && shift == b.shift; }
};

template <class S>
class KeyFrame;

// What a culled keyframe leaves, for the trajectory.
template <class S>
struct PoseRecord {
  Pose mTcp;
  typename S::template reference<KeyFrame<S>, PoseRecord> parent{};
};

template <class S>
class KeyFrame : public S::template object<KeyFrame<S>>,
                 public S::template leaves_record<KeyFrame<S>, PoseRecord<S>>,
                 public listed<KeyFrame<S>> {
  using Point = MapPoint<S>;

 public:
  KeyFrame(long id, const std::vector<Point*>& slots, std::vector<std::size_t> words, Map<S>* map,
           KeyFrameDatabase<S>* database)
      : mnId(id), mBowWords(std::move(words)), mpKeyFrameDB(database) {
    for (Point* const p : slots) mvpMapPoints.push_back(p);
    mpMap = map;
  }

  // ---- covisibility

  void AddConnection(KeyFrame* kf, int weight) {
    this->used();
    {
      const lock l(mMutexConnections);
      mConnectedKeyFrameWeights[kf] = weight;
    }
    UpdateBestCovisibles();
  }
  void EraseConnection(KeyFrame* kf) {
    this->used();
    {
      const lock l(mMutexConnections);
      if (mConnectedKeyFrameWeights.count(kf) == 0) return;
      mConnectedKeyFrameWeights.erase(kf);
    }
    UpdateBestCovisibles();
  }
  // Asks each neighbour whether it is bad; so each has to exist.
  void UpdateBestCovisibles() {
    this->used();
    std::vector<std::pair<KeyFrame*, int>> good;
    for (const auto& neighbour : connections())
      if (!neighbour.first->isBad()) good.push_back(neighbour);
    const lock l(mMutexConnections);
    put_ordered(good);
  }
  // The asymmetry: all neighbours become keys here, this becomes a key only of those that share 15 points, or of the best.
  void UpdateConnections() {
    this->used();
    std::map<KeyFrame*, int, by_id<KeyFrame>> shared_points;
    for (Point* const p : GetMapPointMatches()) {
      if (p == nullptr || p->isBad()) continue;
      for (const auto& seen : p->GetObservations())
        if (seen.first != this && !seen.first->isBad() && seen.first->GetMap() == GetMap())
          ++shared_points[seen.first];
    }
    if (shared_points.empty()) return;
    std::vector<std::pair<KeyFrame*, int>> strong;
    std::pair<KeyFrame*, int> best = *shared_points.begin();
    for (const auto& neighbour : shared_points) {
      if (neighbour.second > best.second) best = neighbour;
      if (neighbour.second >= 15) strong.push_back(neighbour);
    }
    if (strong.empty()) strong.push_back(best);
    for (const auto& neighbour : strong) neighbour.first->AddConnection(this, neighbour.second);
    KeyFrame* first_parent = nullptr;
    {
      const lock l(mMutexConnections);
      mConnectedKeyFrameWeights.clear();
      for (const auto& neighbour : shared_points)
        mConnectedKeyFrameWeights[neighbour.first] = neighbour.second;
      put_ordered(strong);
      if (mbFirstConnection && mnId != GetMap()->GetInitKFid()) {
        first_parent = mvpOrderedConnectedKeyFrames[0];
        mpParent = first_parent;
        mbFirstConnection = false;
      }
    }
    if (first_parent != nullptr) first_parent->AddChild(this);
  }
  std::vector<KeyFrame*> GetVectorCovisibleKeyFrames() {
    this->used();
    const lock l(mMutexConnections);
    return std::vector<KeyFrame*>(mvpOrderedConnectedKeyFrames.begin(),
                                  mvpOrderedConnectedKeyFrames.end());
  }

  // ---- points

  void AddMapPoint(Point* p, std::size_t i) {
    this->used();
    const lock l(mMutexFeatures);
    mvpMapPoints[i] = p;
  }
  void EraseMapPointMatch(std::size_t i) { AddMapPoint(nullptr, i); }
  void ReplaceMapPointMatch(std::size_t i, Point* p) { AddMapPoint(p, i); }
  std::vector<Point*> GetMapPointMatches() {
    this->used();
    const lock l(mMutexFeatures);
    return std::vector<Point*>(mvpMapPoints.begin(), mvpMapPoints.end());
  }

  // ---- spanning tree, loops, time

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
  void ChangeParent(KeyFrame* kf) {
    this->used();
    {
      const lock l(mMutexConnections);
      mpParent = kf;
    }
    if (kf != nullptr)
      kf->AddChild(this);
    else if (!S::adapted)
      ++found.null_used;
  }
  KeyFrame* GetParent() {
    this->used();
    const lock l(mMutexConnections);
    return mpParent;
  }
  std::vector<KeyFrame*> GetChilds() {
    this->used();
    const lock l(mMutexConnections);
    std::vector<KeyFrame*> children(mspChildrens.begin(), mspChildrens.end());
    std::sort(children.begin(), children.end(), by_id<KeyFrame>());
    return children;
  }
  void AddLoopEdge(KeyFrame* kf) {
    const lock l(mMutexConnections);
    mbNotErase = true;
    mspLoopEdges.insert(kf);
  }
  void AddMergeEdge(KeyFrame* kf) {
    const lock l(mMutexConnections);
    mbNotErase = true;
    mspMergeEdges.insert(kf);
  }

  // ---- life

  void SetNotErase() {
    this->used();
    const lock l(mMutexConnections);
    mbNotErase = true;
  }
  void SetErase() {
    this->used();
    {
      const lock l(mMutexConnections);
      if (mspLoopEdges.empty()) mbNotErase = false;
    }
    if (mbToBeErased) SetBadFlag();
  }
  void SetBadFlag() {
    this->used();
    Map<S>* const map = GetMap();
    if (map == nullptr) {
      ++found.null_used;
      return;
    }
    {
      const lock l(mMutexConnections);
      if (mnId == map->GetInitKFid()) return;
      if (mbNotErase) {
        mbToBeErased = true;
        return;
      }
    }
    for (const auto& neighbour : connections()) neighbour.first->EraseConnection(this);
    for (Point* const p : GetMapPointMatches())
      if (p != nullptr) p->EraseObservation(this);
    {
      const lock l(mMutexConnections);
      mConnectedKeyFrameWeights.clear();
      mvpOrderedConnectedKeyFrames.clear();
    }
    KeyFrame* const parent = GetParent();
    for (KeyFrame* const child : GetChilds()) child->ChangeParent(parent);
    if (parent != nullptr) parent->EraseChild(this);
    {
      const lock l(mMutexConnections);
      if (parent != nullptr) mTcp = mTcw * parent->mTcw.inverse();
      mbBad = true;
    }
    map->EraseKeyFrame(this);
    mpKeyFrameDB->erase(this);
    S::retire(this);
  }
  bool isBad() {
    this->used();
    const lock l(mMutexConnections);
    return mbBad;
  }
  Map<S>* GetMap() {
    this->used();
    const lock l(mMutexMap);
    return mpMap;
  }
  void UpdateMap(Map<S>* map) {
    this->used();
    const lock l(mMutexMap);
    mpMap = map;
  }

  // For the trajectory.
  PoseRecord<S> record() {
    const lock l(mMutexConnections);
    return {mTcp, typename S::template reference<KeyFrame, PoseRecord<S>>(mpParent)};
  }

  // The table of docs/orb-slam3-cases.md.
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
               if (next != nullptr && next != this && !next->isBad() && next->GetMap() != nullptr)
                 next->AddChild(this);
               return next;
             }));
    v.edge("mspChildrens", mspChildrens, on::erase);
    v.edge("mspLoopEdges", mspLoopEdges, on::erase);
    v.edge("mspMergeEdges", mspMergeEdges, on::erase);
    v.edge("mPrevKF", mPrevKF,
           on::bypass([](KeyFrame& bad) { return static_cast<KeyFrame*>(bad.mPrevKF); }));
    v.edge("mNextKF", mNextKF,
           on::bypass([](KeyFrame& bad) { return static_cast<KeyFrame*>(bad.mNextKF); }));
    const lock m(mMutexMap);
    v.edge("mpMap", mpMap);
  }

  const long mnId;
  const std::vector<std::size_t> mBowWords;
  Pose mTcw, mTcp;  // mTcp: of a bad one, to its parent
  typename S::template pointer<KeyFrame> mPrevKF{}, mNextKF{};
  typename S::template vector<Point> mvpMapPoints;
  typename S::template map<KeyFrame, int> mConnectedKeyFrameWeights;
  typename S::template vector<KeyFrame> mvpOrderedConnectedKeyFrames;
  std::vector<int> mvOrderedWeights;
  typename S::template pointer<KeyFrame> mpParent{};
  typename S::template set<KeyFrame> mspChildrens, mspLoopEdges, mspMergeEdges;
  typename S::template pointer<Map<S>> mpMap{};

 private:
  std::vector<std::pair<KeyFrame*, int>> connections() {
    const lock l(mMutexConnections);
    std::vector<std::pair<KeyFrame*, int>> all;
    for (const auto& entry : mConnectedKeyFrameWeights) all.emplace_back(entry.first, entry.second);
    return all;
  }
  void put_ordered(std::vector<std::pair<KeyFrame*, int>> neighbours) {
    std::sort(neighbours.begin(), neighbours.end(), [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second > b.second : a.first->mnId < b.first->mnId;
    });
    mvpOrderedConnectedKeyFrames.clear();
    mvOrderedWeights.clear();
    for (const auto& neighbour : neighbours) {
      mvpOrderedConnectedKeyFrames.push_back(neighbour.first);
      mvOrderedWeights.push_back(neighbour.second);
    }
  }

  KeyFrameDatabase<S>* const mpKeyFrameDB;
  std::mutex mMutexFeatures, mMutexConnections, mMutexMap;
  bool mbBad = false, mbNotErase = false, mbToBeErased = false, mbFirstConnection = true;
};

template <class S>
class MapPoint : public S::template object<MapPoint<S>>, public listed<MapPoint<S>> {
  using Frame = KeyFrame<S>;

 public:
  MapPoint(long id, Frame* reference, Map<S>* map) : mnId(id) {
    mpRefKF = reference;
    mpMap = map;
  }

  // Of a keyframe that is known it overwrites the index, and counts again.
  void AddObservation(Frame* kf, std::size_t i) {
    this->used();
    const lock l(mMutexFeatures);
    mObservations[kf] = i;
    ++nObs;
  }
  void EraseObservation(Frame* kf) {
    this->used();
    {
      const lock l(mMutexFeatures);
      if (mObservations.count(kf) == 0) return;
      mObservations.erase(kf);
      --nObs;
      if (static_cast<Frame*>(mpRefKF) == kf) {
        if (!S::adapted && mObservations.empty()) ++found.read_past_end;
        mpRefKF = first_observer();
      }
      if (nObs > 2) return;
    }
    SetBadFlag();
  }
  std::vector<std::pair<Frame*, std::size_t>> GetObservations() {
    this->used();
    const lock l(mMutexFeatures);
    std::vector<std::pair<Frame*, std::size_t>> all;
    for (const auto& entry : mObservations) all.emplace_back(entry.first, entry.second);
    return all;
  }
  bool IsInKeyFrame(Frame* kf) {
    this->used();
    const lock l(mMutexFeatures);
    return mObservations.count(kf) != 0;
  }
  Frame* GetReferenceKeyFrame() {
    this->used();
    const lock l(mMutexFeatures);
    return mpRefKF;
  }
  MapPoint* GetReplaced() {
    this->used();
    const lock l(mMutexFeatures);
    return mpReplaced;
  }
  int Observations() {
    this->used();
    const lock l(mMutexFeatures);
    return nObs;
  }
  void SetBadFlag() {
    const auto seen = GetObservations();
    {
      const lock l(mMutexFeatures);
      mbBad = true;
      mObservations.clear();
    }
    for (const auto& s : seen) s.first->EraseMapPointMatch(s.second);
    GetMap()->EraseMapPoint(this);
    S::retire(this);
  }
  void Replace(MapPoint* by) {
    if (by->mnId == mnId) return;
    const auto seen = GetObservations();
    {
      const lock l(mMutexFeatures);
      mbBad = true;
      mObservations.clear();
      mpReplaced = by;
    }
    for (const auto& s : seen) {
      if (by->IsInKeyFrame(s.first)) {
        s.first->EraseMapPointMatch(s.second);
      } else {
        s.first->ReplaceMapPointMatch(s.second, by);
        by->AddObservation(s.first, s.second);
      }
    }
    GetMap()->EraseMapPoint(this);
    S::retire(this);
  }
  bool isBad() {
    this->used();
    const lock l(mMutexFeatures);
    return mbBad;
  }
  Map<S>* GetMap() {
    this->used();
    const lock l(mMutexMap);
    return mpMap;
  }
  void UpdateMap(Map<S>* map) {
    this->used();
    const lock l(mMutexMap);
    mpMap = map;
  }

  template <class Visitor>
  void edges(Visitor& v) {
    const lock l(mMutexFeatures);
    v.edge("mObservations", mObservations, on::erase);  // before mpRefKF, which is one of them
    v.edge("mpRefKF", mpRefKF, on::bypass([this](Frame&) { return first_observer(); }));
    v.edge("mpReplaced", mpReplaced);
    const lock m(mMutexMap);
    v.edge("mpMap", mpMap);
  }

  const long mnId;
  typename S::template map<Frame, std::size_t> mObservations;
  typename S::template pointer<Frame> mpRefKF{};
  typename S::template pointer<MapPoint> mpReplaced{};
  typename S::template pointer<Map<S>> mpMap{};

 private:
  Frame* first_observer() {
    Frame* first = nullptr;
    for (const auto& entry : mObservations) {
      Frame* const kf = entry.first;
      if (first == nullptr || kf->mnId < first->mnId) first = kf;
    }
    return first;
  }

  std::mutex mMutexFeatures, mMutexMap;
  int nObs = 0;
  bool mbBad = false;
};

template <class S>
class Map : public S::template object<Map<S>>, public listed<Map<S>> {
 public:
  explicit Map(long id) : mnId(id) {}

  void AddKeyFrame(KeyFrame<S>* kf) {
    this->used();
    const lock l(mMutexMap);
    if (mspKeyFrames.empty()) {
      mnInitKFid = kf->mnId;
      mpKFinitial = kf;
      mpKFlowerID = kf;
      mvpKeyFrameOrigins.push_back(kf);
    }
    mspKeyFrames.insert(kf);
  }
  void AddMapPoint(MapPoint<S>* p) {
    this->used();
    const lock l(mMutexMap);
    mspMapPoints.insert(p);
  }
  void EraseKeyFrame(KeyFrame<S>* kf) {
    this->used();
    const lock l(mMutexMap);
    mspKeyFrames.erase(kf);
    if (static_cast<KeyFrame<S>*>(mpKFlowerID) != kf || mspKeyFrames.empty()) return;
    mpKFlowerID = *std::min_element(mspKeyFrames.begin(), mspKeyFrames.end(), by_id<KeyFrame<S>>());
  }
  void EraseMapPoint(MapPoint<S>* p) {
    this->used();
    const lock l(mMutexMap);
    mspMapPoints.erase(p);
  }
  void SetReferenceMapPoints(const std::vector<MapPoint<S>*>& points) {
    const lock l(mMutexMap);
    mvpReferenceMapPoints.clear();
    for (MapPoint<S>* const p : points) mvpReferenceMapPoints.push_back(p);
  }
  std::vector<KeyFrame<S>*> GetAllKeyFrames() {
    this->used();
    const lock l(mMutexMap);
    return std::vector<KeyFrame<S>*>(mspKeyFrames.begin(), mspKeyFrames.end());
  }
  std::vector<MapPoint<S>*> GetAllMapPoints() {
    this->used();
    const lock l(mMutexMap);
    return std::vector<MapPoint<S>*>(mspMapPoints.begin(), mspMapPoints.end());
  }
  long GetInitKFid() {
    const lock l(mMutexMap);
    return mnInitKFid;
  }
  KeyFrame<S>* GetOriginKF() {
    const lock l(mMutexMap);
    return mpKFinitial;
  }
  // Forgets what it holds; no object goes bad, none loses an edge.
  void clear() {
    this->used();
    for (KeyFrame<S>* const kf : GetAllKeyFrames()) kf->UpdateMap(nullptr);
    const lock l(mMutexMap);
    mspMapPoints.clear();
    mspKeyFrames.clear();
    mnInitKFid = -1;
    mvpReferenceMapPoints.clear();
    mvpKeyFrameOrigins.clear();
  }

  template <class Visitor>
  void edges(Visitor& v) {
    const lock l(mMutexMap);
    v.edge("mspKeyFrames", mspKeyFrames, on::erase);
    v.edge("mspMapPoints", mspMapPoints, on::erase);
    v.edge("mvpKeyFrameOrigins", mvpKeyFrameOrigins, on::erase);
    v.edge("mpKFinitial", mpKFinitial, on::null);
    v.edge("mpKFlowerID", mpKFlowerID, on::null);
    v.edge("mvpReferenceMapPoints", mvpReferenceMapPoints, on::erase);
  }

  const long mnId;
  typename S::template registry<typename S::template set<KeyFrame<S>>> mspKeyFrames;
  typename S::template registry<typename S::template set<MapPoint<S>>> mspMapPoints;
  typename S::template vector<KeyFrame<S>> mvpKeyFrameOrigins;
  typename S::template pointer<KeyFrame<S>> mpKFinitial{}, mpKFlowerID{};
  typename S::template vector<MapPoint<S>> mvpReferenceMapPoints;

 private:
  std::mutex mMutexMap;
  long mnInitKFid = -1;
};

template <class S>
class KeyFrameDatabase {
 public:
  static constexpr std::size_t words = 8;

  void add(KeyFrame<S>* kf) {
    const lock l(mMutex);
    for (const std::size_t word : kf->mBowWords) mvInvertedFile[word].push_back(kf);
  }
  void erase(KeyFrame<S>* kf) {
    const lock l(mMutex);
    for (const std::size_t word : kf->mBowWords)
      remove_first(mvInvertedFile[word], [kf](KeyFrame<S>* other) { return other == kf; });
  }
  void clear() {
    const lock l(mMutex);
    for (auto& keyframes : mvInvertedFile) keyframes.clear();
  }
  void clearMap(Map<S>* map) {
    const lock l(mMutex);
    for (auto& keyframes : mvInvertedFile)
      while (remove_first(keyframes, [map](KeyFrame<S>* kf) { return kf->GetMap() == map; })) {
      }
  }
  std::vector<KeyFrame<S>*> DetectCandidates(std::size_t word) {
    const lock l(mMutex);
    std::vector<KeyFrame<S>*> all;
    for (KeyFrame<S>* const kf : mvInvertedFile[word])
      if (!kf->isBad()) all.push_back(kf);
    return all;
  }

  template <class Visitor>
  void edges(Visitor& v) {
    const lock l(mMutex);
    for (auto& keyframes : mvInvertedFile) v.edge("mvInvertedFile", keyframes, on::erase);
  }

  typename S::template list<KeyFrame<S>> mvInvertedFile[words];

 private:
  template <class List, class Condition>
  static bool remove_first(List& keyframes, Condition condition) {
    for (auto i = keyframes.begin(); i != keyframes.end(); ++i) {
      if (!condition(*i)) continue;
      keyframes.erase(i);
      return true;
    }
    return false;
  }

  std::mutex mMutex;
};

template <class S>
class Atlas {
 public:
  ~Atlas() {
    if (!S::adapted) return;
    clearAtlas();
    RemoveBadMaps();
  }
  Map<S>* CreateNewMap() {
    const auto map = S::template make<Map<S>>(mnLastMapId++);
    const lock l(mMutexAtlas);
    mpCurrentMap = map;
    mspMaps.insert(map);
    return map;
  }
  // The maps, and all that is in them, are forgotten.
  void clearAtlas() {
    const lock l(mMutexAtlas);
    clear_all(mspMaps);
    mpCurrentMap = nullptr;
  }
  void SetMapBad(Map<S>* map) {
    const lock l(mMutexAtlas);
    mspBadMaps.insert(map);
    mspMaps.erase(map);
  }
  void RemoveBadMaps() {
    const lock l(mMutexAtlas);
    clear_all(mspBadMaps);
  }
  void ChangeMap(Map<S>* map) {
    const lock l(mMutexAtlas);
    mpCurrentMap = map;
  }
  Map<S>* GetCurrentMap() {
    const lock l(mMutexAtlas);
    return mpCurrentMap;
  }

  template <class Visitor>
  void edges(Visitor& v) {
    const lock l(mMutexAtlas);
    v.edge("mspMaps", mspMaps, on::erase);
    v.edge("mspBadMaps", mspBadMaps, on::erase);
    v.edge("mpCurrentMap", mpCurrentMap);
  }

  typename S::template registry<typename S::template set<Map<S>>> mspMaps, mspBadMaps;
  typename S::template pointer<Map<S>> mpCurrentMap{};

 private:
  template <class Maps>
  static void clear_all(Maps& maps) {
    if (S::adapted)
      for (Map<S>* const map : maps) map->clear();
    maps.clear();
  }

  std::mutex mMutexAtlas;
  long mnLastMapId = 0;
};

}  // namespace orb_slam3
