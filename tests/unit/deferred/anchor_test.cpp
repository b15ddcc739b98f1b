// Anchors: whoever reads one gets the object, or the record that it left.
#include <gtest/gtest.h>
#include <pthread.h>

#include <cstddef>
#include <slamgc/mutex_counter.hpp>
#include <slamgc/slamgc.hpp>
#include <type_traits>
#include <vector>

#include "support/instances.hpp"
#include "support/policies.hpp"
#include "support/stress.hpp"

namespace {

using slamgc::anchor;
using slamgc::domain;
using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::mutator;
using slamgc::waited;

template <class Policy, class Reclaimer>
struct frame;
template <class Policy, class Reclaimer>
struct hop {
  double pose = 0;
  anchor<frame<Policy, Reclaimer>, hop> parent;
};
template <class Policy, class Reclaimer>
struct frame : slamgc::rc_object<frame<Policy, Reclaimer>, Policy, Reclaimer>,
               slamgc::enable_anchor<frame<Policy, Reclaimer>, hop<Policy, Reclaimer>>,
               support::instances<frame<Policy, Reclaimer>> {
  using record_type = hop<Policy, Reclaimer>;
  using handle = anchor<frame, record_type>;

  explicit frame(double p = 0) : pose(p) {}
  ~frame() {
    if (buries) this->bury();
  }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("parent", parent);
    v.edge("other", other);
  }
  record_type record() {
    ++recorded;
    if (locks != nullptr) (void)locks->lock();  // a poll at the worst moment
    return {pose, handle(parent)};
  }
  double pose;
  bool buries = false;
  const handle* locks = nullptr;
  slamgc::rc_slot<frame> parent, other;
  static inline int recorded = 0;
};
using deferred_frame = frame<slamgc::fetch_add_counter, slamgc::reclaim_deferred>;
using retired_frame = frame<slamgc::fetch_add_counter, slamgc::reclaim_retired>;

void settle(domain& d, mutator& m) {
  const mutator::offline_scope offline(m);
  EXPECT_EQ(d.drain(), waited::done);
}

// The product of all poses up to the root, in this order.
template <class Handle>
double chained(Handle at) {
  double product = 1;
  while (at)
    at = at.read(
        [&](auto& object) {
          product *= object.pose;
          return Handle(object.parent);
        },
        [&](const auto& record) {
          product *= record.pose;
          return record.parent;
        });
  return product;
}

template <class Policy>
class AnchorPolicies : public ::testing::Test {};
TYPED_TEST_SUITE(AnchorPolicies, support::all_policies, support::policy_names);

TYPED_TEST(AnchorPolicies, GiveTheObjectThenItsRecord) {
  using object = frame<TypeParam, slamgc::reclaim_deferred>;
  domain d;
  mutator m(d, "m");
  auto p = make_rc<object>(3.5);
  const typename object::handle a(p);
  EXPECT_EQ(a.record(), nullptr);
  EXPECT_EQ(a.lock(), p);
  EXPECT_EQ(chained(a), 3.5);
  p->pose = 4.5;  // the record is made at the end, not before
  p.reset();
  settle(d, m);
  EXPECT_EQ(object::live(), 0);
  EXPECT_EQ(a.lock(), nullptr);
  ASSERT_NE(a.record(), nullptr);
  EXPECT_EQ(a.record()->pose, 4.5);
  EXPECT_EQ(chained(a), 4.5);
}

TYPED_TEST(AnchorPolicies, OfARing) {
  using object = frame<TypeParam, slamgc::reclaim_retired>;
  domain d;
  mutator m(d, "m");
  auto p = make_rc<object>(2);
  p->parent = make_rc<object>(3);
  p->parent->other = p;  // not part of the record
  const typename object::handle a(p);
  slamgc::retire(p->parent.get());
  slamgc::retire(p.get());
  settle(d, m);
  EXPECT_EQ(object::live(), 2);
  EXPECT_EQ(a.record(), nullptr);
  p.reset();
  settle(d, m);
  EXPECT_EQ(object::live(), 0);
  EXPECT_EQ(chained(a), 6);
}

