// Two threads share keyframes through raw pointers: tracking reads and never waits, mapping culls and collects.
#include <atomic>
#include <cstdio>
#include <slamgc/slamgc.hpp>
#include <thread>

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  int pose = 1;
  ~KeyFrame() { pose = 0; }
};

int main() {
  slamgc::rc_slot<KeyFrame> reference;  // a member of the map; was: KeyFrame*
  std::atomic<bool> running{true};

  std::thread tracking([&] {
    slamgc::mutator me("tracking", {true, /*never_reclaim=*/true});
    for (; running; me.quiescent()) {  // the end of each frame: no keyframe is in use
      KeyFrame* pKF = reference;       // borrowed: a plain pointer, valid until quiescent()
      if (pKF != nullptr && pKF->pose != 1) std::puts("used after it was freed!");
    }
  });
  std::thread mapping([&] {
    slamgc::mutator me("mapping");
    for (int i = 0; i < 10000; ++i, me.quiescent()) {
      KeyFrame* pBad = reference;
      reference = new KeyFrame;
      if (pBad != nullptr) slamgc::retire(pBad);  // SetBadFlag(): tracking may still use it
      slamgc::default_domain().collect({1000});   // frees what nobody can see any more; never waits
    }
    slamgc::retire(reference.get());
    reference = nullptr;
    running = false;
  });
  tracking.join();
  mapping.join();
  (void)slamgc::default_domain().drain();
  const slamgc::type_stats keyframes = slamgc::default_domain().stats().types.front();
  std::printf("%llu made, %llu retired, %llu reclaimed, %llu alive\n",
              static_cast<unsigned long long>(keyframes.created),
              static_cast<unsigned long long>(keyframes.retired),
              static_cast<unsigned long long>(keyframes.reclaimed),
              static_cast<unsigned long long>(keyframes.live));
}
