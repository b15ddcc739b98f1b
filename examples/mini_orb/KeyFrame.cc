#include "KeyFrame.h"

#include <algorithm>
#include <utility>

#include "KeyFrameDatabase.h"
#include "Map.h"
#include "MapPoint.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;

Racy<unsigned long> KeyFrame::nNextId;

KeyFrame::KeyFrame(const Frame& F, Map* pMap, KeyFrameDatabase* pKFDB)
    : Features(F),
      mnId(nNextId++),
      mnFrameId(F.mnId),
      mTcw(F.mTcw),
      mvpMapPoints(F.mvpMapPoints),
      mpMap(pMap),
      mpKeyFrameDB(pKFDB) {}

void KeyFrame::SetPose(const Pose& Tcw) {
  lock_guard<mutex> lock(mMutexPose);
  mTcw = Tcw;
}

Pose KeyFrame::GetPose() {
  lock_guard<mutex> lock(mMutexPose);
  return mTcw;
}

Pose KeyFrame::GetPoseInverse() { return GetPose().inverse(); }

Vector3d KeyFrame::GetCameraCenter() { return GetPoseInverse().translation(); }

Vector3d KeyFrame::UnprojectStereo(std::size_t i) { return GetPoseInverse() * InCamera(i); }

void KeyFrame::AddConnection(KeyFrame* pKF, int weight) {
  {
    lock_guard<mutex> lock(mMutexConnections);
    const auto [it, fresh] = mConnectedKeyFrameWeights.emplace(pKF, weight);
    if (!fresh && it->second == weight) return;
    it->second = weight;
  }
  UpdateBestCovisibles();
}

void KeyFrame::EraseConnection(KeyFrame* pKF) {
  {
    lock_guard<mutex> lock(mMutexConnections);
    if (mConnectedKeyFrameWeights.erase(pKF) == 0) return;
  }
  UpdateBestCovisibles();
}

void KeyFrame::UpdateBestCovisibles() {
  lock_guard<mutex> lock(mMutexConnections);
  std::vector<std::pair<int, KeyFrame*>> pairs;
  for (const auto& [pKF, weight] : mConnectedKeyFrameWeights)
    if (!pKF->isBad()) pairs.emplace_back(weight, pKF);
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<KeyFrame*> keyframes;
  std::vector<int> weights;
  for (const auto& [weight, pKF] : pairs) {
    keyframes.push_back(pKF);
    weights.push_back(weight);
  }
  mvpOrderedConnectedKeyFrames = keyframes;
  mvOrderedWeights = weights;
}

std::set<KeyFrame*, ById> KeyFrame::GetConnectedKeyFrames() {
  lock_guard<mutex> lock(mMutexConnections);
  std::set<KeyFrame*, ById> connected;
  for (const auto& [pKF, weight] : mConnectedKeyFrameWeights) connected.insert(pKF);
  return connected;
}

std::vector<KeyFrame*> KeyFrame::GetVectorCovisibleKeyFrames() {
  lock_guard<mutex> lock(mMutexConnections);
  return mvpOrderedConnectedKeyFrames;
}

std::vector<KeyFrame*> KeyFrame::GetBestCovisibilityKeyFrames(std::size_t n) {
  lock_guard<mutex> lock(mMutexConnections);
  if (mvpOrderedConnectedKeyFrames.size() <= n) return mvpOrderedConnectedKeyFrames;
  return std::vector<KeyFrame*>(
      mvpOrderedConnectedKeyFrames.begin(),
      mvpOrderedConnectedKeyFrames.begin() + static_cast<std::ptrdiff_t>(n));
}

int KeyFrame::GetWeight(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexConnections);
  const auto it = mConnectedKeyFrameWeights.find(pKF);
  return it != mConnectedKeyFrameWeights.end() ? it->second : 0;
}

// Every keyframe with a common point becomes a connection of this one; the other side learns of it only if they have
// fifteen in common, or if it is the best.
void KeyFrame::UpdateConnections(bool upParent) {
  constexpr int th = 15;
  std::map<KeyFrame*, int, ById> KFcounter;
  for (MapPoint* pMP : GetMapPointMatches()) {
    if (pMP == nullptr || pMP->isBad()) continue;
    for (const auto& [pKF, indexes] : pMP->GetObservations())
      if (pKF != this && !pKF->isBad() && pKF->GetMap() == GetMap()) ++KFcounter[pKF];
  }
  if (KFcounter.empty()) return;
  std::vector<std::pair<int, KeyFrame*>> pairs;
  std::pair<int, KeyFrame*> best{0, nullptr};
  for (const auto& [pKF, count] : KFcounter) {
    if (count > best.first) best = {count, pKF};
    if (count >= th) pairs.emplace_back(count, pKF);
  }
  if (pairs.empty()) pairs.push_back(best);
  for (const auto& [count, pKF] : pairs) pKF->AddConnection(this, count);
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<KeyFrame*> keyframes;
  std::vector<int> weights;
  for (const auto& [count, pKF] : pairs) {
    keyframes.push_back(pKF);
    weights.push_back(count);
  }
  KeyFrame* pParent = nullptr;
  {
    lock_guard<mutex> lock(mMutexConnections);
    mConnectedKeyFrameWeights = KFcounter;
    mvpOrderedConnectedKeyFrames = keyframes;
    mvOrderedWeights = weights;
    if (upParent && mbFirstConnection && mnId != GetMap()->GetInitKFid()) {
      mpParent = mvpOrderedConnectedKeyFrames.front();
      mbFirstConnection = false;
      pParent = mpParent;
    }
  }
  if (pParent != nullptr) pParent->AddChild(this);
}

