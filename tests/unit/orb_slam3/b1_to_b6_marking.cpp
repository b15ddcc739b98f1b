// B1 to B6: what ORB-SLAM3 leaves when it marks a keyframe or a point as bad.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "world.hpp"

namespace {

using namespace orb_slam3;

// ---- B1: KeyFrame::SetBadFlag

// Keyframe 2, to be culled, is referred to in each way that SetBadFlag does not know.
template <class S>
void cull_in_a_chain(World<S>& w) {
  w.share({w.keyframe()}, 4);
  const std::vector<MapPoint<S>*> points = w.map()->GetAllMapPoints();
  for (int i = 0; i != 4; ++i) {
    w.frame(points);
    w.new_keyframe();
  }
  w.frame({});
  KeyFrame<S>* const kf = w.kf(2);
  const auto late = w.point(kf);
  for (long i : {0, 1, 3}) late->AddObservation(w.kf(i), 63);
  late->AddObservation(kf, 63);  // observed, and in none of its slots
  kf->AddMergeEdge(w.kf(4));
  w.kf(4)->AddMergeEdge(kf);
  kf->SetErase();
  Map<S>* const older = w.map();
  w->atlas.CreateNewMap();
  older->mpKFinitial = kf;
  older->mvpKeyFrameOrigins.push_back(kf);
  w->closing.InsertKeyFrame(kf);  // it waits when it goes bad
  w->closing.mvpMergeConnectedKFs.push_back(kf);
  w->tracking.mvpLocalKeyFrames.push_back(kf);
  kf->SetBadFlag();
  w->closing.NewDetectCommonRegions(w->database);  // adds it to the database
}

const holders in_edges({"KeyFrame 1.mNextKF", "KeyFrame 3.mConnectedKeyFrameWeights",
                        "KeyFrame 3.mPrevKF", "KeyFrame 4.mConnectedKeyFrameWeights",
                        "KeyFrame 4.mspMergeEdges", "KeyFrameDatabase.mvInvertedFile",
                        "KeyFrameDatabase.mvInvertedFile", "LoopClosing.mpCurrentKF",
                        "LoopClosing.mpLastCurrentKF", "LoopClosing.mvpMergeConnectedKFs",
                        "Map 0.mpKFinitial", "Map 0.mvpKeyFrameOrigins", "MapPoint 4.mObservations",
                        "MapPoint 4.mpRefKF", "Tracking.mvpLocalKeyFrames"});

TEST(B1_SetBadFlag, B1_LeavesReferencesInFifteenPlaces) {
  {
    World<plain> w;
    cull_in_a_chain(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.kf(2)), in_edges);
    w.free_bad();
    EXPECT_EQ(w.dangling(), in_edges.size());
    w->database.DetectCandidates(2);
    EXPECT_EQ(found.freed_used, 1);
  }
  {
    World<shared> w;
    cull_in_a_chain(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.kf(2)), in_edges);
  }
  World<counted> w;
  cull_in_a_chain(w);
  w.threads.settle();
  // What loop closing keeps in its members it may use; all the rest is gone.
  EXPECT_EQ(w.holders(w.kf(2)),
            holders({"LoopClosing.mpCurrentKF", "LoopClosing.mpLastCurrentKF"}));
  EXPECT_EQ(w.kf(1)->mNextKF, w.kf(3));  // the chain in time closes
  EXPECT_EQ(w.kf(3)->mPrevKF, w.kf(1));
  EXPECT_EQ(w.mp(4)->GetReferenceKeyFrame(), w.kf(0));
  w->closing.InsertKeyFrame(w.kf(4));
  w->closing.NewDetectCommonRegions(w->database);  // the next one
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.keyframes(), 4u);
}

TEST(B1_SetBadFlag, B1_WhatTrackingUsesStaysUntilItsFrameEnds) {
  World<counted> w;
  w.keyframe();
  w.keyframe();
  KeyFrame<counted>* borrowed = nullptr;
  w.threads.on_tracking([&] { borrowed = w.kf(1); });
  w.kf(1)->SetBadFlag();
  w.threads.collect();
  w.threads.on_tracking([&] { EXPECT_TRUE(borrowed->isBad()); });
  EXPECT_EQ(w.keyframes(), 2u);
  for (int i = 0; i != 2; ++i) {  // one for its borrowed pointers, one for its anchors
    w.threads.end_of_frame();
    w.threads.collect();
  }
  EXPECT_EQ(w.keyframes(), 1u);
}

