// The counted containers: standard containers of raw pointers that count what they hold.
#include <algorithm>
#include <cstdio>
#include <slamgc/slamgc.hpp>

struct MapPoint : slamgc::rc_object<MapPoint> {
  explicit MapPoint(int number) : id(number) {}
  int id;
};

// Old code that insists on the plain container.
void keep_even(std::vector<MapPoint*>& points) {
  points.erase(
      std::remove_if(points.begin(), points.end(), [](MapPoint* p) { return p->id % 2 != 0; }),
      points.end());
}

int main() {
  slamgc::rc_vector<MapPoint> points;
  for (int i = 0; i < 10; ++i) points.push_back(new MapPoint(i));

  // Reading: the standard container's own iterators, and a copy of the raw pointers for free.
  for (MapPoint* p : points) std::printf("%d ", p->id);
  std::vector<MapPoint*> snapshot = points;
  std::sort(snapshot.begin(), snapshot.end(), [](auto* a, auto* b) { return a->id > b->id; });

  // Changing: every element that comes or goes is counted.
  points[3] = points[4];     // point 3 is destroyed
  keep_even(points.edit());  // the odd ones are destroyed when the edit ends
  std::printf("\n%zu points are left\n", points.size());

  slamgc::rc_map<MapPoint, int> found;  // was: std::map<MapPoint*, int>
  for (MapPoint* p : points) ++found[p];
  for (std::map<MapPoint*, int>::iterator it = found.begin(); it != found.end(); ++it)
    std::printf("point %d: %d times, count %u\n", it->first->id, it->second,
                it->first->use_count());

  slamgc::rc_value_map<int, MapPoint> by_id;  // was: std::map<int, MapPoint*>
  for (MapPoint* p : points) by_id[p->id] = p;

  std::vector<slamgc::rc_list<MapPoint>> words(100);  // was: std::vector<std::list<MapPoint*>>
  words[42].push_back(points[0]);
  words[42].remove(points[0]);
}
