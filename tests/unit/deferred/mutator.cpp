// Threads that register: online, offline, nested, in any order with domains and objects.
#include <slamgc/mutator.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <slamgc/slamgc.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "support/instances.hpp"

namespace {

using slamgc::domain;
using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::mutator;
using outcome = slamgc::collected::outcome;

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
              support::instances<node> {};

struct described
    : slamgc::rc_object<described, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  template <class Visitor>
  void edges(Visitor&) {}
};

struct kept {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("slot", slot, slamgc::on_retire::null);
  }
  slamgc::rc_slot<described> slot;
};

class Mutator : public ::testing::Test {
 protected:
  ~Mutator() override { EXPECT_EQ(node::live(), 0); }
  static std::uint64_t live_in(const domain& d) {
    return d.stats().total(&slamgc::type_stats::live);
  }
  // Something waits, so that collect() has a grace period to open.
  static void give_work(domain& d) {
    const mutator m(d, "work");
    slamgc::retire(new node);
  }
};

TEST_F(Mutator, IsOnlineUnlessItIsToldOtherwise) {
  domain d;
  const mutator a(d, "a");
  EXPECT_TRUE(a.is_online());
  mutator::options offline;
  offline.online = false;
  const mutator b(d, "b", offline);
  EXPECT_FALSE(b.is_online());
}

TEST_F(Mutator, DelaysCollectorsOnlyWhileItIsOnline) {
  domain d;
  mutator m(d, "m");
  give_work(d);
  EXPECT_EQ(d.collect().result, outcome::waiting);
  {
    const mutator::offline_scope offline(m);
    EXPECT_FALSE(m.is_online());
    EXPECT_EQ(d.collect().reclaimed, 1u);
    {
      const mutator::offline_scope nested(m);
      const mutator::online_scope online(m);
      EXPECT_TRUE(m.is_online());
      {
        const mutator::online_scope nested_online(m);
        EXPECT_TRUE(m.is_online());
      }
      EXPECT_TRUE(m.is_online());
      give_work(d);
      EXPECT_EQ(d.collect().result, outcome::waiting);
    }
    EXPECT_FALSE(m.is_online());
    EXPECT_EQ(d.collect().reclaimed, 1u);
  }
  EXPECT_TRUE(m.is_online());
  give_work(d);
  EXPECT_EQ(d.collect().result, outcome::waiting);
}

TEST_F(Mutator, OneThatGoesOnlineLaterDoesNotDelayTheOpenGracePeriod) {
  domain d;
  mutator first(d, "first");
  give_work(d);
  EXPECT_EQ(d.collect().result, outcome::waiting);
  const mutator second(d, "second");
  const mutator::offline_scope offline(first);
  EXPECT_EQ(d.collect().reclaimed, 1u);
}

TEST_F(Mutator, AThreadOfTheCallersIsOnlineForOneFrame) {
  domain d;
  mutator m(d, "caller", {false, false});
  slamgc::rc_slot<node> slot;
  for (int frame = 0; frame != 10; ++frame) {
    {
      const mutator::online_scope online(m);
      slot = new node;
    }
    (void)d.collect();
    EXPECT_EQ(node::live(), 1);
  }
  const mutator::online_scope online(m);
  slot.reset();
}

TEST_F(Mutator, NestedOnesOfTwoDomainsKeepTheirObjectsApart) {
  domain outer_domain;
  domain inner_domain;
  mutator outer(outer_domain, "outer");
  auto of_outer = make_rc<node>();
  intrusive_rc<node> of_inner;
  {
    mutator inner(inner_domain, "inner");
    of_inner = make_rc<node>();
    EXPECT_EQ(live_in(outer_domain), 1u);
    EXPECT_EQ(live_in(inner_domain), 1u);
    of_outer.reset();  // by the thread, whose innermost mutator is of the other domain
    EXPECT_EQ(outer_domain.delayed().backlog, 1u);
    EXPECT_EQ(inner_domain.delayed().backlog, 0u);
    outer.quiescent();
    inner.quiescent();
  }
  of_outer = make_rc<node>();
  EXPECT_EQ(live_in(outer_domain), 2u);
  of_inner.reset();
  EXPECT_EQ(inner_domain.collect().reclaimed, 1u);
  EXPECT_EQ(outer_domain.collect().result, outcome::waiting);
  outer.quiescent();
  EXPECT_EQ(outer_domain.collect().reclaimed, 1u);
}