// Keyframes that are culled one after the other, while a member keeps the first of them.
template <class S>
void cull_behind_a_held_one(World<S>& w) {
  const auto k0 = w.keyframe(), k1 = w.keyframe(), k2 = w.keyframe();
  w.share({k0, k1, k2}, 4);
  const std::vector<MapPoint<S>*> points = w.map()->GetAllMapPoints();
  for (long i = 3; i != 33; ++i) {
    w.frame(points);
    w.new_keyframe();
    if (i == 3) {
      w->closing.mpMergeMatchedKF = w.kf(3);
    } else {
      w.kf(i - 1)->AddChild(w.kf(i));
      w.kf(i - 1)->SetBadFlag();
    }
    w.threads.settle();
  }
  w.frame({});  // the last frame refers to the last keyframe but one
  w.threads.settle();
}

TEST(B1_SetBadFlag, B1_OneHeldKeyFrameDoesNotKeepThoseThatAreCulledLater) {
  {
    World<shared> w;
    cull_behind_a_held_one(w);
    EXPECT_EQ(w.bad(), 29u);
  }
  World<counted> w;
  cull_behind_a_held_one(w);
  EXPECT_EQ(w.bad(), 1u);
  EXPECT_EQ(w.holders(w.kf(3)), holders({"LoopClosing.mpMergeMatchedKF"}));
  EXPECT_EQ(w.keyframes(), 5u);
}

// Marked, deferred, marked on release; its child's next parent is culled; released again.
template <class S>
void set_bad_twice(World<S>& w) {
  const auto origin = w.keyframe();
  const auto parent = w.keyframe(), culled = w.keyframe(), child = w.keyframe();
  parent->ChangeParent(origin);
  culled->ChangeParent(parent);
  child->ChangeParent(culled);
  w->closing.mpLoopMatchedKF = static_cast<KeyFrame<S>*>(culled);
  w->closing.mpLoopLastCurrentKF = static_cast<KeyFrame<S>*>(culled);
  culled->SetNotErase();
  culled->SetBadFlag();  // deferred
  culled->SetErase();    // the child goes to the parent, and stays in mspChildrens
  parent->SetBadFlag();  // the child goes to the origin
  culled->SetErase();    // the child goes to the parent again
  w->closing.mpLoopMatchedKF = nullptr;
  w->closing.mpLoopLastCurrentKF = nullptr;
}

TEST(B1_SetBadFlag, B1_ASecondSetEraseGivesALiveKeyFrameABadParent) {
  {
    World<plain> w;
    set_bad_twice(w);
    EXPECT_EQ(w.bad(), 2u);
    EXPECT_EQ(w.kf(3)->GetParent(), w.kf(1));
    EXPECT_TRUE(w.kf(1)->isBad());
    KeyFrame<plain>* const child = w.kf(3);
    w.free_bad();
    child->GetParent()->isBad();
    EXPECT_EQ(found.freed_used, 1);
  }
  {
    World<shared> w;
    set_bad_twice(w);
    EXPECT_EQ(w.bad(), 1u);
  }
  World<counted> w;
  set_bad_twice(w);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.kf(3)->GetParent(), w.kf(0));
  EXPECT_EQ(w.kf(0)->GetChilds(), (std::vector<KeyFrame<counted>*>{w.kf(3)}));
}

template <class S>
void cull_without_a_parent(World<S>& w) {
  const auto origin = w.keyframe();
  const auto a = w.keyframe(), child = w.keyframe();
  child->ChangeParent(a);
  a->SetBadFlag();
  (void)origin;
}

TEST(B1_SetBadFlag, B1_AKeyFrameWithoutAParentHandsItsChildrenToNull) {
  {
    World<plain> w;
    cull_without_a_parent(w);
    EXPECT_EQ(found.null_used, 1);
  }
  World<counted> w;
  cull_without_a_parent(w);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.kf(2)->GetParent(), nullptr);
}

// ---- B2: SetNotErase, SetErase

// The keyframe of a loop candidate is the current one of loop closing as well, which releases it.
template <class S>
void unpin_for_somebody_else(World<S>& w) {
  w.keyframe();
  const auto a = w.keyframe(), b = w.keyframe();
  w->closing.match(a, b, {});
  w->closing.InsertKeyFrame(b);
  w->closing.NewDetectCommonRegions(w->database);  // SetNotErase, SetErase: one bool
  b->SetBadFlag();                                 // is not deferred
  w->closing.InsertKeyFrame(a);
  w->closing.NewDetectCommonRegions(w->database);
}

