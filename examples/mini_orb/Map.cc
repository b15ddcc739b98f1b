#include "Map.h"

#include <algorithm>

#include "KeyFrame.h"
#include "MapPoint.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;

Racy<unsigned long> Map::nNextId;

Map::Map(unsigned long initKFid) : mnId(nNextId++), mnInitKFid(initKFid), mnMaxKFid(initKFid) {}

void Map::AddKeyFrame(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexMap);
  if (mspKeyFrames.empty()) {
    mnInitKFid = pKF->mnId;
    mpKFinitial = pKF;
    mpKFlowerID = pKF;
  }
  mspKeyFrames.insert(pKF);
  if (pKF->mnId > mnMaxKFid) mnMaxKFid = pKF->mnId;
  if (pKF->mnId < mpKFlowerID->mnId) mpKFlowerID = pKF;
}

void Map::AddMapPoint(MapPoint* pMP) {
  lock_guard<mutex> lock(mMutexMap);
  mspMapPoints.insert(pMP);
}

void Map::EraseKeyFrame(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexMap);
  mspKeyFrames.erase(pKF);
  if (mpKFlowerID != pKF || mspKeyFrames.empty()) return;
  mpKFlowerID =
      *std::min_element(mspKeyFrames.begin(), mspKeyFrames.end(),
                        [](const KeyFrame* a, const KeyFrame* b) { return a->mnId < b->mnId; });
}

void Map::EraseMapPoint(MapPoint* pMP) {
  lock_guard<mutex> lock(mMutexMap);
  mspMapPoints.erase(pMP);
}

void Map::SetReferenceMapPoints(const std::vector<MapPoint*>& vpMPs) {
  lock_guard<mutex> lock(mMutexMap);
  mvpReferenceMapPoints = vpMPs;
}

std::vector<KeyFrame*> Map::GetAllKeyFrames() {
  lock_guard<mutex> lock(mMutexMap);
  return std::vector<KeyFrame*>(mspKeyFrames.begin(), mspKeyFrames.end());
}

std::vector<MapPoint*> Map::GetAllMapPoints() {
  lock_guard<mutex> lock(mMutexMap);
  return std::vector<MapPoint*>(mspMapPoints.begin(), mspMapPoints.end());
}

std::vector<MapPoint*> Map::GetReferenceMapPoints() {
  lock_guard<mutex> lock(mMutexMap);
  return mvpReferenceMapPoints;
}

std::size_t Map::KeyFramesInMap() {
  lock_guard<mutex> lock(mMutexMap);
  return mspKeyFrames.size();
}

std::size_t Map::MapPointsInMap() {
  lock_guard<mutex> lock(mMutexMap);
  return mspMapPoints.size();
}

KeyFrame* Map::GetOriginKF() {
  lock_guard<mutex> lock(mMutexMap);
  return mpKFinitial;
}

void Map::AddKeyFrameOrigin(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexMap);
  mvpKeyFrameOrigins.push_back(pKF);
}

std::vector<KeyFrame*> Map::GetKeyFrameOrigins() {
  lock_guard<mutex> lock(mMutexMap);
  return mvpKeyFrameOrigins;
}

void Map::clear() {
  lock_guard<mutex> lock(mMutexMap);
  for (KeyFrame* pKF : mspKeyFrames) pKF->UpdateMap(nullptr);
  mspMapPoints.clear();
  mspKeyFrames.clear();
  mvpReferenceMapPoints.clear();
  mvpKeyFrameOrigins.clear();
}

}  // namespace mini_orb
