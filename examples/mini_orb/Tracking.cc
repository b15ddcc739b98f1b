#include "Tracking.h"

#include <algorithm>
#include <map>
#include <set>

#include "Atlas.h"
#include "KeyFrame.h"
#include "KeyFrameDatabase.h"
#include "LocalMapping.h"
#include "LoopClosing.h"
#include "MapPoint.h"
#include "ORBmatcher.h"
#include "Optimizer.h"
#include "System.h"
#include "Viewer.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;

namespace {
constexpr int kMinInliers = 10;
constexpr unsigned long kMaxFrames = 8;    // between two keyframes
constexpr double kTimeRecentlyLost = 0.5;  // seconds
}  // namespace

Tracking::Tracking(System* pSys, FrameDrawer* pFrameDrawer, Atlas* pAtlas, KeyFrameDatabase* pKFDB)
    : mpSystem(pSys), mpFrameDrawer(pFrameDrawer), mpAtlas(pAtlas), mpKeyFrameDB(pKFDB) {}

void Tracking::GrabImageRGBD(const Image& image) {
  const Stopwatch time(mTrackTimes);
  mCurrentFrame = Frame(image);
  Track();
}

void Tracking::Track() {
  Map* pCurrentMap = mpAtlas->GetCurrentMap();
  std::unique_lock<mutex> lock(pCurrentMap->mMutexMapUpdate);
  while (pCurrentMap != mpAtlas->GetCurrentMap()) {  // it was merged into another one
    pCurrentMap = mpAtlas->GetCurrentMap();
    lock = std::unique_lock<mutex>(pCurrentMap->mMutexMapUpdate);
  }
  if (mState == NOT_INITIALIZED) {
    StereoInitialization();
    mpFrameDrawer->Update(this);
    if (mState != OK) {
      mLastFrame = Frame(mCurrentFrame);
      return;
    }
  } else {
    bool bOK = false;
    if (mState == OK) {
      CheckReplacedInLastFrame();
      bOK = mbVelocity && TrackWithMotionModel();
      if (!bOK) bOK = TrackReferenceKeyFrame();
    } else if (mState == RECENTLY_LOST || mbOnlyTracking) {
      bOK = Relocalization();
      if (!bOK && mCurrentFrame.mTimeStamp - mTimeStampLost > kTimeRecentlyLost) mState = LOST;
    } else {
      if (pCurrentMap->KeyFramesInMap() < 6)
        mpSystem->ResetActiveMap();
      else
        CreateMapInAtlas();
      return;
    }
    mCurrentFrame.mpReferenceKF = mpReferenceKF;
    if (bOK) bOK = TrackLocalMap();
    if (bOK) {
      mState = OK;
    } else if (mState == OK) {
      mState = RECENTLY_LOST;
      mTimeStampLost = mCurrentFrame.mTimeStamp;
    }
    mpFrameDrawer->Update(this);
    mbVelocity = bOK && !mLastFrame.mvpMapPoints.empty();
    if (bOK) {
      if (mbVelocity) mVelocity = mCurrentFrame.GetPose() * mLastFrame.GetPose().inverse();
      // The points of visual odometry are not in the map.
      for (std::size_t i = 0; i != mCurrentFrame.mvpMapPoints.size(); ++i) {
        MapPoint* const pMP = mCurrentFrame.mvpMapPoints[i];
        if (pMP != nullptr && pMP->Observations() < 1) {
          mCurrentFrame.mvbOutlier[i] = false;
          mCurrentFrame.mvpMapPoints[i] = nullptr;
        }
      }
      for (MapPoint* pMP : mlpTemporalPoints) delete pMP;
      mlpTemporalPoints.clear();
      if (NeedNewKeyFrame()) CreateNewKeyFrame();
      DiscardOutliers();
    }
    if (mCurrentFrame.mpReferenceKF == nullptr) mCurrentFrame.mpReferenceKF = mpReferenceKF;
    mLastFrame = Frame(mCurrentFrame);
  }
  if (mCurrentFrame.mpReferenceKF != nullptr && mState == OK) {
    mlRelativeFramePoses.push_back(mCurrentFrame.GetPose() *
                                   mCurrentFrame.mpReferenceKF->GetPoseInverse());
    mlpReferences.push_back(mCurrentFrame.mpReferenceKF);
    mlFrameTimes.push_back(mCurrentFrame.mTimeStamp);
    mlbLost.push_back(false);
  } else if (!mlpReferences.empty()) {
    mlRelativeFramePoses.push_back(mlRelativeFramePoses.back());
    mlpReferences.push_back(mlpReferences.back());
    mlFrameTimes.push_back(mCurrentFrame.mTimeStamp);
    mlbLost.push_back(true);
  }
}

