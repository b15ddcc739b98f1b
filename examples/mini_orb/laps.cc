// laps FEATURES LAPS one-thread|threads: drives round the track and prints what it takes as JSON, for scripts/benchmark --part slam.
// FEATURES: how many a frame has. Memory is what malloc has given out.
#include <malloc.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

#include "KeyFrame.h"
#include "LocalMapping.h"
#include "MapPoint.h"
#include "Session.h"
#include "Tracking.h"

namespace {

int number(const char* text, int most) {
  char* end;
  const long value = std::strtol(text, &end, 10);
  if (*end == 0 && value >= 1 && value <= most) return static_cast<int>(value);
  std::fprintf(stderr, "laps: '%s' is not a number from 1 to %d\n", text, most);
  std::exit(2);
}

void print(const char* name, const std::vector<double>& values) {
  std::printf("\"%s\": [", name);
  for (std::size_t i = 0; i != values.size(); ++i)
    std::printf("%s%.1f", i != 0 ? "," : "", values[i]);
  std::printf("]");
}

}  // namespace

int main(int argc, char** argv) {
  using namespace mini_orb;
  const bool threads = argc == 4 && std::strcmp(argv[3], "threads") == 0;
  if (argc != 4 || (!threads && std::strcmp(argv[3], "one-thread") != 0)) {
    std::fprintf(stderr, "usage: laps FEATURES LAPS one-thread|threads\n");
    return 2;
  }
  const int features = number(argv[1], 5000), laps = number(argv[2], 1000000);
  Session session(features, threads);
  std::printf("{\"laps\": [");
  for (int lap = 0; lap != laps; ++lap) {
    for (int i = 0; i != World::kLap; ++i) {
      session.Drive(1);
      while (threads && session.system->mpLocalMapper->KeyframesInQueue() > 2)
        std::this_thread::yield();  // as a camera does, it leaves local mapping some time
    }
    const System::Summary now = session.system->GetSummary();
    std::printf(
        "%s{\"bytes\": %zu, \"keyframes\": %zu, \"points\": %zu, \"live_keyframes\": %ld, "
        "\"live_points\": %ld, \"made_keyframes\": %ld, \"made_points\": %ld}",
        lap != 0 ? ",\n" : "", mallinfo2().uordblks + mallinfo2().hblkhd, now.keyframes, now.points,
        Instances<KeyFrame>::Alive(), Instances<MapPoint>::Alive(), Instances<KeyFrame>::Made(),
        Instances<MapPoint>::Made());
  }
  session.system->Shutdown();
  std::printf("],\n");
  const Times &tracking = session.system->mpTracker->mTrackTimes,
              &mapping = session.system->mpLocalMapper->mLMTimes;
  print("tracking_us", tracking.elapsed_us);
  std::printf(",\n");
  print("local_mapping_us", mapping.elapsed_us);
  std::printf(",\n");
  print("tracking_processor_us", tracking.processor_us);
  std::printf(",\n");
  print("local_mapping_processor_us", mapping.processor_us);
  std::printf(",\n\"culled\": %d, \"loops\": %d}\n", session.system->GetSummary().culled,
              session.system->GetSummary().loops);
}
