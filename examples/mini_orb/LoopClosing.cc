#include "LoopClosing.h"

#include <unistd.h>

#include <algorithm>
#include <set>

#include "Atlas.h"
#include "KeyFrame.h"
#include "KeyFrameDatabase.h"
#include "LocalMapping.h"
#include "MapPoint.h"
#include "ORBmatcher.h"
#include "Tracking.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;

LoopClosing::LoopClosing(Atlas* pAtlas, KeyFrameDatabase* pDB, bool bThreads)
    : mpAtlas(pAtlas), mpKeyFrameDB(pDB), mbThreads(bThreads), mbFinished(!bThreads) {}

void LoopClosing::Run() {
  while (RunOnce()) usleep(500);
  mbStopGBA = true;
  if (mpThreadGBA != nullptr) mpThreadGBA->join();
  mpThreadGBA.reset();
  lock_guard<mutex> lock(mMutexFinish);
  mbFinished = true;
}

bool LoopClosing::RunOnce() {
  if (CheckNewKeyFrames() && NewDetectCommonRegions()) {
    if (mbMergeDetected) {
      MergeLocal();
      ForgetMerge();
      if (mnLoopNumCoincidences > 0) ForgetLoop();
    } else if (mbLoopDetected) {
      CorrectLoop();
      ForgetLoop();
    }
    mbLoopDetected = mbMergeDetected = false;
  }
  mpLastCurrentKF = mpCurrentKF;
  ResetIfRequested();
  lock_guard<mutex> lock(mMutexFinish);
  return !mbFinishRequested;
}

void LoopClosing::InsertKeyFrame(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutexLoopQueue);
  if (pKF->mnId != 0) mlpLoopKeyFrameQueue.push_back(pKF);
}

bool LoopClosing::CheckNewKeyFrames() {
  lock_guard<mutex> lock(mMutexLoopQueue);
  return !mlpLoopKeyFrameQueue.empty();
}

bool LoopClosing::NewDetectCommonRegions() {
  {
    lock_guard<mutex> lock(mMutexLoopQueue);
    mpCurrentKF = mlpLoopKeyFrameQueue.front();
    mlpLoopKeyFrameQueue.pop_front();
    mpCurrentKF->SetNotErase();
  }
  if (mpCurrentKF->GetMap() == nullptr || mpCurrentKF->GetMap()->KeyFramesInMap() < 5) {
    mpKeyFrameDB->add(mpCurrentKF);
    mpCurrentKF->SetErase();
    return false;
  }
  bool bFound = false;
  if (mnLoopNumCoincidences > 0) {
    if (DetectCommonRegion(mpLoopMatchedKF, mTcwLoop, mvpLoopMPs, mvpLoopMatchedMPs)) {
      bFound = true;
      mpLoopLastCurrentKF->SetErase();
      mpLoopLastCurrentKF = mpCurrentKF;
      mnLoopNumNotFound = 0;
      mbLoopDetected = ++mnLoopNumCoincidences >= 3;
    } else if (++mnLoopNumNotFound >= 2) {
      ForgetLoop();
    }
  }
  if (mnMergeNumCoincidences > 0) {
    if (DetectCommonRegion(mpMergeMatchedKF, mTcwMerge, mvpMergeMPs, mvpMergeMatchedMPs)) {
      bFound = true;
      mpMergeLastCurrentKF->SetErase();
      mpMergeLastCurrentKF = mpCurrentKF;
      mnMergeNumNotFound = 0;
      mbMergeDetected = ++mnMergeNumCoincidences >= 3;
    } else if (++mnMergeNumNotFound >= 2) {
      ForgetMerge();
    }
  }
  if (!mbLoopDetected && !mbMergeDetected && !bFound) {
    std::vector<KeyFrame*> vpLoopCandidates, vpMergeCandidates;
    mpKeyFrameDB->DetectNBestCandidates(mpCurrentKF, vpLoopCandidates, vpMergeCandidates, 3);
    for (KeyFrame* pKF : vpMergeCandidates) {
      if (!DetectCommonRegion(pKF, mTcwMerge, mvpMergeMPs, mvpMergeMatchedMPs)) continue;
      mnMergeNumCoincidences = 1;
      mpMergeLastCurrentKF = mpCurrentKF;
      mpMergeMatchedKF = pKF;
      mpMergeMatchedKF->SetNotErase();
      bFound = true;
      break;
    }
    for (KeyFrame* pKF : vpLoopCandidates) {
      if (!DetectCommonRegion(pKF, mTcwLoop, mvpLoopMPs, mvpLoopMatchedMPs)) continue;
      mnLoopNumCoincidences = 1;
      mpLoopLastCurrentKF = mpCurrentKF;
      mpLoopMatchedKF = pKF;
      mpLoopMatchedKF->SetNotErase();
      bFound = true;
      break;
    }
  }
  mpKeyFrameDB->add(mpCurrentKF);
  if (!bFound) mpCurrentKF->SetErase();
  return mbLoopDetected || mbMergeDetected;
}