void Tracking::StereoInitialization() {
  if (mCurrentFrame.N < 3 * kMinInliers) return;
  Map* const pMap = mpAtlas->GetCurrentMap();
  // A later map begins where the last one was lost: odometry would say so.
  mCurrentFrame.SetPose(Pose::Identity());
  auto* const pKFini = new KeyFrame(mCurrentFrame, pMap, mpKeyFrameDB);
  pMap->AddKeyFrame(pKFini);
  for (std::size_t i = 0; i != mCurrentFrame.mvpMapPoints.size(); ++i) {
    if (mCurrentFrame.mvDepth[i] <= 0) continue;
    auto* const pNewMP = new MapPoint(mCurrentFrame.UnprojectStereo(i), pKFini, pMap);
    pNewMP->AddObservation(pKFini, static_cast<int>(i));
    pKFini->AddMapPoint(pNewMP, i);
    pNewMP->ComputeDistinctiveDescriptors();
    pNewMP->UpdateNormalAndDepth();
    pMap->AddMapPoint(pNewMP);
    mCurrentFrame.mvpMapPoints[i] = pNewMP;
  }
  mpLocalMapper->InsertKeyFrame(pKFini);
  mInitialFrame = Frame(mCurrentFrame);
  mnLastKeyFrameId = mCurrentFrame.mnId;
  mpLastKeyFrame = pKFini;
  mvpLocalKeyFrames.push_back(pKFini);
  mvpLocalMapPoints = pMap->GetAllMapPoints();
  mpReferenceKF = pKFini;
  mCurrentFrame.mpReferenceKF = pKFini;
  pMap->SetReferenceMapPoints(mvpLocalMapPoints);
  pMap->AddKeyFrameOrigin(pKFini);
  mLastFrame = Frame(mCurrentFrame);
  mbVelocity = false;
  mState = OK;
}

void Tracking::CreateMapInAtlas() {
  mpAtlas->CreateNewMap();
  mState = NOT_INITIALIZED;
  mbVelocity = mbVO = false;
  mpLastKeyFrame = nullptr;
  mpReferenceKF = nullptr;
  mLastFrame = Frame();
  mCurrentFrame = Frame();
}

void Tracking::CheckReplacedInLastFrame() {
  for (std::size_t i = 0; i != mLastFrame.mvpMapPoints.size(); ++i) {
    MapPoint* const pMP = mLastFrame.mvpMapPoints[i];
    if (pMP == nullptr) continue;
    MapPoint* const pRep = pMP->GetReplaced();
    if (pRep != nullptr) mLastFrame.mvpMapPoints[i] = pRep;
  }
}

void Tracking::UpdateLastFrame() {
  KeyFrame* const pRef = mLastFrame.mpReferenceKF;
  mLastFrame.SetPose(mlRelativeFramePoses.back() * pRef->GetPose());
  if (!mbOnlyTracking || mnLastKeyFrameId == mLastFrame.mnId) return;
  // Localisation: points of visual odometry, for the next frame only.
  int n = 0;
  for (std::size_t i = 0; i != mLastFrame.mvpMapPoints.size() && n < 100; ++i) {
    MapPoint* const pMP = mLastFrame.mvpMapPoints[i];
    if (mLastFrame.mvDepth[i] <= 0 || (pMP != nullptr && pMP->Observations() >= 1)) continue;
    auto* const pNewMP =
        new MapPoint(mLastFrame.UnprojectStereo(i), mpAtlas->GetCurrentMap(), mLastFrame, i);
    mLastFrame.mvpMapPoints[i] = pNewMP;
    mLastFrame.mvbOutlier[i] = false;
    mlpTemporalPoints.push_back(pNewMP);
    ++n;
  }
}

bool Tracking::TrackWithMotionModel() {
  UpdateLastFrame();
  mCurrentFrame.SetPose(mVelocity * mLastFrame.GetPose());
  std::fill(mCurrentFrame.mvpMapPoints.begin(), mCurrentFrame.mvpMapPoints.end(), nullptr);
  if (ORBmatcher::SearchByProjection(mCurrentFrame, mLastFrame, 25) < kMinInliers) return false;
  Optimizer::PoseOptimization(&mCurrentFrame);
  const int nmatchesMap = DiscardOutliers();
  if (mbOnlyTracking) mbVO = nmatchesMap < kMinInliers;
  return nmatchesMap >= kMinInliers || (mbOnlyTracking && !mlpTemporalPoints.empty());
}

bool Tracking::TrackReferenceKeyFrame() {
  std::vector<MapPoint*> vpMapPointMatches;
  if (mpReferenceKF == nullptr) return false;
  if (ORBmatcher::SearchByBoW(mpReferenceKF, mCurrentFrame, vpMapPointMatches) < kMinInliers)
    return false;
  mCurrentFrame.mvpMapPoints = vpMapPointMatches;
  mCurrentFrame.SetPose(mLastFrame.GetPose());
  Optimizer::PoseOptimization(&mCurrentFrame);
  return DiscardOutliers() >= kMinInliers;
}

