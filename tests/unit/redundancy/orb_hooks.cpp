// The hooks in ORB-SLAM's functions: after each of its events, in any order, the index says what a walk through the map says, and
// nothing of what is gone is left in it.
#include "slamgc/adapters/orb_slam_redundancy.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <random>
#include <set>
#include <slamgc/slamgc.hpp>
#include <vector>

#include "support/stress.hpp"
#include "unit/redundancy/orb_world.hpp"

namespace {

using namespace orb_hooks;
using support::rounds;

// What the map refers to, with slamgc.
template <class S>
struct Roots {};
template <>
struct Roots<Counted> {
  slamgc::rc_set<KeyFrame<Counted>> mspKeyFrames;
  slamgc::rc_set<MapPoint<Counted>> mspMapPoints;
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mspKeyFrames", mspKeyFrames, slamgc::on_retire::erase);
    v.edge("mspMapPoints", mspMapPoints, slamgc::on_retire::erase);
  }
};

template <class S>
class Session {
 public:
  Session(unsigned seed, bool by_depth, const red::rule& rule)
      : random_(seed), by_depth_(by_depth), rule_(rule) {
    Redundancy<S>::use(rule, by_depth);
    if constexpr (S::counted) root_.emplace(slamgc::default_domain(), "map", roots_);
    for (int i = 0; i != 6; ++i) make_point();
  }
  ~Session() {
    if constexpr (S::counted) {
      for (auto* kf : keyframes_) slamgc::retire(kf);
      for (auto* mp : points_) slamgc::retire(mp);
      root_.reset();
      roots_.mspKeyFrames.clear();
      roots_.mspMapPoints.clear();
      EXPECT_EQ(slamgc::default_domain().drain(), slamgc::waited::done);
    } else {
      for (auto* kf : keyframes_) delete kf;
      for (auto* kf : bad_keyframes_) delete kf;
      for (auto* mp : points_) delete mp;
      for (auto* mp : bad_points_) delete mp;
    }
  }

  void one() {
    if (keyframes_.empty() || one_of(10)) return make_keyframe();
    if (points_.size() < 3) return make_point();
    KeyFrame<S>* const kf = any(keyframes_);
    MapPoint<S>* const mp = any(points_);
    const int idx = below(kf->N);
    const auto slot = static_cast<std::size_t>(idx);
    switch (below(20)) {
      case 0:
      case 1:
        make_point();
        break;
      case 2:
      case 3:
      case 4:
      case 5:
      case 6:  // most places
        mp->AddObservation(kf, idx);
        kf->AddMapPoint(mp, slot);
        break;
      case 7:
      case 8:  // CreateInitialMapMonocular, CorrectLoop
        kf->AddMapPoint(mp, slot);
        mp->AddObservation(kf, idx);
        break;
      case 9:  // ProcessNewKeyFrame: the constructor has set the slots
        for (std::size_t i = 0; i != kf->Points().size(); ++i)
          if (auto* const p = kf->Points()[i]; p != nullptr && !p->isBad())
            p->AddObservation(kf, static_cast<int>(i));
        break;
      case 10:
        mp->AddObservation(kf, idx);
        break;
      case 11:
        kf->AddMapPoint(mp, slot);
        break;
      case 12:
        mp->EraseObservation(kf);
        break;
      case 13:  // an outlier
        kf->EraseMapPointMatch(slot);
        mp->EraseObservation(kf);
        break;
      case 14:
        kf->EraseMapPointMatch(slot);
        break;
      case 15:
        if (one_of(2)) bad_point(mp, [&] { mp->SetBadFlag(); });
        break;
      case 16:
        if (MapPoint<S>* const by = any(points_); by != mp) bad_point(mp, [&] { mp->Replace(by); });
        break;
      case 17:
        if (one_of(2)) cull(kf);
        break;
      case 18:
        late(mp);
        break;
      default:
        if (one_of(2)) forget(kf, mp);
        break;
    }
    if (one_of(4)) reclaim();
  }

