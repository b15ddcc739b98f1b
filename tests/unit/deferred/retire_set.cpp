// The thesis's collector: a set of dead objects that is scanned.
#include <slamgc/retire_set.hpp>

#include <gtest/gtest.h>

#include <functional>
#include <slamgc/slamgc.hpp>

#include "support/instances.hpp"
#include "support/policies.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;

template <class Policy>
struct node : slamgc::rc_object<node<Policy>, Policy, slamgc::reclaim_by_scan>,
              support::instances<node<Policy>> {
  virtual ~node() {
    if (at_end) at_end();
  }
  std::function<void()> at_end;
  slamgc::rc_vector<node> edges;
};
template <class Policy>
struct derived_node : node<Policy> {
  derived_node() { ++alive; }
  derived_node(const derived_node&) = delete;
  derived_node& operator=(const derived_node&) = delete;
  ~derived_node() override { --alive; }
  static inline int alive = 0;
};

template <class Policy>
class RetireSet : public ::testing::Test {
 protected:
  ~RetireSet() override { EXPECT_EQ(node<Policy>::live(), 0); }
};
TYPED_TEST_SUITE(RetireSet, support::all_policies, support::policy_names);

TYPED_TEST(RetireSet, NothingIsDestroyedWithoutAScan) {
  slamgc::retire_set<node<TypeParam>> dead;
  EXPECT_TRUE(dead.empty());
  EXPECT_EQ(dead.scan(), 0u);
  auto p = make_rc<node<TypeParam>>();
  auto* const raw = p.get();
  p.reset();
  EXPECT_EQ(dead.scan(), 0u);
  EXPECT_EQ(node<TypeParam>::live(), 1);
  EXPECT_TRUE(dead.insert(raw));
  EXPECT_FALSE(dead.empty());
  EXPECT_EQ(node<TypeParam>::live(), 1);
  EXPECT_EQ(dead.scan(), 1u);
  EXPECT_TRUE(dead.empty());
}

TYPED_TEST(RetireSet, AnObjectIsInItOnce) {
  slamgc::retire_set<node<TypeParam>> dead;
  slamgc::retire_set<node<TypeParam>> other;
  const auto p = make_rc<node<TypeParam>>();
  EXPECT_TRUE(dead.insert(p.get()));
  EXPECT_FALSE(dead.insert(p.get()));
  EXPECT_FALSE(other.insert(p.get()));
  EXPECT_TRUE(p->state().is_retired());
  EXPECT_TRUE(other.empty());
  EXPECT_EQ(dead.scan(), 0u);
  EXPECT_FALSE(dead.insert(p.get()));  // it is still in it
}

TYPED_TEST(RetireSet, WhatIsReferredToStaysInIt) {
  slamgc::retire_set<node<TypeParam>> dead;
  auto p = make_rc<node<TypeParam>>();
  auto q = make_rc<node<TypeParam>>();
  dead.insert(p.get());
  dead.insert(q.get());
  q.reset();
  EXPECT_EQ(dead.scan(), 1u);
  EXPECT_FALSE(dead.empty());
  EXPECT_EQ(dead.scan(), 0u);
  p.reset();
  EXPECT_EQ(node<TypeParam>::live(), 1);
  EXPECT_EQ(dead.scan(), 1u);
  EXPECT_TRUE(dead.empty());
}

TYPED_TEST(RetireSet, DestructorsMayInsertAndScan) {
  slamgc::retire_set<node<TypeParam>> dead;
  auto* const second = new node<TypeParam>;
  auto* const first = new derived_node<TypeParam>;
  auto* const third = new node<TypeParam>;
  first->at_end = [&] {
    EXPECT_TRUE(dead.insert(second));
    EXPECT_EQ(dead.scan(), 1u);  // what was inserted since the outer one began
  };
  dead.insert(first);
  dead.insert(third);
  EXPECT_EQ(dead.scan(), 2u);
  EXPECT_TRUE(dead.empty());
  EXPECT_EQ(derived_node<TypeParam>::alive, 0);
}

TYPED_TEST(RetireSet, WhatADestructorReleasesGoesWithThisScanOrTheNext) {
  slamgc::retire_set<node<TypeParam>> dead;
  auto* const hub = new node<TypeParam>;
  dead.insert(hub);
  for (int i = 0; i != 5; ++i) {
    hub->edges.push_back(new node<TypeParam>);
    dead.insert(hub->edges.back().get());
  }
  EXPECT_GE(dead.scan(), 1u);
  (void)dead.scan();
  EXPECT_EQ(node<TypeParam>::live(), 0);
}

TYPED_TEST(RetireSet, ItsEndScansOnceMore) {
  intrusive_rc<node<TypeParam>> kept = make_rc<node<TypeParam>>();
  {
    slamgc::retire_set<node<TypeParam>> dead;
    dead.insert(new node<TypeParam>);
    dead.insert(kept.get());
  }
  EXPECT_EQ(node<TypeParam>::live(), 1);
  auto* const mine = kept.get();
  kept.reset();
  EXPECT_EQ(node<TypeParam>::live(), 1);  // nobody destroys it any more
  delete mine;
}

TYPED_TEST(RetireSet, LocalsThatAreCountedKeepWhatTheyName) {
  slamgc::retire_set<node<TypeParam>> dead;
  auto map = make_rc<node<TypeParam>>();
  auto* const point = new node<TypeParam>;
  map->edges.push_back(point);
  {
    const slamgc::scoped_count points(map->edges.raw());  // under the lock, in a program of threads
    map->edges.clear();
    dead.insert(point);
    EXPECT_EQ(dead.scan(), 0u);
    EXPECT_EQ(point->use_count(), 1u);
  }
  EXPECT_EQ(dead.scan(), 1u);
  dead.insert(map.get());
  map.reset();
  EXPECT_EQ(dead.scan(), 1u);
}

}  // namespace
