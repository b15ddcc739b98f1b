// A3, B14.1: the trajectory refers to the reference keyframe of each frame, for ever.
#include <gtest/gtest.h>

#include <vector>

#include "world.hpp"

namespace {

using namespace orb_slam3;

// Two frames per keyframe; then every second keyframe is culled, and some of their parents.
template <class S, class F>
void drive_and_cull(World<S>& w, F before_culling) {
  for (int i = 0; i != 12; ++i) {
    w.keyframe();
    KeyFrame<S>* const kf = w.kf(i);
    kf->mTcw = {1 + 0.1 * i, 0.3 * i};
    if (i != 0) kf->ChangeParent(w.kf(i - 1));
    w.threads.on_tracking([&] {
      w->tracking.mpReferenceKF = kf;
      for (int frame = 0; frame != 2; ++frame)
        w->tracking.add_to_trajectory({1, 0.01 * i + 0.001 * frame});
    });
  }
  before_culling();
  for (long id : {9, 7, 5, 3, 8, 4, 6}) {
    w.kf(id)->SetBadFlag();
    w.threads.settle();
  }
}
template <class S>
void drive_and_cull(World<S>& w) {
  drive_and_cull(w, [] {});
}
template <class S>
std::vector<Pose> trajectory(World<S>& w) {
  std::vector<Pose> poses;
  w.threads.on_tracking([&] { poses = w->tracking.SaveTrajectory(); });
  return poses;
}

TEST(A3_Trajectory, A3_EachFrameKeepsItsReferenceKeyFrame) {
  std::vector<Pose> today;
  {
    World<plain> w;
    drive_and_cull(w);
    today = trajectory(w);
    EXPECT_EQ(w.bad(), 7u);
    EXPECT_EQ(found.freed_used, 0);
    w.free_bad();
    (void)trajectory(w);
    EXPECT_GE(found.freed_used, 2 * 7);
  }
  {
    World<shared> w;
    drive_and_cull(w);
    EXPECT_EQ(trajectory(w), today);
    EXPECT_EQ(w.bad(), 7u);
  }
  World<counted> w;
  drive_and_cull(w);
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.keyframes(), 5u);
  EXPECT_EQ(trajectory(w), today);  // bit by bit
}

// A bad keyframe that a thread still uses keeps the parent that its pose is relative to, and that one its own.
TEST(A3_Trajectory, A3_AHeldKeyFrameKeepsItsParents) {
  std::vector<Pose> today;
  {
    World<plain> w;
    drive_and_cull(w);
    today = trajectory(w);
  }
  World<counted> w;
  slamgc::pin<KeyFrame<counted>> held;
  drive_and_cull(w, [&] { held = w.kf(9); });
  EXPECT_EQ(w.bad(),
            3u);  // 9, its parent 8, and 6, which was the parent of that when it was culled
  EXPECT_EQ(trajectory(w), today);
  held = nullptr;
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(trajectory(w), today);
}

}  // namespace