  testing::AssertionResult right() const {
    for (KeyFrame<S>* kf : keyframes_) {
      const auto expected = walk(*kf, by_depth_, rule_.others);
      for (const red::verdict& v : {Redundancy<S>::check(kf), Redundancy<S>::recompute(kf)}) {
        if (v.eligible_slots == expected.first && v.redundant_slots == expected.second &&
            v.redundant == (10 * v.redundant_slots > 9 * v.eligible_slots))
          continue;
        return testing::AssertionFailure()
               << v.redundant_slots << " of " << v.eligible_slots << " instead of "
               << expected.second << " of " << expected.first;
      }
    }
    return testing::AssertionSuccess();
  }

 private:
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  bool one_of(int n) { return below(n) == 0; }
  template <class T>
  T* any(const std::vector<T*>& all) {
    return all[static_cast<std::size_t>(below(static_cast<int>(all.size())))];
  }
  template <class T>
  static void take(std::vector<T*>& all, T* one) {
    all.erase(std::find(all.begin(), all.end(), one));
  }

  void make_point() {
    points_.push_back(new MapPoint<S>);
    if constexpr (S::counted) roots_.mspMapPoints.insert(points_.back());
  }
  KeyFrame<S>* new_keyframe() {
    const int n = 2 + below(4);
    const int left = S::two_cameras && one_of(2) ? 1 + below(n) : -1;
    std::vector<int> octaves;
    std::vector<float> depths;
    std::vector<MapPoint<S>*> seen;
    for (int i = 0; i != n; ++i) {
      octaves.push_back(below(8));
      depths.push_back(one_of(6) ? -1.0F : one_of(6) ? 6.0F : 2.0F);
      seen.push_back(one_of(2) ? any(points_) : nullptr);
    }
    return new KeyFrame<S>(octaves, depths, left, seen);
  }
  void make_keyframe() {
    KeyFrame<S>* const kf = new_keyframe();
    keyframes_.push_back(kf);
    if constexpr (S::counted) roots_.mspKeyFrames.insert(kf);
    if (keyframes_.size() > 8) cull(any(keyframes_));
  }
  template <class F>
  void bad_point(MapPoint<S>* mp, F f) {
    take(points_, mp);
    f();
    if constexpr (S::counted) {
      roots_.mspMapPoints.erase(mp);
      slamgc::retire(mp);
    }
    bad_points_.push_back(mp);
  }
  void cull(KeyFrame<S>* kf) {
    take(keyframes_, kf);
    kf->SetBadFlag();
    if constexpr (S::counted) {
      roots_.mspKeyFrames.erase(kf);
      slamgc::retire(kf);
    }
    bad_keyframes_.push_back(kf);
  }
  // Another thread has not noticed yet that they are bad.
  void late(MapPoint<S>* mp) {
    if (!bad_keyframes_.empty()) {
      KeyFrame<S>* const bad = any(bad_keyframes_);
      const int idx = below(bad->N);
      mp->AddObservation(bad, idx);
      if (one_of(2)) bad->AddMapPoint(mp, static_cast<std::size_t>(idx));
    }
    if (!bad_points_.empty() && !keyframes_.empty()) {
      KeyFrame<S>* const kf = any(keyframes_);
      const int idx = below(kf->N);
      kf->AddMapPoint(any(bad_points_), static_cast<std::size_t>(idx));
      if (one_of(2)) any(bad_points_)->AddObservation(kf, idx);
    }
  }
  // Not bad, and at an end nevertheless: a keyframe in a queue that is dropped, with the slots of its frame; with slamgc, all of
  // a map that is cleared, of which others may still be in use by the rest.
  void forget(KeyFrame<S>* kf, MapPoint<S>* mp) {
    if constexpr (S::counted) {
      roots_.mspKeyFrames.erase(kf);
      slamgc::retire(kf);
      take(keyframes_, kf);
      if (one_of(2)) return;
      roots_.mspMapPoints.erase(mp);
      slamgc::retire(mp);
      take(points_, mp);
    } else {
      delete new_keyframe();
    }
  }
  void reclaim() {
    if constexpr (S::counted) {
      bad_points_.clear();
      bad_keyframes_.clear();
      if (one_of(2))
        (void)slamgc::default_domain().collect();
      else
        EXPECT_EQ(slamgc::default_domain().drain(), slamgc::waited::done);
    } else {
      std::set<void*> used;
      for (const auto* all : {&points_, &bad_points_})
        for (MapPoint<S>* mp : *all)
          for (const auto& o : mp->Observations()) used.insert(o.first);
      delete_unused(bad_keyframes_, used);
      for (const auto* all : {&keyframes_, &bad_keyframes_})
        for (KeyFrame<S>* kf : *all)
          for (MapPoint<S>* mp : kf->Points()) used.insert(mp);
      delete_unused(bad_points_, used);
    }
  }
  template <class T>
  static void delete_unused(std::vector<T*>& all, const std::set<void*>& used) {
    const auto unused =
        std::partition(all.begin(), all.end(), [&](T* p) { return used.count(p) != 0; });
    for (auto i = unused; i != all.end(); ++i) delete *i;
    all.erase(unused, all.end());
  }

