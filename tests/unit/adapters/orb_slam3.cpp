// The adapter on classes that have ORB-SLAM3's members and nothing else; examples/mini_orb has the whole of it.
#include <slamgc/adapters/orb_slam3.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <list>
#include <map>
#include <mutex>
#include <set>
#include <slamgc/diagnosis/audit.hpp>
#include <thread>
#include <tuple>
#include <vector>

#include "support/instances.hpp"

namespace {

using slamgc::waited;
using slamgc::orb_slam3::access;
using slamgc::orb_slam3::adjusting;
using slamgc::orb_slam3::adjustment;
using slamgc::orb_slam3::frame;
using slamgc::orb_slam3::session;

class KeyFrame;
class Map;
class MapPoint;

// Moves do not commute: the order of multiplications shows.
struct Pose {
  double scale = 1, shift = 0;
  friend Pose operator*(const Pose& a, const Pose& b) {
    return {a.scale * b.scale, a.scale * b.shift + a.shift};
  }
  friend bool operator==(const Pose& a, const Pose& b) {
    return a.scale == b.scale && a.shift == b.shift;
  }
};
using reference = slamgc::orb_slam3::trajectory_reference<KeyFrame, Pose>;

class KeyFrame : public slamgc::orb_slam3::keyframe_base<KeyFrame, Pose>,
                 public support::instances<KeyFrame> {
  friend access;

 public:
  explicit KeyFrame(unsigned long id) : mnId(id), Tcw{1 + 0.25 * static_cast<double>(id), 3} {}
  bool isBad() {
    const std::lock_guard<std::mutex> lock(mMutexConnections);
    return mbBad;
  }
  KeyFrame* GetParent() {
    const std::lock_guard<std::mutex> lock(mMutexConnections);
    return mpParent;
  }
  Pose GetPose() const { return Tcw; }
  void SetParent(KeyFrame* pKF) {
    const std::lock_guard<std::mutex> lock(mMutexConnections);
    mpParent = pKF;
  }
  void SetBadFlag() {
    {
      const std::lock_guard<std::mutex> lock(mMutexConnections);
      mbBad = true;
    }
    slamgc::retire(this);
  }
  std::set<KeyFrame*> GetChilds() {
    const std::lock_guard<std::mutex> lock(mMutexConnections);
    return mspChildrens;
  }

  const unsigned long mnId;
  Pose mTcp{0.5, 2};
  const Pose Tcw;
  slamgc::rc_slot<KeyFrame> mPrevKF, mNextKF;
  std::mutex mMutexConnections, mMutexFeatures, mMutexMap;
  slamgc::rc_slot<Map> mpMap;

 private:
  bool mbBad = false;
  slamgc::rc_vector<MapPoint> mvpMapPoints;
  slamgc::rc_map<KeyFrame, int> mConnectedKeyFrameWeights;
  slamgc::rc_vector<KeyFrame> mvpOrderedConnectedKeyFrames;
  std::vector<int> mvOrderedWeights;
  slamgc::rc_slot<KeyFrame> mpParent;
  slamgc::rc_set<KeyFrame> mspChildrens, mspLoopEdges, mspMergeEdges;
};

class MapPoint : public slamgc::orb_slam3::map_point_base<MapPoint>,
                 public support::instances<MapPoint> {
  friend access;

 public:
  void Observe(KeyFrame* pKF) {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    mObservations[pKF] = std::make_tuple(0, -1);
    if (mpRefKF == nullptr) mpRefKF = pKF;
  }
  KeyFrame* GetReferenceKeyFrame() {
    const std::lock_guard<std::mutex> lock(mMutexFeatures);
    return mpRefKF;
  }
  unsigned long mnId = 0;
  std::mutex mMutexFeatures, mMutexMap;
  slamgc::rc_slot<Map> mpMap;

 private:
  slamgc::rc_map<KeyFrame, std::tuple<int, int>> mObservations;
  slamgc::rc_slot<KeyFrame> mpRefKF;
  slamgc::rc_slot<MapPoint> mpReplaced;
};

class Map : public slamgc::orb_slam3::map_base<Map>, public support::instances<Map> {
  friend access;

