// Pictures: a map before and after the culling of a keyframe and a map point, for Graphviz.
//   graphviz before | dot -Tsvg > before.svg
//   graphviz after | dot -Tsvg > after.svg
//   graphviz around | dot -Tsvg > around.svg    only what is one edge away from the culled keyframe
#include <cstdio>
#include <iostream>
#include <mutex>
#include <slamgc/diagnosis/graphviz.hpp>
#include <slamgc/slamgc.hpp>
#include <string>

template <class T>
using object = slamgc::rc_object<T, slamgc::fetch_add_counter, slamgc::reclaim_retired>;

struct MapPoint;
struct KeyFrame : object<KeyFrame> {
  explicit KeyFrame(unsigned long id) : mnId(id) {}
  unsigned long report_id() const { return mnId; }
  template <class Visitor>
  void edges(Visitor& v) {
    {
      const std::lock_guard<std::mutex> lock(mMutexFeatures);
      v.edge("mvpMapPoints", mvpMapPoints, slamgc::on_retire::null);
    }
    const std::lock_guard<std::mutex> lock(mMutexConnections);
    v.edge("mConnectedKeyFrameWeights", mConnectedKeyFrameWeights, slamgc::on_retire::erase);
    v.edge("mPrevKF", mPrevKF,
           slamgc::on_retire::bypass([](KeyFrame& kf) { return kf.mPrevKF.get(); }));
  }
  const unsigned long mnId;
  std::mutex mMutexFeatures;
  std::mutex mMutexConnections;
  slamgc::rc_vector<MapPoint> mvpMapPoints;
  slamgc::rc_map<KeyFrame, int> mConnectedKeyFrameWeights;
  slamgc::rc_slot<KeyFrame> mPrevKF;
};
struct MapPoint : object<MapPoint> {
  explicit MapPoint(unsigned long id) : mnId(id) {}
  unsigned long report_id() const { return mnId; }
  template <class Visitor>
  void edges(Visitor& v) {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    v.edge("mObservations", mObservations, slamgc::on_retire::erase);
    v.edge("mpRefKF", mpRefKF, slamgc::on_retire::null);
  }
  const unsigned long mnId;
  std::mutex mMutexFeatures;
  slamgc::rc_map<KeyFrame, int> mObservations;
  slamgc::rc_slot<KeyFrame> mpRefKF;
};
struct Map {
  template <class Visitor>
  void edges(Visitor& v) {
    const std::lock_guard<std::mutex> lock(mMutexMap);
    v.edge("mspKeyFrames", mspKeyFrames, slamgc::on_retire::erase);
  }
  std::mutex mMutexMap;
  slamgc::registry<slamgc::rc_set<KeyFrame>> mspKeyFrames;
  slamgc::root root{"Map", *this};
};

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "before";
  slamgc::domain& domain = slamgc::default_domain();
  Map map;
  KeyFrame* kf[3];
  MapPoint* point[2];
  {
    slamgc::mutator me("mapping");
    for (unsigned long i = 0; i != 3; ++i) {
      kf[i] = new KeyFrame(i + 1);
      map.mspKeyFrames.insert(kf[i]);
      if (i == 0) continue;
      kf[i]->mPrevKF = kf[i - 1];
    }
    kf[2]->mConnectedKeyFrameWeights[kf[1]] = 30;  // in one direction only, as ORB-SLAM3 leaves it
    for (unsigned long i = 0; i != 2; ++i) {
      point[i] = new MapPoint(i + 1);
      point[i]->mpRefKF = kf[i];
      for (auto* k : {kf[i], kf[i + 1]}) {
        k->mvpMapPoints.push_back(point[i]);
        point[i]->mObservations[k] = 0;
      }
    }
    // Marked bad, and taken out of nothing.
    slamgc::retire(kf[1]);
    slamgc::retire(point[1]);
  }
  if (what == "after") (void)domain.drain();
  slamgc::picture_options options;
  if (what == "around") {
    options.centre = kf[1];
    options.hops = 1;
  }
  slamgc::write_dot(std::cout, slamgc::capture(domain), options);

  (void)domain.drain();
  {
    slamgc::mutator me("mapping");
    slamgc::retire(point[0]);
  }
  map.mspKeyFrames.clear();
  (void)domain.drain();
}
