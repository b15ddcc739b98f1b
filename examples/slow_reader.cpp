// A global bundle adjustment takes ten seconds. It pins its keyframes and goes offline, so that the rest of the
// map is reclaimed meanwhile; and a background thread reclaims it, so that no SLAM thread runs a destructor.
#include <cstdio>
#include <slamgc/background_reclaimer.hpp>
#include <slamgc/slamgc.hpp>

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
  double pose = 0;
};

int main() {
  slamgc::domain map;
  map.on_backlog(100, [](const slamgc::delay& d, void*) {
    std::printf("%llu objects wait for %s\n", static_cast<unsigned long long>(d.backlog), d.oldest);
  });
  slamgc::background_reclaimer reclaimer(map);
  {
    slamgc::mutator me(map, "bundle adjustment");
    slamgc::rc_vector<KeyFrame> keyframes;  // the map's
    for (int i = 0; i < 1000; ++i) keyframes.push_back(new KeyFrame);

    const slamgc::pin_set<KeyFrame> window(keyframes.end() - 10, keyframes.end());
    {
      const slamgc::mutator::offline_scope offline(me);
      keyframes.clear();  // another thread resets the map
      for (KeyFrame* pKF : window) pKF->pose += 1;
      while (map.stats().total(&slamgc::type_stats::live) > 10) reclaimer.wake();
      std::puts("only the pinned keyframes are left");
    }
  }  // online again, for the end of the scope
  const bool drained = reclaimer.stop() == slamgc::waited::done;
  std::printf("drained: %s, alive: %llu\n", drained ? "yes" : "no",
              static_cast<unsigned long long>(map.stats().total(&slamgc::type_stats::live)));
}
