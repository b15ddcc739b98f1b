// Any sequence of events: after each one all exact indices give the answer of the rule.
#include <gtest/gtest.h>

#include <random>
#include <slamgc/env.hpp>

#include "support/stress.hpp"
#include "unit/redundancy/events.hpp"

namespace {

using namespace redundancy_test;
using support::rounds;

template <class World>
class RandomEvents : public ::testing::Test {};
using worlds = ::testing::Types<world<8, slamgc::std_env>, world<2, slamgc::std_env>>;
TYPED_TEST_SUITE(RandomEvents, worlds, );

TYPED_TEST(RandomEvents, AllExactIndicesGiveTheAnswerOfTheRule) {
  std::mt19937 random(1);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int episode = 0; episode != rounds(); ++episode) {
    const red::rule r{below(5), below(3), below(10), 10};
    TypeParam w(3 + below(5), 2 + below(5), r);
    make_keyframes(w, 2 + below(4), random);
    events<TypeParam> e(w, static_cast<unsigned>(random()));
    for (int i = 0; i != 500; ++i) {
      e.one();
      ASSERT_TRUE(w.agrees()) << "episode " << episode << ", event " << i;
    }
  }
}

// The map is as it became; new indices are told of it as if it came from a file, in either order, and go on with it.
TYPED_TEST(RandomEvents, AMapCanBeLoaded) {
  std::mt19937 random(2);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int episode = 0; episode != rounds() / 10 + 1; ++episode) {
    const red::rule r{below(5), below(3), 9, 10};
    const int keyframes = 3 + below(5), points = 2 + below(5), slots = 2 + below(4);
    TypeParam first(keyframes, points, r), loaded(keyframes, points, r);
    std::mt19937 same = random;
    make_keyframes(first, slots, random);
    make_keyframes(loaded, slots, same);
    events<TypeParam> before(first, static_cast<unsigned>(random())), after(loaded, 1);
    for (int i = 0; i != 200; ++i) before.one();
    for (std::size_t k = 0; k != first.keyframes.size(); ++k)
      loaded.keyframes[k].points = first.keyframes[k].points;
    for (std::size_t p = 0; p != first.points.size(); ++p) {
      loaded.points[p].observers = first.points[p].observers;
      loaded.points[p].bad = first.points[p].bad;
    }
    const auto add_points = [&] {
      for (int p = 0; p != points; ++p) {
        const auto s = [&](auto& index) { return index.add_point(p); };
        EXPECT_EQ(s(loaded.histogram), status::ok);
        EXPECT_EQ(s(loaded.sets), status::ok);
        EXPECT_EQ(s(loaded.recompute), status::ok);
        const bool known = !loaded.points[TypeParam::at(p)].observers.empty() &&
                           !loaded.points[TypeParam::at(p)].bad;
        EXPECT_EQ(s(loaded.histogram), known ? status::known_point : status::ok);
        EXPECT_EQ(s(loaded.sets), known ? status::known_point : status::ok);
      }
    };
    if (episode % 2 == 0) add_points();
    for (int k = 0; k != keyframes; ++k) EXPECT_EQ(loaded.add_keyframe(k), status::ok);
    if (episode % 2 != 0) add_points();
    for (int i = 0; i != 100; ++i) {
      ASSERT_TRUE(loaded.agrees()) << "episode " << episode << ", event " << i;
      after.one();
    }
  }
}

}  // namespace
