#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "Common.h"
#include "KeyFrame.h"
#include "Optimizer.h"

namespace mini_orb {

class Atlas;
class KeyFrame;
class KeyFrameDatabase;
class LocalMapping;
class Map;
class MapPoint;
class Tracking;

class LoopClosing {
 public:
  LoopClosing(Atlas* pAtlas, KeyFrameDatabase* pDB, bool bThreads);

  // The thread.
  void Run();
  // One round of it. Returns false when it shall end.
  bool RunOnce();

  void InsertKeyFrame(KeyFrame* pKF);
  void RequestReset();
  void RequestResetActiveMap(Map* pMap);
  void RequestFinish();
  bool isFinished();
  bool isRunningGBA() const { return mnRunningGBA != 0; }

  Tracking* mpTracker = nullptr;
  LocalMapping* mpLocalMapper = nullptr;
  Racy<int> mnLoops = 0, mnMerges = 0, mnGBAs = 0, mnAbortedGBAs = 0;
  // How often a global BA goes over the map.
  Racy<int> mnIterationsGBA = 2;

 private:
  using KeyFrameAndPose = Optimizer::KeyFrameAndPose;

  bool CheckNewKeyFrames();
  bool NewDetectCommonRegions();
  bool DetectCommonRegion(KeyFrame* pMatchedKF, Pose& Tcw, std::vector<MapPoint*>& vpMPs,
                          std::vector<MapPoint*>& vpMatchedMPs);
  void CorrectLoop();
  void MergeLocal();
  void FuseMatched(const std::vector<MapPoint*>& vpMatchedMPs);
  void SearchAndFuse(const std::vector<KeyFrame*>& vConnectedKFs,
                     const std::vector<MapPoint*>& vpMapPoints);
  void StopLocalMappingAndGBA();
  void LaunchGBA(Map* pActiveMap);
  void RunGlobalBundleAdjustment(Map* pActiveMap, unsigned long nLoopKF);
  void ForgetLoop();
  void ForgetMerge();
  void ResetIfRequested();

  Atlas* const mpAtlas;
  KeyFrameDatabase* const mpKeyFrameDB;
  const bool mbThreads;

  std::list<KeyFrame*> mlpLoopKeyFrameQueue;
  std::mutex mMutexLoopQueue;

  KeyFrame* mpCurrentKF = nullptr;
  KeyFrame* mpLastCurrentKF = nullptr;
  std::vector<KeyFrame*> mvpCurrentConnectedKFs;

  bool mbLoopDetected = false, mbMergeDetected = false;
  int mnLoopNumCoincidences = 0, mnLoopNumNotFound = 0;
  KeyFrame* mpLoopLastCurrentKF = nullptr;
  KeyFrame* mpLoopMatchedKF = nullptr;
  std::vector<MapPoint*> mvpLoopMPs, mvpLoopMatchedMPs;
  Pose mTcwLoop;
  int mnMergeNumCoincidences = 0, mnMergeNumNotFound = 0;
  KeyFrame* mpMergeLastCurrentKF = nullptr;
  KeyFrame* mpMergeMatchedKF = nullptr;
  std::vector<MapPoint*> mvpMergeMPs, mvpMergeMatchedMPs;
  Pose mTcwMerge;

  Racy<int> mnRunningGBA = 0, mnFullBAIdx = 0;
  Racy<bool> mbStopGBA = false;
  std::unique_ptr<std::thread> mpThreadGBA;

  bool mbResetRequested = false, mbResetActiveMapRequested = false;
  Map* mpMapToReset = nullptr;
  std::mutex mMutexReset;
  bool mbFinishRequested = false, mbFinished;
  std::mutex mMutexFinish;
};

}  // namespace mini_orb
