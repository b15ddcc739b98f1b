#pragma once

#include <map>
#include <set>
#include <vector>

#include "Common.h"

namespace mini_orb {

class Frame;
class KeyFrame;
class Map;
class MapPoint;

// Least squares in closed form, by turns: where are the points if the poses are right, and the other way round. Takes much less time
// than a bundle adjustment, and holds the same pointers meanwhile.
class Optimizer {
 public:
  using KeyFrameAndPose = std::map<KeyFrame*, Pose, ById>;

  // Returns how many of its points the frame agrees with.
  static int PoseOptimization(Frame* pFrame);
  static void LocalBundleAdjustment(KeyFrame* pKF, const Racy<bool>* pbStopFlag, Map* pMap);
  // Puts its result into mTcwGBA and mPosGBA.
  static void GlobalBundleAdjustemnt(Map* pMap, int nIterations, const Racy<bool>* pbStopFlag,
                                     unsigned long nLoopKF);
  // Distributes the correction of a loop over the keyframes that are not corrected.
  static void OptimizeEssentialGraph(Map* pMap, KeyFrame* pLoopKF, KeyFrame* pCurKF,
                                     const KeyFrameAndPose& NonCorrected,
                                     const KeyFrameAndPose& Corrected,
                                     const std::set<MapPoint*, ById>& CorrectedPoints);
  // The pose of pKF1 that puts its features where the points at them are, if enough agree with it.
  static bool OptimizePose(KeyFrame* pKF1, std::vector<MapPoint*>& vpMatches, std::size_t nMin,
                           Pose& Tcw);
};

}  // namespace mini_orb