TEST(Anchor, Null) {
  const retired_frame::handle none;
  EXPECT_FALSE(none);
  EXPECT_EQ(none.lock(), nullptr);
  EXPECT_EQ(none.record(), nullptr);
  EXPECT_EQ(none, retired_frame::handle(nullptr));
  EXPECT_EQ(none, retired_frame::handle(intrusive_rc<retired_frame>()));
  EXPECT_EQ(sizeof(none), sizeof(void*));
}

TEST(Anchor, CopiesMovesAndCompares) {
  domain d;
  mutator m(d, "m");
  auto p = make_rc<deferred_frame>(1);
  deferred_frame::handle a(p);
  const deferred_frame::handle b = a;  // NOLINT(performance-unnecessary-copy-initialization)
  EXPECT_EQ(a, b);
  deferred_frame::handle c = std::move(a);
  EXPECT_FALSE(a);  // NOLINT(bugprone-use-after-move)
  EXPECT_NE(a, b);
  a.swap(c);
  EXPECT_EQ(a, b);
  a.reset();
  EXPECT_FALSE(a);
  p.reset();
  settle(d, m);
  EXPECT_EQ(chained(b), 1);
}

TEST(Anchor, WeakHandlesToTheSameObjects) {
  domain d;
  mutator m(d, "m");
  auto p = make_rc<deferred_frame>(1);
  const slamgc::weak_rc<deferred_frame> w(p);
  const deferred_frame::handle a(p);
  EXPECT_EQ(w.lock(), p);
  p.reset();
  settle(d, m);
  EXPECT_TRUE(w.expired());
  EXPECT_NE(a.record(), nullptr);
}

TEST(Anchor, ACopyOfAnObjectLeavesARecordOfItsOwn) {
  domain d;
  mutator m(d, "m");
  auto p = make_rc<deferred_frame>(1);
  auto q = make_rc<deferred_frame>(*p);
  const deferred_frame::handle a(p);
  const deferred_frame::handle b(q);
  EXPECT_NE(a, b);
  *q = *p;
  q->pose = 2;
  p.reset();
  q.reset();
  settle(d, m);
  EXPECT_EQ(chained(a), 1);
  EXPECT_EQ(chained(b), 2);
}

// Culled in any order, alone or together: the poses are multiplied as before, bit for bit.
TEST(Anchor, ChainsKeepEachHopInWhateverOrderTheObjectsGo) {
  for (int order = 0; order != 4; ++order) {
    domain d;
    mutator m(d, "m");
    std::vector<intrusive_rc<retired_frame>> map;
    std::vector<retired_frame::handle> references;
    for (int i = 0; i != 40; ++i) {
      map.push_back(make_rc<retired_frame>(1.0 + 1.0 / (3 + i)));
      if (i != 0) {
        map.back()->parent = map[static_cast<std::size_t>(i) / 2];
        map[static_cast<std::size_t>(i) / 2]->other = map.back();
      }
      references.emplace_back(map.back());
    }
    std::vector<double> before;
    for (const auto& a : references) before.push_back(chained(a));
    const auto expect_the_same = [&] {
      for (std::size_t i = 0; i != references.size(); ++i)
        EXPECT_EQ(chained(references[i]), before[i]);
    };
    const auto cull = [&](std::size_t i) {
      slamgc::retire(map[i].get());
      map[i].reset();
    };
    for (std::size_t i = 0; i != map.size(); ++i) {
      cull(order == 0 ? i : order == 1 ? map.size() - 1 - i : (i * 7) % map.size());
      if (order != 3) {
        settle(d, m);
        expect_the_same();
      }
    }
    settle(d, m);
    EXPECT_EQ(retired_frame::live(), 0);
    expect_the_same();
  }
}

TEST(Anchor, ReadAtAnyStepOfTheCollector) {
  int records = 0;
  for (int at = 0; at != 60; ++at) {
    domain d;
    mutator m(d, "m");
    auto p = make_rc<retired_frame>(5);
    p->other = make_rc<retired_frame>(7);
    p->other->other = p;
    const retired_frame::handle a(p);
    const retired_frame::handle b(p->other);
    slamgc::retire(p->other.get());
    slamgc::retire(p.get());
    p.reset();
    for (int i = 0; i != at; ++i) {
      m.quiescent();
      (void)d.collect({1});
    }
    m.quiescent();
    EXPECT_EQ(chained(b), 7);
    EXPECT_EQ(chained(a), 5);
    EXPECT_EQ(a.lock() == nullptr, b.lock() == nullptr);
    records += a.lock() == nullptr;
    settle(d, m);
    EXPECT_EQ(chained(a) * chained(b), 35);
    EXPECT_EQ(retired_frame::live(), 0);
  }
  EXPECT_GT(records, 5);
  EXPECT_LT(records, 55);
}

