// expect-error: slamgc: a member of ORB-SLAM is not counted yet
// ORB-SLAM2, which has no atlas, may use the last frame's local map once more: it has to be counted there.
#include <list>
#include <slamgc/adapters/orb_slam3.hpp>
#include <vector>

struct Object : slamgc::rc_object<Object, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  template <class Visitor>
  void edges(Visitor&) {}
};
struct Frame {
  slamgc::rc_vector<Object> mvpMapPoints;
  slamgc::rc_slot<Object> mpReferenceKF;
};
struct Tracking {
  Frame mCurrentFrame, mLastFrame, mInitialFrame;
  std::list<int> mlpReferences;
  slamgc::rc_slot<Object> mpReferenceKF, mpLastKeyFrame;
  slamgc::rc_vector<Object> mvpLocalKeyFrames;
#ifdef SLAMGC_POSITIVE_CONTROL
  slamgc::rc_vector<Object> mvpLocalMapPoints;
#else
  std::vector<Object*> mvpLocalMapPoints;
#endif
  slamgc::registry<slamgc::rc_list<Object>> mlpTemporalPoints;
};

void begin(slamgc::orb_slam3::session& s, Tracking& tracking) { s.add(tracking); }
