// What ORB-SLAM3 leaks, case by case (README.md), on one thread. The plain build shows the leak, or the pointer that dangles; the one with
// slamgc that there is none. B13 needs threads: mini_orb_threads_test.cc.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <sstream>
#include <vector>

#include "Atlas.h"
#include "KeyFrame.h"
#include "KeyFrameDatabase.h"
#include "LocalMapping.h"
#include "Map.h"
#include "MapPoint.h"
#include "Session.h"
#include "Tracking.h"

namespace mini_orb {
namespace {

constexpr int kFeatures = 60;

class MiniOrb : public testing::Test {
 protected:
  // What was made since the test began, and is alive.
  long KeyFrames() const { return Instances<KeyFrame>::Alive() - keyframes_; }
  long Points() const { return Instances<MapPoint>::Alive() - points_; }
  long Maps() const { return Instances<Map>::Alive() - maps_; }
  Map* CurrentMap() const { return session.system->mpAtlas->GetCurrentMap(); }
  long Held(std::size_t System::Summary::*what) const {
    return static_cast<long>(session.system->GetSummary().*what);
  }
  // Points that are bad and still alive, since tracking used them in its last frame.
  void ExpectNothingButTheMap() {
    ASSERT_TRUE(session.system->Drain());
    EXPECT_EQ(KeyFrames(), Held(&System::Summary::keyframes));
    EXPECT_EQ(Maps(), Held(&System::Summary::maps));
    EXPECT_EQ(Points(), Held(&System::Summary::points));
  }
  void ExpectNothingAtTheEnd() {
    session.system.reset();
    EXPECT_EQ(KeyFrames(), 0);
    EXPECT_EQ(Points(), 0);
    EXPECT_EQ(Maps(), 0);
  }