TEST(Anchor, ADecisionThatFailedMakesAnotherRecord) {
  domain d;
  mutator m(d, "m");
  for (const bool ring : {false, true}) {
    auto p = make_rc<retired_frame>(5);
    const retired_frame::handle a(p);
    if (ring) p->other = p;
    p->locks = &a;
    slamgc::retire(p.get());
    p.reset();
    retired_frame::recorded = 0;
    settle(d, m);  // each decision is vetoed, until patience ends
    EXPECT_EQ(retired_frame::live(), 0);
    EXPECT_GT(retired_frame::recorded, 1);
    EXPECT_LT(retired_frame::recorded, 10);
    EXPECT_EQ(chained(a), 5);
  }
}

TEST(Anchor, OfAnObjectThatTheProgramDeletes) {
  domain d;
  mutator m(d, "m");
  auto* const p = new deferred_frame(8);
  const deferred_frame::handle a(p);
  p->buries = true;
  delete p;
  EXPECT_EQ(chained(a), 8);

  auto* const nobodys = new deferred_frame(8);  // nothing to report
  delete nobodys;
  EXPECT_EQ(deferred_frame::live(), 0);
}

TEST(Anchor, BuryIsNothingForWhatACollectorHasBuried) {
  domain d;
  mutator m(d, "m");
  auto p = make_rc<deferred_frame>(8);
  const deferred_frame::handle a(p);
  p->buries = true;
  p.reset();
  deferred_frame::recorded = 0;
  settle(d, m);
  EXPECT_EQ(deferred_frame::recorded, 1);
  EXPECT_EQ(chained(a), 8);
}

TEST(Anchor, OutlivesTheDomain) {
  deferred_frame::handle a;
  {
    domain d;
    mutator m(d, "m");
    auto p = make_rc<deferred_frame>(2);
    p->parent = make_rc<deferred_frame>(4);
    a = p;
    p.reset();
  }
  ASSERT_NE(a.record(), nullptr);
  EXPECT_EQ(a.record()->pose, 2);
  ASSERT_NE(a.record()->parent.record(), nullptr);
  EXPECT_EQ(a.record()->parent.record()->pose, 4);
}

const int long_chain = 100 * support::rounds();

// Each record refers to the next; the last anchor frees all of them in the stack of one.
TEST(Anchor, AChainOfRecordsIsFreedInASmallStack) {
  pthread_attr_t attributes;
  ASSERT_EQ(pthread_attr_init(&attributes), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&attributes, std::size_t{256} * 1024), 0);
  pthread_t thread{};
  const auto body = [](void*) -> void* {
    domain d;
    mutator m(d, "m");
    retired_frame::handle end;
    slamgc::rc_slot<retired_frame> newest;
    for (int i = 0; i != long_chain; ++i) {
      const auto made = make_rc<retired_frame>(1);
      made->parent = newest;
      newest = made;
      slamgc::retire(made.get());
    }
    end = newest;
    newest.reset();
    settle(d, m);
    EXPECT_EQ(retired_frame::live(), 0);
    int hops = 0;
    for (auto at = end; at; at = retired_frame::handle(at.record()->parent)) ++hops;
    EXPECT_EQ(hops, long_chain);
    end.reset();
    return nullptr;
  };
  ASSERT_EQ(pthread_create(&thread, &attributes, body, nullptr), 0);
  ASSERT_EQ(pthread_join(thread, nullptr), 0);
  pthread_attr_destroy(&attributes);
}

static_assert(std::is_nothrow_move_constructible_v<retired_frame::handle>);
static_assert(!std::is_convertible_v<retired_frame*, retired_frame::handle>);

}  // namespace