// Whether the current keyframe sees what pMatchedKF and its neighbours see; then Tcw is where it would be.
bool LoopClosing::DetectCommonRegion(KeyFrame* pMatchedKF, Pose& Tcw, std::vector<MapPoint*>& vpMPs,
                                     std::vector<MapPoint*>& vpMatchedMPs) {
  std::vector<KeyFrame*> vpCovKFs = pMatchedKF->GetBestCovisibilityKeyFrames(5);
  vpCovKFs.insert(vpCovKFs.begin(), pMatchedKF);
  std::vector<MapPoint*> vpMatches(mpCurrentKF->mDescriptors.size(), nullptr);
  std::set<MapPoint*, ById> spMPs;
  for (KeyFrame* pKF : vpCovKFs) {
    if (pKF->isBad()) continue;
    std::vector<MapPoint*> vpOfKF;
    ORBmatcher::SearchByBoW(mpCurrentKF, pKF, vpOfKF);
    for (std::size_t i = 0; i != vpOfKF.size(); ++i)
      if (vpMatches[i] == nullptr) vpMatches[i] = vpOfKF[i];
    for (MapPoint* pMP : pKF->GetMapPoints()) spMPs.insert(pMP);
  }
  const auto nMin = static_cast<std::size_t>(std::max(12, mpCurrentKF->N / 6));
  if (!Optimizer::OptimizePose(mpCurrentKF, vpMatches, nMin, Tcw)) return false;
  vpMatchedMPs = vpMatches;
  vpMPs.assign(spMPs.begin(), spMPs.end());
  return true;
}

void LoopClosing::StopLocalMappingAndGBA() {
  mpLocalMapper->RequestStop();
  mpLocalMapper->EmptyQueue();
  if (isRunningGBA()) {
    // It goes on until it sees the flag, beside what comes now.
    mbStopGBA = true;
    mnFullBAIdx += 1;
    mnAbortedGBAs += 1;
    if (mpThreadGBA != nullptr) {
      mpThreadGBA->detach();
      mpThreadGBA.reset();
    }
  }
  while (!mpLocalMapper->isStopped()) {
    mpLocalMapper->RequestStop();  // somebody may have released it meanwhile
    usleep(300);
  }
}

void LoopClosing::CorrectLoop() {
  mnLoops += 1;
  StopLocalMappingAndGBA();
  Map* const pMap = mpCurrentKF->GetMap();
  mpCurrentKF->UpdateConnections();
  mvpCurrentConnectedKFs = mpCurrentKF->GetVectorCovisibleKeyFrames();
  mvpCurrentConnectedKFs.push_back(mpCurrentKF);

  KeyFrameAndPose CorrectedSim3, NonCorrectedSim3;
  std::set<MapPoint*, ById> spCorrected;
  {
    lock_guard<mutex> lock(pMap->mMutexMapUpdate);
    const Pose Twc = mpCurrentKF->GetPoseInverse();
    for (KeyFrame* pKFi : mvpCurrentConnectedKFs) {
      NonCorrectedSim3[pKFi] = pKFi->GetPose();
      CorrectedSim3[pKFi] = pKFi->GetPose() * Twc * mTcwLoop;
    }
    for (const auto& [pKFi, Corrected] : CorrectedSim3) {
      const Pose move = Corrected.inverse() * NonCorrectedSim3[pKFi];
      for (MapPoint* pMPi : pKFi->GetMapPointMatches()) {
        if (pMPi == nullptr || pMPi->isBad() || !spCorrected.insert(pMPi).second) continue;
        pMPi->SetWorldPos(move * pMPi->GetWorldPos());
      }
      pKFi->SetPose(Corrected);
    }
    for (KeyFrame* pKFi : mvpCurrentConnectedKFs) pKFi->UpdateConnections();
    FuseMatched(mvpLoopMatchedMPs);
  }
  SearchAndFuse(mvpCurrentConnectedKFs, mvpLoopMPs);
  for (KeyFrame* pKFi : mvpCurrentConnectedKFs) pKFi->UpdateConnections();
  Optimizer::OptimizeEssentialGraph(pMap, mpLoopMatchedKF, mpCurrentKF, NonCorrectedSim3,
                                    CorrectedSim3, spCorrected);
  mpLoopMatchedKF->AddLoopEdge(mpCurrentKF);
  mpCurrentKF->AddLoopEdge(mpLoopMatchedKF);
  LaunchGBA(pMap);
  mpLocalMapper->Release();
}

