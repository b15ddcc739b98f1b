#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "Common.h"
#include "World.h"

namespace mini_orb {

class KeyFrame;
class MapPoint;

struct KeyPoint {
  float x = 0, y = 0, size = 0, angle = 0, response = 0;
  int octave = 0, class_id = -1;
};

// What a frame and the keyframe made of it have in common: features, their grid and their words.
struct Features {
  static constexpr std::size_t kGridCols = 64, kGridRows = 48;
  static constexpr float mThDepth = 5;  // metres: what is nearer is close

  Features() = default;
  explicit Features(const Image& image);
  // The keypoints within r of a place.
  std::vector<std::size_t> GetFeaturesInArea(double x, double y, double r) const;
  // The place of feature i relative to the camera. Only with depth.
  Vector3d InCamera(std::size_t i) const;
  // The direction in which the camera sees it, with depth 1.
  Vector3d Ray(std::size_t i) const;

  static int Distance(const Descriptor& a, const Descriptor& b);

  double mTimeStamp = 0;
  int N = 0;
  std::vector<KeyPoint> mvKeys, mvKeysUn;
  std::vector<float> mvuRight, mvDepth;  // negative: none
  std::vector<Descriptor> mDescriptors;
  std::map<unsigned, double> mBowVec;                  // by word
  std::map<unsigned, std::vector<unsigned>> mFeatVec;  // by node
  std::vector<std::vector<std::vector<std::size_t>>> mGrid;
};

class Frame : public Features {
 public:
  Frame() = default;
  explicit Frame(const Image& image);

  void SetPose(const Pose& Tcw);
  const Pose& GetPose() const { return mTcw; }
  Vector3d UnprojectStereo(std::size_t i) const;

  static Racy<unsigned long> nNextId;
  unsigned long mnId = 0;
  Pose mTcw = Pose::Identity();
  std::vector<MapPoint*> mvpMapPoints;
  std::vector<bool> mvbOutlier;
  KeyFrame* mpReferenceKF = nullptr;
  KeyFrame* mpLastKeyFrame = nullptr;
};

}  // namespace mini_orb
