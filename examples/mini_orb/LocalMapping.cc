#include "LocalMapping.h"

#include <unistd.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "Atlas.h"
#include "KeyFrame.h"
#include "LoopClosing.h"
#include "MapPoint.h"
#include "ORBmatcher.h"
#include "Optimizer.h"
#include "Tracking.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;

LocalMapping::LocalMapping(Atlas* pAtlas, bool bThreads)
    : mpAtlas(pAtlas), mbThreads(bThreads), mbFinished(!bThreads) {}

void LocalMapping::Run() {
  while (RunOnce()) usleep(300);
  lock_guard<mutex> lock(mMutexFinish);
  mbFinished = true;
}

bool LocalMapping::RunOnce() {
  mbAcceptKeyFrames = false;
  if (CheckNewKeyFrames()) {
    const Stopwatch time(mLMTimes);
    ProcessNewKeyFrame();
    MapPointCulling();
    CreateNewMapPoints();
    mbAbortBA = false;
    if (!CheckNewKeyFrames()) {
      SearchInNeighbors();
      if (!stopRequested()) {
        KeyFrame* const pKF = mpCurrentKeyFrame;
        if (pKF->GetMap()->KeyFramesInMap() > 2)
          Optimizer::LocalBundleAdjustment(pKF, &mbAbortBA, pKF->GetMap());
        KeyFrameCulling();
      }
    }
    mpLoopCloser->InsertKeyFrame(mpCurrentKeyFrame);
  } else {
    Stop();
  }
  ResetIfRequested();
  mbAcceptKeyFrames = true;
  lock_guard<mutex> lock(mMutexFinish);
  return !mbFinishRequested;
}

void LocalMapping::InsertKeyFrame(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexNewKFs);
  mlNewKeyFrames.push_back(pKF);
  mbAbortBA = true;
}

bool LocalMapping::CheckNewKeyFrames() { return !isStopped() && KeyframesInQueue() != 0; }

std::size_t LocalMapping::KeyframesInQueue() {
  lock_guard<mutex> lock(mMutexNewKFs);
  return mlNewKeyFrames.size();
}

void LocalMapping::EmptyQueue() {
  while (KeyframesInQueue() != 0) ProcessNewKeyFrame();
}

// On the thread of loop closing, too.
void LocalMapping::ProcessNewKeyFrame() {
  KeyFrame* pKF;
  {
    lock_guard<mutex> lock(mMutexNewKFs);
    if (mlNewKeyFrames.empty()) return;
    pKF = mlNewKeyFrames.front();
    mpCurrentKeyFrame = pKF;
    mlNewKeyFrames.pop_front();
  }
  const std::vector<MapPoint*> vpMapPointMatches = pKF->GetMapPointMatches();
  for (std::size_t i = 0; i != vpMapPointMatches.size(); ++i) {
    MapPoint* const pMP = vpMapPointMatches[i];
    if (pMP == nullptr || pMP->isBad()) continue;
    if (!pMP->IsInKeyFrame(pKF)) {
      pMP->AddObservation(pKF, static_cast<int>(i));
      pMP->UpdateNormalAndDepth();
      pMP->ComputeDistinctiveDescriptors();
    } else {
      lock_guard<mutex> lock(mMutexRecent);
      mlpRecentAddedMapPoints.push_back(pMP);
    }
  }
  pKF->UpdateConnections();
  if (Map* const pMap = pKF->GetMap()) pMap->AddKeyFrame(pKF);
}

void LocalMapping::MapPointCulling() {
  const auto nCurrentKFid = static_cast<long>(mpCurrentKeyFrame->mnId);
  std::vector<MapPoint*> vpBad;
  {
    lock_guard<mutex> lock(mMutexRecent);
    auto it = mlpRecentAddedMapPoints.begin();
    while (it != mlpRecentAddedMapPoints.end()) {
      MapPoint* const pMP = *it;
      const long age = nCurrentKFid - pMP->mnFirstKFid;
      const bool bBad =
          !pMP->isBad() && (pMP->GetFoundRatio() < 0.25f || (age >= 2 && pMP->Observations() <= 3));
      if (bBad) vpBad.push_back(pMP);
      if (bBad || pMP->isBad() || age >= 3)
        it = mlpRecentAddedMapPoints.erase(it);
      else
        ++it;
    }
  }
  for (MapPoint* pMP : vpBad) pMP->SetBadFlag();
}