bool Tracking::Relocalization() {
  for (KeyFrame* pKF :
       mpKeyFrameDB->DetectRelocalizationCandidates(mCurrentFrame, mpAtlas->GetCurrentMap())) {
    if (pKF->isBad()) continue;
    std::vector<MapPoint*> vpMapPointMatches;
    if (ORBmatcher::SearchByBoW(pKF, mCurrentFrame, vpMapPointMatches) < 2 * kMinInliers) continue;
    mCurrentFrame.mvpMapPoints = vpMapPointMatches;
    mCurrentFrame.SetPose(pKF->GetPose());
    Optimizer::PoseOptimization(&mCurrentFrame);
    if (DiscardOutliers() < kMinInliers) continue;
    mpReferenceKF = pKF;
    return true;
  }
  return false;
}

bool Tracking::TrackLocalMap() {
  UpdateLocalKeyFrames();
  UpdateLocalPoints();
  SearchLocalPoints();
  Optimizer::PoseOptimization(&mCurrentFrame);
  mnMatchesInliers = 0;
  for (std::size_t i = 0; i != mCurrentFrame.mvpMapPoints.size(); ++i) {
    MapPoint* const pMP = mCurrentFrame.mvpMapPoints[i];
    if (pMP == nullptr || mCurrentFrame.mvbOutlier[i]) continue;
    pMP->IncreaseFound();
    if (mbOnlyTracking || pMP->Observations() > 0) ++mnMatchesInliers;
  }
  return mnMatchesInliers >= kMinInliers;
}

void Tracking::UpdateLocalKeyFrames() {
  std::map<KeyFrame*, int, ById> keyframeCounter;
  for (std::size_t i = 0; i != mCurrentFrame.mvpMapPoints.size(); ++i) {
    MapPoint* const pMP = mCurrentFrame.mvpMapPoints[i];
    if (pMP == nullptr) continue;
    if (pMP->isBad()) {
      mCurrentFrame.mvpMapPoints[i] = nullptr;
      continue;
    }
    for (const auto& [pKF, indexes] : pMP->GetObservations()) ++keyframeCounter[pKF];
  }
  if (keyframeCounter.empty()) return;
  KeyFrame* pKFmax = nullptr;
  int max = 0;
  mvpLocalKeyFrames.clear();
  for (const auto& [pKF, count] : keyframeCounter) {
    if (pKF->isBad()) continue;
    if (count > max) max = count, pKFmax = pKF;
    mvpLocalKeyFrames.push_back(pKF);
    pKF->mnTrackReferenceForFrame = mCurrentFrame.mnId;
  }
  // Neighbours of neighbours.
  const auto add = [&](KeyFrame* pKF) {
    if (pKF->mnTrackReferenceForFrame == mCurrentFrame.mnId) return false;
    mvpLocalKeyFrames.push_back(pKF);
    pKF->mnTrackReferenceForFrame = mCurrentFrame.mnId;
    return true;
  };
  const std::size_t direct = mvpLocalKeyFrames.size();
  for (std::size_t i = 0; i != direct && mvpLocalKeyFrames.size() < 80; ++i) {
    KeyFrame* const pKF = mvpLocalKeyFrames[i];
    for (KeyFrame* pNeighKF : pKF->GetBestCovisibilityKeyFrames(10))
      if (!pNeighKF->isBad() && add(pNeighKF)) break;
    for (KeyFrame* pChildKF : pKF->GetChilds())
      if (!pChildKF->isBad() && add(pChildKF)) break;
    if (KeyFrame* const pParent = pKF->GetParent()) add(pParent);
  }
  if (pKFmax != nullptr) {
    mpReferenceKF = pKFmax;
    mCurrentFrame.mpReferenceKF = pKFmax;
  }
}

void Tracking::UpdateLocalPoints() {
  mvpLocalMapPoints.clear();
  for (KeyFrame* pKF : mvpLocalKeyFrames)
    for (MapPoint* pMP : pKF->GetMapPointMatches()) {
      if (pMP == nullptr || pMP->mnTrackReferenceForFrame == mCurrentFrame.mnId) continue;
      if (pMP->isBad()) continue;
      mvpLocalMapPoints.push_back(pMP);
      pMP->mnTrackReferenceForFrame = mCurrentFrame.mnId;
    }
  mpAtlas->GetCurrentMap()->SetReferenceMapPoints(mvpLocalMapPoints);
}

