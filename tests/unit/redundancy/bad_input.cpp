// What must not be announced is refused with a reason, and changes nothing.
#include <gtest/gtest.h>

#include <random>
#include <slamgc/env.hpp>

#include "unit/redundancy/world.hpp"

namespace {

using namespace redundancy_test;
using red::status;

// Six keyframes see two points at level 0, each in slots 0 and 1; a third slot is empty, a fourth not eligible.
class BadInput : public ::testing::Test {
 protected:
  using map = world<8, slamgc::std_env>;
  BadInput() : w(7, 3, red::orb_slam3) {
    for (auto& k : w.keyframes) {
      k.points.assign(4, none);
      k.levels = {0, 0, 3, 0};
      k.eligible = {1, 1, 1, 0};
    }
    for (int k = 0; k != 6; ++k) {
      EXPECT_EQ(w.add_keyframe(k), status::ok);
      for (int p = 0; p != 2; ++p) {
        EXPECT_EQ(w.set_observation(k, p, {p, 0}), status::ok);
        EXPECT_EQ(w.set_slot(k, p, p), status::ok);
      }
    }
    expect_as_it_was();
  }
  ~BadInput() override {
    expect_as_it_was();
    // Nor is anything left that would show later.
    EXPECT_EQ(w.erase_observation(0, 0), status::ok);
    EXPECT_EQ(w.erase_observation(1, 0), status::ok);
    EXPECT_TRUE(w.agrees());
    EXPECT_EQ(w.histogram.check(2).redundant_slots, 1);
  }
  void expect_as_it_was() {
    EXPECT_TRUE(w.agrees());
    for (int k = 0; k != 6; ++k) {
      const red::verdict v = w.histogram.check(k);
      EXPECT_EQ(v.result, status::ok);
      EXPECT_TRUE(v.redundant);
      EXPECT_EQ(v.eligible_slots, 2);
      EXPECT_EQ(v.redundant_slots, 2);
    }
  }
  map w;
  static constexpr int unknown = 6;
};

TEST_F(BadInput, UnknownKeyframe) {
  EXPECT_EQ(w.set_observation(unknown, 0, {0, 0}), status::unknown_keyframe);
  EXPECT_EQ(w.erase_observation(unknown, 0), status::unknown_keyframe);
  EXPECT_EQ(w.set_slot(unknown, 0, 0), status::unknown_keyframe);
  EXPECT_EQ(w.clear_slot(unknown, 0), status::unknown_keyframe);
  EXPECT_EQ(w.remove_keyframe(unknown), status::unknown_keyframe);
  EXPECT_EQ(w.histogram.check(unknown).result, status::unknown_keyframe);
}

TEST_F(BadInput, KnownKeyframe) { EXPECT_EQ(w.add_keyframe(0), status::known_keyframe); }

TEST_F(BadInput, KnownPoint) {
  EXPECT_EQ(w.histogram.add_point(0), status::known_point);
  EXPECT_EQ(w.sets.add_point(0), status::known_point);
}

TEST_F(BadInput, ObserversThatWereNotTold) {
  w.points[2].observers[0] = {2, 3};
  EXPECT_EQ(w.histogram.erase_observation(0, 2), status::unknown_point);
  EXPECT_EQ(w.sets.erase_observation(0, 2), status::unknown_point);
  EXPECT_EQ(w.histogram.set_observation(0, 2, {2, 1}), status::unknown_point);
  EXPECT_EQ(w.sets.set_observation(0, 2, {2, 1}), status::unknown_point);
  w.points[2].observers.clear();
}

TEST_F(BadInput, LevelOutOfRange) {
  EXPECT_EQ(w.set_observation(0, 2, {2, 8}), status::level_out_of_range);
  EXPECT_EQ(w.set_observation(0, 2, {2, -1}), status::level_out_of_range);
  EXPECT_EQ(w.set_observation(0, 2, {2, 4}), status::level_out_of_range);  // coarser than its slot
  w.keyframes[unknown].levels[1] = 8;
  EXPECT_EQ(w.add_keyframe(unknown), status::level_out_of_range);
  EXPECT_EQ(w.histogram.check(unknown).result, status::unknown_keyframe);
  w.points[2].observers[0] = {2, 8};
  EXPECT_EQ(w.histogram.add_point(2), status::level_out_of_range);
  w.points[2].observers.clear();
}

TEST_F(BadInput, SlotOutOfRange) {
  for (const int slot : {-1, 4}) {
    EXPECT_EQ(w.set_slot(0, slot, 0), status::slot_out_of_range);
    EXPECT_EQ(w.clear_slot(0, slot), status::slot_out_of_range);
  }
  EXPECT_EQ(w.set_observation(0, 2, {4, 0}), status::slot_out_of_range);
  EXPECT_EQ(w.set_observation(0, 2, {-2, 0}), status::slot_out_of_range);
}

TEST_F(BadInput, EraseWithoutAdd) {
  EXPECT_EQ(w.erase_observation(0, 2), status::no_observation);
  EXPECT_EQ(w.clear_slot(0, 2), status::empty_slot);
  EXPECT_EQ(w.clear_slot(0, 3), status::empty_slot);
}

TEST_F(BadInput, NoPoint) {
  EXPECT_EQ(w.set_observation(0, none, {0, 0}), status::no_point);
  EXPECT_EQ(w.erase_observation(0, none), status::no_point);
  EXPECT_EQ(w.set_slot(0, 0, none), status::no_point);
  EXPECT_EQ(w.mark_bad(none), status::no_point);
  EXPECT_EQ(w.histogram.add_point(none), status::no_point);
}

TEST_F(BadInput, WhatIsThereAlreadyIsNoError) {
  EXPECT_EQ(w.set_slot(0, 0, 0), status::ok);
  EXPECT_EQ(w.set_observation(0, 0, {0, 0}), status::ok);
}

TEST_F(BadInput, ASlotThatIsNotEligibleNeverCounts) {
  EXPECT_EQ(w.set_slot(0, 3, 2), status::ok);
  EXPECT_EQ(w.set_slot(0, 3, 1), status::ok);
}

// Of its own: the bad point and the removed keyframe would not go back.
TEST(BadAndRemoved, DoNothingASecondTime) {
  world<8, slamgc::std_env> w(2, 1, red::orb_slam3);
  for (auto& k : w.keyframes) {
    k.points = {none};
    k.levels = {0};
    k.eligible = {1};
  }
  EXPECT_EQ(w.add_keyframe(0), status::ok);
  EXPECT_EQ(w.add_keyframe(1), status::ok);
  EXPECT_EQ(w.set_observation(0, 0, {0, 0}), status::ok);
  EXPECT_EQ(w.set_slot(0, 0, 0), status::ok);
  for (int i = 0; i != 2; ++i) {
    EXPECT_EQ(w.mark_bad(0), status::ok);
    EXPECT_EQ(w.histogram.check(0).eligible_slots, 0);
    EXPECT_EQ(w.remove_keyframe(0), status::ok);
    EXPECT_EQ(w.histogram.check(0).result, status::removed_keyframe);
  }
  EXPECT_EQ(w.erase_observation(0, 0), status::no_observation);
  EXPECT_EQ(w.clear_slot(0, 0), status::ok);
  EXPECT_TRUE(w.agrees());
}

// Its memory may be given back, and another keyframe get its name.
TEST(BadAndRemoved, ARemovedKeyframeLeavesNoLooseSlot) {
  world<8, slamgc::std_env> w(1, 1, red::orb_slam3);
  w.keyframes[0].points = {none};
  w.keyframes[0].levels = {0};
  w.keyframes[0].eligible = {1};
  EXPECT_EQ(w.add_keyframe(0), status::ok);
  EXPECT_EQ(w.set_slot(0, 0, 0), status::ok);
  EXPECT_NE(w.points[0].histogram.ends.first(), nullptr);
  EXPECT_EQ(w.remove_keyframe(0), status::ok);
  EXPECT_EQ(w.points[0].histogram.ends.first(), nullptr);
  EXPECT_EQ(w.points[0].sets.ends.first(), nullptr);
}

// As many observers as 16 bits count, by one keyframe each.
struct crowd {
  using keyframe = int;
  using point = int;
  static constexpr int levels = 8;
  struct data {
    std::vector<red::keyframe_counts<>> keyframes = std::vector<red::keyframe_counts<>>(65537);
    red::point_levels<int> point;
    int observers = 0;
  };
  data* d;
  auto& keyframe_state(int k) const { return d->keyframes[static_cast<std::size_t>(k)]; }
  auto& point_state(int) const { return d->point; }
  int lock_observations(int) const { return 0; }
  bool is_null(int) const { return false; }
  bool bad(int) const { return false; }
  bool find(int, int k, red::observation& o) const { return o = {-1, 0}, k < d->observers; }
  template <class F>
  void observers(int, F f) const {
    for (int k = 0; k != d->observers && f(k, red::observation{-1, 0}); ++k) {
    }
  }
  int slots(int) const { return 1; }
  int level(int, int) const { return 0; }
  bool eligible(int, int) const { return true; }
  int slot(int, int) const { return 0; }
};

TEST(Crowd, TooManyObserversAreRefused) {
  crowd::data d;
  red::level_histogram<crowd> index(crowd{&d});
  for (auto& k : d.keyframes) k.set_known();
  for (; d.observers != 65535; ++d.observers)
    ASSERT_EQ(index.set_observation(d.observers, 0, {-1, 0}), status::ok);
  EXPECT_EQ(index.set_observation(65535, 0, {-1, 0}), status::too_many_observers);
  EXPECT_EQ(index.set_observation(0, 0, {-1, 0}), status::ok);  // observes already
  EXPECT_EQ(index.erase_observation(0, 0), status::ok);
  crowd::data e;
  e.observers = 65536;
  EXPECT_EQ(red::level_histogram<crowd>(crowd{&e}).add_point(0), status::too_many_observers);
  EXPECT_EQ(e.point.up_to[7], 0);
}

}  // namespace
