// mini_orb with the threads of ORB-SLAM3: every path beside every other one, for the sanitizers; and that nothing is left.
#include <gtest/gtest.h>

#include <sstream>
#include <thread>

#include "KeyFrame.h"
#include "LocalMapping.h"
#include "LoopClosing.h"
#include "Map.h"
#include "MapPoint.h"
#include "Session.h"
#include "Tracking.h"

namespace mini_orb {
namespace {

class MiniOrbThreads : public testing::Test {
 protected:
  // As a camera does, it leaves local mapping some time.
  void Drive(int frames) {
    for (; frames != 0; --frames) {
      session.Drive(1);
      while (session.system->mpLocalMapper->KeyframesInQueue() > 2) std::this_thread::yield();
    }
  }
  // Until the condition holds. That it comes to hold is for the test's time limit.
  template <class Condition>
  void DriveUntil(Condition condition) {
    while (!condition()) Drive(1);
  }
  void ExpectNothingAtTheEnd() {
    session.system.reset();
    if (!kReclaims) return;
    EXPECT_EQ(Instances<KeyFrame>::Alive(), keyframes_);
    EXPECT_EQ(Instances<MapPoint>::Alive(), points_);
    EXPECT_EQ(Instances<Map>::Alive(), maps_);
  }

  // What was made since the test began, and what of it is alive.
  long MadeKeyFrames() const { return Instances<KeyFrame>::Made() - made_keyframes_; }
  long MadePoints() const { return Instances<MapPoint>::Made() - made_points_; }
  long KeyFrames() const { return Instances<KeyFrame>::Alive() - keyframes_; }
  long Points() const { return Instances<MapPoint>::Alive() - points_; }