 public:
  void AddKeyFrame(KeyFrame* pKF) {
    const std::lock_guard<std::mutex> lock(mMutexMap);
    mspKeyFrames.insert(pKF);
    pKF->mpMap = this;
  }
  void AddMapPoint(MapPoint* pMP) {
    const std::lock_guard<std::mutex> lock(mMutexMap);
    mspMapPoints.insert(pMP);
    pMP->mpMap = this;
  }
  void EraseKeyFrame(KeyFrame* pKF) {
    const std::lock_guard<std::mutex> lock(mMutexMap);
    mspKeyFrames.erase(pKF);
  }
  void clear() {
    const std::lock_guard<std::mutex> lock(mMutexMap);
    for (KeyFrame* pKF : mspKeyFrames) pKF->mpMap = nullptr;
    mspKeyFrames.clear();
    mspMapPoints.clear();
  }

 private:
  slamgc::registry<slamgc::rc_set<KeyFrame>> mspKeyFrames;
  slamgc::registry<slamgc::rc_set<MapPoint>> mspMapPoints;
  slamgc::rc_vector<KeyFrame> mvpKeyFrameOrigins;
  slamgc::rc_vector<MapPoint> mvpReferenceMapPoints;
  slamgc::rc_slot<KeyFrame> mpKFinitial, mpKFlowerID;
  std::mutex mMutexMap;
};

class Atlas {
  friend access;

 public:
  Map* CreateNewMap() {
    const std::lock_guard<std::mutex> lock(mMutexAtlas);
    mpCurrentMap = new Map;
    mspMaps.insert(mpCurrentMap);
    return mpCurrentMap;
  }
  void clearAtlas() {
    const std::lock_guard<std::mutex> lock(mMutexAtlas);
    for (Map* pMap : mspMaps) pMap->clear();
    mspMaps.clear();
    mpCurrentMap = nullptr;
  }
  void RemoveBadMaps() {
    const std::lock_guard<std::mutex> lock(mMutexAtlas);
    mspBadMaps.clear();
  }

 private:
  slamgc::registry<slamgc::rc_set<Map>> mspMaps, mspBadMaps;
  slamgc::rc_slot<Map> mpCurrentMap;
  std::mutex mMutexAtlas;
};

struct Frame {
  slamgc::rc_vector<MapPoint> mvpMapPoints;
  slamgc::rc_slot<KeyFrame> mpReferenceKF, mpLastKeyFrame;
};

class Tracking {
  friend access;

 public:
  Frame mCurrentFrame, mLastFrame, mInitialFrame;
  std::list<reference> mlpReferences;
  slamgc::rc_vector<KeyFrame> mvpLocalKeyFrames;
  std::vector<MapPoint*> mvpLocalMapPoints;  // the end of a frame empties it
  Atlas* mpAtlas = nullptr;

 private:
  slamgc::rc_slot<KeyFrame> mpReferenceKF, mpLastKeyFrame;
  slamgc::registry<slamgc::rc_list<MapPoint>> mlpTemporalPoints;
};

// The rest of it is as dead as mvConsistentGroups is in ORB-SLAM3.
class LoopClosing {
  friend access;

 public:
  // What it finds in one round it uses in that round.
  void Round(KeyFrame* pKF, MapPoint* pMP) {
    mpCurrentKF = pKF;
    mvpLoopMPs = {pMP};
    mpLoopMatchedKF = mpCurrentKF;
    mpMergeMatchedKF = mpCurrentKF;
  }
  bool IsEmpty() const { return mpCurrentKF == nullptr && mvpLoopMPs.empty(); }
  KeyFrame* Matched() const { return mpLoopMatchedKF; }
  bool IsToStop() {
    const std::lock_guard<std::mutex> lock(mMutexGBA);
    return mbStopGBA;
  }

 private:
  slamgc::rc_list<KeyFrame> mlpLoopKeyFrameQueue;
  std::mutex mMutexLoopQueue, mMutexGBA;
  KeyFrame* mpCurrentKF = nullptr;
  std::vector<MapPoint*> mvpLoopMPs;
  std::vector<std::pair<std::set<KeyFrame*>, int>> mvConsistentGroups;
  slamgc::rc_slot<KeyFrame> mpLoopMatchedKF, mpMergeMatchedKF;
  bool mbStopGBA = false;
};

class LocalMapping {
  friend access;

 public:
  slamgc::rc_list<MapPoint> mlpRecentAddedMapPoints;

