// retire_set: the thesis's collector, without mutators. Each local is counted under the lock of the slot it is
// read from; then a count of zero means that nobody can have the object.
#include <cstdio>
#include <mutex>
#include <slamgc/retire_set.hpp>
#include <slamgc/slamgc.hpp>

struct MapPoint : slamgc::rc_object<MapPoint, slamgc::cas_counter, slamgc::reclaim_by_scan> {
  int observations = 2;
};

int main() {
  std::mutex lock;  // guards the keyframe's points
  slamgc::rc_vector<MapPoint> points;
  points.push_back(new MapPoint);
  slamgc::retire_set<MapPoint> bad;

  slamgc::intrusive_rc<MapPoint> used;  // by another thread
  {
    const std::lock_guard<std::mutex> guard(lock);
    used = points[0];  // counted under the lock
  }
  bad.insert(points[0]);  // SetBadFlag(); a second time would do nothing
  {
    const std::lock_guard<std::mutex> guard(lock);
    points.clear();
  }
  std::printf("in use: %zu freed\n", bad.scan());
  used.reset();
  std::printf("afterwards: %zu freed\n", bad.scan());
}
