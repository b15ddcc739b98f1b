// synchronize() and drain(): what they wait for, when they give up, when they refuse.
#include <slamgc/domain.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <slamgc/slamgc.hpp>
#include <thread>

#include "support/instances.hpp"

namespace {

using slamgc::domain;
using slamgc::intrusive_rc;
using slamgc::mutator;
using slamgc::waited;
using std::chrono::nanoseconds;

constexpr nanoseconds moment = std::chrono::microseconds(100);

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
              support::instances<node> {
  ~node() {
    if (at_end) at_end();
  }
  std::function<void()> at_end;
  slamgc::rc_slot<node> next;
};

class Waiting : public ::testing::Test {
 protected:
  ~Waiting() override { EXPECT_EQ(node::live(), 0); }
};

TEST_F(Waiting, WithoutMutatorsThereIsNothingToWaitFor) {
  domain d;
  EXPECT_EQ(d.synchronize(nanoseconds(0)), waited::done);
  EXPECT_EQ(d.drain(nanoseconds(0)), waited::done);
}

TEST_F(Waiting, AnOnlineMutatorWouldWaitForItself) {
  domain d;
  domain another;
  mutator m(d, "m");
  EXPECT_EQ(d.synchronize(), waited::refused);
  EXPECT_EQ(d.drain(), waited::refused);
  EXPECT_EQ(another.synchronize(), waited::done);
  EXPECT_EQ(another.drain(), waited::done);
  {
    const mutator inner(another, "inner");
    EXPECT_EQ(d.synchronize(), waited::refused);  // the outer one is online
    EXPECT_EQ(d.drain(), waited::refused);
  }
  const mutator::offline_scope offline(m);
  EXPECT_EQ(d.synchronize(), waited::done);
  EXPECT_EQ(d.drain(), waited::done);
}

TEST_F(Waiting, TheyGiveUpInTime) {
  domain d;
  std::atomic<bool> online{false};
  std::atomic<bool> enough{false};
  std::thread stalled([&] {
    const mutator m(d, "stalled");
    slamgc::retire(new node);
    online = true;
    while (!enough) std::this_thread::yield();
  });
  while (!online) std::this_thread::yield();
  EXPECT_EQ(d.synchronize(moment), waited::timed_out);
  EXPECT_EQ(d.drain(moment), waited::timed_out);
  EXPECT_STREQ(d.delayed().oldest, "stalled");
  EXPECT_EQ(node::live(), 1);
  enough = true;
  stalled.join();
  EXPECT_EQ(d.drain(), waited::done);
}

TEST_F(Waiting, SynchronizeEndsWhenEachMutatorHasPassed) {
  domain d;
  std::atomic<int> passed{0};
  std::atomic<bool> online{false};
  std::atomic<bool> enough{false};
  std::thread reader([&] {
    mutator m(d, "reader");
    online = true;
    while (!enough) {
      ++passed;
      m.quiescent();
      std::this_thread::yield();
    }
  });
  while (!online) std::this_thread::yield();
  for (int i = 0; i != 20; ++i) {
    const int before = passed;
    EXPECT_EQ(d.synchronize(), waited::done);
    EXPECT_GT(passed, before);
  }
  enough = true;
  reader.join();
}

TEST_F(Waiting, DrainTakesAsManyGracePeriodsAsAChainHasLinks) {
  domain d;
  std::atomic<bool> made{false};
  std::atomic<bool> enough{false};
  std::thread mapping([&] {
    mutator m(d, "mapping");
    intrusive_rc<node> head;
    for (int i = 0; i != 20; ++i) {
      auto p = slamgc::make_rc<node>();
      p->next = std::move(head);
      head = std::move(p);
    }
    head.reset();
    made = true;
    while (!enough) {
      m.quiescent();
      std::this_thread::yield();
    }
  });
  while (!made) std::this_thread::yield();
  EXPECT_EQ(d.drain(), waited::done);
  EXPECT_EQ(node::live(), 0);
  EXPECT_GE(d.stats().grace_periods, 20u);
  enough = true;
  mapping.join();
}

TEST_F(Waiting, ADestructorCannotWaitForItsOwnCollector) {
  domain d;
  waited drained = waited::done;
  {
    const mutator m(d, "maker");
    auto p = slamgc::make_rc<node>();
    p->at_end = [&] { drained = d.drain(); };
  }
  EXPECT_EQ(d.collect().reclaimed, 1u);
  EXPECT_EQ(drained, waited::refused);
}

TEST_F(Waiting, DrainWaitsForACollectorOnAnotherThread) {
  domain d;
  std::atomic<bool> collecting{false};
  std::atomic<bool> go_on{false};
  {
    const mutator m(d, "maker");
    auto p = slamgc::make_rc<node>();
    p->at_end = [&] {
      collecting = true;
      while (!go_on) std::this_thread::yield();
    };
  }
  std::thread collector([&] { (void)d.collect(); });
  while (!collecting) std::this_thread::yield();
  EXPECT_EQ(d.collect().result, slamgc::collected::outcome::busy);
  EXPECT_EQ(d.drain(moment), waited::timed_out);
  go_on = true;
  EXPECT_EQ(d.drain(), waited::done);
  collector.join();
}

}  // namespace
