// The example of the README: what changes in a SLAM system's classes, and what does not.
#include <cstdio>
#include <slamgc/slamgc.hpp>

struct MapPoint;

struct KeyFrame : slamgc::rc_object<KeyFrame> {     // was: struct KeyFrame {
  slamgc::rc_vector<MapPoint> mvpMapPoints;         // was: std::vector<MapPoint*>
  slamgc::rc_map<KeyFrame, int> mConnectedWeights;  // was: std::map<KeyFrame*, int>
  slamgc::rc_slot<KeyFrame> mpParent;               // was: KeyFrame*
  ~KeyFrame() { std::puts("a keyframe is destroyed"); }
};
struct MapPoint : slamgc::rc_object<MapPoint> {
  slamgc::rc_map<KeyFrame, int> mObservations;  // was: std::map<KeyFrame*, int>
  ~MapPoint() { std::puts("a map point is destroyed"); }
};

int main() {
  slamgc::rc_set<KeyFrame> mspKeyFrames;  // was: std::set<KeyFrame*>
  KeyFrame* pKF = new KeyFrame;           // from here on as it was
  MapPoint* pMP = new MapPoint;
  mspKeyFrames.insert(pKF);
  pKF->mvpMapPoints.push_back(pMP);
  pMP->mObservations[pKF] = 0;
  std::printf("the keyframe is referred to %u times\n", pKF->use_count());
  for (MapPoint* p : pKF->mvpMapPoints) p->mObservations.erase(pKF);
  mspKeyFrames.erase(pKF);  // the last reference: both are destroyed
  std::puts("done");
}
