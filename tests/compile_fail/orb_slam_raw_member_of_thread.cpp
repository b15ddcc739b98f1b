// expect-error: slamgc: a member of ORB-SLAM is not counted yet
#include <list>
#include <slamgc/adapters/orb_slam3.hpp>

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  template <class Visitor>
  void edges(Visitor&) {}
};
struct LocalMapping {
  void Run() { slamgc::orb_slam3::thread me("LocalMapping", *this); }
  std::mutex mMutexNewKFs;
#ifdef SLAMGC_POSITIVE_CONTROL
  slamgc::registry<slamgc::rc_list<KeyFrame>> mlNewKeyFrames;
#else
  std::list<KeyFrame*> mlNewKeyFrames;
#endif
  slamgc::rc_slot<KeyFrame> mpCurrentKeyFrame;
};

void run(LocalMapping& l) { l.Run(); }
