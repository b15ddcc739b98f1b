#pragma once

#include <list>
#include <mutex>
#include <vector>

#include "Common.h"
#include "Frame.h"
#include "KeyFrame.h"

namespace mini_orb {

class Atlas;
class FrameDrawer;
class KeyFrame;
class KeyFrameDatabase;
class LocalMapping;
class LoopClosing;
class Map;
class MapPoint;
class System;

// Runs on the thread that calls System::TrackRGBD.
class Tracking {
 public:
  enum eTrackingState { NOT_INITIALIZED, OK, RECENTLY_LOST, LOST };

  Tracking(System* pSys, FrameDrawer* pFrameDrawer, Atlas* pAtlas, KeyFrameDatabase* pKFDB);

  void GrabImageRGBD(const Image& image);
  void Reset();
  void ResetActiveMap();
  void InformOnlyTracking(bool flag) { mbOnlyTracking = flag; }

  LocalMapping* mpLocalMapper = nullptr;
  LoopClosing* mpLoopClosing = nullptr;

  eTrackingState mState = NOT_INITIALIZED;
  Frame mCurrentFrame, mLastFrame;

  // For each frame that was tracked, where it is relative to its reference keyframe.
  std::list<Pose> mlRelativeFramePoses;
  std::list<KeyFrame*> mlpReferences;
  std::list<double> mlFrameTimes;
  std::list<bool> mlbLost;
  Times mTrackTimes;

 private:
  void Track();
  void StereoInitialization();
  void CreateMapInAtlas();
  void CheckReplacedInLastFrame();
  void UpdateLastFrame();
  bool TrackWithMotionModel();
  bool TrackReferenceKeyFrame();
  bool Relocalization();
  bool TrackLocalMap();
  void UpdateLocalKeyFrames();
  void UpdateLocalPoints();
  void SearchLocalPoints();
  bool NeedNewKeyFrame();
  void CreateNewKeyFrame();
  int DiscardOutliers();

  System* const mpSystem;
  FrameDrawer* const mpFrameDrawer;
  Atlas* const mpAtlas;
  KeyFrameDatabase* const mpKeyFrameDB;

  Frame mInitialFrame;
  KeyFrame* mpReferenceKF = nullptr;
  KeyFrame* mpLastKeyFrame = nullptr;
  std::vector<KeyFrame*> mvpLocalKeyFrames;
  std::vector<MapPoint*> mvpLocalMapPoints;
  std::list<MapPoint*> mlpTemporalPoints;

  bool mbOnlyTracking = false, mbVO = false, mbVelocity = false;
  Pose mVelocity = Pose::Identity();
  unsigned long mnLastKeyFrameId = 0, mnInitialFrameId = 0;
  double mTimeStampLost = 0;
  int mnMatchesInliers = 0;
};

}  // namespace mini_orb
