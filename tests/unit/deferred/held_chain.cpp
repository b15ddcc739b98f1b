// One retired object that is held keeps itself, and not what was retired after it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <slamgc/slamgc.hpp>
#include <vector>

#include "support/instances.hpp"

namespace {

struct keyframe : slamgc::rc_object<keyframe, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
                  support::instances<keyframe> {
  template <class Visitor>
  void edges(Visitor& v) {
    if (keep_next)
      v.edge("next", next);
    else
      v.edge("next", next, slamgc::on_retire::bypass([](keyframe& retired) {
               ++steps;
               return retired.next.get();
             }));
  }

  bool keep_next = false;
  slamgc::rc_slot<keyframe> next;
  static inline std::size_t steps = 0;
};

struct map {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("keyframes", keyframes, slamgc::on_retire::erase);
    v.edge("held", held);
  }

  slamgc::rc_set<keyframe> keyframes;
  slamgc::rc_slot<keyframe> held;
};

class HeldChain : public ::testing::Test {
 protected:
  ~HeldChain() override { EXPECT_EQ(keyframe::live(), 0); }

  // Three hundred keyframes, each retired when its successor has come; the first one is held.
  void run(bool keep_next, int live_at_most, int live_in_the_end) {
    slamgc::domain d;
    {
      slamgc::mutator m(d, "mapping");
      map all;
      const slamgc::root root(d, "map", all);
      keyframe* last = new keyframe;
      last->keep_next = keep_next;
      all.held = last;
      int most = 0;
      for (int i = 1; i != 300; ++i) {
        auto* const k = new keyframe;
        k->keep_next = keep_next;
        all.keyframes.insert(k);
        last->next = k;
        all.keyframes.erase(last);
        slamgc::retire(last);
        last = k;
        for (int call = 0; call != 4; ++call, m.quiescent()) d.collect();
        if (i % 100 == 99) most = std::max(most, keyframe::live());
      }
      EXPECT_LE(most, live_at_most);
      {
        const slamgc::mutator::offline_scope offline(m);
        ASSERT_EQ(d.drain(), slamgc::waited::done);
      }
      EXPECT_EQ(keyframe::live(), live_in_the_end);
      slamgc::retire(last);
    }
    ASSERT_EQ(d.drain(), slamgc::waited::done);
  }
};

TEST_F(HeldChain, KeepsItsFirstMember) { run(false, 8, 2); }

TEST_F(HeldChain, KeepsWhatItsMembersHold) { run(true, 300, 300); }

TEST(HeldMember, OfALongDeadChainCostsLinearTime) {
  constexpr std::size_t n = 5000;
  slamgc::domain d;
  {
    slamgc::mutator m(d, "mapping");
    slamgc::registry<slamgc::rc_set<keyframe>> all;
    map other;
    const slamgc::root root(d, "map", other);
    other.held = new keyframe;
    keyframe* last = other.held;
    all.insert(last);
    for (std::size_t i = 1; i != n; ++i) {
      last->next = new keyframe;
      last = last->next;
      all.insert(last);
    }
    keyframe::steps = 0;
    all.clear();
    const slamgc::mutator::offline_scope offline(m);
    ASSERT_EQ(d.drain(), slamgc::waited::done);
    EXPECT_EQ(keyframe::live(), 1);
    EXPECT_GE(keyframe::steps, n - 1);
    EXPECT_LE(keyframe::steps, 100 * n);
  }
  ASSERT_EQ(d.drain(), slamgc::waited::done);
  EXPECT_EQ(keyframe::live(), 0);
}

}  // namespace
