#pragma once

#include <list>
#include <mutex>
#include <vector>

#include "Common.h"
#include "KeyFrame.h"

namespace mini_orb {

class Atlas;
class KeyFrame;
class LoopClosing;
class Map;
class MapPoint;
class Tracking;

class LocalMapping {
 public:
  // bThreads: whether Run() is called, on a thread of its own.
  LocalMapping(Atlas* pAtlas, bool bThreads);

  // The thread.
  void Run();
  // One round of it. Returns false when it shall end.
  bool RunOnce();

  void InsertKeyFrame(KeyFrame* pKF);
  void EmptyQueue();
  std::size_t KeyframesInQueue();

  void RequestStop();
  bool Stop();
  void Release();
  bool isStopped();
  bool stopRequested();
  bool SetNotStop(bool flag);
  void RequestReset();
  void RequestResetActiveMap(Map* pMap);
  void RequestFinish();
  bool isFinished();
  bool AcceptKeyFrames() const { return mbAcceptKeyFrames; }
  void InterruptBA() { mbAbortBA = true; }

  Tracking* mpTracker = nullptr;
  LoopClosing* mpLoopCloser = nullptr;
  Racy<int> mnCulled = 0;
  Times mLMTimes;  // for each keyframe; of this thread

 private:
  bool CheckNewKeyFrames();
  void ProcessNewKeyFrame();
  void CreateNewMapPoints();
  void MapPointCulling();
  void SearchInNeighbors();
  void KeyFrameCulling();
  void ResetIfRequested();

  Atlas* const mpAtlas;
  const bool mbThreads;

  std::list<KeyFrame*> mlNewKeyFrames;
  Racy<KeyFrame*> mpCurrentKeyFrame;
  std::list<MapPoint*> mlpRecentAddedMapPoints;
  std::mutex mMutexNewKFs, mMutexRecent;

  bool mbStopped = false, mbStopRequested = false, mbNotStop = false;
  std::mutex mMutexStop;
  bool mbResetRequested = false, mbResetRequestedActiveMap = false;
  Map* mpMapToReset = nullptr;
  std::mutex mMutexReset;
  bool mbFinishRequested = false, mbFinished;
  std::mutex mMutexFinish;
  Racy<bool> mbAbortBA = false, mbAcceptKeyFrames = true;
};

}  // namespace mini_orb