 private:
  slamgc::registry<slamgc::rc_list<KeyFrame>> mlNewKeyFrames;
  slamgc::rc_slot<KeyFrame> mpCurrentKeyFrame;
  std::mutex mMutexNewKFs;
};

class FrameDrawer {
  friend access;
  Frame mCurrentFrame;
  std::vector<MapPoint*> mvpLocalMap;
  std::mutex mMutex;
};

// What a Viewer has of a thread.
class Viewer {
 public:
  void RequestFinish() { finish_ = true; }
  void Run() {
    while (!finish_) std::this_thread::yield();
  }

 private:
  std::atomic<bool> finish_{false};
};

class System {
  friend access;

 public:
  System(bool with_threads, bool with_viewer, waited& ended) : ended_(ended) {
    if (with_threads) {
      mptLocalMapping = new std::thread([this] { Run("LocalMapping", mapper_, finish_mapping_); });
      mptLoopClosing = new std::thread([this] { Run("LoopClosing", closer_, finish_closing_); });
    }
    if (with_viewer) {
      mpViewer = &viewer_;
      mptViewer = new std::thread(&Viewer::Run, mpViewer);
    }
    mSlamgc.start(*this);
  }
  ~System() {
    End();
    delete mptLocalMapping;
    delete mptLoopClosing;
    delete mptViewer;
  }
  void End() { ended_ = mSlamgc.end(*this); }
  void Track() {
    const frame here(mSlamgc);
    if (map_ == nullptr) map_ = mpAtlas->CreateNewMap();
    auto* const pKF = new KeyFrame(0);
    auto* const pMP = new MapPoint;
    map_->AddKeyFrame(pKF);
    map_->AddMapPoint(pMP);
    mpTracker->mvpLocalKeyFrames.push_back(pKF);
    mpTracker->mvpLocalMapPoints.push_back(pMP);
    mTrackedMapPoints.push_back(pMP);
    mapper_.mlpRecentAddedMapPoints.push_back(pMP);
  }
  bool isShutDown() const { return shut_down_ != 0; }
  void Shutdown() {
    EXPECT_EQ(++shut_down_, 1);
    mSlamgc.stop();
    finish_mapping_.set_value();
    finish_closing_.set_value();
  }

 private:
  template <class Part>
  void Run(const char* name, Part& part, std::promise<void>& finish) {
    const slamgc::orb_slam3::thread me(name, part);
    finish.get_future().wait();
  }

  waited& ended_;
  int shut_down_ = 0;
  Tracking tracker_;
  Atlas atlas_;
  FrameDrawer drawer_;
  LocalMapping mapper_;
  LoopClosing closer_;
  Viewer viewer_;
  Map* map_ = nullptr;
  std::promise<void> finish_mapping_, finish_closing_;
  Tracking* mpTracker = &tracker_;
  Atlas* mpAtlas = &atlas_;
  FrameDrawer* mpFrameDrawer = &drawer_;
  LocalMapping* mpLocalMapper = &mapper_;
  LoopClosing* mpLoopCloser = &closer_;
  Viewer* mpViewer = nullptr;
  std::thread *mptLocalMapping = nullptr, *mptLoopClosing = nullptr, *mptViewer = nullptr;
  slamgc::rc_vector<MapPoint> mTrackedMapPoints;
  std::mutex mMutexState;
  session mSlamgc;
};

class OrbSlam3Adapter : public ::testing::Test {
 protected:
  OrbSlam3Adapter() { slamgc_.add(tracker, atlas); }
  ~OrbSlam3Adapter() override {
    EXPECT_EQ(slamgc_.end(tracker, atlas), waited::done);
    EXPECT_EQ(KeyFrame::live(), 0);
    EXPECT_EQ(MapPoint::live(), 0);
    EXPECT_EQ(Map::live(), 0);
  }
  // A good keyframe in the map.
  KeyFrame* Good(unsigned long id) {
    auto* const pKF = new KeyFrame(id);
    map->AddKeyFrame(pKF);
    return pKF;
  }
  void Cull(KeyFrame* pKF) {
    map->EraseKeyFrame(pKF);
    pKF->SetBadFlag();
  }

