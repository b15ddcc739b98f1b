// A piece of a real session, event by event: the exact indices agree at each of them.
#include <gtest/gtest.h>

#include <sstream>

#include "../../../examples/orb_map.hpp"

namespace {

namespace red = slamgc::redundancy;

template <class View>
using histogram = red::level_histogram<View>;
template <class View>
using sets = red::connection_sets<View>;
template <class View>
using recomputing = red::recompute<View>;

TEST(Replay, IndicesAgreeAtEachEventOfARecordedSession) {
  std::istringstream file(
#include "../../../examples/recorded_piece.inc"
  );
  recorded_session session;
  session.load(file);
  for (const red::rule& rule : {red::orb_slam3, red::orb_slam2, red::orb_slam3_inertial_depth}) {
    orb_map<recompute_states, recomputing> a(session, rule);
    orb_map<level_histogram_states, histogram> b(session, rule);
    orb_map<connection_sets_states, sets> c(session, rule);
    int events = 0, redundant = 0, removed = 0;
    for (const recorded_event& e : session.events) {
      a.replay(e), b.replay(e), c.replay(e);
      for (int k = 0; k != static_cast<int>(session.levels.size()); ++k) {
        if (a.keyframe(k) == nullptr) continue;
        const red::verdict x = a.index.check(a.keyframe(k));
        for (const red::verdict& y : {b.index.check(b.keyframe(k)), c.index.check(c.keyframe(k))}) {
          ASSERT_EQ(x.result, y.result) << "event " << events << ", keyframe " << k;
          ASSERT_EQ(x.eligible_slots, y.eligible_slots) << "event " << events << ", keyframe " << k;
          ASSERT_EQ(x.redundant_slots, y.redundant_slots)
              << "event " << events << ", keyframe " << k;
          ASSERT_EQ(x.redundant, y.redundant) << "event " << events << ", keyframe " << k;
        }
        redundant += x.redundant;
        removed += x.result == red::status::removed_keyframe;
      }
      ++events;
    }
    EXPECT_GT(events, 500);
    EXPECT_GT(redundant, 0);
    EXPECT_GT(removed, 0);
  }
}

}  // namespace
