// Three threads change observations, as tracking, mapping and loop closing do, and one reads verdicts. In the end all
// exact indices agree with the rule.
#include <gtest/gtest.h>

#include <atomic>
#include <random>
#include <thread>
#include <type_traits>

#include "support/environments.hpp"
#include "support/stress.hpp"
#include "unit/redundancy/events.hpp"

namespace {

using namespace redundancy_test;
using support::in_threads;
using support::rounds;

template <class Env>
class RedundancyStress : public ::testing::Test {};
TYPED_TEST_SUITE(RedundancyStress, support::environments, support::environment_names);

TYPED_TEST(RedundancyStress, ThreeThreadsChangeObservationsAndOneReads) {
  using map = world<8, TypeParam>;
  constexpr int keyframes = 6, slots = 4, points = 6, changing = 3;
  const int most = std::is_same<TypeParam, yield_env>::value ? rounds() / 100 : rounds() / 5;
  for (int round = 0; round <= most; ++round) {
    const auto seed = static_cast<unsigned>(yield_env::seed()) + static_cast<unsigned>(round) * 8;
    map w(keyframes, points, red::rule{2, 1, 1, 2});
    std::mt19937 random(seed);
    make_keyframes(w, slots, random);
    for (int k = 0; k != keyframes; ++k) ASSERT_EQ(w.add_keyframe(k), status::ok);
    std::atomic<int> left{changing};
    in_threads(changing + 1, [&](int me) {
      if (me != changing) {
        events<map> e(w, seed + static_cast<unsigned>(me) + 1);
        for (int i = 0; i != 200; ++i) e.one();
        --left;
        return;
      }
      do {
        for (int k = 0; k != keyframes; ++k)
          for (const red::verdict& v :
               {w.histogram.check(k), w.sets.check(k), w.recompute.check(k)}) {
            if (v.result == status::removed_keyframe) continue;
            ASSERT_EQ(v.result, status::ok);
            ASSERT_GE(v.redundant_slots, 0);
            ASSERT_LE(v.redundant_slots, v.eligible_slots);
            ASSERT_LE(v.eligible_slots, slots);
            ASSERT_EQ(v.redundant, v.redundant_slots * 2 > v.eligible_slots);
          }
        std::this_thread::yield();
      } while (left != 0);
    });
    ASSERT_TRUE(w.agrees()) << "round " << round;
  }
}

}  // namespace
