// The map and the keyframe database, as model.hpp has keyframes and points.
#pragma once

#include <algorithm>
#include <cstddef>
#include <mutex>
#include <utility>
#include <vector>

#include "model.hpp"

namespace replay {

template <class S>
class Map {
 public:
  void AddKeyFrame(KeyFrame<S>* kf) {
    const lock l(mMutexMap);
    mspKeyFrames.insert(kf);
  }
  void AddMapPoint(MapPoint<S>* p) {
    const lock l(mMutexMap);
    mspMapPoints.insert(p);
  }
  void EraseKeyFrame(KeyFrame<S>* kf) {
    const lock l(mMutexMap);
    mspKeyFrames.erase(kf);
  }
  void EraseMapPoint(MapPoint<S>* p) {
    const lock l(mMutexMap);
    mspMapPoints.erase(p);
  }
  void SetReferenceMapPoints(const locals<S, MapPoint<S>>& points) {
    const lock l(mMutexMap);
    S::assign(mvpReferenceMapPoints, points);
  }
  locals<S, KeyFrame<S>> GetAllKeyFrames() {
    const lock l(mMutexMap);
    return copied<S, KeyFrame<S>>(mspKeyFrames);
  }
  locals<S, MapPoint<S>> GetAllMapPoints() {
    const lock l(mMutexMap);
    return copied<S, MapPoint<S>>(mspMapPoints);
  }
  locals<S, MapPoint<S>> GetReferenceMapPoints() {
    const lock l(mMutexMap);
    return copied<S, MapPoint<S>>(mvpReferenceMapPoints);
  }
  // Forgets what it holds; no object goes bad, none loses an edge.
  void clear() {
    const lock l(mMutexMap);
    mspMapPoints.clear();
    mspKeyFrames.clear();
    mvpReferenceMapPoints.clear();
  }

  template <class Visitor>
  void edges(Visitor& v) {
    const lock l(mMutexMap);
    v.edge("mspKeyFrames", mspKeyFrames, on::erase);
    v.edge("mspMapPoints", mspMapPoints, on::erase);
    v.edge("mvpReferenceMapPoints", mvpReferenceMapPoints, on::erase);
  }

  typename S::template registry<typename S::template set<KeyFrame<S>>> mspKeyFrames;
  typename S::template registry<typename S::template set<MapPoint<S>>> mspMapPoints;
  typename S::template vector<MapPoint<S>> mvpReferenceMapPoints;

 private:
  std::mutex mMutexMap;
};

template <class S>
class KeyFrameDatabase {
 public:
  KeyFrameDatabase() : mvInvertedFile(words_of_vocabulary) {}

  void add(KeyFrame<S>* kf) {
    kf->used();
    const lock l(mMutex);
    for (const auto& word : kf->own.mBowVec) mvInvertedFile[word.first].push_back(kf);
  }
  void erase(KeyFrame<S>* kf) {
    kf->used();
    const lock l(mMutex);
    for (const auto& word : kf->own.mBowVec) {
      auto& keyframes = mvInvertedFile[word.first];
      for (auto i = keyframes.begin(); i != keyframes.end(); ++i)
        if (S::plain(*i) == kf) {
          keyframes.erase(i);
          break;
        }
    }
  }
  // Those that share words, and how many.
  std::size_t DetectCandidates(KeyFrame<S>* kf) {
    kf->used();
    owning_vector<S, std::pair<local<S, KeyFrame<S>>, int>> sharing;
    {
      const lock l(mMutex);
      std::vector<std::pair<KeyFrame<S>*, int>> found;
      for (const auto& word : kf->own.mBowVec)
        for (const auto& other : mvInvertedFile[word.first]) found.emplace_back(S::plain(other), 1);
      std::sort(found.begin(), found.end());
      for (const auto& f : found) {
        if (sharing.empty() || S::raw(sharing.back().first) != f.first)
          sharing.emplace_back(S::template local_of<KeyFrame<S>>(f.first), 0);
        ++sharing.back().second;
      }
    }
    std::size_t candidates = 0;
    for (const auto& s : sharing) candidates += !S::raw(s.first)->isBad() && s.second > 10;
    return candidates;
  }
  bool contains(KeyFrame<S>* kf) {
    const lock l(mMutex);
    const auto& keyframes = mvInvertedFile[kf->own.mBowVec.begin()->first];
    return std::any_of(keyframes.begin(), keyframes.end(),
                       [kf](const auto& other) { return S::plain(other) == kf; });
  }
  void clear() {
    const lock l(mMutex);
    for (auto& keyframes : mvInvertedFile) keyframes.clear();
  }

  template <class Visitor>
  void edges(Visitor& v) {
    const lock l(mMutex);
    for (auto& keyframes : mvInvertedFile) v.edge("mvInvertedFile", keyframes, on::erase);
  }

  owning_vector<S, typename S::template list<KeyFrame<S>>> mvInvertedFile;

 private:
  std::mutex mMutex;
};

}  // namespace replay
