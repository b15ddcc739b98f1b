// weak_rc: who keeps a pointer across quiescent states without keeping its object. Addresses are used again; handles are
// not.
#include <cstdio>
#include <slamgc/slamgc.hpp>

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
                  slamgc::enable_weak_rc<KeyFrame> {
  explicit KeyFrame(int id) : mnId(id) {}
  const int mnId;
};

int main() {
  slamgc::domain system;
  slamgc::mutator tracking(system, "tracking", {false});
  slamgc::rc_set<KeyFrame> map;
  slamgc::weak_rc<KeyFrame> mLastKeyFrame;  // does not keep it
  const void* address = nullptr;
  {
    const slamgc::mutator::online_scope online(tracking);
    KeyFrame* pKF = new KeyFrame(1);
    map.insert(pKF);
    mLastKeyFrame = slamgc::weak_rc<KeyFrame>(pKF);
    address = pKF;
    if (const auto locked = mLastKeyFrame.lock())
      std::printf("keyframe %d is there\n", locked->mnId);

    map.erase(pKF);  // culled
    slamgc::retire(pKF);
  }
  if (system.drain() != slamgc::waited::done) return 1;
  {
    const slamgc::mutator::online_scope online(tracking);
    if (mLastKeyFrame.lock() == nullptr) std::puts("it is gone");
    for (int id = 2; id != 100; ++id) {  // one of them probably has the address of the first
      KeyFrame* pKF = new KeyFrame(id);
      map.insert(pKF);
      if (pKF == address) std::printf("keyframe %d has its address\n", id);
      if (slamgc::weak_rc<KeyFrame>(pKF) == mLastKeyFrame) return 1;  // never
    }
    for (KeyFrame* pKF : map) slamgc::retire(pKF);
    map.clear();
  }
  return system.drain() == slamgc::waited::done ? 0 : 1;
}