TEST(B2_SetErase, B2_OneFlagCannotPinTwice) {
  {
    World<plain> w;
    unpin_for_somebody_else(w);
    EXPECT_EQ(w.bad(), 1u);
    w.free_bad();
    w->closing.give_up();
    EXPECT_GT(found.freed_used, 0);
  }
  {
    World<shared> w;
    unpin_for_somebody_else(w);
    w->closing.give_up();
    EXPECT_EQ(w.bad(), 1u);
  }
  World<counted> w;
  unpin_for_somebody_else(w);
  w.threads.settle();
  EXPECT_EQ(w.holders(w.kf(2)), holders({"LoopClosing.mpLoopMatchedKF"}));
  w->closing.give_up();
  w->closing.match(w.kf(1), w.kf(0), {});
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
}

TEST(B2_SetErase, B2_ACountedPinPinsAsOftenAsItIsTaken) {
  World<counted> w;
  w.keyframe();
  w.keyframe();
  slamgc::pin<KeyFrame<counted>> first(w.kf(1));
  slamgc::pin<KeyFrame<counted>> second(w.kf(1));
  w.kf(1)->SetBadFlag();
  w.threads.settle();
  EXPECT_TRUE(first->isBad());
  first = nullptr;
  w.threads.settle();
  EXPECT_TRUE(second->isBad());
  second = nullptr;
  w.threads.settle();
  EXPECT_EQ(w.keyframes(), 1u);
}

// ---- B3: MapPoint::SetBadFlag

template <class S>
void cull_a_point_that_all_know(World<S>& w) {
  w.share({w.keyframe()}, 2);
  const typename S::template local<MapPoint<S>> p = w.mp(0), other = w.mp(1);
  w.frame({p, other});
  w.new_keyframe(/*processed=*/false);
  w.map()->SetReferenceMapPoints({p, other});
  w->mapping.mlpRecentAddedMapPoints.push_back(p);
  w->closing.mvpLoopMapPoints.push_back(p);
  w.threads.on_tracking([&] {
    w->tracking.mvpLocalMapPoints.push_back(p);
    w->outputs.mTrackedMapPoints.push_back(p);
    w->outputs.mTrackedMapPoints.push_back(other);
    w->outputs.mvpLocalMap.push_back(p);
  });
  p->SetBadFlag();
}

TEST(B3_MapPointSetBadFlag, B3_LeavesThePointInEveryList) {
  const holders all({"KeyFrame 1.mvpMapPoints", "LocalMapping.mlpRecentAddedMapPoints",
                     "LoopClosing.mvpLoopMapPoints", "Map 0.mvpReferenceMapPoints",
                     "Outputs.mTrackedMapPoints", "Outputs.mvpLocalMap",
                     "Tracking.mvpLocalMapPoints", "Tracking.mvpMapPoints",
                     "Tracking.mvpMapPoints"});
  {
    World<plain> w;
    cull_a_point_that_all_know(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.mp(0)), all);
    w.free_bad();
    EXPECT_EQ(w.dangling(), all.size());
    w->tracking.use_members();
    EXPECT_EQ(found.freed_used, 1);
  }
  {
    World<shared> w;
    cull_a_point_that_all_know(w);
    EXPECT_EQ(w.holders(w.mp(0)), all);
  }
  World<counted> w;
  cull_a_point_that_all_know(w);
  w.threads.settle();
  // The frame's slots, and so those of the keyframe that is made of it and is not in the map yet.
  EXPECT_EQ(w.holders(w.mp(0)),
            holders({"KeyFrame 1.mvpMapPoints", "Tracking.mvpMapPoints", "Tracking.mvpMapPoints"}));
  EXPECT_EQ(w->outputs.mTrackedMapPoints.size(), 2u);
  w.process();
  w.frame({w.mp(1)});
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.points(), 1u);
}

// ---- B4: MapPoint::Replace

template <class S>
void fuse_what_tracking_has_matched(World<S>& w) {
  const auto origin = w.keyframe();
  const auto a = w.keyframe();
  w.share({origin}, 1);
  w.share({a}, 1);
  const typename S::template local<MapPoint<S>> x = w.mp(0), y = w.mp(1);
  w.frame({x});
  origin->AddMapPoint(x, 40);  // a slot without its index
  x->Replace(y);
}

