#pragma once

#include <mutex>
#include <vector>

#include "Common.h"
#include "Frame.h"
#include "MapPoint.h"

namespace mini_orb {

class Atlas;
class MapPoint;
class Tracking;

// Keeps a copy of what tracking has just done.
class FrameDrawer {
 public:
  void Update(Tracking* pTracker);
  std::size_t DrawFrame();

 private:
  Frame mCurrentFrame;
  std::vector<MapPoint*> mvpLocalMap;
  std::mutex mMutex;
};

// Has no window: it adds up what it would draw.
class Viewer {
 public:
  Viewer(FrameDrawer* pFrameDrawer, Atlas* pAtlas, bool bThreads);

  // The thread.
  void Run();
  bool RunOnce();

  void RequestStop();
  bool isStopped();
  void Release();
  void RequestFinish();
  bool isFinished();

  double Drawn() const { return mDrawn; }

 private:
  void DrawKeyFrames();
  void DrawMapPoints();

  FrameDrawer* const mpFrameDrawer;
  Atlas* const mpAtlas;
  double mDrawn = 0;
  bool mbStopRequested = false, mbStopped = false, mbFinishRequested = false, mbFinished;
  std::mutex mMutex;
};

}  // namespace mini_orb