  const long made_keyframes_ = Instances<KeyFrame>::Made();
  const long made_points_ = Instances<MapPoint>::Made();
  const long keyframes_ = Instances<KeyFrame>::Alive();
  const long points_ = Instances<MapPoint>::Alive();
  const long maps_ = Instances<Map>::Alive();
  Session session{60, true};
};

TEST_F(MiniOrbThreads, LapsAndCulling) {
  DriveUntil([&] { return session.system->GetSummary().loops > 0; });
  DriveUntil([&] { return session.system->GetSummary().culled > 10; });
  session.system->Shutdown();
  std::ostringstream trajectory;
  session.system->SaveTrajectory(trajectory);
  EXPECT_FALSE(trajectory.str().empty());
  EXPECT_EQ(session.system->GetSummary().state, Tracking::OK);
  ExpectNothingAtTheEnd();
}

TEST_F(MiniOrbThreads, NewMapAndMerge) {
  Drive(World::kLap);
  DriveUntil([&] { return session.system->GetSummary().keyframes > 10; });
  session.Dark(30);
  DriveUntil([&] { return session.system->GetSummary().merges > 0; });
  Drive(40);
  ExpectNothingAtTheEnd();
}

TEST_F(MiniOrbThreads, Localisation) {
  Drive(World::kLap);
  for (int i = 0; i != 4; ++i) {
    session.system->ActivateLocalizationMode();
    Drive(25);
    session.system->DeactivateLocalizationMode();
    Drive(25);
  }
  ExpectNothingAtTheEnd();
}

// What it works on is in use till it ends, and it goes on beside a reset, and beside the loop that aborts it.
TEST_F(MiniOrbThreads, B13_AGlobalBAOutlivesResets) {
  session.system->mpLoopCloser->mnIterationsGBA = 1000000;  // till it is aborted
  for (int i = 0; i != 2; ++i) {
    DriveUntil([&] { return session.system->mpLoopCloser->isRunningGBA(); });
    Drive(5);
    const auto adjusted = static_cast<long>(session.system->GetSummary().keyframes);
    if (i == 0)
      session.system->ResetActiveMap();
    else
      session.system->Reset();
    Drive(30);
    EXPECT_TRUE(session.system->mpLoopCloser->isRunningGBA());
    EXPECT_GE(KeyFrames(), adjusted / 2);  // those that came after it began may be gone
    EXPECT_FALSE(session.system->GetTrackedMapPoints().empty());
    // The second loop aborts it, and it is detached.
    if (i == 0) DriveUntil([&] { return session.system->GetSummary().abortedGBAs > 0; });
  }
  if (!kReclaims) {
    EXPECT_GE(Instances<Map>::Alive() - maps_, 2);
  }
  ExpectNothingAtTheEnd();
}

TEST_F(MiniOrbThreads, ShutdownInEachState) {
  for (const int frames : {0, 1, 5, 60, 170}) {
    session.system = std::make_unique<System>(true);
    session.Drive(frames);
    if (frames > 5) session.system->ActivateLocalizationMode();
    session.Dark(frames / 4);
  }
  ExpectNothingAtTheEnd();
}

// Hours of driving round the same track, as fast as it goes. After each lap, and with all threads at work, what is alive comes
// down to what the map holds, and a few that are on their way: a leak would never let it.
TEST_F(MiniOrbThreads, ALongSessionStaysFlat) {
  if (!kReclaims) GTEST_SKIP() << "the plain build grows with each lap";
  constexpr int kLaps = 12;
  DriveUntil([&] { return session.system->GetSummary().culled > 10; });
  const auto known = session.system->GetSummary();
  for (int lap = 0; lap != kLaps; ++lap) {
    Drive(World::kLap);
    DriveUntil([&] {
      const auto now = session.system->GetSummary();
      return KeyFrames() - static_cast<long>(now.keyframes) <= 10 &&
             Points() - static_cast<long>(now.points) <= 100;
    });
  }
  DriveUntil([&] { return session.system->GetSummary().culled > known.culled + 2 * kLaps; });
  ASSERT_TRUE(session.system->Drain());
  EXPECT_LE(KeyFrames() - static_cast<long>(session.system->GetSummary().keyframes), 3);
  ExpectNothingAtTheEnd();
}

// What was marked goes while all threads are at work, but for one in a hundred at most, and the few that are in use.
TEST_F(MiniOrbThreads, WhatIsMarkedGoesMeanwhile) {
  if (!kReclaims) GTEST_SKIP() << "the plain build frees nothing";
  DriveUntil([&] { return session.system->GetSummary().culled > 20; });
  const auto then = session.system->GetSummary();
  const long keyframes = MadeKeyFrames() - static_cast<long>(then.keyframes) - 3;  // in the queue
  const long points = MadePoints() - static_cast<long>(then.points);
  ASSERT_GT(points, 100);
  DriveUntil([&] {
    return 100 * (MadeKeyFrames() - KeyFrames()) >= 99 * keyframes &&
           100 * (MadePoints() - Points()) >= 99 * points;
  });
}

TEST_F(MiniOrbThreads, NothingEndsOnTheTrackingThread) {
  if (!kReclaims) GTEST_SKIP() << "the plain build deletes points of localisation there";
  std::thread([&] {
    Instances<KeyFrame>::ForbidHere();
    Instances<MapPoint>::ForbidHere();
    Instances<Map>::ForbidHere();
    Session here{60, true};
    session.system.swap(here.system);
    DriveUntil([&] { return session.system->GetSummary().culled > 10; });
    session.system->ActivateLocalizationMode();
    Drive(30);
    session.system->DeactivateLocalizationMode();
    session.system->ResetActiveMap();
    Drive(30);
    session.system->Reset();
    Drive(30);
    // The reclaimer has a thread of its own, and rests in between.
    DriveUntil([&] { return MadeKeyFrames() - KeyFrames() > 10; });
    session.system.swap(here.system);
    EXPECT_EQ(Instances<KeyFrame>::EndedWhereForbidden(), 0);
    EXPECT_EQ(Instances<MapPoint>::EndedWhereForbidden(), 0);
    EXPECT_EQ(Instances<Map>::EndedWhereForbidden(), 0);
  }).join();
}

}  // namespace
}  // namespace mini_orb