TEST(B4_Replace, B4_TheReplacedPointIsNeededForOneMoreFrame) {
  {
    World<plain> w;
    fuse_what_tracking_has_matched(w);
    EXPECT_EQ(w.bad(), 1u);
    EXPECT_EQ(w.holders(w.mp(0)), holders({"KeyFrame 0.mvpMapPoints", "Tracking.mvpMapPoints",
                                           "Tracking.mvpMapPoints"}));
    w.free_bad();
    w.frame({});  // CheckReplacedInLastFrame
    EXPECT_EQ(found.freed_used, 1);
  }
  {
    World<shared> w;
    fuse_what_tracking_has_matched(w);
    w.frame({});
    EXPECT_EQ(w.bad(), 1u);
  }
  World<counted> w;
  fuse_what_tracking_has_matched(w);
  w.threads.settle();
  ASSERT_NE(w.mp(0), nullptr);
  MapPoint<counted>* const x = w.mp(0);
  EXPECT_EQ(x->GetReplaced(), w.mp(1));
  w.threads.on_tracking([&] {
    w->tracking.CheckReplacedInLastFrame();
    EXPECT_EQ(w->tracking.mLastFrame.mvpMapPoints[0], w.mp(1));
  });
  w.frame({w.mp(1)});
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.holders(w.mp(1)).size(), 5u);  // map, two slots, two frames
}

// ---- B5: MapPoint::EraseObservation

template <class S>
void erase_the_last_observation(World<S>& w) {
  const auto origin = w.keyframe();
  const auto a = w.keyframe(), b = w.keyframe();
  w.share({a}, 1);             // seen by one keyframe
  w.share({b, a, origin}, 1);  // loses one of three observers, and keeps its reference keyframe
  w.frame({w.mp(1)});
  a->SetBadFlag();
  b->SetBadFlag();
}

TEST(B5_EraseObservation, B5_TheReferenceKeyFrameOutlivesTheObservations) {
  {
    World<plain> w;
    erase_the_last_observation(w);
    EXPECT_EQ(found.read_past_end, 1);  // begin()->first of an empty map
    EXPECT_EQ(w.bad(), 4u);
    EXPECT_EQ(w.holders(w.kf(2)), holders({"MapPoint 1.mpRefKF"}));
    w.free_bad();
    EXPECT_EQ(w.dangling(), 2u);
  }
  {
    World<shared> w;
    erase_the_last_observation(w);
    EXPECT_EQ(w.bad(), 2u);  // the frame keeps the point, and the point the keyframe
  }
  World<counted> w;
  erase_the_last_observation(w);
  w.threads.settle();
  ASSERT_NE(w.mp(1), nullptr);
  EXPECT_EQ(w.mp(1)->GetReferenceKeyFrame(), nullptr);
  EXPECT_EQ(w.bad(), 1u);
  w.frame({});
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
}

// ---- B6: Map::EraseKeyFrame, Map::EraseMapPoint

// The first keyframe of a map is moved to another one, which does not protect it, and culled there.
template <class S>
void cull_the_first_keyframe_of_another_map(World<S>& w) {
  const auto first = w.keyframe();
  w.keyframe();
  w.share({first}, 1);
  Map<S>* const older = w.map();
  older->SetReferenceMapPoints({w.mp(0)});
  w->atlas.CreateNewMap();
  w.keyframe();
  older->EraseKeyFrame(first);
  first->UpdateMap(w.map());
  w.map()->AddKeyFrame(first);
  first->SetBadFlag();
}

TEST(B6_EraseKeyFrame, B6_LeavesTheOriginsAndTheReferencePoints) {
  {
    World<plain> w;
    cull_the_first_keyframe_of_another_map(w);
    EXPECT_EQ(w.bad(), 2u);
    EXPECT_EQ(w.holders(w.kf(0)), holders({"Map 0.mpKFinitial", "Map 0.mvpKeyFrameOrigins"}));
    EXPECT_EQ(w.holders(w.mp(0)),
              holders({"KeyFrame 0.mvpMapPoints", "Map 0.mvpReferenceMapPoints"}));
    Map<plain>* const older = w.kf(1)->GetMap();
    w.free_bad();
    older->GetOriginKF()->isBad();
    EXPECT_EQ(found.freed_used, 1);
  }
  {
    World<shared> w;
    cull_the_first_keyframe_of_another_map(w);
    EXPECT_EQ(w.bad(), 2u);
  }
  World<counted> w;
  cull_the_first_keyframe_of_another_map(w);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  Map<counted>* const older = w.kf(1)->GetMap();
  EXPECT_EQ(older->GetOriginKF(), nullptr);
  EXPECT_TRUE(older->mvpKeyFrameOrigins.empty());
  EXPECT_EQ(older->mpKFlowerID, w.kf(1));
}

}  // namespace
