#pragma once

#include <utility>
#include <vector>

#include "Common.h"

namespace mini_orb {

struct Features;
class Frame;
class KeyFrame;
class MapPoint;

// Finds the same landmark in two places, by descriptors. Each function returns how many it found.
class ORBmatcher {
 public:
  static constexpr int TH_LOW = 50;  // bits of 256

  // Points of the map in a frame.
  static int SearchByProjection(Frame& F, const std::vector<MapPoint*>& vpMapPoints, double th);
  // Points of the last frame.
  static int SearchByProjection(Frame& CurrentFrame, const Frame& LastFrame, double th);
  // What each feature of F is among the points of pKF, by words.
  static int SearchByBoW(KeyFrame* pKF, const Frame& F, std::vector<MapPoint*>& vpMatches);
  // The points of pKF2 at the features of pKF1.
  static int SearchByBoW(KeyFrame* pKF1, KeyFrame* pKF2, std::vector<MapPoint*>& vpMatches12);
  // Pairs of features without points.
  static int SearchForTriangulation(KeyFrame* pKF1, KeyFrame* pKF2,
                                    std::vector<std::pair<std::size_t, std::size_t>>& vMatched);
  // Puts the points into the keyframe. Where it has another one there, the one that is seen more often replaces the other; but if
  // pvpReplace is given, it is told which one to replace.
  static int Fuse(KeyFrame* pKF, const std::vector<MapPoint*>& vpMapPoints, double th,
                  std::vector<MapPoint*>* pvpReplace = nullptr);
};

}  // namespace mini_orb