void KeyFrame::AddChild(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexConnections);
  mspChildrens.insert(pKF);
}

void KeyFrame::EraseChild(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexConnections);
  mspChildrens.erase(pKF);
}

void KeyFrame::ChangeParent(KeyFrame* pKF) {
  {
    lock_guard<mutex> lock(mMutexConnections);
    mpParent = pKF;
  }
  if (pKF != nullptr) pKF->AddChild(this);
}

std::set<KeyFrame*, ById> KeyFrame::GetChilds() {
  lock_guard<mutex> lock(mMutexConnections);
  return mspChildrens;
}

KeyFrame* KeyFrame::GetParent() {
  lock_guard<mutex> lock(mMutexConnections);
  return mpParent;
}

void KeyFrame::AddLoopEdge(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexConnections);
  mbNotErase = true;
  mspLoopEdges.insert(pKF);
}

std::set<KeyFrame*, ById> KeyFrame::GetLoopEdges() {
  lock_guard<mutex> lock(mMutexConnections);
  return mspLoopEdges;
}

void KeyFrame::AddMergeEdge(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexConnections);
  mbNotErase = true;
  mspMergeEdges.insert(pKF);
}

void KeyFrame::AddMapPoint(MapPoint* pMP, std::size_t idx) {
  lock_guard<mutex> lock(mMutexFeatures);
  mvpMapPoints[idx] = pMP;
}

void KeyFrame::EraseMapPointMatch(std::size_t idx) {
  lock_guard<mutex> lock(mMutexFeatures);
  mvpMapPoints[idx] = nullptr;
}

void KeyFrame::ReplaceMapPointMatch(std::size_t idx, MapPoint* pMP) {
  lock_guard<mutex> lock(mMutexFeatures);
  mvpMapPoints[idx] = pMP;
}

std::set<MapPoint*, ById> KeyFrame::GetMapPoints() {
  std::set<MapPoint*, ById> points;
  for (MapPoint* pMP : GetMapPointMatches())
    if (pMP != nullptr && !pMP->isBad()) points.insert(pMP);
  return points;
}

std::vector<MapPoint*> KeyFrame::GetMapPointMatches() {
  lock_guard<mutex> lock(mMutexFeatures);
  return mvpMapPoints;
}

MapPoint* KeyFrame::GetMapPoint(std::size_t idx) {
  lock_guard<mutex> lock(mMutexFeatures);
  return mvpMapPoints[idx];
}

int KeyFrame::TrackedMapPoints(int minObs) {
  int n = 0;
  for (MapPoint* pMP : GetMapPointMatches())
    if (pMP != nullptr && !pMP->isBad() && pMP->Observations() >= minObs) ++n;
  return n;
}

void KeyFrame::SetNotErase() {
  lock_guard<mutex> lock(mMutexConnections);
  mbNotErase = true;
}

void KeyFrame::SetErase() {
  {
    lock_guard<mutex> lock(mMutexConnections);
    if (mspLoopEdges.empty()) mbNotErase = false;
  }
  if (mbToBeErased) SetBadFlag();
}

void KeyFrame::SetBadFlag() {
  Map* const pMap = GetMap();
  if (pMap == nullptr) return;  // its map was cleared
  {
    lock_guard<mutex> lock(mMutexConnections);
    if (mnId == pMap->GetInitKFid()) return;
    if (mbNotErase) {
      mbToBeErased = true;
      return;
    }
  }
  for (KeyFrame* pKF : GetConnectedKeyFrames()) pKF->EraseConnection(this);
  for (MapPoint* pMP : GetMapPointMatches())
    if (pMP != nullptr) pMP->EraseObservation(this);

  std::set<KeyFrame*, ById> childrens;
  KeyFrame* pParent;
  {
    lock_guard<mutex> lock(mMutexConnections);
    mConnectedKeyFrameWeights.clear();
    mvpOrderedConnectedKeyFrames.clear();
    childrens = mspChildrens;
    pParent = mpParent;
  }
  // Each child gets the candidate that sees most of what it sees; a child that has found a parent is one itself.
  std::set<KeyFrame*, ById> candidates;
  if (pParent != nullptr) candidates.insert(pParent);
  while (!childrens.empty()) {
    int bestWeight = -1;
    KeyFrame *pChild = nullptr, *pNewParent = nullptr;
    for (KeyFrame* pKF : childrens) {
      if (pKF->isBad()) continue;
      for (KeyFrame* pConnected : pKF->GetVectorCovisibleKeyFrames()) {
        if (candidates.count(pConnected) == 0) continue;
        const int weight = pKF->GetWeight(pConnected);
        if (weight > bestWeight) bestWeight = weight, pChild = pKF, pNewParent = pConnected;
      }
    }
    if (pChild == nullptr) break;
    pChild->ChangeParent(pNewParent);
    EraseChild(pChild);
    candidates.insert(pChild);
    childrens.erase(pChild);
  }
  for (KeyFrame* pKF : childrens) pKF->ChangeParent(pParent);  // they stay in mspChildrens
  if (pParent != nullptr) {
    pParent->EraseChild(this);
    mTcp = GetPose() * pParent->GetPoseInverse();
  }
  mbBad = true;
  pMap->EraseKeyFrame(this);
  mpKeyFrameDB->erase(this);
}

Map* KeyFrame::GetMap() {
  lock_guard<mutex> lock(mMutexMap);
  return mpMap;
}

void KeyFrame::UpdateMap(Map* pMap) {
  lock_guard<mutex> lock(mMutexMap);
  mpMap = pMap;
}

}  // namespace mini_orb
