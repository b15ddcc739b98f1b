// Which keyframes are redundant, why, and what it takes to know that.
//
//   keyframe_culling [FILE]
//
// FILE is a recorded session or a graph, in the formats of recorded_session.hpp; without it, a small piece of a
// session of ORB-SLAM3 is used. What a program has to add to its map is in orb_map.hpp.
#include <chrono>
#include <cstdio>
#include <sstream>
#include <string>

#include "orb_map.hpp"

namespace {

namespace red = slamgc::redundancy;

template <class View>
using histogram = red::level_histogram<View>;
template <class View>
using sets = red::connection_sets<View>;
template <class View>
using recomputing = red::recompute<View>;

// The session, and a culling pass wherever one was due; milliseconds for all passes, and for all of it.
template <class States, template <class> class Index>
void replay(const char* name, const recorded_session& session, bool explain) {
  using clock = std::chrono::steady_clock;
  const auto ms = [](clock::duration d) {
    return std::chrono::duration<double, std::milli>(d).count();
  };
  orb_map<States, Index> map(session, red::orb_slam3);
  long asked = 0, redundant = 0;
  clock::duration passes{0}, covisible{0};
  const auto begin = clock::now();
  for (const recorded_event& e : session.events) {
    map.replay(e);
    if (e.what != recorded_event::pass) continue;
    const auto before = clock::now();
    const auto candidates = map.GetBestCovisibilityKeyFrames(map.keyframe(e.keyframe));
    const auto found = clock::now();
    for (auto* pKF : candidates) redundant += map.index.check(pKF).redundant;
    asked += static_cast<long>(candidates.size());
    covisible += found - before;
    passes += clock::now() - found;
  }
  const auto all = clock::now() - begin - covisible;
  std::printf(
      "%-16s %8ld keyframes asked for, %6ld times redundant; passes %9.3f ms, with the map's "
      "changes %9.3f ms\n",
      name, asked, redundant, ms(passes), ms(all));
  if (!explain) return;
  std::puts(
      "\nIn the end these are redundant: more than 90 % of their points are seen by four others, "
      "well enough.");
  int shown = 0, more = 0;
  for (int k = 0; k != static_cast<int>(session.levels.size()); ++k) {
    if (map.keyframe(k) == nullptr) continue;
    const red::verdict v = map.index.check(map.keyframe(k));
    if (!v.redundant || ++shown > 20) {
      more += v.redundant;
      continue;
    }
    std::printf("  keyframe %3d: %d of %d\n", k, v.redundant_slots, v.eligible_slots);
  }
  if (more != 0) std::printf("  and %d more\n", more);
  if (shown == 0) std::puts("  none");
}

}  // namespace

int main(int argc, char** argv) {
  recorded_session session;
  if (argc > 1) {
    if (!session.load(argv[1])) {
      std::fprintf(stderr, "%s: cannot be read, or is no session\n", argv[1]);
      return 1;
    }
  } else {
    std::istringstream piece(
#include "recorded_piece.inc"
    );
    session.load(piece);
  }
  std::printf("%zu events, %zu keyframes, %d points\n", session.events.size(),
              session.levels.size(), session.points);
  replay<recompute_states, recomputing>("recompute", session, false);
  replay<connection_sets_states, sets>("connection_sets", session, false);
  replay<level_histogram_states, histogram>("level_histogram", session, true);
}
