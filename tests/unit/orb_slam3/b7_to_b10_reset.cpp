// B7 to B10: whole maps that ORB-SLAM3 forgets.
#include <gtest/gtest.h>

#include <cstddef>
#include <vector>

#include "world.hpp"

namespace {

using namespace orb_slam3;

// A map of keyframes that are connected in every way, and tracking in the midst of it.
template <class S>
void drive(World<S>& w, int keyframes) {
  for (int i = 0; i != keyframes; ++i) {
    const std::size_t n = w.map()->GetAllKeyFrames().size();
    std::vector<MapPoint<S>*> seen;
    for (MapPoint<S>* const p : w.map()->GetAllMapPoints())
      if (seen.size() != 40) seen.push_back(p);
    seen.resize(64, nullptr);
    w.frame(seen);
    const long id = w.new_keyframe();
    w.share({w.kf(id)}, 10);
    w.kf(id)->UpdateConnections();
    w.threads.on_tracking([&] {
      w->tracking.UpdateLocalMap(w.map()->GetAllKeyFrames());
      w->outputs.mvpLocalMap.clear();
      for (MapPoint<S>* const p : w.map()->GetAllMapPoints()) w->outputs.mvpLocalMap.push_back(p);
    });
    EXPECT_EQ(w.map()->GetAllKeyFrames().size(), n + 1);
  }
}

// ---- B7: Map::clear

template <class S>
void clear_a_map(World<S>& w) {
  drive(w, 10);
  w->database.clearMap(w.map());
  w.map()->clear();
  w.threads.on_tracking([&] {
    w->tracking.forget_frames();
    w->tracking.mvpLocalKeyFrames.clear();
    w->tracking.mvpLocalMapPoints.clear();
    w->outputs.mvpLocalMap.clear();
  });
  w->closing.mpCurrentKF = w->closing.mpLastCurrentKF = nullptr;
  w->mapping.mpCurrentKeyFrame = nullptr;
}

TEST(B7_MapClear, B7_TheClearedGraphStaysConnected) {
  {
    World<plain> w;
    clear_a_map(w);
    EXPECT_EQ(w.bad(), 0u);  // nobody calls it bad
    EXPECT_EQ(w.keyframes(), 10u);
    EXPECT_EQ(w.points(), 100u);
    drive(w, 2);
    EXPECT_EQ(w.keyframes(), 12u);
  }
  {
    World<shared> w;
    clear_a_map(w);
    EXPECT_EQ(w.keyframes(), 10u);
    EXPECT_EQ(w.points(), 100u);
  }
  World<counted> w;
  clear_a_map(w);
  w.threads.settle();
  EXPECT_EQ(w.keyframes(), 0u);
  EXPECT_EQ(w.points(), 0u);
  EXPECT_EQ(w.maps(), 1u);
  drive(w, 2);
  w.threads.settle();
  EXPECT_EQ(w.keyframes(), 2u);  // the map lives on
  EXPECT_EQ(w.points(), 20u);
}

TEST(B7_MapClear, B7_WhatTrackingUsesOfAClearedMapStays) {
  World<counted> w;
  drive(w, 10);
  KeyFrame<counted>* kf = nullptr;
  w.threads.on_tracking([&] {
    kf = w->tracking.mpReferenceKF;
    w->tracking.mpLastKeyFrame = nullptr;
    w->tracking.mCurrentFrame = w->tracking.mLastFrame = Frame<counted>();
    w->tracking.mpReferenceKF = nullptr;  // borrowed from now on
  });
  w->database.clearMap(w.map());
  w.map()->clear();
  w->closing.ResetIfRequested(nullptr);
  w->mapping.mpCurrentKeyFrame = nullptr;
  w.threads.collect();
  EXPECT_EQ(w.keyframes(), 10u);
  w.threads.on_tracking([&] { EXPECT_EQ(kf->GetMapPointMatches().size(), 64u); });
  w.threads.end_of_frame();
  w.threads.settle();
  EXPECT_EQ(w.keyframes() + w.points(), 0u);
}

// ---- B8: Atlas::clearAtlas, SetMapBad, RemoveBadMaps

template <class S>
void lose_maps(World<S>& w) {
  drive(w, 3);
  Map<S>* const merged_away = w.map();
  w->atlas.CreateNewMap();
  drive(w, 3);
  w->atlas.SetMapBad(merged_away);
  w->atlas.RemoveBadMaps();
}

TEST(B8_Atlas, B8_BadMapsAndClearedOnesAreLeaked) {
  {
    World<plain> w;
    lose_maps(w);
    EXPECT_EQ(w.maps(), 2u);
    EXPECT_EQ(w.keyframes(), 6u);
    w->atlas.clearAtlas();
    w->atlas.CreateNewMap();
    EXPECT_EQ(w.maps(), 3u);
    EXPECT_EQ(w.keyframes(), 6u);
  }
  {
    World<shared> w;
    lose_maps(w);
    w->atlas.clearAtlas();
    w->atlas.CreateNewMap();
    EXPECT_EQ(w.maps(), 3u);
    EXPECT_EQ(w.keyframes(), 6u);
  }
  World<counted> w;
  lose_maps(w);
  w.threads.settle();
  EXPECT_EQ(w.maps(), 1u);
  EXPECT_EQ(w.keyframes(), 3u);
  EXPECT_EQ(w.points(), 30u);
  w->atlas.clearAtlas();
  w->atlas.CreateNewMap();
  w.threads.on_tracking([&] { w->tracking.forget_frames(); });
  w->closing.ResetIfRequested(nullptr);
  w->mapping.mpCurrentKeyFrame = nullptr;
  w.threads.settle();
  EXPECT_EQ(w.maps(), 1u);
  EXPECT_EQ(w.keyframes() + w.points(), 0u);
}

// ---- B9: Tracking::Reset

// In the order of the original: mapping, loop closing, database, atlas, tracking. A keyframe waits in mapping's queue, a global
// bundle adjustment runs.
template <class S>
void reset(World<S>& w) {
  drive(w, 8);
  w.new_keyframe(/*processed=*/false);
  w->adjustment.begin(w.map());
  w->mapping.ResetIfRequested();
  w->closing.ResetIfRequested(nullptr);
  w->database.clear();
  w->atlas.clearAtlas();
  w->atlas.CreateNewMap();
  w.threads.on_tracking([&] { w->tracking.forget_frames(); });
}

TEST(B9_Reset, B9_TheOldMapTheQueueAndTheAdjustmentStay) {
  {
    World<plain> w;
    reset(w);
    EXPECT_EQ(w.keyframes(), 9u);
    EXPECT_EQ(w.points(), 80u);
    EXPECT_EQ(w.maps(), 2u);
    for (KeyFrame<plain>* const kf : listed<KeyFrame<plain>>::all()) plain::destroy(kf);
    w.threads.on_tracking([&] { w->tracking.use_members(); });
    EXPECT_EQ(found.freed_used, 9 - 1);  // mvpLocalKeyFrames; one was not processed
    w->adjustment.write_back();
    EXPECT_EQ(found.freed_used, 2 * (9 - 1));
  }
  {
    World<shared> w;
    reset(w);
    w->adjustment.end();
    EXPECT_EQ(w.keyframes(), 9u);
    EXPECT_EQ(w.points(), 80u);
    EXPECT_EQ(w.maps(), 2u);
  }
  World<counted> w;
  reset(w);
  w.threads.settle();
  // The adjustment has what it needs, and mapping's last keyframe is one of those; the queue's keyframe is gone.
  EXPECT_EQ(w.keyframes(), 8u);
  EXPECT_EQ(w.maps(), 2u);
  EXPECT_TRUE(w->tracking.mvpLocalKeyFrames.empty());
  EXPECT_TRUE(w->tracking.mvpLocalMapPoints.empty());
  EXPECT_TRUE(w->outputs.mvpLocalMap.empty());
  EXPECT_EQ(w->adjustment.write_back(), 88u);
  w->adjustment.end();
  w.threads.settle();
  EXPECT_EQ(w.keyframes(), 1u);
  EXPECT_EQ(w.points(), 0u);
  EXPECT_EQ(w.holders(w->mapping.mpCurrentKeyFrame), holders({"LocalMapping.mpCurrentKeyFrame"}));
  drive(w, 2);  // the new map
  w.threads.settle();
  EXPECT_EQ(w.keyframes(), 2u);
  EXPECT_EQ(w.points(), 20u);
  EXPECT_EQ(w.maps(), 1u);
}

// ---- B10: Tracking::ResetActiveMap, CreateMapInAtlas

// Loop closing has a candidate, which mapping wanted to cull; then the map is cleared.
template <class S>
void reset_the_active_map(World<S>& w) {
  drive(w, 8);
  w->closing.match(w.kf(6), w.kf(3), {w.mp(0)});
  w.kf(3)->SetBadFlag();  // deferred
  w->mapping.ResetIfRequested();
  w->closing.ResetIfRequested(w.map());
  w->database.clearMap(w.map());
  w.map()->clear();
  w.threads.on_tracking([&] { w->tracking.forget_frames(); });
  if (w->closing.mnLoopNumCoincidences > 0) w->closing.give_up();
}

TEST(B10_ResetActiveMap, B10_LoopClosingReleasesAKeyFrameOfTheClearedMap) {
  {
    World<plain> w;
    reset_the_active_map(w);
    EXPECT_EQ(found.null_used, 1);  // SetErase, SetBadFlag, its map
    EXPECT_EQ(w.keyframes(), 8u);
    EXPECT_EQ(w.points(), 80u);
  }
  {
    World<shared> w;
    reset_the_active_map(w);
    EXPECT_EQ(found.null_used, 1);
    EXPECT_EQ(w.keyframes(), 8u);
    EXPECT_EQ(w.points(), 80u);
  }
  World<counted> w;
  reset_the_active_map(w);
  w.threads.settle();
  EXPECT_EQ(found.null_used, 0);
  EXPECT_EQ(w.keyframes(), 1u);  // mapping's last one, until the next
  EXPECT_EQ(w.points(), 0u);
  drive(w, 1);
  w.threads.settle();
  EXPECT_EQ(w.keyframes(), 1u);
  EXPECT_EQ(w.points(), 10u);
}

template <class S>
void new_map_in_the_atlas(World<S>& w) {
  drive(w, 4);
  w->atlas.CreateNewMap();
  w.threads.on_tracking([&] { w->tracking.forget_frames(); });
  w.kf(2)->SetBadFlag();  // in the map that is not the current one
}

TEST(B10_ResetActiveMap, B10_TheLocalMapOfTheOldMapStaysWhenANewOneIsMade) {
  {
    World<plain> w;
    new_map_in_the_atlas(w);
    w.free_bad();
    w.threads.on_tracking([&] { w->tracking.use_members(); });
    EXPECT_GT(found.freed_used, 0);
  }
  {
    World<shared> w;
    new_map_in_the_atlas(w);
    EXPECT_GE(w.bad(), 1u);
  }
  World<counted> w;
  new_map_in_the_atlas(w);
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w->tracking.mvpLocalKeyFrames.size(), 3u);
  EXPECT_EQ(w.keyframes(), 3u);
}

}  // namespace
