// expect-error: slamgc: a member of ORB-SLAM is not counted yet
#include <map>
#include <slamgc/adapters/orb_slam3.hpp>
#include <vector>

struct Point;
struct System {
  std::mutex mMutexState;
#ifdef SLAMGC_POSITIVE_CONTROL
  slamgc::rc_vector<Point> mTrackedMapPoints;
#else
  std::vector<Point*> mTrackedMapPoints;
#endif
};
struct Point : slamgc::rc_object<Point, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  template <class Visitor>
  void edges(Visitor&) {}
};

void begin(slamgc::orb_slam3::session& s, System& system) { s.add(system); }
