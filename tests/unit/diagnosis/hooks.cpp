// What a domain tells a profiler, and when.
#include <slamgc/diagnosis/hooks.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <slamgc/slamgc.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace {

using slamgc::domain;
using slamgc::mutator;
using slamgc::slice_stats;
using slamgc::type_stats;
using outcome = slamgc::collected::outcome;

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};
struct other : slamgc::rc_object<other, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};

bool names(const type_stats& t, const char* type) {
  return std::string(t.type).find(type) != std::string::npos;
}

// Writes down what it is told, in order.
class recorder final : public slamgc::collector_hooks {
 public:
  void slice_begins(time_point when) noexcept override {
    thread_ = std::this_thread::get_id();
    begin_ = when;
    say() << "begin";
  }
  void grace_period_closed(std::uint64_t number, time_point when) noexcept override {
    EXPECT_EQ(thread_, std::this_thread::get_id());
    EXPECT_EQ(when, begin_);
    say() << "closed " << number;
  }
  void grace_period_opened(std::uint64_t number, time_point when) noexcept override {
    EXPECT_GE(when, begin_);
    EXPECT_LE(when, std::chrono::steady_clock::now());
    say() << "opened " << number;
  }
  void objects(const type_stats& now, std::uint64_t reclaimed) noexcept override {
    say() << (names(now, "node") ? "node" : "other") << ": live " << now.live << ", backlog "
          << now.backlog << ", reclaimed " << reclaimed;
  }
  void slice_ended(const slice_stats& s) noexcept override {
    EXPECT_EQ(s.begin, begin_);
    EXPECT_GT(s.took.count(), 0);
    say() << (s.did.result == outcome::done      ? "done "
              : s.did.result == outcome::waiting ? "waiting "
                                                 : "partial ")
          << s.did.reclaimed << ", grace periods " << s.grace_periods;
    if (s.delayed.oldest != nullptr) line_ << ", for " << s.delayed.oldest;
  }

  std::vector<std::string> told() {
    (void)say();
    auto all = std::move(told_);
    told_.clear();
    return all;
  }

 private:
  std::ostringstream& say() {
    if (!line_.str().empty()) told_.push_back(line_.str());
    line_.str("");
    return line_;
  }
  std::thread::id thread_;
  time_point begin_;
  std::ostringstream line_;
  std::vector<std::string> told_;
};

using told = std::vector<std::string>;

class Hooks : public ::testing::Test {
 protected:
  void retire(int n) {
    const mutator m(domain_, "mapping", {false, false});
    for (int i = 0; i != n; ++i) slamgc::retire(new node);
  }
  recorder hooks_;  // outlives the domain
  domain domain_;
};

TEST_F(Hooks, ASliceThatReclaims) {
  domain_.install(&hooks_);
  retire(3);
  EXPECT_EQ(domain_.collect().reclaimed, 3u);
  EXPECT_EQ(hooks_.told(),
            (told{"begin", "node: live 0, backlog 0, reclaimed 3", "done 3, grace periods 1"}));
}

TEST_F(Hooks, TypesAreToldWhenTheirNumbersChange) {
  retire(2);
  {
    const mutator m(domain_, "m", {false, false});
    slamgc::retire(new other);
  }
  (void)domain_.collect();  // not told
  domain_.install(&hooks_);
  (void)domain_.collect();
  EXPECT_EQ(hooks_.told(),
            (told{"begin", "other: live 0, backlog 0, reclaimed 0",
                  "node: live 0, backlog 0, reclaimed 0", "done 0, grace periods 0"}));
  (void)domain_.collect();
  EXPECT_EQ(hooks_.told(), (told{"begin", "done 0, grace periods 0"}));
  retire(1);
  (void)domain_.collect();
  EXPECT_EQ(hooks_.told(),
            (told{"begin", "node: live 0, backlog 0, reclaimed 1", "done 1, grace periods 1"}));
  recorder others;
  domain_.install(&others);
  (void)domain_.collect();
  EXPECT_EQ(others.told().size(), 4u);
  domain_.install(nullptr);
}