  std::mt19937 random_;
  const bool by_depth_;
  const red::rule rule_;
  std::vector<KeyFrame<S>*> keyframes_, bad_keyframes_;
  std::vector<MapPoint<S>*> points_, bad_points_;
  Roots<S> roots_;
  std::optional<slamgc::root> root_;
};

template <class S>
class OrbHooks : public testing::Test {
 protected:
  ~OrbHooks() override { Redundancy<S>::use(red::orb_slam3, true); }
  static void run(unsigned seed) {
    for (int episode = 0; episode != rounds() / 10 + 1; ++episode) {
      const red::rule rule{1 + episode % 4, 1, 9, 10};
      Session<S> session(seed + static_cast<unsigned>(episode), episode % 2 == 0, rule);
      for (int i = 0; i != 300; ++i) {
        session.one();
        ASSERT_TRUE(session.right()) << "episode " << episode << ", event " << i;
      }
    }
  }
};
using Shapes = testing::Types<OrbSlam2, OrbSlam3, Counted>;
TYPED_TEST_SUITE(OrbHooks, Shapes, );

TYPED_TEST(OrbHooks, SayWhatAWalkSays) { this->run(1); }

TYPED_TEST(OrbHooks, AddressesAreUsedAgain) {
  Reused<KeyFrame<TypeParam>>::reuse = Reused<MapPoint<TypeParam>>::reuse = true;
  this->run(1000);
  EXPECT_GT(Reused<KeyFrame<TypeParam>>::again, 100);
  EXPECT_GT(Reused<MapPoint<TypeParam>>::again, 100);
  Reused<KeyFrame<TypeParam>>::end_reuse();
  Reused<MapPoint<TypeParam>>::end_reuse();
}

// Eight keyframes at level 0 to 7, one point, which each sees in slot 0; a second slot is empty.
template <class S>
struct Eight {
  explicit Eight(bool from_file = false) {
    Redundancy<S>::use(red::orb_slam3, false);
    for (int level = 0; level != 8; ++level)
      keyframes.push_back(new KeyFrame<S>({level, 0}, {1, 1}, -1, {point, nullptr}, from_file));
  }
  ~Eight() {
    Redundancy<S>::use(red::orb_slam3, true);
    for (auto* kf : keyframes) delete kf;
    delete point;
  }
  void see() {
    for (auto* kf : keyframes) point->AddObservation(kf, 0);
  }
  std::vector<int> redundant() const {
    std::vector<int> n;
    for (auto* kf : keyframes) n.push_back(Redundancy<S>::check(kf).redundant_slots);
    return n;
  }
  MapPoint<S>* const point = new MapPoint<S>;
  std::vector<KeyFrame<S>*> keyframes;
};

template <class S>
class RawHooks : public testing::Test {};
using RawShapes = testing::Types<OrbSlam2, OrbSlam3>;
TYPED_TEST_SUITE(RawHooks, RawShapes, );

TYPED_TEST(RawHooks, FourOthersAtMostOneLevelCoarser) {
  static_assert(sizeof(typename Redundancy<TypeParam>::keyframe_state) == 8);
  static_assert(sizeof(typename Redundancy<TypeParam>::point_state) == 16 + sizeof(void*));
  Eight<TypeParam> e;
  EXPECT_EQ(e.redundant(), std::vector<int>(8, 0));
  e.see();
  EXPECT_EQ(e.redundant(), (std::vector<int>{0, 0, 0, 1, 1, 1, 1, 1}));
  EXPECT_TRUE(Redundancy<TypeParam>::check(e.keyframes[3]).redundant);
  e.keyframes[0]->SetBadFlag();
  EXPECT_EQ(e.redundant(), (std::vector<int>{0, 0, 0, 0, 1, 1, 1, 1}));
}

