// A7: where the graph of ORB-SLAM3 is not symmetric. Each asymmetry leaves a reference to a bad object behind.
//
// In each test: with plain members it is never freed, and if it were, the reference would dangle; with shared_ptr it stays; with
// slamgc the reference goes and the object is reclaimed.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "world.hpp"

namespace {

using namespace orb_slam3;

// Keyframe 0 is the map's first one, which is never culled; the others of a case begin with 1.

template <class S>
void a_knows_not_who_knows_it(World<S>& w) {
  const auto origin = w.keyframe();
  const auto a = w.keyframe(), b = w.keyframe(), c = w.keyframe();
  w.share({origin, b, c}, 20);
  w.share({origin, a, b, c}, 5);
  b->UpdateConnections();  // they share 5 points, less than 15: a becomes a key of b, and b none of a
  a->SetBadFlag();
}

TEST(A7_Asymmetries, A7_1_CovisibilityKeysAreNotSymmetric) {
  {
    World<plain> w;
    a_knows_not_who_knows_it(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.kf(1)), holders({"KeyFrame 2.mConnectedKeyFrameWeights"}));
    w.free_bad();
    EXPECT_EQ(w.dangling(), 1u);
    w.kf(2)->UpdateBestCovisibles();
    EXPECT_EQ(found.freed_used, 1);
  }
  {
    World<shared> w;
    a_knows_not_who_knows_it(w);
    EXPECT_EQ(w.bad(), 1u);
  }
  World<counted> w;
  a_knows_not_who_knows_it(w);
  EXPECT_EQ(w.kf(2)->mConnectedKeyFrameWeights.size(), 3u);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.kf(2)->mConnectedKeyFrameWeights.size(), 2u);
  EXPECT_EQ(w.keyframes(), 3u);
}

template <class S>
void a_forgets_b(World<S>& w) {
  const auto origin = w.keyframe();
  const auto a = w.keyframe(), b = w.keyframe(), c = w.keyframe(), d = w.keyframe();
  w.share({origin, a, b, c}, 20);
  w.share({origin, a, c, d}, 20);
  a->UpdateConnections();
  b->UpdateConnections();
  // Bundle adjustment finds that a does not see what it shares with b.
  const std::vector<MapPoint<S>*> slots = a->GetMapPointMatches();
  for (std::size_t i = 0; i != slots.size(); ++i) {
    if (slots[i] == nullptr || !slots[i]->IsInKeyFrame(b)) continue;
    slots[i]->EraseObservation(a);
    a->EraseMapPointMatch(i);
  }
  a->UpdateConnections();  // the map of a is overwritten; that of b keeps a
  a->SetBadFlag();
}

TEST(A7_Asymmetries, A7_2_TheOtherSidesOlderEntryStays) {
  const holders both(
      {"KeyFrame 2.mConnectedKeyFrameWeights", "KeyFrame 2.mvpOrderedConnectedKeyFrames"});
  {
    World<plain> w;
    a_forgets_b(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.kf(1)), both);
    w.free_bad();
    EXPECT_EQ(w.dangling(), 2u);
    for (KeyFrame<plain>* const kf : w.kf(2)->GetVectorCovisibleKeyFrames()) kf->isBad();
    EXPECT_EQ(found.freed_used, 1);
  }
  {
    World<shared> w;
    a_forgets_b(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.kf(1)), both);
  }
  World<counted> w;
  a_forgets_b(w);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  // The weights went with their keyframes.
  const auto* const b = w.kf(2);
  ASSERT_EQ(b->mvOrderedWeights.size(), b->mvpOrderedConnectedKeyFrames.size());
  EXPECT_EQ(b->mvOrderedWeights, (std::vector<int>{20, 20}));
}

template <class S>
void a_slot_of_a_point_that_went_bad(World<S>& w) {
  const auto origin = w.keyframe();
  w.share({origin}, 3);
  w.frame({w.mp(0), w.mp(1), w.mp(2)});
  w.new_keyframe(/*processed=*/false);  // its slots are those of the frame
  w.mp(1)->SetBadFlag();                // the keyframe is no observer yet
  w.process();                          // skips bad points, and leaves them where they are
  w.frame({});
}

TEST(A7_Asymmetries, A7_3_ANewKeyFrameKeepsSlotsOfBadPoints) {
  {
    World<plain> w;
    a_slot_of_a_point_that_went_bad(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.mp(1)), holders({"KeyFrame 1.mvpMapPoints"}));
    w.free_bad();
    EXPECT_EQ(w.dangling(), 1u);
    w.kf(1)->UpdateConnections();
    EXPECT_EQ(found.freed_used, 1);
  }
  {
    World<shared> w;
    a_slot_of_a_point_that_went_bad(w);
    EXPECT_EQ(w.bad(), 1u);
  }
  World<counted> w;
  a_slot_of_a_point_that_went_bad(w);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.kf(1)->GetMapPointMatches(),
            (std::vector<MapPoint<counted>*>{w.mp(0), nullptr, w.mp(2)}));
}

template <class S>
void one_point_in_two_slots(World<S>& w) {
  const auto kf = w.keyframe();
  const auto p = w.point(kf);
  w.see(kf, p);
  w.see(kf, p);  // the index is overwritten, and the observation counted again
  EXPECT_EQ(p->Observations(), 2);
  p->SetBadFlag();
}