  Tracking tracker;
  Atlas atlas;
  Map* map = nullptr;
  session slamgc_;
};

TEST_F(OrbSlam3Adapter, TheTrajectoryPassesFromRecordToRecord) {
  Pose expected{2, 1}, whole;
  {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    KeyFrame* const first = Good(0);
    KeyFrame* const second = Good(1);
    KeyFrame* const third = Good(2);
    third->SetParent(second);
    second->SetParent(first);
    second->mTcp = {0.75, 5};
    tracker.mlpReferences.push_back(third);
    Pose Trw{2, 1};
    EXPECT_EQ(tracker.mlpReferences.back().walk(Trw), third);
    EXPECT_EQ(Trw, expected);
    Cull(second);
    Cull(third);
    expected = expected * third->mTcp * second->mTcp;
    EXPECT_EQ(tracker.mlpReferences.back().walk(Trw), first);
    EXPECT_EQ(Trw, expected);
    whole = Pose() * third->mTcp * second->mTcp * first->GetPose();
  }
  EXPECT_EQ(slamgc_.drain(), waited::done);
  EXPECT_EQ(KeyFrame::live(), 1);
  {
    const frame here(slamgc_);
    Pose Trw{2, 1};
    KeyFrame* const end = tracker.mlpReferences.back().walk(Trw);
    ASSERT_NE(end, nullptr);
    EXPECT_EQ(end->mnId, 0u);
    EXPECT_EQ(Trw, expected);
    EXPECT_EQ(tracker.mlpReferences.back().walk(), end);
    EXPECT_EQ(tracker.mlpReferences.back().Trw(), whole);
    map->clear();
  }
  EXPECT_EQ(slamgc_.drain(), waited::done);
  EXPECT_EQ(KeyFrame::live(), 0);
  const frame here(slamgc_);
  EXPECT_EQ(tracker.mlpReferences.back().walk(), nullptr);
  EXPECT_EQ(tracker.mlpReferences.back().Trw(), whole);
  EXPECT_FALSE(reference());
}

TEST_F(OrbSlam3Adapter, ABadParentIsPassedOver) {
  KeyFrame *root, *child;
  {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    root = Good(0);
    KeyFrame* const bad = Good(1);
    child = Good(2);
    bad->SetParent(root);
    child->SetParent(bad);
    Cull(bad);
  }
  EXPECT_EQ(slamgc_.drain(), waited::done);
  EXPECT_EQ(KeyFrame::live(), 2);
  EXPECT_EQ(child->GetParent(), root);
  EXPECT_EQ(root->GetChilds(), std::set<KeyFrame*>{child});
}

// ORB-SLAM3 locks a keyframe and then its child. ThreadSanitizer would report a collector that does it the other way round.
TEST_F(OrbSlam3Adapter, ACollectorDoesNotWaitForTheNextParent) {
  KeyFrame *root, *child;
  {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    root = Good(0);
    KeyFrame* const bad = Good(1);
    child = Good(2);
    bad->SetParent(root);
    child->SetParent(bad);
    const std::lock_guard<std::mutex> first(root->mMutexConnections);
    const std::lock_guard<std::mutex> second(child->mMutexConnections);
  }
  {
    const frame here(slamgc_);
    Cull(child->GetParent());
  }
  EXPECT_EQ(slamgc_.drain(), waited::done);
  EXPECT_EQ(child->GetParent(), root);
}

TEST_F(OrbSlam3Adapter, AReferenceKeyFrameIsReplacedByTheFirstObserver) {
  MapPoint* point;
  KeyFrame* other;
  {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    KeyFrame* const reference_keyframe = Good(0);
    other = Good(1);
    point = new MapPoint;
    map->AddMapPoint(point);
    point->Observe(reference_keyframe);
    point->Observe(other);
    Cull(reference_keyframe);
  }
  EXPECT_EQ(slamgc_.drain(), waited::done);
  EXPECT_EQ(point->GetReferenceKeyFrame(), other);
  EXPECT_EQ(KeyFrame::live(), 1);
  EXPECT_TRUE(slamgc::audit(slamgc::default_domain(), {true, std::chrono::seconds(1)}).agrees());
}

// A keyframe that was dropped with a queue, and not marked: its points stay good, and the program asks them for it.
TEST_F(OrbSlam3Adapter, AGoodPointKeepsItsOnlyReferenceKeyFrame) {
  MapPoint* point;
  {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    KeyFrame* const dropped = Good(0);
    point = new MapPoint;
    map->AddMapPoint(point);
    point->Observe(dropped);
    map->EraseKeyFrame(dropped);
    slamgc::retire(dropped);
  }
  EXPECT_EQ(slamgc_.drain(), waited::done);
  ASSERT_NE(point->GetReferenceKeyFrame(), nullptr);
  EXPECT_EQ(point->GetReferenceKeyFrame()->mnId, 0u);
}

TEST_F(OrbSlam3Adapter, AFrameMayBeTrackedByAnyThread) {
  std::thread([&] {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    tracker.mvpLocalKeyFrames.push_back(Good(0));
  }).join();
  {
    const frame here(slamgc_);
    Cull(tracker.mvpLocalKeyFrames[0]);
  }
  EXPECT_EQ(slamgc_.drain(), waited::done);  // purges what the tracker alone may touch
  EXPECT_EQ(KeyFrame::live(), 0);
  EXPECT_TRUE(tracker.mvpLocalKeyFrames.empty());
}

TEST_F(OrbSlam3Adapter, AnAdjustmentPinsWhatItNeedsAndDelaysNobody) {
  std::thread adjuster;
  std::promise<void> begun, solved;
  bool pinned_is_alive = false;
  std::vector<KeyFrame*> problem;
  {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    problem.push_back(Good(7));
    const auto adjust = [&](Map* pMap) {
      EXPECT_NE(pMap, nullptr);
      adjustment::optimize(
          [&] {
            begun.set_value();
            solved.get_future().wait();
          },
          problem);
      pinned_is_alive = problem[0]->mnId == 7;
    };
    adjuster = std::thread(adjusting(map, adjust, map));
    begun.get_future().wait();
    Cull(problem[0]);
    KeyFrame* const other = Good(8);
    Cull(other);
  }
  EXPECT_EQ(slamgc_.drain(), waited::done);
  EXPECT_EQ(KeyFrame::live(), 1);
  solved.set_value();
  adjuster.join();
  EXPECT_TRUE(pinned_is_alive);
  EXPECT_EQ(slamgc_.drain(), waited::done);
  EXPECT_EQ(KeyFrame::live(), 0);
}

TEST_F(OrbSlam3Adapter, ALoopCloserIsEmptiedOfWhatItDoesNotCount) {
  LoopClosing closer;
  KeyFrame* good = nullptr;
  std::thread([&] {
    slamgc::orb_slam3::thread me("LoopClosing", closer);
    {
      const frame here(slamgc_);
      map = atlas.CreateNewMap();
      good = Good(0);
    }
    auto* const point = new MapPoint;
    map->AddMapPoint(point);
    closer.Round(good, point);
    EXPECT_FALSE(closer.IsEmpty());
    me.usleep(0);
    EXPECT_TRUE(closer.IsEmpty());
    EXPECT_EQ(closer.Matched(), good);
    closer.Round(good, point);
    me.quiescent();
    EXPECT_TRUE(closer.IsEmpty());
    Cull(good);
    me.quiescent();
    EXPECT_EQ(closer.Matched(), good);  // no collector has been there
  }).join();
  access::whole_system::clear(closer);
  EXPECT_EQ(closer.Matched(), nullptr);
  EXPECT_EQ(slamgc_.drain(), waited::done);
  EXPECT_EQ(KeyFrame::live(), 0);
}

TEST_F(OrbSlam3Adapter, TheEndOfAFrameEmptiesWhatTheTrackerDoesNotCount) {
  {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    auto* const point = new MapPoint;
    map->AddMapPoint(point);
    tracker.mvpLocalMapPoints.push_back(point);
    tracker.mvpLocalKeyFrames.push_back(Good(0));
    { const frame inner(slamgc_); }
    EXPECT_EQ(tracker.mvpLocalMapPoints.size(), 1u);  // not yet over
  }
  EXPECT_TRUE(tracker.mvpLocalMapPoints.empty());
  EXPECT_EQ(tracker.mvpLocalKeyFrames.size(), 1u);  // counted: stays
}

TEST_F(OrbSlam3Adapter, TheEndStopsAnAdjustmentAndWaitsForIt) {
  LoopClosing closer;
  std::thread adjuster;
  std::promise<void> begun;
  bool through = false;
  {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    adjuster = std::thread(adjusting(map, [&] {
      begun.set_value();
      while (!closer.IsToStop()) std::this_thread::yield();
      through = true;
    }));
  }
  begun.get_future().wait();
  EXPECT_EQ(slamgc_.end(tracker, atlas, closer), waited::done);
  EXPECT_TRUE(through);  // written before the adjustment ended
  EXPECT_EQ(Map::live(), 0);
  adjuster.join();
}

// Another thread holds pointers all the while.
TEST_F(OrbSlam3Adapter, DrainingEndsInTime) {
  std::promise<void> online, through;
  std::thread busy([&] {
    slamgc::orb_slam3::thread me("busy");
    online.set_value();
    through.get_future().wait();
  });
  online.get_future().wait();
  {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    Cull(Good(1));
  }
  EXPECT_EQ(slamgc_.drain(std::chrono::milliseconds(1)), waited::timed_out);
  EXPECT_EQ(KeyFrame::live(), 1);
  through.set_value();
  busy.join();
  EXPECT_EQ(slamgc_.drain(), waited::done);
  EXPECT_EQ(KeyFrame::live(), 0);
}

TEST_F(OrbSlam3Adapter, OtherThreadsJustOptimize) {
  const frame here(slamgc_);
  map = atlas.CreateNewMap();
  const std::vector<KeyFrame*> problem{Good(1)};
  int runs = 0;
  adjustment::optimize([&] { ++runs; }, problem);
  EXPECT_EQ(runs, 1);
  EXPECT_EQ(problem[0]->use_count(), 1u);
}

TEST_F(OrbSlam3Adapter, AReclaimerOfItsOwn) {
  slamgc_.start();
  {
    const frame here(slamgc_);
    map = atlas.CreateNewMap();
    for (unsigned long i = 0; i != 100; ++i) Cull(Good(i));
  }
  while (KeyFrame::live() != 0) std::this_thread::yield();
  slamgc_.stop();
  const frame here(slamgc_);
  Cull(Good(0));
  EXPECT_EQ(slamgc_.drain(), waited::refused);
}

// A program without threads of its own calls what they do itself; and an end may come before the destructor's.
TEST(OrbSlam3AdapterAlone, ASystemEndsWithItsThreads) {
  for (int bits = 0; bits != 16; ++bits) {
    const bool with_threads = bits & 1, with_viewer = bits & 2, shut_down_before = bits & 4,
               end_before = bits & 8;
    SCOPED_TRACE(bits);
    waited ended = waited::refused;
    {
      System system(with_threads, with_viewer, ended);
      system.Track();
      system.Track();
      if (shut_down_before) system.Shutdown();
      if (end_before) {
        system.End();
        EXPECT_EQ(ended, waited::done);
        EXPECT_EQ(MapPoint::live(), 0);
        ended = waited::refused;
      }
    }
    EXPECT_EQ(ended, waited::done);
    EXPECT_EQ(KeyFrame::live(), 0);
    EXPECT_EQ(MapPoint::live(), 0);
    EXPECT_EQ(Map::live(), 0);
  }
}

// The measuring step: a member that is not counted is not described, and nobody collects.
TEST(OrbSlam3AdapterAtFirst, NothingIsFreed) {
  class KeyFrame_ : public slamgc::orb_slam3::keyframe_base<KeyFrame_, Pose>,
                    public support::instances<KeyFrame_> {
    friend access;

   public:
    bool isBad() { return mbBad; }
    KeyFrame_* GetParent() { return mpParent; }
    Pose GetPose() const { return {}; }
    unsigned long mnId = 0;
    Pose mTcp;
    KeyFrame_ *mPrevKF = nullptr, *mNextKF = nullptr;
    std::mutex mMutexConnections, mMutexFeatures;
    slamgc::rc_map<KeyFrame_, int> mConnectedKeyFrameWeights;
    bool mbBad = false;
    std::vector<int*> mvpMapPoints;
    std::vector<KeyFrame_*> mvpOrderedConnectedKeyFrames;
    std::vector<int> mvOrderedWeights;
    KeyFrame_* mpParent = nullptr;
    std::set<KeyFrame_*> mspChildrens, mspLoopEdges, mspMergeEdges;
  };
  KeyFrame_ holder;
  auto* const pKF = new KeyFrame_;
  holder.mConnectedKeyFrameWeights[pKF] = 1;
  pKF->mbBad = true;
  slamgc::retire(pKF);
  holder.mConnectedKeyFrameWeights.clear();
  EXPECT_EQ(KeyFrame_::live(), 2);
  EXPECT_EQ(slamgc::default_domain().drain(), waited::done);  // what step 7 would do
  EXPECT_EQ(KeyFrame_::live(), 1);
}

}  // namespace