TEST_F(Mutator, TwoOfOneDomainBothHaveToPass) {
  domain d;
  mutator outer(d, "outer");
  auto p = make_rc<node>();
  {
    mutator inner(d, "inner");
    p.reset();
    EXPECT_EQ(d.collect().result, outcome::waiting);
    inner.quiescent();
    EXPECT_EQ(d.collect().result, outcome::waiting);
    EXPECT_STREQ(d.delayed().oldest, "outer");
    outer.quiescent();
    EXPECT_EQ(d.collect().reclaimed, 1u);
  }
  slamgc::retire(new node);  // the outer one is the innermost again
  EXPECT_EQ(d.delayed().backlog, 1u);
  outer.quiescent();
}

TEST_F(Mutator, RecordsAreUsedAgain) {
  domain d;
  { const mutator a(d, "a"), b(d, "b"); }
  EXPECT_TRUE(d.stats().mutators.empty());
  const mutator c(d, "c");
  ASSERT_EQ(d.stats().mutators.size(), 1u);
  EXPECT_STREQ(d.stats().mutators[0].name, "c");
}

// Thread exit at each step loses nothing and delays nobody.
enum class step { holds, dropped, collected, quiescent, offline, nested };
void live_a_little(domain& d, step until, bool throws) {
  mutator m(d, "short");
  auto p = make_rc<node>();
  auto q = make_rc<node>();
  const auto ends_at = [&](step now) {
    if (throws && until == now) throw std::runtime_error("enough");
    return until == now;
  };
  if (ends_at(step::holds)) return;
  q.reset();
  if (ends_at(step::dropped)) return;
  (void)d.collect();
  if (ends_at(step::collected)) return;
  p.reset();
  m.quiescent();
  if (ends_at(step::quiescent)) return;
  {
    const mutator::offline_scope offline(m);
    slamgc::retire(new node);
    if (ends_at(step::offline)) return;
  }
  const mutator inner(d, "inner");
  slamgc::retire(new node);
  (void)ends_at(step::nested);
}

TEST_F(Mutator, AThreadMayEndAtAnyStep) {
  domain d;
  for (const bool throws : {false, true})
    for (const step until : {step::holds, step::dropped, step::collected, step::quiescent,
                             step::offline, step::nested}) {
      std::thread([&] {
        try {
          live_a_little(d, until, throws);
          EXPECT_FALSE(throws);
        } catch (const std::runtime_error&) {
          EXPECT_TRUE(throws);
        }
      }).join();
      EXPECT_TRUE(d.stats().mutators.empty());
      EXPECT_EQ(d.collect().result, outcome::done);
      EXPECT_EQ(node::live(), 0) << static_cast<int>(until) << throws;
    }
}

TEST_F(Mutator, AThreadsLastReferencesMayGoAfterItsMutator) {
  domain d;
  std::thread([&] {
    thread_local intrusive_rc<node> kept;  // destroyed at the end of the thread
    const mutator m(d, "short");
    kept = make_rc<node>();
  }).join();
  EXPECT_EQ(d.collect().reclaimed, 1u);
}

TEST_F(Mutator, OneThousandShortLivedThreadsLeaveNothingBehind) {
  domain d;
  for (int i = 0; i != 1000; ++i)
    std::thread([&] {
      const mutator m(d, "short");
      slamgc::retire(new node);
    }).join();
  EXPECT_TRUE(d.stats().mutators.empty());
  EXPECT_EQ(d.stats().types.size(), 1u);
  EXPECT_EQ(d.collect().reclaimed, 1000u);
}