TEST(A7_Asymmetries, A7_4_APointSitsInTwoSlotsWithOneIndex) {
  {
    World<plain> w;
    one_point_in_two_slots(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.mp(0)), holders({"KeyFrame 0.mvpMapPoints"}));
    w.free_bad();
    EXPECT_EQ(w.dangling(), 1u);
  }
  {
    World<shared> w;
    one_point_in_two_slots(w);
    EXPECT_EQ(w.bad(), 1u);
  }
  World<counted> w;
  one_point_in_two_slots(w);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.kf(0)->GetMapPointMatches()[0], nullptr);
}

template <class S>
void only_one_side_is_erased(World<S>& w) {
  const auto origin = w.keyframe();
  const auto a = w.keyframe(), b = w.keyframe(), c = w.keyframe();
  w.share({origin, a, b, c}, 1);
  w.mp(0)->EraseObservation(
      a);  // as the essential graph's optimisation does: no EraseMapPointMatch
  w.mp(0)->SetBadFlag();
}

TEST(A7_Asymmetries, A7_5_ErasingAnObservationLeavesTheSlot) {
  {
    World<plain> w;
    only_one_side_is_erased(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.mp(0)), holders({"KeyFrame 1.mvpMapPoints"}));
    w.free_bad();
    EXPECT_EQ(w.dangling(), 1u);
  }
  {
    World<shared> w;
    only_one_side_is_erased(w);
    EXPECT_EQ(w.bad(), 1u);
  }
  World<counted> w;
  only_one_side_is_erased(w);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.kf(1)->GetMapPointMatches()[0], nullptr);
}

template <class S>
void a_bad_point_gets_observations(World<S>& w) {
  const auto origin = w.keyframe();
  const auto a = w.keyframe(), b = w.keyframe();
  w.share({origin, a}, 1);
  w->closing.match(b, a, {w.mp(0)});
  w.mp(0)->SetBadFlag();      // mapping culls it
  w->closing.CorrectLoop(b);  // fuses what it has matched
}

TEST(A7_Asymmetries, A7_6_ABadPointGetsNewObservations) {
  {
    World<plain> w;
    a_bad_point_gets_observations(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.mp(0)),
              holders({"KeyFrame 2.mvpMapPoints", "LoopClosing.mvpLoopMapPoints",
                       "LoopClosing.mvpLoopMatchedMPs"}));
    EXPECT_TRUE(w.mp(0)->IsInKeyFrame(w.kf(2)));
    w.free_bad();
    EXPECT_EQ(w.dangling(), 3u);
  }
  {
    World<shared> w;
    a_bad_point_gets_observations(w);
    w->closing.mvpLoopMapPoints.clear();
    w->closing.mvpLoopMatchedMPs.clear();
    EXPECT_EQ(w.holders(w.mp(0)), holders({"KeyFrame 2.mvpMapPoints"}));
    EXPECT_EQ(w.bad(), 1u);  // and it keeps the keyframe, for which it waits
  }
  World<counted> w;
  a_bad_point_gets_observations(w);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.kf(2)->GetMapPointMatches()[0], nullptr);
}

// The purge may have been there already: who still has a borrowed pointer to the bad point links it once more.
TEST(A7_Asymmetries, A7_6_ABadPointIsLinkedAgainAfterAPurge) {
  World<counted> w;
  const auto kf = w.keyframe();
  w.share({kf}, 2);
  MapPoint<counted>* const p = w.mp(0);
  kf->AddMapPoint(p, 5);
  w.threads.on_tracking([&] { w->tracking.mLastFrame.mvpMapPoints.push_back(p); });  // keeps it
  p->SetBadFlag();
  w.threads.settle();
  EXPECT_EQ(w.holders(p), holders({"Tracking.mvpMapPoints"}));
  for (int i = 0; i != 3; ++i) {
    kf->AddMapPoint(p, 6);
    p->AddObservation(kf, 6);
    EXPECT_EQ(w.holders(p), holders({"KeyFrame 0.mvpMapPoints", "Tracking.mvpMapPoints"}));
    w.threads.settle();
    EXPECT_EQ(w.holders(p), holders({"Tracking.mvpMapPoints"}));
  }
  w.frame({});
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.points(), 1u);
}

template <class S>
void two_points_replaced_each_other(World<S>& w) {
  const auto origin = w.keyframe();
  const auto a = w.keyframe();
  w.share({origin}, 1);
  w.share({a}, 1);
  const typename S::template local<MapPoint<S>> p = w.mp(0), x = w.mp(1);
  p->Replace(x);  // mapping
  x->Replace(p);  // loop closing, later: p is bad, and gets the observations of x
  origin->EraseMapPointMatch(0);
  a->EraseMapPointMatch(0);
}

TEST(A7_Asymmetries, A7_7_TwoPointsReplacedEachOther) {
  {
    World<plain> w;
    two_points_replaced_each_other(w);
    EXPECT_EQ(w.bad(), 2u);
    EXPECT_EQ(w.holders(w.mp(0)), holders({"MapPoint 1.mpReplaced"}));
    EXPECT_EQ(w.holders(w.mp(1)), holders({"MapPoint 0.mpReplaced"}));
  }
  {
    World<shared> w;
    two_points_replaced_each_other(w);
    EXPECT_EQ(w.bad(), 2u);  // a cycle
  }
  World<counted> w;
  two_points_replaced_each_other(w);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.points(), 0u);
}

}  // namespace