TEST_F(Hooks, AGracePeriodThatSpansSlices) {
  domain_.install(&hooks_);
  retire(1);
  mutator m(domain_, "tracking");
  EXPECT_EQ(domain_.collect().result, outcome::waiting);
  EXPECT_EQ(hooks_.told(), (told{"begin", "opened 1", "node: live 1, backlog 1, reclaimed 0",
                                 "waiting 0, grace periods 1, for tracking"}));
  EXPECT_EQ(domain_.collect().result, outcome::waiting);
  EXPECT_EQ(hooks_.told(), (told{"begin", "waiting 0, grace periods 0, for tracking"}));
  {
    const mutator::offline_scope offline(m);
    EXPECT_EQ(domain_.collect().reclaimed, 1u);
  }
  EXPECT_EQ(hooks_.told(), (told{"begin", "closed 1", "node: live 0, backlog 0, reclaimed 1",
                                 "done 1, grace periods 0"}));
}

TEST_F(Hooks, OneGracePeriodAfterTheOther) {
  domain_.install(&hooks_);
  mutator m(domain_, "tracking");
  slamgc::retire(new node);
  EXPECT_EQ(domain_.collect().result, outcome::waiting);
  slamgc::retire(new node);
  m.quiescent();
  EXPECT_EQ(domain_.collect().result, outcome::waiting);
  EXPECT_EQ(hooks_.told(), (told{"begin", "opened 1", "node: live 1, backlog 1, reclaimed 0",
                                 "waiting 0, grace periods 1, for tracking", "begin", "closed 1",
                                 "opened 2", "node: live 1, backlog 1, reclaimed 1",
                                 "waiting 1, grace periods 1, for tracking"}));
}

TEST_F(Hooks, ASliceThatUsesItsBudgetUp) {
  domain_.install(&hooks_);
  retire(3);
  slamgc::budget two;
  two.objects = 2;
  EXPECT_EQ(domain_.collect(two).result, outcome::partial);
  EXPECT_EQ(hooks_.told(),
            (told{"begin", "node: live 3, backlog 3, reclaimed 0", "partial 0, grace periods 0"}));
}

TEST_F(Hooks, CallsThatDoNothingAreNotTold) {
  struct nested : slamgc::rc_object<nested, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
    explicit nested(domain& d) : of(d) {}
    ~nested() { EXPECT_EQ(of.collect().result, outcome::busy); }
    domain& of;
  };
  {
    const mutator m(domain_, "m", {false, false});
    slamgc::retire(new nested(domain_));
  }
  domain_.install(&hooks_);
  (void)domain_.collect();
  EXPECT_EQ(hooks_.told().size(), 3u);
}

TEST_F(Hooks, TheEndOfADomainIsASlice) {
  recorder hooks;
  {
    domain d;
    d.install(&hooks);
    const mutator m(d, "m", {false, false});
    slamgc::retire(new node);
  }
  EXPECT_EQ(hooks.told().size(), 3u);
}

TEST_F(Hooks, NoneAreCalledUnlessOverridden) {
  slamgc::collector_hooks nothing;
  domain_.install(&nothing);
  retire(1);
  const mutator m(domain_, "tracking");
  EXPECT_EQ(domain_.collect().result, outcome::waiting);
  domain_.install(nullptr);
}

TEST_F(Hooks, SlicesOfManyThreadsComeOneAtATime) {
  class checks final : public slamgc::collector_hooks {
   public:
    void slice_begins(time_point) noexcept override { EXPECT_FALSE(inside_.exchange(true)); }
    void objects(const type_stats&, std::uint64_t n) noexcept override { reclaimed += n; }
    void slice_ended(const slice_stats&) noexcept override { EXPECT_TRUE(inside_.exchange(false)); }
    std::uint64_t reclaimed = 0;

   private:
    std::atomic<bool> inside_{false};
  } hooks;
  domain d;
  d.install(&hooks);
  std::thread threads[3];
  for (std::thread& t : threads)
    t = std::thread([&d] {
      mutator m(d, "m");
      for (int i = 0; i != 200; ++i) {
        slamgc::retire(new node);
        m.quiescent();
        (void)d.collect();
      }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(d.drain(), slamgc::waited::done);
  EXPECT_EQ(hooks.reclaimed, 600u);
  d.install(nullptr);
}

}  // namespace
