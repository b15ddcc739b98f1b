// What calls do with null, with a time or a thread that is not theirs, and in an order that is not the usual one.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <mutex>
#include <slamgc/background_reclaimer.hpp>
#include <slamgc/slamgc.hpp>
#include <string>
#include <thread>

#include "support/instances.hpp"

namespace {

using slamgc::waited;
using std::chrono::milliseconds;

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
              support::instances<node> {};
struct slow : slamgc::rc_object<slow, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
  ~slow() {
    const auto end = std::chrono::steady_clock::now() + milliseconds(1);
    while (std::chrono::steady_clock::now() < end) {
    }
  }
};
struct scanned : slamgc::rc_object<scanned, slamgc::fetch_add_counter, slamgc::reclaim_by_scan> {};

TEST(Limits, NullIsNotRetired) {
  EXPECT_FALSE(slamgc::retire(static_cast<node*>(nullptr)));
  slamgc::retire_set<scanned> set;
  EXPECT_FALSE(set.insert(nullptr));
  EXPECT_TRUE(set.empty());
}

TEST(Limits, AConstantObjectCanBeRetired) {
  slamgc::domain domain;
  {
    const slamgc::mutator m(domain, "m");
    const node* const p = new node;
    EXPECT_TRUE(slamgc::retire(p));
  }
  EXPECT_EQ(domain.collect().reclaimed, 1U);
}

TEST(Limits, AMutatorWithoutANameIsNamedAsADelayAllTheSame) {
  slamgc::domain domain;
  const slamgc::mutator nameless(domain, nullptr);
  std::thread([&domain] {
    const slamgc::mutator m(domain, "m");
    slamgc::retire(new node);
  }).join();
  EXPECT_EQ(domain.collect().result, slamgc::collected::outcome::waiting);
  ASSERT_NE(domain.delayed().oldest, nullptr);
  EXPECT_EQ(std::string(domain.delayed().oldest), "");
}

TEST(Limits, TheOldestMutatorIsNamed) {
  slamgc::domain domain;
  slamgc::mutator oldest(domain, "oldest", {false, false});
  slamgc::mutator younger(domain, "younger", {false, false});
  const slamgc::mutator::online_scope first(oldest);
  (void)domain.collect();
  std::thread([&domain] { (void)domain.synchronize(milliseconds(0)); }).join();  // another epoch
  const slamgc::mutator::online_scope second(younger);
  slamgc::retire(new node);
  EXPECT_EQ(domain.collect().result, slamgc::collected::outcome::waiting);
  EXPECT_EQ(std::string(domain.delayed().oldest), "oldest");
  oldest.quiescent();
  EXPECT_EQ(std::string(domain.delayed().oldest), "younger");
}

TEST(Limits, DrainKeepsItsTimeWhileDestructorsRun) {
  slamgc::domain domain;
  {
    const slamgc::mutator m(domain, "m");
    for (int i = 0; i != 200; ++i) slamgc::retire(new slow);
  }
  EXPECT_EQ(domain.drain(milliseconds(20)), waited::timed_out);
  EXPECT_GT(domain.stats().types.front().live, 0U);
  EXPECT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(domain.stats().types.front().live, 0U);
}

TEST(Limits, ARealTimeThreadMayDrainWhileItIsOffline) {
  slamgc::domain domain;
  slamgc::mutator tracking(domain, "tracking", {false, true});
  {
    const slamgc::mutator::online_scope frame(tracking);
    slamgc::retire(new node);
  }
  EXPECT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(domain.stats().types.front().live, 0U);
  EXPECT_EQ(domain.stats().refused_collects, 0U);
}

TEST(Limits, ADomainThatEndsOnARealTimeThreadRunsNoDestructor) {
  static slamgc::mutator* tracking = nullptr;  // stays, and keeps what the object needs in reach
  static node* left = nullptr;
  const int before = node::live();
  testing::internal::CaptureStderr();
  std::thread([] {
    slamgc::domain domain;
    tracking = new slamgc::mutator(domain, "tracking", {true, true});
    left = new node;
    slamgc::retire(left);
  }).join();
  EXPECT_NE(testing::internal::GetCapturedStderr().find("while 1 objects"), std::string::npos);
  EXPECT_EQ(node::live(), before + 1);
  EXPECT_TRUE(tracking->is_online());
}

// As in a program whose main() has a mutator when it first calls a function with a thread_local one.
TEST(Limits, MutatorsEndInAnyOrder) {
  slamgc::domain domain;
  std::thread([&domain] {
    auto outer = std::make_unique<slamgc::mutator>(domain, "outer");
    auto inner = std::make_unique<slamgc::mutator>(domain, "inner");
    auto innermost = std::make_unique<slamgc::mutator>(domain, "innermost");
    slamgc::retire(new node);
    inner.reset();
    slamgc::retire(new node);
    outer.reset();
    slamgc::retire(new node);
    innermost->quiescent();
    innermost.reset();
  }).join();
  EXPECT_TRUE(domain.stats().mutators.empty());
  EXPECT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(domain.stats().types.front().reclaimed, 3U);
}

TEST(Limits, AMutatorMadeByADestructorOutlivesTheCollection) {
  struct registers
      : slamgc::rc_object<registers, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
    std::unique_ptr<slamgc::mutator>* made;
    slamgc::domain* domain;
    ~registers() { *made = std::make_unique<slamgc::mutator>(*domain, "made by a destructor"); }
  };
  slamgc::domain domain;
  std::unique_ptr<slamgc::mutator> made;
  {
    const slamgc::mutator m(domain, "m");
    auto* const p = new registers;
    p->made = &made;
    p->domain = &domain;
    slamgc::retire(p);
  }
  (void)domain.collect();
  ASSERT_NE(made, nullptr);
  EXPECT_TRUE(made->is_online());
  slamgc::retire(new node);  // belongs to the domain, by that mutator
  EXPECT_EQ(domain.drain(), waited::refused);
  made.reset();
  EXPECT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(domain.stats().total(&slamgc::type_stats::live), 0U);
}

TEST(Limits, APauseForEverAndAStopOnTheThreadItself) {
  slamgc::domain domain;
  waited on_its_thread = waited::done;
  slamgc::background_reclaimer* self = nullptr;
  std::atomic<bool> told{false};
  slamgc::reclaimer_options options;
  options.pause = std::chrono::nanoseconds::max();
  options.stats_period = std::chrono::nanoseconds(0);
  options.on_stats = [&](const slamgc::domain_stats&) {
    if (self == nullptr || told) return;
    on_its_thread = self->stop();
    told = true;
  };
  std::mutex ready;
  std::unique_lock<std::mutex> not_ready(ready);
  options.on_start = [&ready] { const std::lock_guard<std::mutex> wait(ready); };
  slamgc::background_reclaimer reclaimer(domain, options);
  self = &reclaimer;
  not_ready.unlock();
  while (!told) std::this_thread::yield();
  EXPECT_EQ(on_its_thread, waited::refused);
  EXPECT_EQ(reclaimer.stop(), waited::done);
}

}  // namespace