  const long keyframes_ = Instances<KeyFrame>::Alive();
  const long points_ = Instances<MapPoint>::Alive();
  const long maps_ = Instances<Map>::Alive();
  Session session{kFeatures, false};
};

TEST_F(MiniOrb, B1_AndB3_AndB4_WhatASessionMarksStays) {
  session.Drive(5 * World::kLap);
  const auto now = session.system->GetSummary();
  ASSERT_GT(now.culled, 20);
  ASSERT_GE(now.loops, 1);  // which fuses points
  ASSERT_TRUE(session.system->Drain());
  if (!kReclaims) {
    EXPECT_GE(KeyFrames(), Held(&System::Summary::keyframes) + 20);
    EXPECT_GT(Points(), 3 * Held(&System::Summary::points) / 2);
  }
  if (kReclaims) ExpectNothingButTheMap();
  if (kReclaims) ExpectNothingAtTheEnd();
}

// Two users ask that a keyframe stays; when the first one has finished, it goes bad. (What needs it has to count it.)
TEST_F(MiniOrb, B2_OneFlagDoesNotPinForTwo) {
  session.Drive(World::kLap);
  ASSERT_TRUE(session.system->Drain());
  const long others = KeyFrames() - 1;
  const std::vector<KeyFrame*> all = CurrentMap()->GetAllKeyFrames();
  KeyFrame* const pKF = all[all.size() / 2];
  pKF->SetNotErase();
  pKF->SetNotErase();
  pKF->SetBadFlag();
  EXPECT_FALSE(pKF->isBad());
  pKF->SetErase();
  EXPECT_TRUE(pKF->isBad());
  ASSERT_TRUE(session.system->Drain());
  EXPECT_EQ(KeyFrames(), others + (kReclaims ? 0 : 1));
}

TEST_F(MiniOrb, B3_AndB6_ABadPointStaysInTheListOfReferencePoints) {
  session.Drive(World::kLap);
  ASSERT_TRUE(session.system->Drain());
  Map* const pMap = CurrentMap();
  const std::size_t before = pMap->GetReferenceMapPoints().size();
  MapPoint* pBad = nullptr;  // of the local map, and of no frame
  const auto pNow = session.system->mpTracker->mCurrentFrame.mvpMapPoints;
  const auto pLast = session.system->mpTracker->mLastFrame.mvpMapPoints;
  for (MapPoint* pMP : pMap->GetReferenceMapPoints())
    if (!pMP->isBad() && std::count(pNow.begin(), pNow.end(), pMP) == 0 &&
        std::count(pLast.begin(), pLast.end(), pMP) == 0)
      pBad = pMP;
  ASSERT_NE(pBad, nullptr);
  for (const auto& [pKF, indexes] : pBad->GetObservations()) pBad->EraseObservation(pKF);
  EXPECT_TRUE(pBad->isBad());
  ASSERT_TRUE(session.system->Drain());
  EXPECT_EQ(pMap->GetReferenceMapPoints().size(), before - (kReclaims ? 1 : 0));
}

// Tracking asks the points of its last frame what has replaced them.
TEST_F(MiniOrb, B4_AReplacedPointIsNeededForOneMoreFrame) {
  session.Drive(40);
  ASSERT_TRUE(session.system->Drain());
  std::vector<MapPoint*> seen;
  for (MapPoint* pMP : session.system->mpTracker->mLastFrame.mvpMapPoints)
    if (pMP != nullptr && !pMP->isBad()) seen.push_back(pMP);
  ASSERT_GE(seen.size(), 2u);
  const long before = Points();
  seen[0]->Replace(seen[1]);
  ASSERT_TRUE(session.system->Drain());
  EXPECT_EQ(Points(), before);
  EXPECT_EQ(seen[0]->GetReplaced(), seen[1]);
  session.Drive(3);
  ASSERT_TRUE(session.system->Drain());
  if (!kReclaims) {
    EXPECT_TRUE(seen[0]->isBad());
  }
  if (kReclaims) ExpectNothingButTheMap();
}

TEST_F(MiniOrb, B7_AndB10_AClearedMapStays) {
  session.Drive(World::kLap);
  const long before = KeyFrames();
  session.system->ResetActiveMap();
  session.Drive(20);
  ASSERT_TRUE(session.system->Drain());
  ASSERT_LT(Held(&System::Summary::keyframes), 5);
  if (!kReclaims) {
    EXPECT_GE(KeyFrames(), before + 1);
  }
  if (kReclaims) ExpectNothingButTheMap();
}

TEST_F(MiniOrb, B8_AndB9_AResetLeavesEverything) {
  session.Drive(World::kLap);
  const long before = KeyFrames();
  session.system->Reset();
  session.Drive(20);
  ASSERT_TRUE(session.system->Drain());
  if (!kReclaims) {
    EXPECT_EQ(Maps(), 2);
  }
  if (!kReclaims) {
    EXPECT_GE(KeyFrames(), before + 1);
  }
  if (kReclaims) ExpectNothingButTheMap();
  // Keyframes have the numbers of those before.
  ASSERT_GE(Held(&System::Summary::keyframes), 1);
  EXPECT_EQ(CurrentMap()->GetOriginKF()->mnId, 0u);
}

TEST_F(MiniOrb, B10_TrackingLosesItselfInASmallMap) {
  session.Drive(10);
  session.Dark(30);
  session.Drive(10);
  EXPECT_EQ(session.system->GetSummary().state, Tracking::OK);
  ASSERT_TRUE(session.system->Drain());
  if (!kReclaims) {
    EXPECT_GT(KeyFrames(), Held(&System::Summary::keyframes));
  }
  if (kReclaims) ExpectNothingButTheMap();
}

TEST_F(MiniOrb, B12_AMergedMapStays) {
  session.Drive(World::kLap + 40);
  session.Dark(30);
  session.Drive(20);
  ASSERT_EQ(session.system->GetSummary().maps, 2u);
  session.Drive(World::kLap);
  ASSERT_EQ(session.system->GetSummary().merges, 1);
  ASSERT_EQ(session.system->GetSummary().maps, 1u);
  ASSERT_TRUE(session.system->Drain());
  if (!kReclaims) {
    EXPECT_EQ(Maps(), 2);
  }
  if (kReclaims) ExpectNothingButTheMap();
  if (kReclaims) ExpectNothingAtTheEnd();
}

TEST_F(MiniOrb, B9_AResetDropsTheQueue) {
  session.Drive(40);
  const long before = KeyFrames();
  Frame frame(session.world.Look(0, 1000000));
  auto* const pKF = new KeyFrame(frame, CurrentMap(), nullptr);
  session.system->mpLocalMapper->InsertKeyFrame(pKF);
  session.system->mpLocalMapper->RequestReset();
  ASSERT_TRUE(session.system->Drain());
  EXPECT_EQ(KeyFrames(), before + (kReclaims ? 0 : 1));
}

// Its predecessor and its points refer to a new keyframe before mapping has seen it.
TEST_F(MiniOrb, B11_ReleaseDeletesAKeyFrameThatIsInUse) {
  session.Drive(40);
  ASSERT_TRUE(session.system->Drain());
  const long before = KeyFrames();
  KeyFrame* const pPrevious = CurrentMap()->GetAllKeyFrames().back();
  MapPoint* const pMP = CurrentMap()->GetAllMapPoints().back();
  const std::size_t observers = pMP->GetObservations().size();
  Frame frame(session.world.Look(0, 1000000));
  auto* const pKF = new KeyFrame(frame, CurrentMap(), nullptr);
  const auto address = reinterpret_cast<std::uintptr_t>(pKF);
  pKF->mPrevKF = pPrevious;
  pPrevious->mNextKF = pKF;
  pMP->AddObservation(pKF, 0);
  session.system->mpLocalMapper->InsertKeyFrame(pKF);
  session.system->mpLocalMapper->Release();
  KeyFrame* const pNext = pPrevious->mNextKF;
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(pNext), address);
  EXPECT_EQ(pMP->GetObservations().size(), observers + 1);
  if (!kReclaims) {
    EXPECT_EQ(KeyFrames(), before);  // there is no such keyframe any more
    return;
  }
  EXPECT_EQ(KeyFrames(), before + 1);
  EXPECT_FALSE(pNext->isBad());
  // When it goes, its last user has gone, or forgets it.
  session.system->mpLocalMapper->RequestReset();
  ASSERT_TRUE(session.system->Drain());
  EXPECT_EQ(KeyFrames(), before);
  EXPECT_EQ(pMP->GetObservations().size(), observers);
}

TEST_F(MiniOrb, LocalisationUsesTemporalPoints) {
  session.Drive(World::kLap);
  session.system->ActivateLocalizationMode();
  const long made = Instances<MapPoint>::Made();
  session.Drive(60);
  EXPECT_GT(Instances<MapPoint>::Made(), made + 100);
  EXPECT_EQ(session.system->GetSummary().state, Tracking::OK);
  session.system->DeactivateLocalizationMode();
  session.Drive(40);
  if (kReclaims) ExpectNothingButTheMap();
  if (kReclaims) ExpectNothingAtTheEnd();
}

TEST_F(MiniOrb, SaveAndLoad) {
  session.Drive(2 * World::kLap);
  std::stringstream file;
  session.system->SaveAtlas(file);
  const auto saved = session.system->GetSummary();
  session.system->Reset();
  session.Drive(1);
  session.system->LoadAtlas(file);
  const auto loaded = session.system->GetSummary();
  EXPECT_EQ(loaded.maps, saved.maps + 1);
  EXPECT_EQ(loaded.keyframes, saved.keyframes + 1);
  session.Drive(World::kLap);
  EXPECT_GE(session.system->GetSummary().merges, 1);
  if (kReclaims) ExpectNothingButTheMap();
  if (kReclaims) ExpectNothingAtTheEnd();
}

TEST_F(MiniOrb, EndsInEachState) {
  if (!kReclaims) GTEST_SKIP() << "the plain build ends with everything it made";
  ExpectNothingAtTheEnd();
  for (const int frames : {1, 10, 100}) {
    session.system = std::make_unique<System>(false);
    session.Drive(frames);
    ExpectNothingAtTheEnd();
    session.system = std::make_unique<System>(false);
    session.Drive(frames);
    session.Dark(frames);
    ExpectNothingAtTheEnd();
  }
}

// About what a keyframe of ORB-SLAM3 takes.
TEST_F(MiniOrb, AKeyFrameIsLarge) {
  World large(7, 1000);
  Frame frame(large.Look(0, 1));
  ASSERT_GT(frame.N, 500);
  std::size_t blocks = 0, bytes = sizeof(KeyFrame);
  const auto add = [&](std::size_t n) { blocks += n != 0 ? 1 : 0, bytes += n; };
  add(frame.mvKeys.capacity() * sizeof(KeyPoint) * 2);
  add(frame.mDescriptors.capacity() * sizeof(Descriptor));
  for (const auto& column : frame.mGrid) {
    add(column.capacity() * sizeof(column[0]));
    for (const auto& cell : column) add(cell.capacity() * sizeof(cell[0]));
  }
  add(48 * frame.mBowVec.size());
  blocks += frame.mBowVec.size() - 1;
  for (const auto& [node, features] : frame.mFeatVec) add(64), add(4 * features.capacity());
  EXPECT_GT(blocks, 1000u);
  EXPECT_GT(bytes, 150000u);
}

// Keyframes and points by hand: what a session does by chance.
class MiniOrbGraph : public MiniOrb {
 protected:
  // Of the same view as all others. The first one is that of the map, which is never culled.
  KeyFrame* MakeKeyFrame(const std::vector<MapPoint*>& slots = {}) {
    Frame frame(image);
    for (std::size_t i = 0; i != slots.size(); ++i) frame.mvpMapPoints[i] = slots[i];
    return new KeyFrame(frame, CurrentMap(), &database);
  }
  KeyFrame* Add() {
    KeyFrame* const pKF = MakeKeyFrame();
    CurrentMap()->AddKeyFrame(pKF);
    return pKF;
  }
  // New points, each of which is seen by all of these, in the slots after those before.
  std::vector<MapPoint*> Share(const std::vector<KeyFrame*>& keyframes, std::size_t n) {
    std::vector<MapPoint*> points;
    for (; points.size() != n; ++slot) {
      if (keyframes[0]->mvDepth[slot] <= 0) continue;
      auto* const pMP =
          new MapPoint(keyframes[0]->UnprojectStereo(slot), keyframes[0], CurrentMap());
      for (KeyFrame* pKF : keyframes) {
        pMP->AddObservation(pKF, static_cast<int>(slot));
        pKF->AddMapPoint(pMP, slot);
      }
      pMP->ComputeDistinctiveDescriptors();
      CurrentMap()->AddMapPoint(pMP);
      points.push_back(pMP);
    }
    return points;
  }
  // How many bad ones are among these.
  template <class Objects>
  static std::ptrdiff_t Bad(const Objects& objects) {
    return std::count_if(objects.begin(), objects.end(),
                         [](const auto* p) { return p != nullptr && p->isBad(); });
  }
  // What there is once all is freed that can be: without slamgc so many more, which are bad.
  void ExpectStays(long keyframes, long points, long bad_keyframes, long bad_points) {
    ASSERT_TRUE(session.system->Drain());
    EXPECT_EQ(KeyFrames(), keyframes + (kReclaims ? 0 : bad_keyframes));
    EXPECT_EQ(Points(), points + (kReclaims ? 0 : bad_points));
  }
  static constexpr int kBad = kReclaims ? 0 : 1;

