// The adapter on classes with ORB-SLAM2's members: one map that is no object, no temporal links, no merge edges.
#include <slamgc/adapters/orb_slam3.hpp>

#include <gtest/gtest.h>

#include <list>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include "support/instances.hpp"

namespace {

using slamgc::waited;
using slamgc::orb_slam3::access;
using slamgc::orb_slam3::frame;
using slamgc::orb_slam3::session;

class Map;
class MapPoint;

// As cv::Mat: nothing by default.
struct Mat {
  std::vector<double> values;
  friend Mat operator*(const Mat& a, const Mat& b) { return {{a.values.at(0) * b.values.at(0)}}; }
};

class KeyFrame : public slamgc::orb_slam3::keyframe_base<KeyFrame, Mat>,
                 public support::instances<KeyFrame> {
  friend access;

 public:
  bool isBad() { return mbBad; }
  KeyFrame* GetParent() { return mpParent; }
  Mat GetPose() { return {{3}}; }
  void SetBadFlag() {
    mbBad = true;
    slamgc::retire(this);
  }
  unsigned long mnId = 0;
  Mat mTcp{{5}};
  slamgc::rc_slot<KeyFrame> mpParent;
  Map* mpMap = nullptr;

 private:
  bool mbBad = false;
  std::mutex mMutexConnections, mMutexFeatures;
  slamgc::rc_vector<MapPoint> mvpMapPoints;
  slamgc::rc_map<KeyFrame, int> mConnectedKeyFrameWeights;
  slamgc::rc_vector<KeyFrame> mvpOrderedConnectedKeyFrames;
  std::vector<int> mvOrderedWeights;
  slamgc::rc_set<KeyFrame> mspChildrens, mspLoopEdges;
};

class MapPoint : public slamgc::orb_slam3::map_point_base<MapPoint> {
  friend access;
  std::mutex mMutexFeatures;
  slamgc::rc_map<KeyFrame, std::size_t> mObservations;
  slamgc::rc_slot<KeyFrame> mpRefKF;
  slamgc::rc_slot<MapPoint> mpReplaced;
  Map* mpMap = nullptr;

 public:
  unsigned long mnId = 0;
};

class Map {
  friend access;

 public:
  void AddKeyFrame(KeyFrame* pKF) {
    const std::lock_guard<std::mutex> lock(mMutexMap);
    mspKeyFrames.insert(pKF);
  }
  void EraseKeyFrame(KeyFrame* pKF) {
    const std::lock_guard<std::mutex> lock(mMutexMap);
    mspKeyFrames.erase(pKF);
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mMutexMap);
    mspKeyFrames.clear();
    mspMapPoints.clear();
  }

 private:
  slamgc::registry<slamgc::rc_set<KeyFrame>> mspKeyFrames;
  slamgc::registry<slamgc::rc_set<MapPoint>> mspMapPoints;
  slamgc::rc_vector<KeyFrame> mvpKeyFrameOrigins;
  slamgc::rc_vector<MapPoint> mvpReferenceMapPoints;
  std::mutex mMutexMap;
};

struct Frame {
  slamgc::rc_vector<MapPoint> mvpMapPoints;
  slamgc::rc_slot<KeyFrame> mpReferenceKF;
};

struct Tracking {
  Frame mCurrentFrame, mLastFrame, mInitialFrame;
  std::list<slamgc::orb_slam3::trajectory_reference<KeyFrame, Mat>> mlpReferences;
  slamgc::rc_slot<KeyFrame> mpReferenceKF, mpLastKeyFrame;
  slamgc::rc_vector<KeyFrame> mvpLocalKeyFrames;
  slamgc::rc_vector<MapPoint> mvpLocalMapPoints;
  slamgc::registry<slamgc::rc_list<MapPoint>> mlpTemporalPoints;
};

struct LoopClosing {
  using ConsistentGroup = std::pair<slamgc::rc_set<KeyFrame>, int>;
  slamgc::rc_list<KeyFrame> mlpLoopKeyFrameQueue;
  std::mutex mMutexLoopQueue;
  slamgc::rc_slot<KeyFrame> mpCurrentKF, mpMatchedKF;
  std::vector<ConsistentGroup> mvConsistentGroups;
  slamgc::rc_vector<KeyFrame> mvpEnoughConsistentCandidates, mvpCurrentConnectedKFs;
  slamgc::rc_vector<MapPoint> mvpCurrentMatchedPoints, mvpLoopMapPoints;
};

