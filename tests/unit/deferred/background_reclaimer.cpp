// The thread that collects. Waits are for what it does, not for time.
#include <slamgc/background_reclaimer.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <slamgc/slamgc.hpp>
#include <thread>
#include <type_traits>

#include "support/instances.hpp"

namespace {

using slamgc::background_reclaimer;
using slamgc::domain;
using slamgc::mutator;
using slamgc::reclaimer_options;
using slamgc::waited;

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
              support::instances<node> {
  ~node() { last_thread = std::this_thread::get_id(); }
  static inline std::atomic<std::thread::id> last_thread{};
};

class Background : public ::testing::Test {
 protected:
  ~Background() override { EXPECT_EQ(node::live(), 0); }
  // Offline: a reclaimer that happens to be at work has nothing to wait for.
  void drop(int n) {
    const mutator m(domain_, "mapping", {false, false});
    for (int i = 0; i != n; ++i) slamgc::retire(new node);
  }
  static void until_empty() {
    while (node::live() != 0) std::this_thread::yield();
  }
  // One that does nothing of its own accord.
  static reclaimer_options on_demand() {
    reclaimer_options o;
    o.pause = std::chrono::hours(1);
    return o;
  }
  domain domain_;
};

TEST_F(Background, CollectsOnAThreadOfItsOwn) {
  reclaimer_options o;
  o.pause = std::chrono::microseconds(50);
  const background_reclaimer r(domain_, o);
  for (int i = 0; i != 5; ++i) {
    drop(100);
    until_empty();
    EXPECT_NE(node::last_thread.load(), std::this_thread::get_id());
  }
}

TEST_F(Background, IsNotCopied) {
  EXPECT_FALSE(std::is_copy_constructible<background_reclaimer>::value);
  EXPECT_FALSE(std::is_copy_assignable<background_reclaimer>::value);
}

TEST_F(Background, WakeEndsAPause) {
  background_reclaimer r(domain_, on_demand());
  for (int i = 0; i != 20; ++i) {
    drop(3);
    r.wake();  // lost by none: also one that comes before the pause counts
    until_empty();
  }
}

// A slice that used its budget up is followed by a short pause, however long the pause is.
TEST_F(Background, ALargeBacklogIsNotPausedOver) {
  reclaimer_options o = on_demand();
  o.slice.objects = 10;
  background_reclaimer r(domain_, o);
  drop(1000);
  r.wake();
  until_empty();
}

TEST_F(Background, OnStartIsCalledFirstAndOnItsThread) {
  std::atomic<std::thread::id> started{};
  reclaimer_options o = on_demand();
  o.on_start = [&] {
    EXPECT_EQ(domain_.stats().grace_periods, 0u);
    started = std::this_thread::get_id();
  };
  drop(1);
  const background_reclaimer r(domain_, o);
  until_empty();
  EXPECT_EQ(started.load(), node::last_thread.load());
  EXPECT_NE(started.load(), std::this_thread::get_id());
}

TEST_F(Background, OnStatsIsToldNowAndThen) {
  std::atomic<int> told{0};
  std::atomic<bool> saw_them{false};
  reclaimer_options o;
  o.pause = std::chrono::microseconds(50);
  o.stats_period = std::chrono::nanoseconds(0);
  o.on_stats = [&](const slamgc::domain_stats& s) {
    if (s.total(&slamgc::type_stats::reclaimed) == 10) saw_them = true;
    ++told;
  };
  const background_reclaimer r(domain_, o);
  drop(10);
  while (!saw_them || told < 3) std::this_thread::yield();
}

TEST_F(Background, OnStatsKeepsItsPeriod) {
  std::atomic<int> told{0};
  std::atomic<int> collected{0};
  reclaimer_options o = on_demand();
  o.stats_period = std::chrono::hours(1);
  o.on_stats = [&](const slamgc::domain_stats&) { ++told; };
  background_reclaimer r(domain_, o);
  for (; collected != 10; ++collected) {
    drop(1);
    r.wake();
    until_empty();
  }
  EXPECT_EQ(r.stop(), waited::done);
  EXPECT_EQ(told, 0);
}

TEST_F(Background, StopDrains) {
  background_reclaimer r(domain_, on_demand());
  drop(1000);
  EXPECT_EQ(r.stop(), waited::done);
  EXPECT_EQ(node::live(), 0);
  EXPECT_EQ(r.stop(), waited::done);  // again
  r.wake();                           // nobody is there
  drop(1);
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
}

TEST_F(Background, StopGivesUpInTimeAndIsRefusedWhereDrainIs) {
  background_reclaimer r(domain_, on_demand());
  std::atomic<bool> enough{false};
  std::atomic<bool> online{false};
  std::thread stalled([&] {
    const mutator m(domain_, "stalled");
    slamgc::retire(new node);
    online = true;
    while (!enough) std::this_thread::yield();
  });
  while (!online) std::this_thread::yield();
  EXPECT_EQ(r.stop(std::chrono::milliseconds(1)), waited::timed_out);
  {
    const mutator m(domain_, "m");
    EXPECT_EQ(r.stop(), waited::refused);
  }
  enough = true;
  stalled.join();
  EXPECT_EQ(r.stop(), waited::done);
}

TEST_F(Background, StopByManyThreads) {
  background_reclaimer r(domain_);
  drop(100);
  std::thread others[3];
  for (std::thread& t : others)
    t = std::thread([&] {
      EXPECT_EQ(r.stop(), waited::done);
      r.wake();
    });
  for (std::thread& t : others) t.join();
  EXPECT_EQ(node::live(), 0);
}

TEST_F(Background, ItsEndDrainsNothing) {
  std::atomic<bool> started{false};
  {
    reclaimer_options o = on_demand();
    o.on_start = [&] { started = true; };
    const background_reclaimer r(domain_, o);
    while (!started || domain_.stats().longest_collect.count() == 0) std::this_thread::yield();
    drop(5);
  }
  EXPECT_EQ(node::live(), 5);
  EXPECT_EQ(domain_.collect().reclaimed, 5u);
}

TEST_F(Background, CollectsBesideOthers) {
  reclaimer_options o;
  o.pause = std::chrono::nanoseconds(0);
  background_reclaimer first(domain_, o);
  background_reclaimer second(domain_, o);
  for (int i = 0; i != 50; ++i) {
    drop(10);
    (void)domain_.collect();
  }
  EXPECT_EQ(first.stop(), waited::done);
  EXPECT_EQ(second.stop(), waited::done);
}

}  // namespace
