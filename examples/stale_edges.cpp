// on_retire, root and registry: what culling leaves behind is taken out, and clearing a map is the death of all that is in it.
#include <cstdio>
#include <mutex>
#include <slamgc/slamgc.hpp>
#include <vector>

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  explicit KeyFrame(int id) : mnId(id) {}

  template <class Visitor>
  void edges(Visitor& v) {
    const std::lock_guard<std::mutex> lock(mMutexConnections);
    v.edge("mvpOrderedConnectedKeyFrames", mvpOrderedConnectedKeyFrames,
           slamgc::on_retire::erase_with(mvOrderedWeights));  // both stay in step
    v.edge("mPrevKF", mPrevKF,
           slamgc::on_retire::bypass([](KeyFrame& bad) { return bad.mPrevKF.get(); }));
  }

  const int mnId;
  std::mutex mMutexConnections;
  slamgc::rc_vector<KeyFrame> mvpOrderedConnectedKeyFrames;
  std::vector<int> mvOrderedWeights;
  slamgc::rc_slot<KeyFrame> mPrevKF;
};

struct Map {
  template <class Visitor>
  void edges(Visitor& v) {
    const std::lock_guard<std::mutex> lock(mMutexMap);
    v.edge("mspKeyFrames", mspKeyFrames, slamgc::on_retire::erase);
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mMutexMap);
    mspKeyFrames.clear();  // retires them all, in O(1)
  }

  std::mutex mMutexMap;
  slamgc::registry<slamgc::rc_set<KeyFrame>> mspKeyFrames;
  slamgc::root root{"Map", *this};  // last: where purges begin
};

int main() {
  Map map;
  {
    slamgc::mutator me("mapping");
    KeyFrame* previous = nullptr;
    std::vector<KeyFrame*> all;
    for (int id = 0; id != 4; ++id) {
      auto* const pKF = new KeyFrame(id);
      map.mspKeyFrames.insert(pKF);
      pKF->mPrevKF = previous;
      for (KeyFrame* p : all) {
        pKF->mvpOrderedConnectedKeyFrames.push_back(p);
        pKF->mvOrderedWeights.push_back(10 * p->mnId);
      }
      all.push_back(previous = pKF);
    }
    slamgc::retire(all[1]);  // marked bad; 2 and 3 still refer to it
    slamgc::retire(all[2]);
  }
  (void)slamgc::default_domain().drain();
  {
    slamgc::mutator me("mapping");
    for (KeyFrame* p : map.mspKeyFrames) {
      if (p->mnId != 3) continue;
      std::printf("keyframe 3: previous %d, weights", p->mPrevKF->mnId);
      for (int weight : p->mvOrderedWeights) std::printf(" %d", weight);
      std::printf("\n");
    }
    std::printf("%zu keyframes in the map\n", map.mspKeyFrames.size());
    map.clear();
  }
  (void)slamgc::default_domain().drain();
  std::printf("%llu alive\n",
              static_cast<unsigned long long>(
                  slamgc::default_domain().stats().total(&slamgc::type_stats::live)));
}