struct LocalMapping {
  slamgc::registry<slamgc::rc_list<KeyFrame>> mlNewKeyFrames;
  slamgc::rc_slot<KeyFrame> mpCurrentKeyFrame;
  slamgc::rc_list<MapPoint> mlpRecentAddedMapPoints;
  std::mutex mMutexNewKFs;
};

struct Viewer {
  void RequestFinish() {}
};

// Its Shutdown() waits for the threads, does not join them, and may be called again.
struct System {
  void Shutdown() { ++shut_downs; }
  int shut_downs = 0;
  Tracking* mpTracker;
  Map* mpMap;
  LocalMapping* mpLocalMapper;
  LoopClosing* mpLoopCloser;
  Viewer* mpViewer = nullptr;
  std::thread *mptLocalMapping, *mptLoopClosing, *mptViewer = nullptr;
  slamgc::rc_vector<MapPoint> mTrackedMapPoints;
  std::mutex mMutexState;
};

class OrbSlam2Adapter : public ::testing::Test {
 protected:
  Tracking tracker;
  Map map;
  LoopClosing closer;
  session slamgc_;
};

TEST_F(OrbSlam2Adapter, LoopClosingForgetsWhatIsBad) {
  slamgc_.add(tracker, map);
  slamgc_.own(closer);
  {
    const frame here(slamgc_);
    auto* const root = new KeyFrame;
    auto* const pKF = new KeyFrame;
    map.AddKeyFrame(root);
    pKF->mpParent = root;
    closer.mpMatchedKF = pKF;
    closer.mvConsistentGroups.emplace_back();
    closer.mvConsistentGroups[0].first.insert(pKF);
    closer.mvConsistentGroups[0].first.insert(root);
    closer.mvpEnoughConsistentCandidates.push_back(pKF);
    tracker.mlpReferences.push_back(pKF);
    pKF->SetBadFlag();
  }
  EXPECT_EQ(slamgc_.drain(), waited::done);
  EXPECT_EQ(KeyFrame::live(), 1);
  EXPECT_EQ(closer.mpMatchedKF, nullptr);
  EXPECT_EQ(closer.mvConsistentGroups[0].first.size(), 1u);
  {
    const frame here(slamgc_);
    Mat Trw{{1}};
    EXPECT_NE(tracker.mlpReferences.back().walk(Trw), nullptr);
    EXPECT_EQ(Trw.values[0], 5);
    EXPECT_EQ(tracker.mlpReferences.back().Trw({{1}}).values[0], 15);
  }
  EXPECT_EQ(slamgc_.end(tracker, closer, map), waited::done);
  EXPECT_EQ(KeyFrame::live(), 0);
}

TEST_F(OrbSlam2Adapter, ASystemEndsWithItsThreads) {
  LocalMapping mapper;
  Viewer viewer;
  std::thread mapping([] {}), closing([] {}), viewing([] {});
  System system;
  system.mpTracker = &tracker;
  system.mpMap = &map;
  system.mpLocalMapper = &mapper;
  system.mpLoopCloser = &closer;
  system.mpViewer = &viewer;
  system.mptLocalMapping = &mapping;
  system.mptLoopClosing = &closing;
  system.mptViewer = &viewing;
  slamgc_.start(system);
  {
    const frame here(slamgc_);
    auto* const pKF = new KeyFrame;
    map.AddKeyFrame(pKF);
    tracker.mvpLocalKeyFrames.push_back(pKF);
    mapper.mpCurrentKeyFrame = pKF;
    closer.mlpLoopKeyFrameQueue.push_back(pKF);
  }
  closing.join();  // by the program itself
  EXPECT_EQ(slamgc_.end(system), waited::done);
  EXPECT_EQ(system.shut_downs, 1);
  EXPECT_FALSE(mapping.joinable());
  EXPECT_FALSE(viewing.joinable());
  EXPECT_EQ(KeyFrame::live(), 0);
}

}  // namespace
