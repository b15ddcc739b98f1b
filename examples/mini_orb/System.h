#pragma once

#include <iosfwd>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "Common.h"
#include "World.h"

namespace mini_orb {

class Atlas;
class FrameDrawer;
class KeyFrameDatabase;
class LocalMapping;
class LoopClosing;
class Map;
class MapPoint;
class Tracking;
class Viewer;

class System {
 public:
  // bThreads: local mapping, loop closing, global BA and the viewer have threads of their own. Otherwise TrackRGBD() gives each its
  // turn, always in the same order.
  explicit System(bool bThreads);
  ~System();

  void TrackRGBD(const Image& image);
  void ActivateLocalizationMode() { mbActivateLocalizationMode = true; }
  void DeactivateLocalizationMode() { mbDeactivateLocalizationMode = true; }
  void Reset() { mbReset = true; }
  void ResetActiveMap() { mbResetActiveMap = true; }
  // Ends all threads. Nothing is tracked afterwards.
  void Shutdown();

  // Frees what can be freed now, if there are no threads. Between two frames.
  void Collect() {}
  // Frees what can be freed, between two frames. Whether that was all.
  bool Drain() { return true; }

  // One line for each frame that was tracked: time, then Twc.
  void SaveTrajectory(std::ostream& out);
  // By the thread that calls TrackRGBD(), without other threads.
  void SaveAtlas(std::ostream& out);
  void LoadAtlas(std::istream& in);
  std::vector<MapPoint*> GetTrackedMapPoints();

  // What there is.
  struct Summary {
    std::size_t maps = 0, keyframes = 0, points = 0, frames = 0;
    int culled = 0, loops = 0, merges = 0, globalBAs = 0, abortedGBAs = 0, state = 0;
  };
  Summary GetSummary();
  // The content of all maps: what refers to a bad keyframe or point, as good as gone, is left out.
  void PrintMaps(std::ostream& out);

  Atlas* mpAtlas;
  Tracking* mpTracker;
  LocalMapping* mpLocalMapper;
  LoopClosing* mpLoopCloser;

 private:
  void SaveMap(Map* pMap, std::ostream& out);
  void LoadMap(std::istream& in);

  const bool mbThreads;
  KeyFrameDatabase* mpKeyFrameDatabase;
  FrameDrawer* mpFrameDrawer;
  Viewer* mpViewer;
  std::thread mptLocalMapping, mptLoopClosing, mptViewer;
  bool mbShutDown = false;
  bool mbReset = false, mbResetActiveMap = false;
  bool mbActivateLocalizationMode = false, mbDeactivateLocalizationMode = false;
  std::vector<MapPoint*> mTrackedMapPoints;
  std::mutex mMutexState;
};

}  // namespace mini_orb
