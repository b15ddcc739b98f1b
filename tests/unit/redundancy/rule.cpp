// The numbers of the rule, and what the indices take of memory.
#include <gtest/gtest.h>

#include <cmath>
#include <slamgc/redundancy.hpp>
#include <string>

namespace {

namespace red = slamgc::redundancy;

// Integers against the comparison of ORB-SLAM3, in float, around each threshold.
void expect_as_in_float(const red::rule& r, float share) {
  for (int eligible = 0; eligible <= 20000; ++eligible) {
    const int edge = static_cast<int>(share * static_cast<float>(eligible));
    for (int redundant = edge > 2 ? edge - 2 : 0; redundant <= edge + 2 && redundant <= eligible;
         ++redundant)
      ASSERT_EQ(r.exceeded(redundant, eligible),
                static_cast<float>(redundant) > share * static_cast<float>(eligible))
          << redundant << " of " << eligible;
  }
}

TEST(Rule, IntegersAgreeWithTheFloatComparison) {
  expect_as_in_float(red::orb_slam3, 0.9F);
  expect_as_in_float(red::orb_slam3_inertial_depth, 0.5F);
}

TEST(Rule, AKeyframeWithoutEligibleSlotsIsNotRedundant) {
  EXPECT_FALSE(red::orb_slam3.exceeded(0, 0));
}

TEST(Rule, LargeCountsDoNotOverflow) {
  EXPECT_TRUE((red::rule{4, 1, 1, 1000000000}).exceeded(2147483647, 2147483647));
}

TEST(Rule, DepthIsEligibleFromZeroToTheFarthest) {
  EXPECT_TRUE(red::eligible_by_depth(0, 40));
  EXPECT_TRUE(red::eligible_by_depth(40, 40));
  EXPECT_FALSE(red::eligible_by_depth(40.001F, 40));
  EXPECT_FALSE(red::eligible_by_depth(-1, 40));            // no depth, in ORB-SLAM
  EXPECT_TRUE(red::eligible_by_depth(std::nanf(""), 40));  // neither comparison holds, as there
}

TEST(Rule, EachStatusHasAName) {
  for (int s = 0; s <= static_cast<int>(red::status::out_of_memory); ++s)
    EXPECT_NE(std::string(red::name_of(static_cast<red::status>(s))), "") << s;
}

TEST(Rule, TheHistogramTakes24BytesAPointAnd8AKeyframe) {
  if (sizeof(void*) != 8) GTEST_SKIP();
  EXPECT_EQ(sizeof(red::point_levels<int*>), 24U);
  EXPECT_EQ(sizeof(red::keyframe_counts<>), 8U);
}

}  // namespace
