#include "MapPoint.h"

#include <algorithm>
#include <vector>

#include "KeyFrame.h"
#include "Map.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;
using std::unique_lock;

Racy<unsigned long> MapPoint::nNextId;
mutex MapPoint::mGlobalMutex;

MapPoint::MapPoint(const Vector3d& Pos, KeyFrame* pRefKF, Map* pMap)
    : mnId(nNextId++),
      mnFirstKFid(static_cast<long>(pRefKF->mnId)),
      mWorldPos(Pos),
      mpRefKF(pRefKF),
      mpMap(pMap) {}

MapPoint::MapPoint(const Vector3d& Pos, Map* pMap, const Frame& frame, std::size_t i)
    : mnId(nNextId++),
      mnFirstKFid(-1),
      mWorldPos(Pos),
      mDescriptor(frame.mDescriptors[i]),
      mpMap(pMap) {}

void MapPoint::SetWorldPos(const Vector3d& Pos) {
  lock_guard<mutex> global(mGlobalMutex);
  lock_guard<mutex> lock(mMutexPos);
  mWorldPos = Pos;
}

Vector3d MapPoint::GetWorldPos() {
  lock_guard<mutex> lock(mMutexPos);
  return mWorldPos;
}

Descriptor MapPoint::GetDescriptor() {
  lock_guard<mutex> lock(mMutexFeatures);
  return mDescriptor;
}

KeyFrame* MapPoint::GetReferenceKeyFrame() {
  lock_guard<mutex> lock(mMutexFeatures);
  return mpRefKF;
}

std::map<KeyFrame*, std::tuple<int, int>, ById> MapPoint::GetObservations() {
  lock_guard<mutex> lock(mMutexFeatures);
  return mObservations;
}

int MapPoint::Observations() { return nObs; }

void MapPoint::AddObservation(KeyFrame* pKF, int idx) {
  lock_guard<mutex> lock(mMutexFeatures);
  mObservations[pKF] = std::make_tuple(idx, -1);
  nObs += pKF->mvuRight[static_cast<std::size_t>(idx)] >= 0 ? 2 : 1;
}

void MapPoint::EraseObservation(KeyFrame* pKF) {
  bool bBad = false;
  {
    lock_guard<mutex> lock(mMutexFeatures);
    const auto it = mObservations.find(pKF);
    if (it == mObservations.end()) return;
    const auto idx = static_cast<std::size_t>(std::get<0>(it->second));
    nObs += pKF->mvuRight[idx] >= 0 ? -2 : -1;
    mObservations.erase(it);
    if (mpRefKF == pKF) mpRefKF = mObservations.empty() ? nullptr : mObservations.begin()->first;
    bBad = nObs <= 2;
  }
  if (bBad) SetBadFlag();
}

std::tuple<int, int> MapPoint::GetIndexInKeyFrame(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexFeatures);
  const auto it = mObservations.find(pKF);
  return it != mObservations.end() ? it->second : std::make_tuple(-1, -1);
}

bool MapPoint::IsInKeyFrame(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexFeatures);
  return mObservations.count(pKF) != 0;
}

void MapPoint::SetBadFlag() {
  std::map<KeyFrame*, std::tuple<int, int>, ById> obs;
  {
    lock_guard<mutex> lock(mMutexFeatures);
    mbBad = true;
    obs = mObservations;
    mObservations.clear();
  }
  for (const auto& [pKF, indexes] : obs)
    pKF->EraseMapPointMatch(static_cast<std::size_t>(std::get<0>(indexes)));
  GetMap()->EraseMapPoint(this);
}

MapPoint* MapPoint::GetReplaced() {
  lock_guard<mutex> lock(mMutexFeatures);
  return mpReplaced;
}

void MapPoint::Replace(MapPoint* pMP) {
  if (pMP == this) return;
  std::map<KeyFrame*, std::tuple<int, int>, ById> obs;
  {
    lock_guard<mutex> lock(mMutexFeatures);
    obs = mObservations;
    mObservations.clear();
    mbBad = true;
    mpReplaced = pMP;
  }
  for (const auto& [pKF, indexes] : obs) {
    const int idx = std::get<0>(indexes);
    if (!pMP->IsInKeyFrame(pKF)) {
      pKF->ReplaceMapPointMatch(static_cast<std::size_t>(idx), pMP);
      pMP->AddObservation(pKF, idx);
    } else {
      pKF->EraseMapPointMatch(static_cast<std::size_t>(idx));
    }
  }
  pMP->IncreaseFound(mnFound);
  pMP->IncreaseVisible(mnVisible);
  pMP->ComputeDistinctiveDescriptors();
  GetMap()->EraseMapPoint(this);
}

void MapPoint::ComputeDistinctiveDescriptors() {
  std::vector<Descriptor> seen;
  if (mbBad) return;
  for (const auto& [pKF, indexes] : GetObservations())
    if (!pKF->isBad())
      seen.push_back(pKF->mDescriptors[static_cast<std::size_t>(std::get<0>(indexes))]);
  if (seen.empty()) return;
  std::size_t best = 0;
  int bestDistance = 1 << 20;
  for (std::size_t i = 0; i != seen.size(); ++i) {
    int sum = 0;
    for (const Descriptor& other : seen) sum += Features::Distance(seen[i], other);
    if (sum < bestDistance) best = i, bestDistance = sum;
  }
  lock_guard<mutex> lock(mMutexFeatures);
  mDescriptor = seen[best];
}

void MapPoint::UpdateNormalAndDepth() {
  KeyFrame* const pRefKF = GetReferenceKeyFrame();
  const auto observations = GetObservations();
  if (mbBad || observations.empty() || pRefKF == nullptr) return;
  const Vector3d Pos = GetWorldPos();
  Vector3d normal = Vector3d::Zero();
  for (const auto& [pKF, indexes] : observations) {
    const Vector3d ray = Pos - pKF->GetCameraCenter();
    normal += ray.normalized();
  }
  const auto distance = static_cast<float>((Pos - pRefKF->GetCameraCenter()).norm());
  lock_guard<mutex> lock(mMutexPos);
  mNormalVector = normal / static_cast<double>(observations.size());
  mfMinDistance = distance / 3;
  mfMaxDistance = distance * 3;
}

Map* MapPoint::GetMap() {
  lock_guard<mutex> lock(mMutexMap);
  return mpMap;
}

void MapPoint::UpdateMap(Map* pMap) {
  lock_guard<mutex> lock(mMutexMap);
  mpMap = pMap;
}

}  // namespace mini_orb
