// A trace of a short run, for https://ui.perfetto.dev: when who collects, for whom grace periods wait, how much waits. The name
// of the file is the argument.
#include <cstdio>
#include <slamgc/background_reclaimer.hpp>
#include <slamgc/integrations/trace_json.hpp>
#include <slamgc/slamgc.hpp>

struct MapPoint : slamgc::rc_object<MapPoint, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
  double position[3] = {};
};

int main(int argc, char** argv) {
  slamgc::trace_json trace(argc > 1 ? argv[1] : "trace.json");
  slamgc::domain map;
  map.install(&trace);  // before others collect
  slamgc::background_reclaimer reclaimer(map);
  {
    slamgc::mutator me(map, "tracking");
    trace.name_thread("tracking");
    slamgc::rc_vector<MapPoint> points;
    for (int frame = 0; frame < 100; ++frame) {
      const slamgc::trace_json::span shown(trace, "TrackMonocular");
      for (int i = 0; i < 1000; ++i) points.push_back(new MapPoint);
      if (points.size() > 5000) {
        points.clear();
        reclaimer.wake();
      }
      me.quiescent();
    }
  }
  const bool drained = reclaimer.stop() == slamgc::waited::done;
  map.install(nullptr);
  std::printf("drained: %s, written: %s\n", drained ? "yes" : "no", trace.good() ? "yes" : "no");
}