// Map::PostLoad: the points first.
TYPED_TEST(RawHooks, AMapFromAFile) {
  Eight<TypeParam> e(true);
  std::map<KeyFrame<TypeParam>*, typename TypeParam::Indices> obs;
  for (auto* kf : e.keyframes) {
    if constexpr (TypeParam::two_cameras)
      obs[kf] = {0, -1};
    else
      obs[kf] = 0;
  }
  e.point->PostLoad(obs);
  for (auto* kf : e.keyframes) kf->PostLoad();
  EXPECT_EQ(e.redundant(), (std::vector<int>{0, 0, 0, 1, 1, 1, 1, 1}));
  e.point->EraseObservation(e.keyframes[0]);
  EXPECT_EQ(e.redundant(), (std::vector<int>{0, 0, 0, 0, 1, 1, 1, 1}));
}

TYPED_TEST(RawHooks, WhatIsNotThereIsNoError) {
  Eight<TypeParam> e;
  e.keyframes[0]->EraseMapPointMatch(1);
  e.point->EraseObservation(e.keyframes[0]);
  e.keyframes[0]->AddMapPoint(nullptr, 0);
  e.keyframes[0]->SetBadFlag();
  EXPECT_EQ(Redundancy<TypeParam>::check(e.keyframes[0]).eligible_slots, 0);
  EXPECT_EQ(e.keyframes[0]->Points()[0], nullptr);
}

TYPED_TEST(RawHooks, AKeyFrameThatNobodyToldOfIsDeleted) {
  delete new KeyFrame<TypeParam>({0}, {1}, -1, {nullptr}, true);
}

// A keyframe of a queue, with the slots of its frame.
TYPED_TEST(RawHooks, ADeletedKeyFrameLeavesNoLooseSlot) {
  Eight<TypeParam> e;
  EXPECT_NE(e.point->mRedundancy.ends.first(), nullptr);
  for (auto* kf : e.keyframes) delete kf;
  e.keyframes.clear();
  EXPECT_EQ(e.point->mRedundancy.ends.first(), nullptr);
}

// The right camera's level counts for others, its slots do not.
TEST(TwoCameras, TheFinerLevelCounts) {
  Redundancy<OrbSlam3>::use({1, 0, 9, 10}, true);
  MapPoint<OrbSlam3> point;
  KeyFrame<OrbSlam3> sees({3}, {1}, -1, {&point});
  KeyFrame<OrbSlam3> other({5, 2}, {1, 1}, 1, {nullptr, nullptr});
  point.AddObservation(&sees, 0);
  other.AddMapPoint(&point, 0);
  point.AddObservation(&other, 0);
  EXPECT_EQ(Redundancy<OrbSlam3>::check(&sees).redundant_slots, 0);
  point.AddObservation(&other, 1);
  other.AddMapPoint(&point, 1);
  EXPECT_EQ(Redundancy<OrbSlam3>::check(&sees).redundant_slots, 1);
  EXPECT_EQ(Redundancy<OrbSlam3>::check(&other).eligible_slots, 1);
  point.SetBadFlag();
  Redundancy<OrbSlam3>::use(red::orb_slam3, true);
}

TEST(OrbHooksDeathTest, AHookThatIsMissingIsReported) {
  KeyFrame<OrbSlam3> kf({0}, {1}, -1, {nullptr}, true);
  MapPoint<OrbSlam3> point;
  EXPECT_DEATH(point.AddObservation(&kf, 0), "slamgc: unknown keyframe: .*MapPoint");
  EXPECT_DEATH((void)Redundancy<OrbSlam3>::check(&kf), "slamgc: unknown keyframe: .*KeyFrame");
}

TEST(OrbHooksDeathTest, APyramidOfMoreLevelsIsReported) {
  EXPECT_DEATH(KeyFrame<OrbSlam3>({8}, {1}, -1, {nullptr}), "slamgc: level out of range");
}

}  // namespace
