// B11 to B13: what ORB-SLAM3's threads do to each other: a queue that is deleted, maps that merge, an adjustment of minutes.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <thread>
#include <vector>

#include "world.hpp"

namespace {

using namespace orb_slam3;

// Keyframes of the current map; each sees all of its points, and adds ten.
template <class S>
void drive(World<S>& w, int keyframes) {
  for (int i = 0; i != keyframes; ++i) {
    std::vector<MapPoint<S>*> seen = w.map()->GetAllMapPoints();
    seen.resize(100, nullptr);
    w.frame(seen);
    const long id = w.new_keyframe();
    w.share({w.kf(id)}, 10);
  }
}

// ---- B11: LocalMapping::Release

template <class S>
void release_a_queued_keyframe(World<S>& w) {
  drive(w, 3);
  w.frame({w.mp(0)});
  const long id = w.new_keyframe(/*processed=*/false);
  w.mp(0)->AddObservation(w.kf(id), 0);  // stereo: tracking does that itself
}

TEST(B11_Release, B11_DeletesAKeyFrameThatIsInUse) {
  const holders users({"KeyFrame 2.mNextKF", "MapPoint 0.mObservations", "Tracking.mpLastKeyFrame",
                       "Tracking.mpReferenceKF", "Tracking.mpReferenceKF"});
  {
    World<plain> w;
    release_a_queued_keyframe(w);
    KeyFrame<plain>* const kf = w.kf(3);
    w->mapping.Release();
    EXPECT_EQ(w.kf(3), nullptr);
    EXPECT_EQ(w.holders(kf), users);
    EXPECT_EQ(w.dangling(), users.size());
    w.new_keyframe(/*processed=*/false);  // mpLastKeyFrame->mNextKF = ...
    EXPECT_EQ(found.freed_used, 1);
  }
  {
    World<shared> w;
    release_a_queued_keyframe(w);
    w->mapping.Release();
    EXPECT_EQ(w.holders(w.kf(3)), users);
    w.new_keyframe(/*processed=*/false);
    EXPECT_EQ(w.holders(w.kf(3)),  // for ever
              holders({"KeyFrame 2.mNextKF", "KeyFrame 4.mPrevKF", "MapPoint 0.mObservations"}));
  }
  World<counted> w;
  release_a_queued_keyframe(w);
  w->mapping.Release();
  w.threads.settle();
  EXPECT_EQ(w.holders(w.kf(3)), holders({"Tracking.mpLastKeyFrame", "Tracking.mpReferenceKF",
                                         "Tracking.mpReferenceKF"}));
  w.threads.on_tracking([&] { w->tracking.use_members(); });
  w.new_keyframe();  // it follows the one that was deleted
  w.threads.settle();
  EXPECT_EQ(w.kf(3), nullptr);
  EXPECT_EQ(w.keyframes(), 4u);
  EXPECT_EQ(w.kf(4)->mPrevKF, w.kf(2));
  EXPECT_FALSE(w.mp(0)->isBad());
}

// ---- B12: LoopClosing::MergeLocal, MergeLocal2

// The keyframe and its ancestors, in reverse, hang on @p parent afterwards.
template <class S>
void hang_on(KeyFrame<S>* kf, KeyFrame<S>* parent) {
  while (kf != nullptr) {
    KeyFrame<S>* const next = kf->GetParent();
    if (next != nullptr) next->EraseChild(kf);
    kf->ChangeParent(parent);
    parent = kf;
    kf = next;
  }
}
// Map 1, with keyframes 4 to 7 and points from 40, goes into map 0.
template <class S>
void merge(World<S>& w) {
  drive(w, 4);
  Map<S>* const to = w.map();
  Map<S>* const from = w->atlas.CreateNewMap();
  w.threads.on_tracking([&] { w->tracking.forget_frames(); });
  drive(w, 4);
  w.new_keyframe(/*processed=*/false);  // in the queue; it keeps the map that it was made for
  KeyFrame<S>* const current = w.kf(7);
  KeyFrame<S>* const matched = w.kf(2);
  w->closing.mpMergeMatchedKF = matched;
  w->closing.mvpMergeConnectedKFs.push_back(w.kf(1));
  for (KeyFrame<S>* const kf : from->GetAllKeyFrames()) {
    kf->UpdateMap(to);
    to->AddKeyFrame(kf);
    from->EraseKeyFrame(kf);
  }
  for (MapPoint<S>* const p : from->GetAllMapPoints()) {
    if (p->mnId == 79) continue;  // mapping made it meanwhile
    p->UpdateMap(to);
    to->AddMapPoint(p);
    from->EraseMapPoint(p);
  }
  w->atlas.ChangeMap(to);
  w->atlas.SetMapBad(from);
  hang_on(current, matched);
  for (long id : {40, 41, 42}) w.mp(id)->Replace(w.mp(id - 40));
  current->AddMergeEdge(matched);
  matched->AddMergeEdge(current);
  w->atlas.RemoveBadMaps();
}
template <class S>
void cull_after_merge(World<S>& w) {
  merge(w);
  for (long id : {4, 1}) w.kf(id)->SetBadFlag();  // 4 was the first one of map 1
  for (long id : {7, 2}) w.kf(id)->SetErase();    // a merge edge does not pin
  w.kf(7)->SetBadFlag();
}
// Keyframes in the spanning tree.
template <class S>
std::size_t in_tree(KeyFrame<S>* root) {
  std::size_t n = 1;
  for (KeyFrame<S>* const child : root->GetChilds())
    if (!child->isBad() && child->GetParent() == root) n += in_tree(child);
  return n;
}

TEST(B12_Merge, B12_TheMergedAwayMapStaysWithWhatItRefersTo) {
  {
    World<plain> w;
    cull_after_merge(w);
    EXPECT_EQ(w.maps(), 2u);
    const holders of_4 = w.holders(w.kf(4));
    EXPECT_EQ(std::count(of_4.begin(), of_4.end(), "Map 1.mpKFinitial"), 1);
    EXPECT_EQ(std::count(of_4.begin(), of_4.end(), "Map 1.mvpKeyFrameOrigins"), 1);
    const holders of_7 = w.holders(w.kf(7));
    EXPECT_EQ(std::count(of_7.begin(), of_7.end(), "KeyFrame 2.mspMergeEdges"), 1);
    EXPECT_NE(w.mp(79), nullptr);
    w.free_bad();
    EXPECT_GT(w.dangling(), 0u);
  }
  {
    World<shared> w;
    cull_after_merge(w);
    EXPECT_EQ(w.maps(), 2u);
    EXPECT_NE(w.kf(4), nullptr);
    EXPECT_NE(w.kf(7), nullptr);
  }
  World<counted> w;
  cull_after_merge(w);
  w->mapping.mpCurrentKeyFrame = nullptr;  // keyframe 7, which loop closing keeps as well
  w->closing.mpCurrentKF = w->closing.mpLastCurrentKF = nullptr;
  w.threads.on_tracking([&] { w->tracking.mpReferenceKF = nullptr; });
  w.frame({});
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.mp(79), nullptr);
  EXPECT_EQ(w.keyframes(), 6u);
  EXPECT_EQ(w.maps(), 2u);  // keyframe 8 still says that it belongs there
  EXPECT_EQ(w.holders(w.kf(8)->GetMap()), holders({"KeyFrame 8.mpMap"}));
  EXPECT_EQ(in_tree(w.kf(0)), 5u);
  w.kf(8)->UpdateMap(w.map());
  w.process();
  w.threads.settle();
  EXPECT_EQ(w.maps(), 1u);
  EXPECT_EQ(w.keyframes(), 6u);
}