// Features without depth: where the rays of two keyframes meet.
void LocalMapping::CreateNewMapPoints() {
  KeyFrame* const pCurrent = mpCurrentKeyFrame;
  Map* const pMap = pCurrent->GetMap();
  if (pMap == nullptr) return;
  for (KeyFrame* pKF2 : pCurrent->GetBestCovisibilityKeyFrames(10)) {
    std::vector<std::pair<std::size_t, std::size_t>> vMatchedIndices;
    ORBmatcher::SearchForTriangulation(pCurrent, pKF2, vMatchedIndices);
    const Pose Twc1 = pCurrent->GetPoseInverse(), Twc2 = pKF2->GetPoseInverse();
    for (const auto& [i1, i2] : vMatchedIndices) {
      const Vector3d ray1 = Twc1.linear() * pCurrent->Ray(i1);
      const Vector3d ray2 = Twc2.linear() * pKF2->Ray(i2);
      const Vector3d base = Twc2.translation() - Twc1.translation();
      const double a = ray1.dot(ray1), b = ray1.dot(ray2), c = ray2.dot(ray2);
      const double parallax = a * c - b * b;
      if (base.norm() < 0.2 || parallax < 1e-4 * a * c) continue;
      const double s = (c * ray1.dot(base) - b * ray2.dot(base)) / parallax;
      const double t = (b * ray1.dot(base) - a * ray2.dot(base)) / parallax;
      const Vector3d p1 = Twc1.translation() + s * ray1, p2 = Twc2.translation() + t * ray2;
      if (s <= 0 || t <= 0 || (p1 - p2).norm() > 0.3) continue;
      auto* const pMP = new MapPoint(0.5 * (p1 + p2), pCurrent, pMap);
      pMP->AddObservation(pCurrent, static_cast<int>(i1));
      pMP->AddObservation(pKF2, static_cast<int>(i2));
      pCurrent->AddMapPoint(pMP, i1);
      pKF2->AddMapPoint(pMP, i2);
      pMP->ComputeDistinctiveDescriptors();
      pMP->UpdateNormalAndDepth();
      pMap->AddMapPoint(pMP);
      lock_guard<mutex> lock(mMutexRecent);
      mlpRecentAddedMapPoints.push_back(pMP);
    }
  }
}

void LocalMapping::SearchInNeighbors() {
  KeyFrame* const pCurrent = mpCurrentKeyFrame;
  std::vector<KeyFrame*> vpTargetKFs;
  const auto add = [&](KeyFrame* pKF) {
    if (pKF->isBad() || pKF->mnFuseTargetForKF == pCurrent->mnId || pKF == pCurrent) return;
    vpTargetKFs.push_back(pKF);
    pKF->mnFuseTargetForKF = pCurrent->mnId;
  };
  for (KeyFrame* pKF : pCurrent->GetBestCovisibilityKeyFrames(10)) {
    add(pKF);
    for (KeyFrame* pSecond : pKF->GetBestCovisibilityKeyFrames(5)) add(pSecond);
  }
  const std::vector<MapPoint*> vpMapPointMatches = pCurrent->GetMapPointMatches();
  for (KeyFrame* pKF : vpTargetKFs) ORBmatcher::Fuse(pKF, vpMapPointMatches, 6);
  std::vector<MapPoint*> vpFuseCandidates;
  for (KeyFrame* pKF : vpTargetKFs)
    for (MapPoint* pMP : pKF->GetMapPointMatches()) {
      if (pMP == nullptr || pMP->isBad()) continue;
      if (pMP->mnFuseCandidateForKF == pCurrent->mnId) continue;
      pMP->mnFuseCandidateForKF = pCurrent->mnId;
      vpFuseCandidates.push_back(pMP);
    }
  ORBmatcher::Fuse(pCurrent, vpFuseCandidates, 6);
  for (MapPoint* pMP : pCurrent->GetMapPointMatches())
    if (pMP != nullptr && !pMP->isBad()) {
      pMP->ComputeDistinctiveDescriptors();
      pMP->UpdateNormalAndDepth();
    }
  pCurrent->UpdateConnections();
}