  const Image image = World(7, 200).Look(0, 0);
  KeyFrameDatabase database;
  std::size_t slot = 0;
};

TEST_F(MiniOrbGraph, A7_1_CovisibilityKeysAreNotSymmetric) {
  KeyFrame *const pOrigin = Add(), *const a = Add(), *const b = Add(), *const c = Add();
  Share({pOrigin, b, c}, 20);
  Share({pOrigin, a, b, c}, 5);
  b->UpdateConnections();  // less than 15 in common: b knows a, and a not b
  EXPECT_EQ(b->GetWeight(a), 5);
  EXPECT_EQ(a->GetWeight(b), 0);
  a->SetBadFlag();
  EXPECT_EQ(Bad(b->GetConnectedKeyFrames()), 1);
  ExpectStays(3, 25, 1, 0);
  EXPECT_EQ(Bad(b->GetConnectedKeyFrames()), kBad);
}

TEST_F(MiniOrbGraph, A7_2_TheOtherSidesOlderEntryStays) {
  KeyFrame *const pOrigin = Add(), *const a = Add(), *const b = Add(), *const c = Add();
  Share({pOrigin, a, c}, 20);
  const auto common = Share({pOrigin, a, b, c}, 20);
  a->UpdateConnections();
  b->UpdateConnections();
  // Bundle adjustment finds that a does not see what it shares with b.
  for (MapPoint* pMP : common) {
    a->EraseMapPointMatch(static_cast<std::size_t>(std::get<0>(pMP->GetIndexInKeyFrame(a))));
    pMP->EraseObservation(a);
  }
  a->UpdateConnections();
  EXPECT_EQ(a->GetWeight(b), 0);
  EXPECT_EQ(b->GetWeight(a), 20);
  a->SetBadFlag();
  EXPECT_EQ(Bad(b->GetVectorCovisibleKeyFrames()), 1);
  ExpectStays(3, 40, 1, 0);
  EXPECT_EQ(Bad(b->GetVectorCovisibleKeyFrames()), kBad);
}

TEST_F(MiniOrbGraph, A7_3_ANewKeyFrameKeepsSlotsOfBadPoints) {
  const auto points = Share({Add()}, 3);
  KeyFrame* const pKF = MakeKeyFrame(points);  // it observes none of them yet
  points[1]->SetBadFlag();
  session.system->mpLocalMapper->InsertKeyFrame(pKF);
  session.system->mpLocalMapper->EmptyQueue();  // skips bad points, and leaves them where they are
  EXPECT_EQ(Bad(pKF->GetMapPointMatches()), 1);
  ExpectStays(2, 2, 0, 1);
  EXPECT_EQ(Bad(pKF->GetMapPointMatches()), kBad);
}

TEST_F(MiniOrbGraph, A7_4_APointSitsInTwoSlotsWithOneIndex) {
  KeyFrame* const pKF = Add();
  MapPoint* const pMP = Share({pKF}, 1)[0];
  const int once = pMP->Observations();
  pMP->AddObservation(pKF, static_cast<int>(slot));
  pKF->AddMapPoint(pMP, slot);
  EXPECT_GT(pMP->Observations(), once);  // the index was overwritten, the observation counted again
  pMP->SetBadFlag();
  EXPECT_EQ(Bad(pKF->GetMapPointMatches()), 1);
  ExpectStays(1, 0, 0, 1);
  EXPECT_EQ(Bad(pKF->GetMapPointMatches()), kBad);
}

TEST_F(MiniOrbGraph, A7_5_ErasingAnObservationLeavesTheSlot) {
  KeyFrame *const pOrigin = Add(), *const a = Add(), *const b = Add(), *const c = Add();
  MapPoint* const pMP = Share({pOrigin, a, b, c}, 1)[0];
  pMP->EraseObservation(a);
  pMP->SetBadFlag();
  EXPECT_EQ(Bad(a->GetMapPointMatches()), 1);
  ExpectStays(4, 0, 0, 1);
  EXPECT_EQ(Bad(a->GetMapPointMatches()), kBad);
}

// Mapping culls a point that loop closing has matched and then fuses, without a test.
TEST_F(MiniOrbGraph, A7_6_ABadPointGetsNewObservations) {
  KeyFrame *const pOrigin = Add(), *const a = Add();
  MapPoint *const pMatched = Share({pOrigin}, 1)[0], *const pMP = Share({a}, 1)[0];
  pMatched->SetBadFlag();
  pMP->Replace(pMatched);
  EXPECT_TRUE(pMatched->IsInKeyFrame(a));
  EXPECT_EQ(Bad(a->GetMapPointMatches()), 1);
  ExpectStays(2, 0, 0, 2);
  EXPECT_EQ(Bad(a->GetMapPointMatches()), kBad);
}

TEST_F(MiniOrbGraph, A7_7_TwoPointsReplacedEachOther) {
  KeyFrame *const pOrigin = Add(), *const a = Add();
  MapPoint *const p = Share({pOrigin}, 1)[0], *const x = Share({a}, 1)[0];
  p->Replace(x);  // mapping
  x->Replace(p);  // loop closing, later
  EXPECT_EQ(p->GetReplaced(), x);
  EXPECT_EQ(x->GetReplaced(), p);
  ExpectStays(2, 0, 0, 2);
}

TEST_F(MiniOrbGraph, B5_ABadPointKeepsItsReferenceKeyFrame) {
  Add();
  KeyFrame *const a = Add(), *const b = Add();
  MapPoint* const pMP = Share({a, b}, 1)[0];
  pMP->EraseObservation(a);  // one is not enough
  EXPECT_TRUE(pMP->isBad());
  EXPECT_EQ(pMP->GetReferenceKeyFrame(), b);
  b->SetBadFlag();
  ExpectStays(2, 0, 1, 1);
}

// A map's first keyframe, once it is merged into another one, is culled as any other.
TEST_F(MiniOrbGraph, B6_AnErasedKeyFrameStaysAnOrigin) {
  Add();
  KeyFrame* const pKF = Add();
  CurrentMap()->AddKeyFrameOrigin(pKF);
  pKF->SetBadFlag();
  ASSERT_TRUE(session.system->Drain());
  // A bundle adjustment begins there, and asks whether it is bad. It stays as long as the map.
  EXPECT_EQ(Bad(CurrentMap()->GetKeyFrameOrigins()), 1);
  EXPECT_EQ(KeyFrames(), 2);
  CurrentMap()->clear();
  ExpectStays(1, 0, 1, 0);  // mpKFinitial, until the map has another one
}

// The rule of culling counts all who see a point, bad or not, and a purge takes the bad ones out of mObservations. So slamgc may decide
// otherwise once a purge was there; and not before.
class MiniOrbCulling : public MiniOrbGraph {
 protected:
  // How many mapping culls of keyframes whose points are seen by three others, and by a bad one, if that is still there.
  int Culled(bool purged) {
    KeyFrame *const pOrigin = Add(), *const a = Add(), *const b = Add(), *const pBad = Add();
    KeyFrame* const pCurrent = MakeKeyFrame();
    const auto points = Share({pOrigin, a, b, pBad, pCurrent}, 30);
    pBad->SetBadFlag();
    // Meanwhile another thread adds what it sees.
    for (MapPoint* pMP : points)
      pMP->AddObservation(pBad, std::get<0>(pMP->GetIndexInKeyFrame(pOrigin)));
    EXPECT_TRUE(!purged || session.system->Drain());
    session.system->mpLocalMapper->InsertKeyFrame(pCurrent);
    session.system->mpLocalMapper->RunOnce();
    return session.system->GetSummary().culled;
  }
};

TEST_F(MiniOrbCulling, F1_ABadObserverCountsUntilAPurge) { EXPECT_EQ(Culled(false), 1); }

TEST_F(MiniOrbCulling, F1_ABadObserverCountsNoMoreAfterAPurge) {
  EXPECT_EQ(Culled(true), kReclaims ? 0 : 1);
}

}  // namespace
}  // namespace mini_orb
