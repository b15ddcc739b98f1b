// atomic_rc: a pointer that threads replace and read without a lock, and whose readers may keep what they read.
#include <cstdio>
#include <slamgc/slamgc.hpp>
#include <thread>

struct Pose : slamgc::rc_object<Pose, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
  explicit Pose(int n) : frame(n) {}
  const int frame;
};

int main() {
  slamgc::domain map;
  slamgc::mutator me(map, "main");
  slamgc::atomic_rc<Pose> latest(slamgc::make_rc<Pose>(0));

  std::thread tracking([&] {
    slamgc::mutator tracker(map, "tracking");
    for (int i = 1; i <= 1000; ++i, tracker.quiescent()) {
      Pose* seen = latest.get();  // borrowed
      while (seen->frame < i && !latest.compare_exchange_weak(seen, slamgc::make_rc<Pose>(i))) {
      }
    }
  });
  const slamgc::intrusive_rc<Pose> kept = latest.load();  // counted: outlives the quiescent states
  me.quiescent();
  {
    const slamgc::mutator::offline_scope waiting(me);
    tracking.join();
    (void)map.drain();
  }
  const slamgc::borrow<Pose> now = latest.get();  // checks itself in the checked flavour
  std::printf("kept frame %s, now frame %d, alive: %llu\n",
              kept->frame <= now->frame ? "an older one" : "?", now->frame,
              static_cast<unsigned long long>(map.stats().total(&slamgc::type_stats::live)));
}