void Tracking::SearchLocalPoints() {
  for (MapPoint* pMP : mCurrentFrame.mvpMapPoints)
    if (pMP != nullptr) {
      pMP->IncreaseVisible();
      pMP->mnLastFrameSeen = mCurrentFrame.mnId;
    }
  ORBmatcher::SearchByProjection(mCurrentFrame, mvpLocalMapPoints, 10);
}

bool Tracking::NeedNewKeyFrame() {
  if (mbOnlyTracking || mpLocalMapper->isStopped() || mpLocalMapper->stopRequested()) return false;
  const int nRefMatches = mpReferenceKF->TrackedMapPoints(3);
  const bool bWeak = mnMatchesInliers < 0.8 * nRefMatches;
  const bool bLate = mCurrentFrame.mnId >= mnLastKeyFrameId + kMaxFrames;
  const bool bEarly = mCurrentFrame.mnId < mnLastKeyFrameId + 2;
  if ((!bWeak && !bLate) || bEarly) return false;
  if (mpLocalMapper->AcceptKeyFrames()) return true;
  mpLocalMapper->InterruptBA();
  return mpLocalMapper->KeyframesInQueue() < 3;
}

void Tracking::CreateNewKeyFrame() {
  if (!mpLocalMapper->SetNotStop(true)) return;
  Map* const pMap = mpAtlas->GetCurrentMap();
  auto* const pKF = new KeyFrame(mCurrentFrame, pMap, mpKeyFrameDB);
  mpReferenceKF = pKF;
  mCurrentFrame.mpReferenceKF = pKF;
  if (mpLastKeyFrame != nullptr) {
    pKF->mPrevKF = mpLastKeyFrame;
    mpLastKeyFrame->mNextKF = pKF;
  }
  for (std::size_t i = 0; i != mCurrentFrame.mvpMapPoints.size(); ++i) {
    if (mCurrentFrame.mvDepth[i] <= 0) continue;
    MapPoint* const pMP = mCurrentFrame.mvpMapPoints[i];
    if (pMP != nullptr && pMP->Observations() >= 1) continue;
    auto* const pNewMP = new MapPoint(mCurrentFrame.UnprojectStereo(i), pKF, pMap);
    pNewMP->AddObservation(pKF, static_cast<int>(i));
    pKF->AddMapPoint(pNewMP, i);
    pNewMP->ComputeDistinctiveDescriptors();
    pNewMP->UpdateNormalAndDepth();
    pMap->AddMapPoint(pNewMP);
    mCurrentFrame.mvpMapPoints[i] = pNewMP;
    mCurrentFrame.mvbOutlier[i] = false;
  }
  mpLocalMapper->InsertKeyFrame(pKF);
  mpLocalMapper->SetNotStop(false);
  mnLastKeyFrameId = mCurrentFrame.mnId;
  mpLastKeyFrame = pKF;
}

// Returns how many points of the map are left.
int Tracking::DiscardOutliers() {
  int n = 0;
  for (std::size_t i = 0; i != mCurrentFrame.mvpMapPoints.size(); ++i) {
    MapPoint* const pMP = mCurrentFrame.mvpMapPoints[i];
    if (pMP == nullptr) continue;
    if (mCurrentFrame.mvbOutlier[i]) {
      mCurrentFrame.mvpMapPoints[i] = nullptr;
      mCurrentFrame.mvbOutlier[i] = false;
    } else if (pMP->Observations() > 0) {
      ++n;
    }
  }
  return n;
}

void Tracking::Reset() {
  mpLocalMapper->RequestReset();
  mpLoopClosing->RequestReset();
  mpKeyFrameDB->clear();
  mpAtlas->clearAtlas();
  mpAtlas->CreateNewMap();
  KeyFrame::nNextId = 0;
  Frame::nNextId = 0;
  mState = NOT_INITIALIZED;
  mlRelativeFramePoses.clear();
  mlpReferences.clear();
  mlFrameTimes.clear();
  mlbLost.clear();
  mCurrentFrame = Frame();
  mLastFrame = Frame();
  mpReferenceKF = nullptr;
  mpLastKeyFrame = nullptr;
  mbVelocity = false;
}

void Tracking::ResetActiveMap() {
  Map* const pMap = mpAtlas->GetCurrentMap();
  mpLocalMapper->RequestResetActiveMap(pMap);
  mpLoopClosing->RequestResetActiveMap(pMap);
  mpKeyFrameDB->clearMap(pMap);
  pMap->clear();
  mState = NOT_INITIALIZED;
  for (auto lost = mlbLost.begin(); lost != mlbLost.end(); ++lost) *lost = true;
  mCurrentFrame = Frame();
  mLastFrame = Frame();
  mpReferenceKF = nullptr;
  mpLastKeyFrame = nullptr;
  mbVelocity = false;
}

}  // namespace mini_orb