TEST(B12_Merge, B12_MovingFromMapToMapRetiresNothing) {
  World<counted> w;
  merge(w);
  w.frame({});
  w.process();
  w.threads.settle();
  EXPECT_EQ(w.keyframes(), 9u);
  EXPECT_EQ(w.points(), 80u - 4);  // three were fused, one was left behind
  EXPECT_EQ(w.map()->GetAllKeyFrames().size(), 9u);
  EXPECT_EQ(in_tree(w.kf(0)), 8u);
}

// ---- B13: LoopClosing::RunGlobalBundleAdjustment

template <class S>
std::size_t cull_during_an_adjustment(World<S>& w) {
  for (int i : {2, 4}) w.kf(i)->SetBadFlag();
  for (long id : {3, 5, 7}) w.mp(id)->SetBadFlag();
  w.frame({});
  return 5;
}

TEST(B13_GlobalBundleAdjustment, B13_ItsSnapshotOutlivesWhatItRefersTo) {
  {
    World<plain> w;
    drive(w, 6);
    w->adjustment.begin(w.map());
    const std::size_t culled = cull_during_an_adjustment(w);
    w.free_bad();
    w->adjustment.write_back();
    EXPECT_GE(found.freed_used, static_cast<int>(culled));
  }
  {
    World<shared> w;
    drive(w, 6);
    w->adjustment.begin(w.map());
    cull_during_an_adjustment(w);
    w->adjustment.end();
    EXPECT_GE(w.bad(), 2u);
  }
  World<counted> w;
  drive(w, 6);
  actor adjusting;
  std::unique_ptr<slamgc::mutator> me;
  std::unique_ptr<slamgc::mutator::offline_scope> minutes;
  adjusting.run([&] {
    me = std::make_unique<slamgc::mutator>(w.threads.domain(), "GlobalBundleAdjustment");
    w->adjustment.begin(w.map());
    minutes = std::make_unique<slamgc::mutator::offline_scope>(*me);
  });
  const std::size_t culled = cull_during_an_adjustment(w);
  const auto fresh = w.keyframe();  // culled as well, but not in the snapshot
  fresh->SetBadFlag();
  w.threads.settle();
  EXPECT_TRUE(w.threads.drained());  // it delays nobody
  EXPECT_EQ(w.kf(6), nullptr);
  EXPECT_GE(w.bad(), culled);
  const std::size_t all = 6 + 60;
  adjusting.run([&] {
    EXPECT_EQ(w->adjustment.write_back(), all - w.bad());
    minutes.reset();
    w->adjustment.end();
    me.reset();
  });
  w.threads.settle();
  EXPECT_EQ(w.bad(), 0u);
  EXPECT_EQ(w.keyframes(), 4u);
}

