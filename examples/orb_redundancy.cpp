// Keyframe culling without walking observers, in classes of ORB-SLAM's shape: each function has one line more. A whole system with
// the same lines is examples/mini_orb (redundancy.patch); docs/redundancy.md is the guide.
#include <cstdio>
#include <map>
#include <memory>
#include <mutex>
#include <slamgc/adapters/orb_slam_redundancy.hpp>
#include <tuple>
#include <utility>
#include <vector>

class KeyFrame;
class MapPoint;
using Redundancy = slamgc::orb_slam3::redundancy_hooks<KeyFrame, MapPoint>;

class MapPoint {
  friend slamgc::orb_slam3::access;

 public:
  void AddObservation(KeyFrame* pKF, int idx) {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    const std::tuple<int, int> indexes(idx, -1);
    Redundancy::set_observation(pKF, this, indexes);  // new
    mObservations[pKF] = indexes;
  }
  void EraseObservation(KeyFrame* pKF) {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    Redundancy::erase_observation(pKF, this);  // new
    mObservations.erase(pKF);
  }

  Redundancy::point_state mRedundancy;  // new

 private:
  bool mbBad = false;
  std::map<KeyFrame*, std::tuple<int, int>> mObservations;
  std::mutex mMutexFeatures;
};

struct KeyPoint {
  int octave;
};

class KeyFrame {
  friend slamgc::orb_slam3::access;

 public:
  explicit KeyFrame(std::vector<KeyPoint> keys)
      : N(static_cast<int>(keys.size())), mvKeysUn(std::move(keys)), mvpMapPoints(mvKeysUn.size()) {
    Redundancy::add_keyframe(this);  // new
  }
  ~KeyFrame() { Redundancy::remove_keyframe(this); }  // new

  void AddMapPoint(MapPoint* pMP, std::size_t idx) {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    Redundancy::set_slot(this, idx, pMP);  // new
    mvpMapPoints[idx] = pMP;
  }
  void SetBadFlag() {
    for (MapPoint* pMP : mvpMapPoints)
      if (pMP != nullptr) pMP->EraseObservation(this);
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    Redundancy::remove_keyframe(this);  // new
    mbBad = true;
  }
  bool isBad() const { return mbBad; }

  const int N;
  const std::vector<KeyPoint> mvKeysUn;
  std::vector<float> mvDepth;
  float mThDepth = 0;
  Redundancy::keyframe_state mRedundancy;  // new

 private:
  bool mbBad = false;
  std::vector<MapPoint*> mvpMapPoints;
  std::mutex mMutexFeatures;
};

int main() {
  Redundancy::use(slamgc::redundancy::orb_slam3, false);  // one camera
  std::vector<std::unique_ptr<MapPoint>> points;
  for (int i = 0; i != 20; ++i) points.push_back(std::make_unique<MapPoint>());
  // Eight keyframes see the same points, each from one level farther away than the one before.
  std::vector<std::unique_ptr<KeyFrame>> keyframes;
  for (int level = 0; level != 8; ++level) {
    keyframes.push_back(std::make_unique<KeyFrame>(std::vector<KeyPoint>(20, {level})));
    for (std::size_t i = 0; i != points.size(); ++i) {
      points[i]->AddObservation(keyframes.back().get(), static_cast<int>(i));
      keyframes.back()->AddMapPoint(points[i].get(), i);
    }
  }
  int culled = 0;
  for (std::size_t k = 0; k != keyframes.size(); ++k) {  // LocalMapping::KeyFrameCulling
    const auto seen = Redundancy::check(keyframes[k].get());
    std::printf("keyframe %zu: %d of %d points are seen as well by four others\n", k,
                seen.redundant_slots, seen.eligible_slots);
    if (!seen.redundant) continue;
    keyframes[k]->SetBadFlag();
    ++culled;
  }
  std::printf("%d culled\n", culled);
  return culled == 4 ? 0 : 1;
}
