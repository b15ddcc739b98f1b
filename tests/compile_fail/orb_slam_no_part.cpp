// expect-error: slamgc: this is no part of ORB-SLAM that refers to keyframes or points
#include <slamgc/adapters/orb_slam3.hpp>

class System {
#ifdef SLAMGC_POSITIVE_CONTROL
  friend slamgc::orb_slam3::access;
#endif
  std::mutex mMutexState;
  struct Point : slamgc::rc_object<Point, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
    template <class Visitor>
    void edges(Visitor&) {}
  };
  slamgc::rc_vector<Point> mTrackedMapPoints;
};

void begin(slamgc::orb_slam3::session& s, System& system) { s.add(system); }