// Aborted and detached, it goes on for a while: over a reset, and beside the next one.
TEST(B13_GlobalBundleAdjustment, B13_AnAbortedOneOverlapsAResetAndTheNextOne) {
  World<counted> w;
  std::atomic<bool> begun[2] = {{false}, {false}};
  std::atomic<bool> stopped{false};
  std::atomic<std::size_t> written{0};
  const auto run = [&](std::size_t which) {
    slamgc::mutator me(w.threads.domain(), "GlobalBundleAdjustment");
    GlobalBundleAdjustment<counted> adjustment;
    adjustment.begin(w.map());
    begun[which] = true;
    const slamgc::mutator::offline_scope minutes(me);
    while (!stopped) written += adjustment.write_back();
    adjustment.end();
  };
  const auto start = [&](std::size_t which) {
    std::thread t(run, which);
    while (!begun[which]) std::this_thread::yield();
    return t;
  };
  drive(w, 6);
  std::thread first = start(0);
  w->mapping.ResetIfRequested();
  w->closing.ResetIfRequested(nullptr);
  w->database.clear();
  w->atlas.clearAtlas();
  w->atlas.CreateNewMap();
  w.threads.on_tracking([&] { w->tracking.forget_frames(); });
  drive(w, 4);
  std::thread second = start(1);
  for (long id : {7, 8}) w.kf(id)->SetBadFlag();
  w.threads.settle();
  EXPECT_EQ(w.keyframes(), 10u);  // pinned by one of the two
  EXPECT_EQ(w.maps(), 2u);
  const std::size_t before = written;
  while (written == before) std::this_thread::yield();
  stopped = true;
  first.join();
  second.join();
  w.frame({});
  w.threads.settle();
  EXPECT_EQ(w.keyframes(), 2u);
  EXPECT_EQ(w.maps(), 1u);
  EXPECT_EQ(w.bad(), 0u);
}

}  // namespace