TEST_F(Mutator, ThereMayBeMoreThanHaveAPlaceOfTheirOwn) {
  constexpr std::size_t many = slamgc::std_env::mutator_doors + 8;
  domain d;
  std::vector<std::unique_ptr<mutator>> all;
  for (std::size_t i = 0; i != many; ++i) {
    all.push_back(std::make_unique<mutator>(d, "one of many"));
    slamgc::retire(new node);
    auto p = make_rc<node>();
  }
  EXPECT_EQ(d.stats().mutators.size(), many);
  EXPECT_EQ(d.delayed().backlog, 2 * many);
  EXPECT_EQ(live_in(d), 2 * many);
  while (!all.empty()) all.pop_back();  // the last made first
  EXPECT_EQ(d.collect().reclaimed, 2 * many);
  EXPECT_EQ(live_in(d), 0u);
}

TEST_F(Mutator, AThreadThatNeverRegisteredMayCountAndDrop) {
  domain d;
  intrusive_rc<node> p;
  {
    const mutator m(d, "maker");
    p = make_rc<node>();
  }
  std::thread([&] {
    auto copy = p;
    p.reset();
    slamgc::rc_vector<node> v(3, copy.get());
    copy.reset();
  }).join();
  EXPECT_EQ(d.collect().reclaimed, 1u);
}

TEST_F(Mutator, WithoutADomainItIsTheDefaultOnesAndSoAreItsObjects) {
  const std::uint64_t before = live_in(slamgc::default_domain());
  mutator m("default");
  auto p = make_rc<node>();
  EXPECT_EQ(live_in(slamgc::default_domain()), before + 1);
  p.reset();
  (void)slamgc::default_domain().collect();
  m.quiescent();
  EXPECT_EQ(slamgc::default_domain().collect().reclaimed, 1u);
}

TEST_F(Mutator, WithoutAMutatorObjectsAreTheDefaultDomains) {
  auto p = make_rc<node>();
  p.reset();
  EXPECT_TRUE(slamgc::retire(new node));
  EXPECT_EQ(slamgc::default_domain().collect().reclaimed, 2u);
}

TEST_F(Mutator, RoamsFromThreadToThread) {
  domain d;
  mutator m(d, "m", {false, false, true});
  EXPECT_FALSE(m.is_online());
  const auto use = [&] {
    const mutator::online_scope online(m);
    EXPECT_TRUE(m.is_online());
    slamgc::retire(new node);  // of its domain, whichever thread it is on
  };
  use();
  std::thread(use).join();
  std::thread(use).join();
  EXPECT_EQ(live_in(d), 3u);
  EXPECT_EQ(d.collect().reclaimed, 3u);
  EXPECT_EQ(d.drain(), slamgc::waited::done);
}

TEST_F(Mutator, OfNoThreadWhileItDoesNotRoam) {
  domain d;
  std::thread([&] {
    mutator m(d, "m", {false, false, true});
    { const mutator::online_scope online(m); }
    EXPECT_EQ(d.synchronize(), slamgc::waited::done);  // no part of this thread is online
  }).join();
  auto m = std::make_unique<mutator>(d, "m", mutator::options{false, false, true});
  std::thread([&] { m.reset(); }).join();
  EXPECT_TRUE(d.stats().mutators.empty());
}

// What it refers to is given up by whoever is the owner next.
TEST_F(Mutator, RoamsWithItsRoots) {
  domain d;
  mutator m(d, "m", {false, false, true});
  kept part;
  const slamgc::root root(m, "kept", part);
  {
    const mutator::online_scope online(m);
    auto* const p = new described;
    part.slot = p;
    slamgc::retire(p);
  }
  EXPECT_EQ(d.drain(), slamgc::waited::done);
  EXPECT_NE(part.slot, nullptr);
  std::thread([&] { const mutator::online_scope online(m); }).join();
  EXPECT_EQ(part.slot, nullptr);
  EXPECT_EQ(d.drain(), slamgc::waited::done);
  EXPECT_EQ(live_in(d), 0u);
}

}  // namespace
