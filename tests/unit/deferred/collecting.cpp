// collect(): how much one call does, how it ends, and what is reported when a mutator holds it up.
#include <slamgc/domain.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <limits>
#include <slamgc/slamgc.hpp>
#include <thread>
#include <vector>

#include "support/instances.hpp"

namespace {

using slamgc::budget;
using slamgc::make_rc;
using slamgc::mutator;
using outcome = slamgc::collected::outcome;
using std::chrono::nanoseconds;

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
              support::instances<node> {};
struct other : slamgc::rc_object<other, slamgc::cas_counter, slamgc::reclaim_retired>,
               support::instances<other> {};
struct slow : slamgc::rc_object<slow, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
              support::instances<slow> {
  ~slow() {
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(2);
    while (std::chrono::steady_clock::now() < end) {
    }
  }
};

// A domain with a mutator that is offline unless a test needs it, so that grace periods are over at once.
class Collecting : public ::testing::Test {
 protected:
  ~Collecting() override {
    EXPECT_EQ(node::live() + other::live() + slow::live(), 0);
    EXPECT_EQ(domain_.delayed().backlog, 0u);
  }
  template <class T>
  void drop(int n) {
    for (int i = 0; i != n; ++i) slamgc::retire(new T);
  }

  slamgc::domain domain_;
  mutator mutator_{domain_, "test", {false, false}};
};

TEST_F(Collecting, NothingToDoIsDone) {
  const auto done = domain_.collect();
  EXPECT_EQ(done.result, outcome::done);
  EXPECT_EQ(done.reclaimed, 0u);
  EXPECT_EQ(domain_.stats().grace_periods, 0u);
}

TEST_F(Collecting, NoObjectsMeansNothingIsDone) {
  drop<node>(1);
  EXPECT_EQ(domain_.collect(budget{0}).result, outcome::partial);
  EXPECT_EQ(node::live(), 1);
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
}

// An object is handled twice: noted, then destroyed.
TEST_F(Collecting, ABudgetOfObjectsIsKept) {
  constexpr int objects = 1000;
  drop<node>(objects);
  int calls = 0;
  int before = node::live();
  for (;;) {
    const auto did = domain_.collect(budget{100});
    ++calls;
    EXPECT_LE(did.reclaimed, 100u);
    EXPECT_EQ(before - node::live(), static_cast<int>(did.reclaimed));
    before = node::live();
    if (did.result == outcome::done) break;
    ASSERT_EQ(did.result, outcome::partial);
  }
  EXPECT_GE(calls, 2 * objects / 100);
  EXPECT_LE(calls, 2 * objects / 100 + 1);
  EXPECT_EQ(domain_.stats().grace_periods, 1u);
}

TEST_F(Collecting, ABudgetGoesOverAllTypes) {
  drop<node>(30);
  drop<other>(30);
  std::size_t reclaimed = 0;
  int calls = 0;
  for (outcome now = outcome::partial; now != outcome::done; ++calls) {
    const auto did = domain_.collect(budget{7});
    now = did.result;
    EXPECT_LE(did.reclaimed, 7u);
    reclaimed += did.reclaimed;
  }
  EXPECT_EQ(reclaimed, 60u);
  EXPECT_GE(calls, 120 / 7);
}

TEST_F(Collecting, OneObjectAtATimeComesToAnEnd) {
  drop<node>(50);
  std::size_t reclaimed = 0;
  while (node::live() != 0) {
    const auto did = domain_.collect(budget{1});
    ASSERT_LE(did.reclaimed, 1u);
    reclaimed += did.reclaimed;
  }
  EXPECT_EQ(reclaimed, 50u);
  (void)domain_.collect();
}

TEST_F(Collecting, ABudgetOfTimeEndsAfterTheObjectItIsAt) {
  drop<slow>(4);
  budget brief;
  brief.time = std::chrono::milliseconds(1);
  int calls = 0;
  for (outcome now = outcome::partial; now != outcome::done; ++calls) {
    const auto did = domain_.collect(brief);
    now = did.result;
    EXPECT_LE(did.reclaimed, 1u);  // each takes longer than the budget
  }
  EXPECT_GE(calls, 4);
  EXPECT_GE(domain_.stats().longest_collect, std::chrono::milliseconds(2));
}

TEST_F(Collecting, NoTimeIsEnoughForOneObject) {
  drop<node>(3);
  budget none;
  none.time = nanoseconds(0);
  for (int i = 0; i != 100 && node::live() != 0; ++i) {
    const int before = node::live();
    (void)domain_.collect(none);
    EXPECT_LE(before - node::live(), 1);
  }
  EXPECT_EQ(node::live(), 0);
  (void)domain_.collect();
}

TEST_F(Collecting, HugeBudgetsDoNotOverflow) {
  drop<node>(10);
  budget almost_for_ever;
  almost_for_ever.time = nanoseconds::max() - nanoseconds(1);
  EXPECT_EQ(domain_.collect(almost_for_ever).reclaimed, 10u);
  drop<node>(10);
  EXPECT_EQ(domain_.collect(budget{std::numeric_limits<std::size_t>::max() - 1}).reclaimed, 10u);
}

TEST_F(Collecting, BothLimitsHold) {
  drop<node>(100);
  const auto did = domain_.collect({10, std::chrono::hours(1)});
  EXPECT_EQ(did.result, outcome::partial);
  EXPECT_EQ(did.reclaimed, 0u);  // it noted ten
  EXPECT_EQ(domain_.collect().reclaimed, 100u);
}

TEST_F(Collecting, WhatEntersWhileAGracePeriodIsOpenWaitsForTheNextOne) {
  const mutator::online_scope online(mutator_);
  drop<node>(3);
  EXPECT_EQ(domain_.collect().result, outcome::waiting);
  drop<node>(2);
  mutator_.quiescent();
  const auto first = domain_.collect();
  EXPECT_EQ(first.reclaimed, 3u);
  EXPECT_EQ(first.result, outcome::waiting);
  mutator_.quiescent();
  const auto second = domain_.collect();
  EXPECT_EQ(second.reclaimed, 2u);
  EXPECT_EQ(second.result, outcome::done);
}

// The first call finds only that something is in the chain of a mutator, which publishes it when it ends.
TEST_F(Collecting, AGracePeriodWithoutObjectsIsFollowedByTheNextOneAtOnce) {
  std::atomic<bool> dropped{false};
  std::atomic<bool> enough{false};
  std::thread mapping([&] {
    const mutator m(domain_, "mapping");
    drop<node>(3);
    dropped = true;
    while (!enough) std::this_thread::yield();
  });
  while (!dropped) std::this_thread::yield();
  EXPECT_EQ(domain_.collect().result, outcome::waiting);
  enough = true;
  mapping.join();
  const auto done = domain_.collect();
  EXPECT_EQ(done.result, outcome::done);
  EXPECT_EQ(done.reclaimed, 3u);
}

struct told {
  int calls = 0;
  slamgc::delay last;
};
void tell(const slamgc::delay& d, void* context) {
  auto& to = *static_cast<told*>(context);
  ++to.calls;
  to.last = d;
}

// A mutator that never becomes quiescent.
TEST_F(Collecting, AStalledMutatorIsNamedAndItsBacklogIsTold) {
  told heard;
  domain_.on_backlog(10, &tell, &heard);
  const mutator::online_scope online(mutator_);
  drop<node>(10);
  EXPECT_EQ(domain_.collect().result, outcome::waiting);
  EXPECT_EQ(heard.calls, 0);  // not more than the limit
  drop<node>(1);
  EXPECT_EQ(domain_.collect().result, outcome::waiting);
  EXPECT_EQ(heard.calls, 1);
  EXPECT_STREQ(heard.last.oldest, "test");
  EXPECT_EQ(heard.last.backlog, 11u);
  const nanoseconds age = heard.last.age;
  EXPECT_GE(age.count(), 0);
  while (domain_.delayed().age <= age) {
  }  // it grows
  drop<node>(1000);
  EXPECT_EQ(domain_.collect().result, outcome::waiting);
  EXPECT_EQ(heard.calls, 2);
  EXPECT_GT(heard.last.age, age);
  EXPECT_EQ(heard.last.backlog, 1011u);
  EXPECT_EQ(node::live(), 1011);

  const auto stats = domain_.stats();
  ASSERT_EQ(stats.mutators.size(), 1u);
  EXPECT_TRUE(stats.mutators[0].delays);
  EXPECT_STREQ(stats.delayed.oldest, "test");
  EXPECT_EQ(stats.grace_periods, 1u);

  mutator_.quiescent();
  EXPECT_EQ(domain_.delayed().oldest, nullptr);
  EXPECT_EQ(domain_.delayed().age.count(), 0);
  EXPECT_FALSE(domain_.stats().mutators[0].delays);
  domain_.on_backlog(0, nullptr);
  while (domain_.collect().result != outcome::done) mutator_.quiescent();
  EXPECT_EQ(heard.calls, 2);
}

void collect_again(const slamgc::delay&, void* context) {
  EXPECT_EQ(static_cast<slamgc::domain*>(context)->collect().result, outcome::busy);
}
TEST_F(Collecting, TheHookMayCallCollectWhichDoesNothing) {
  domain_.on_backlog(0, &collect_again, &domain_);
  {
    const mutator::online_scope online(mutator_);
    drop<node>(1);
    EXPECT_EQ(domain_.collect().result, outcome::waiting);
  }
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
}

TEST_F(Collecting, ManyDomainsAreCollectedApart) {
  std::vector<slamgc::domain> domains(3);
  for (auto& d : domains) {
    const mutator m(d, "other");
    drop<node>(2);
  }
  EXPECT_EQ(domain_.collect().reclaimed, 0u);
  for (auto& d : domains) EXPECT_EQ(d.collect().reclaimed, 2u);
}

}  // namespace
