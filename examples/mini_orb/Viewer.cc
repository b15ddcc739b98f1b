#include "Viewer.h"

#include <unistd.h>

#include "Atlas.h"
#include "KeyFrame.h"
#include "MapPoint.h"
#include "Tracking.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;

void FrameDrawer::Update(Tracking* pTracker) {
  lock_guard<mutex> lock(mMutex);
  mCurrentFrame = pTracker->mCurrentFrame;
  mvpLocalMap = pTracker->mCurrentFrame.mvpMapPoints;
}

std::size_t FrameDrawer::DrawFrame() {
  lock_guard<mutex> lock(mMutex);
  return static_cast<std::size_t>(mCurrentFrame.N) + mvpLocalMap.size();
}

Viewer::Viewer(FrameDrawer* pFrameDrawer, Atlas* pAtlas, bool bThreads)
    : mpFrameDrawer(pFrameDrawer), mpAtlas(pAtlas), mbFinished(!bThreads) {}

void Viewer::Run() {
  while (RunOnce()) usleep(3000);
  lock_guard<mutex> lock(mMutex);
  mbFinished = true;
}

bool Viewer::RunOnce() {
  {
    lock_guard<mutex> lock(mMutex);
    mbStopped = mbStopRequested;
    if (mbFinishRequested || mbStopped) return !mbFinishRequested;
  }
  DrawKeyFrames();
  DrawMapPoints();
  mDrawn += static_cast<double>(mpFrameDrawer->DrawFrame());
  return true;
}

void Viewer::DrawKeyFrames() {
  for (Map* pMap : mpAtlas->GetAllMaps())
    for (KeyFrame* pKF : pMap->GetAllKeyFrames()) {
      const Vector3d Ow = pKF->GetCameraCenter();
      const auto line = [&](KeyFrame* pTo) {
        if (pTo != nullptr) mDrawn += (pTo->GetCameraCenter() - Ow).norm();
      };
      for (KeyFrame* pCovisible : pKF->GetVectorCovisibleKeyFrames()) line(pCovisible);
      line(pKF->GetParent());
      for (KeyFrame* pLoopKF : pKF->GetLoopEdges()) line(pLoopKF);
      line(pKF->mNextKF);
    }
}

void Viewer::DrawMapPoints() {
  Map* const pMap = mpAtlas->GetCurrentMap();
  for (MapPoint* pMP : pMap->GetAllMapPoints())
    if (!pMP->isBad()) mDrawn += pMP->GetWorldPos().norm();
  for (MapPoint* pMP : pMap->GetReferenceMapPoints())
    if (!pMP->isBad()) mDrawn += pMP->GetWorldPos().norm();
}

void Viewer::RequestStop() {
  lock_guard<mutex> lock(mMutex);
  mbStopRequested = true;
}

bool Viewer::isStopped() {
  lock_guard<mutex> lock(mMutex);
  return mbStopped || mbFinished;
}

void Viewer::Release() {
  lock_guard<mutex> lock(mMutex);
  mbStopRequested = mbStopped = false;
}

void Viewer::RequestFinish() {
  lock_guard<mutex> lock(mMutex);
  mbFinishRequested = true;
}

bool Viewer::isFinished() {
  lock_guard<mutex> lock(mMutex);
  return mbFinished;
}

}  // namespace mini_orb