// A keyframe is redundant if more than nine tenths of its close points are seen at the same scale or a finer one by at least
// four others.
void LocalMapping::KeyFrameCulling() {
  KeyFrame* const pCurrent = mpCurrentKeyFrame;
  pCurrent->UpdateBestCovisibles();
  int count = 0;
  for (KeyFrame* pKF : pCurrent->GetVectorCovisibleKeyFrames()) {
    Map* const pMap = pKF->GetMap();
    if (pMap == nullptr || pKF->mnId == pMap->GetInitKFid() || pKF->isBad()) continue;
    const std::vector<MapPoint*> vpMapPoints = pKF->GetMapPointMatches();
    int nMPs = 0, nRedundantObservations = 0;
    for (std::size_t i = 0; i != vpMapPoints.size(); ++i) {
      MapPoint* const pMP = vpMapPoints[i];
      if (pMP == nullptr || pMP->isBad()) continue;
      if (pKF->mvDepth[i] > KeyFrame::mThDepth || pKF->mvDepth[i] < 0) continue;
      ++nMPs;
      if (pMP->Observations() <= 3) continue;
      int nObs = 0;
      for (const auto& [pKFi, indexes] : pMP->GetObservations()) {
        if (pKFi == pKF) continue;
        const auto at = static_cast<std::size_t>(std::get<0>(indexes));
        if (pKFi->mvKeysUn[at].octave <= pKF->mvKeysUn[i].octave + 1) ++nObs;
      }
      if (nObs > 3) ++nRedundantObservations;
    }
    if (10 * nRedundantObservations > 9 * nMPs) {
      pKF->SetBadFlag();
      mnCulled += 1;
    }
    ++count;
    if ((count > 20 && mbAbortBA) || count > 100) break;
  }
}

void LocalMapping::RequestStop() {
  {
    lock_guard<mutex> lock(mMutexStop);
    mbStopRequested = true;
    mbAbortBA = true;
  }
  if (!mbThreads) Stop();
}

bool LocalMapping::Stop() {
  lock_guard<mutex> lock(mMutexStop);
  if (!mbStopRequested || mbNotStop) return false;
  return mbStopped = true;
}

bool LocalMapping::isStopped() {
  lock_guard<mutex> lock(mMutexStop);
  return mbStopped;
}

bool LocalMapping::stopRequested() {
  lock_guard<mutex> lock(mMutexStop);
  return mbStopRequested;
}

bool LocalMapping::SetNotStop(bool flag) {
  lock_guard<mutex> lock(mMutexStop);
  if (flag && mbStopped) return false;
  mbNotStop = flag;
  return true;
}

// Deletes what is in the queue: the map was changed without it.
void LocalMapping::Release() {
  {
    lock_guard<mutex> lock(mMutexStop);
    mbStopped = false;
    mbStopRequested = false;
  }
  lock_guard<mutex> lock(mMutexNewKFs);
  for (KeyFrame* pKF : mlNewKeyFrames) delete pKF;
  mlNewKeyFrames.clear();
}

void LocalMapping::RequestReset() {
  {
    lock_guard<mutex> lock(mMutexReset);
    mbResetRequested = true;
  }
  if (!mbThreads) ResetIfRequested();
  for (;;) {
    {
      lock_guard<mutex> lock(mMutexReset);
      if (!mbResetRequested) return;
    }
    usleep(300);
  }
}

void LocalMapping::RequestResetActiveMap(Map* pMap) {
  {
    lock_guard<mutex> lock(mMutexReset);
    mbResetRequestedActiveMap = true;
    mpMapToReset = pMap;
  }
  if (!mbThreads) ResetIfRequested();
  for (;;) {
    {
      lock_guard<mutex> lock(mMutexReset);
      if (!mbResetRequestedActiveMap) return;
    }
    usleep(300);
  }
}

void LocalMapping::ResetIfRequested() {
  lock_guard<mutex> lock(mMutexReset);
  if (!mbResetRequested && !mbResetRequestedActiveMap) return;
  {
    lock_guard<mutex> lockQueue(mMutexNewKFs);
    mlNewKeyFrames.clear();
  }
  {
    lock_guard<mutex> lockRecent(mMutexRecent);
    mlpRecentAddedMapPoints.clear();
  }
  mbResetRequested = false;
  mbResetRequestedActiveMap = false;
}

void LocalMapping::RequestFinish() {
  lock_guard<mutex> lock(mMutexFinish);
  mbFinishRequested = true;
}

bool LocalMapping::isFinished() {
  lock_guard<mutex> lock(mMutexFinish);
  return mbFinished;
}

}  // namespace mini_orb