void LoopClosing::MergeLocal() {
  mnMerges += 1;
  StopLocalMappingAndGBA();
  Map* const pCurrentMap = mpCurrentKF->GetMap();
  Map* const pMergeMap = mpMergeMatchedKF->GetMap();
  if (pCurrentMap != pMergeMap) {
    std::scoped_lock lock(pCurrentMap->mMutexMapUpdate, pMergeMap->mMutexMapUpdate);
    const Pose move = mTcwMerge.inverse() * mpCurrentKF->GetPose();
    for (KeyFrame* pKFi : pCurrentMap->GetAllKeyFrames()) {
      pKFi->SetPose(pKFi->GetPose() * move.inverse());
      pKFi->UpdateMap(pMergeMap);
      pMergeMap->AddKeyFrame(pKFi);
      pCurrentMap->EraseKeyFrame(pKFi);
    }
    for (MapPoint* pMPi : pCurrentMap->GetAllMapPoints()) {
      pMPi->SetWorldPos(move * pMPi->GetWorldPos());
      pMPi->UpdateMap(pMergeMap);
      pMergeMap->AddMapPoint(pMPi);
      pCurrentMap->EraseMapPoint(pMPi);
    }
    mpAtlas->ChangeMap(pMergeMap);
    mpAtlas->SetMapBad(pCurrentMap);
    // The spanning tree of the current map hangs on the current keyframe from now on.
    KeyFrame* pNewChild = mpCurrentKF;
    KeyFrame* pNewParent = mpCurrentKF->GetParent();
    mpCurrentKF->ChangeParent(mpMergeMatchedKF);
    while (pNewParent != nullptr) {
      pNewParent->EraseChild(pNewChild);
      KeyFrame* const pOldParent = pNewParent->GetParent();
      pNewParent->ChangeParent(pNewChild);
      pNewChild = pNewParent;
      pNewParent = pOldParent;
    }
    FuseMatched(mvpMergeMatchedMPs);
    mpCurrentKF->UpdateConnections();
  }
  std::vector<KeyFrame*> vpWindow = mpCurrentKF->GetVectorCovisibleKeyFrames();
  vpWindow.push_back(mpCurrentKF);
  SearchAndFuse(vpWindow, mvpMergeMPs);
  for (KeyFrame* pKFi : vpWindow) pKFi->UpdateConnections();
  mpMergeMatchedKF->UpdateConnections();
  mpCurrentKF->AddMergeEdge(mpMergeMatchedKF);
  mpMergeMatchedKF->AddMergeEdge(mpCurrentKF);
  LaunchGBA(pMergeMap);
  mpLocalMapper->Release();
  mpAtlas->RemoveBadMaps();
}

// The current keyframe sees the points of the other place from now on; no test whether they are bad, as in ORB-SLAM3.
void LoopClosing::FuseMatched(const std::vector<MapPoint*>& vpMatchedMPs) {
  for (std::size_t i = 0; i != vpMatchedMPs.size(); ++i) {
    MapPoint* const pLoopMP = vpMatchedMPs[i];
    if (pLoopMP == nullptr) continue;
    MapPoint* const pCurMP = mpCurrentKF->GetMapPoint(i);
    if (pCurMP != nullptr) {
      pCurMP->Replace(pLoopMP);
    } else {
      mpCurrentKF->AddMapPoint(pLoopMP, i);
      pLoopMP->AddObservation(mpCurrentKF, static_cast<int>(i));
      pLoopMP->ComputeDistinctiveDescriptors();
    }
  }
}

void LoopClosing::SearchAndFuse(const std::vector<KeyFrame*>& vConnectedKFs,
                                const std::vector<MapPoint*>& vpMapPoints) {
  for (KeyFrame* pKFi : vConnectedKFs) {
    std::vector<MapPoint*> vpReplacePoints(vpMapPoints.size(), nullptr);
    ORBmatcher::Fuse(pKFi, vpMapPoints, 12, &vpReplacePoints);
    lock_guard<mutex> lock(pKFi->GetMap()->mMutexMapUpdate);
    for (std::size_t i = 0; i != vpReplacePoints.size(); ++i)
      if (vpReplacePoints[i] != nullptr) vpReplacePoints[i]->Replace(vpMapPoints[i]);
  }
}

