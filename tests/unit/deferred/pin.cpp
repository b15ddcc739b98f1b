// Slow readers: they count what they need, go offline, and delay nobody.
#include <slamgc/pin.hpp>

#include <gtest/gtest.h>

#include <slamgc/slamgc.hpp>
#include <type_traits>
#include <vector>

#include "support/instances.hpp"

namespace {

struct keyframe : slamgc::rc_object<keyframe, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
                  support::instances<keyframe> {
  int pose = 1;
};

TEST(Pin, IsACountedPointer) {
  EXPECT_TRUE((std::is_same<slamgc::pin<keyframe>, slamgc::intrusive_rc<keyframe>>::value));
}

TEST(Pin, WhatIsPinnedStaysWhileTheReaderIsOfflineAndTheRestGoes) {
  slamgc::domain d;
  slamgc::mutator adjusting(d, "bundle adjustment");
  std::vector<keyframe*> all;
  for (int i = 0; i != 10; ++i) all.push_back(new keyframe);
  {
    const slamgc::pin_set<keyframe> some(all.begin(), all.begin() + 3);
    const slamgc::pin<keyframe> one = all[3];
    const slamgc::mutator::offline_scope offline(adjusting);
    {
      const slamgc::mutator culling(d, "culling");
      for (keyframe* const k : all) slamgc::retire(k);
    }
    EXPECT_EQ(d.collect().reclaimed, 6u);
    for (keyframe* const k : some) EXPECT_EQ(k->pose, 1);
    EXPECT_EQ(one->pose, 1);
    EXPECT_EQ(d.stats().total(&slamgc::type_stats::live), 4u);
  }
  EXPECT_EQ(d.collect().result, slamgc::collected::outcome::waiting);
  adjusting.quiescent();
  EXPECT_EQ(d.collect().reclaimed, 4u);
  EXPECT_EQ(keyframe::live(), 0);
}

TEST(Pin, ASetMayBeMadeOfAContainerAsItIs) {
  slamgc::domain d;
  {
    const slamgc::mutator m(d, "m");
    slamgc::rc_vector<keyframe> map{new keyframe, new keyframe};
    const std::vector<keyframe*> raw(map.begin(), map.end());
    const slamgc::pin_set<keyframe> of_map = map;
    const slamgc::pin_set<keyframe> of_raw = raw;
    EXPECT_EQ(of_raw[0]->use_count(), 3u);
    for (keyframe* const k : raw) slamgc::retire(k);
  }
  EXPECT_EQ(d.collect().reclaimed, 2u);
}

}  // namespace
