// edges(): a map is full of cycles. Described edges let the collector find the retired objects that nothing but each
// other refers to.
#include <cstdio>
#include <mutex>
#include <slamgc/slamgc.hpp>

struct MapPoint;

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  ~KeyFrame() { std::puts("a keyframe is reclaimed"); }
  template <class Visitor>
  void edges(Visitor& v) {  // each counted member once, under the program's own lock
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    v.edge("mvpMapPoints", mvpMapPoints);
  }
  std::mutex mMutexFeatures;
  slamgc::rc_vector<MapPoint> mvpMapPoints;
};
struct MapPoint : slamgc::rc_object<MapPoint, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  ~MapPoint() { std::puts("a map point is reclaimed"); }
  template <class Visitor>
  void edges(Visitor& v) {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    v.edge("mObservations", mObservations);
    v.edge("mpRefKF", mpRefKF);
  }
  std::mutex mMutexFeatures;
  slamgc::rc_map<KeyFrame, int> mObservations;
  slamgc::rc_slot<KeyFrame> mpRefKF;
};

int main() {
  {
    slamgc::mutator me("mapping");
    KeyFrame* pKF = new KeyFrame;
    MapPoint* pMP = new MapPoint;
    pKF->mvpMapPoints.push_back(pMP);
    pMP->mObservations[pKF] = 0;
    pMP->mpRefKF = pKF;
    slamgc::retire(pKF);  // marked bad; nobody takes the references out
    slamgc::retire(pMP);
  }
  (void)slamgc::default_domain().drain();
  std::puts("done");
}
