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

TEST_F(MiniOrbThreads, ResetsBesideAGlobalBA) {
  session.system->mpLoopCloser->mnIterationsGBA = 1000000;  // till it is aborted
  for (int i = 0; i != 2; ++i) {
    DriveUntil([&] { return session.system->mpLoopCloser->isRunningGBA(); });
    Drive(5);
    if (i == 0)
      session.system->ResetActiveMap();
    else
      session.system->Reset();
    Drive(30);
    EXPECT_TRUE(session.system->mpLoopCloser->isRunningGBA());
    EXPECT_FALSE(session.system->GetTrackedMapPoints().empty());
    // The second loop aborts it, and it is detached.
    if (i == 0) DriveUntil([&] { return session.system->GetSummary().abortedGBAs > 0; });
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

}  // namespace
}  // namespace mini_orb