void LoopClosing::LaunchGBA(Map* pActiveMap) {
  const unsigned long nLoopKF = mpCurrentKF->mnId;
  if (mpThreadGBA != nullptr) mpThreadGBA->join();
  mpThreadGBA.reset();
  mbStopGBA = false;
  mnRunningGBA += 1;
  if (mbThreads)
    mpThreadGBA = std::make_unique<std::thread>(&LoopClosing::RunGlobalBundleAdjustment, this,
                                                pActiveMap, nLoopKF);
  else
    RunGlobalBundleAdjustment(pActiveMap, nLoopKF);
}

// On a thread of its own. Those keyframes and points that came meanwhile follow their parents and reference keyframes.
void LoopClosing::RunGlobalBundleAdjustment(Map* pActiveMap, unsigned long nLoopKF) {
  const int idx = mnFullBAIdx;
  Optimizer::GlobalBundleAdjustemnt(pActiveMap, mnIterationsGBA, &mbStopGBA, nLoopKF);
  if (idx == mnFullBAIdx && !mbStopGBA) {
    lock_guard<mutex> lock(pActiveMap->mMutexMapUpdate);
    std::vector<KeyFrame*> lpKFtoCheck = pActiveMap->GetKeyFrameOrigins();
    while (!lpKFtoCheck.empty()) {
      KeyFrame* const pKF = lpKFtoCheck.back();
      lpKFtoCheck.pop_back();
      if (pKF->mnBAGlobalForKF != nLoopKF) continue;
      const Pose Twc = pKF->GetPoseInverse();
      for (KeyFrame* pChild : pKF->GetChilds()) {
        if (pChild->isBad()) continue;
        if (pChild->mnBAGlobalForKF != nLoopKF) {
          pChild->mTcwGBA = pChild->GetPose() * Twc * pKF->mTcwGBA;
          pChild->mnBAGlobalForKF = nLoopKF;
        }
        lpKFtoCheck.push_back(pChild);
      }
      pKF->mTcwBefGBA = pKF->GetPose();
      pKF->SetPose(pKF->mTcwGBA);
    }
    for (MapPoint* pMP : pActiveMap->GetAllMapPoints()) {
      if (pMP->isBad()) continue;
      if (pMP->mnBAGlobalForKF == nLoopKF) {
        pMP->SetWorldPos(pMP->mPosGBA);
        continue;
      }
      KeyFrame* const pRefKF = pMP->GetReferenceKeyFrame();
      if (pRefKF == nullptr || pRefKF->mnBAGlobalForKF != nLoopKF) continue;
      pMP->SetWorldPos(pRefKF->GetPoseInverse() * (pRefKF->mTcwBefGBA * pMP->GetWorldPos()));
    }
    pActiveMap->InformNewBigChange();
    mnGBAs += 1;
  }
  mnRunningGBA += -1;
}

void LoopClosing::ForgetLoop() {
  mpLoopLastCurrentKF->SetErase();
  mpLoopMatchedKF->SetErase();
  mnLoopNumCoincidences = mnLoopNumNotFound = 0;
  mvpLoopMatchedMPs.clear();
  mvpLoopMPs.clear();
}

void LoopClosing::ForgetMerge() {
  mpMergeLastCurrentKF->SetErase();
  mpMergeMatchedKF->SetErase();
  mnMergeNumCoincidences = mnMergeNumNotFound = 0;
  mvpMergeMatchedMPs.clear();
  mvpMergeMPs.clear();
}

void LoopClosing::RequestReset() {
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

void LoopClosing::RequestResetActiveMap(Map* pMap) {
  {
    lock_guard<mutex> lock(mMutexReset);
    mbResetActiveMapRequested = true;
    mpMapToReset = pMap;
  }
  if (!mbThreads) ResetIfRequested();
  for (;;) {
    {
      lock_guard<mutex> lock(mMutexReset);
      if (!mbResetActiveMapRequested) return;
    }
    usleep(300);
  }
}

// Coincidences are forgotten, the keyframes and points of the last ones are not.
void LoopClosing::ResetIfRequested() {
  lock_guard<mutex> lock(mMutexReset);
  if (!mbResetRequested && !mbResetActiveMapRequested) return;
  lock_guard<mutex> lockQueue(mMutexLoopQueue);
  if (mbResetRequested)
    mlpLoopKeyFrameQueue.clear();
  else
    mlpLoopKeyFrameQueue.remove_if([&](KeyFrame* pKF) { return pKF->GetMap() == mpMapToReset; });
  mnLoopNumCoincidences = mnMergeNumCoincidences = 0;
  mbResetRequested = mbResetActiveMapRequested = false;
}

void LoopClosing::RequestFinish() {
  lock_guard<mutex> lock(mMutexFinish);
  mbFinishRequested = true;
}

bool LoopClosing::isFinished() {
  lock_guard<mutex> lock(mMutexFinish);
  return mbFinished;
}

}  // namespace mini_orb
