// Chosen interleavings: what another thread does right before or after an access to the state word is done
// there, by a counter policy with hooks. (tests/model tries all of them; this runs under the sanitizers.)
#include <slamgc/deferred.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <slamgc/slamgc.hpp>
#include <utility>

#include "support/instances.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::retire;
using outcome = slamgc::collected::outcome;

std::function<void()> after_load;
std::function<void()> before_exchange;
void once(std::function<void()>& hook) {
  if (const auto now = std::exchange(hook, nullptr)) now();
}

struct hooked_counter : slamgc::fetch_add_counter {
  static std::uint64_t load(const storage& s) noexcept {
    const std::uint64_t found = slamgc::fetch_add_counter::load(s);
    once(after_load);
    return found;
  }
  static bool compare_exchange(storage& s, std::uint64_t& expected,
                               std::uint64_t desired) noexcept {
    once(before_exchange);
    return slamgc::fetch_add_counter::compare_exchange(s, expected, desired);
  }
};

template <class Reclaimer>
struct node : slamgc::rc_object<node<Reclaimer>, hooked_counter, Reclaimer>,
              support::instances<node<Reclaimer>> {};
using at_zero = node<slamgc::reclaim_deferred>;
using when_retired = node<slamgc::reclaim_retired>;
using by_scan = node<slamgc::reclaim_by_scan>;

class Interleaving : public ::testing::Test {
 protected:
  ~Interleaving() override {
    EXPECT_FALSE(after_load);
    EXPECT_FALSE(before_exchange);
    EXPECT_EQ(at_zero::live() + when_retired::live() + by_scan::live(), 0);
    EXPECT_EQ(domain_.delayed().backlog, 0u);
  }
  std::size_t pass() {
    mutator_.quiescent();
    return domain_.collect().reclaimed;
  }
  std::uint64_t retired() const { return domain_.stats().total(&slamgc::type_stats::retired); }

  slamgc::domain domain_;
  slamgc::mutator mutator_{domain_, "m"};
};

TEST_F(Interleaving, AnObjectFallsToZeroWhileItIsBeingRetired) {
  auto p = make_rc<at_zero>();
  at_zero* const raw = p.get();
  after_load = [&] { p.reset(); };  // its link names no table any more
  EXPECT_TRUE(retire(raw));
  EXPECT_EQ(retired(), 1u);
  EXPECT_EQ(domain_.delayed().backlog, 1u);
  (void)domain_.collect();
  EXPECT_EQ(pass(), 1u);
}

TEST_F(Interleaving, TheLastReferenceGoesWhileAnObjectIsBeingRetired) {
  auto p = make_rc<when_retired>();
  when_retired* const raw = p.get();
  before_exchange = [&] { p.reset(); };  // not retired yet: it does not enter
  EXPECT_TRUE(retire(raw));
  EXPECT_TRUE(raw->state().is_queued());
  (void)domain_.collect();
  EXPECT_EQ(pass(), 1u);
}

TEST_F(Interleaving, AnObjectIsRetiredWhileItsLastReferenceGoes) {
  auto p = make_rc<when_retired>();
  when_retired* const raw = p.get();
  before_exchange = [&] { EXPECT_TRUE(retire(raw)); };  // still counted: it does not enter
  p.reset();
  EXPECT_TRUE(raw->state().is_queued());
  EXPECT_EQ(domain_.delayed().backlog, 1u);
  (void)domain_.collect();
  EXPECT_EQ(pass(), 1u);
}

TEST_F(Interleaving, OfTwoRetirementsOneCounts) {
  auto* const raw = new when_retired;
  before_exchange = [&] { EXPECT_TRUE(retire(raw)); };
  EXPECT_FALSE(retire(raw));
  EXPECT_EQ(retired(), 1u);
  EXPECT_EQ(domain_.delayed().backlog, 1u);
  (void)domain_.collect();
  EXPECT_EQ(pass(), 1u);
}

TEST_F(Interleaving, OfTwoLastReferencesOneEnters) {
  auto p = make_rc<at_zero>();
  auto q = p;
  before_exchange = [&] { q.reset(); };
  p.reset();
  EXPECT_EQ(domain_.delayed().backlog, 1u);
  (void)domain_.collect();
  EXPECT_EQ(pass(), 1u);
}

TEST_F(Interleaving, AReferenceComesWhileTheLastOneGoes) {
  auto p = make_rc<at_zero>();
  at_zero* const raw = p.get();
  intrusive_rc<at_zero> q;
  before_exchange = [&] { q = raw; };
  p.reset();
  EXPECT_FALSE(raw->state().is_queued());
  q.reset();
  (void)domain_.collect();
  EXPECT_EQ(pass(), 1u);
}

TEST_F(Interleaving, AReferenceGoesWhileTheCollectorLetsTheObjectLeave) {
  auto p = make_rc<at_zero>();
  at_zero* const raw = p.get();
  p.reset();
  (void)domain_.collect();
  p = raw;
  before_exchange = [&] { p.reset(); };  // the flag is still set: it enters nothing
  EXPECT_EQ(pass(), 0u);
  EXPECT_TRUE(raw->state().is_queued());
  EXPECT_EQ(domain_.delayed().backlog, 1u);
  EXPECT_EQ(pass(), 1u);
}

TEST_F(Interleaving, AReferenceComesRightAfterTheCollectorHasDecided) {
  auto p = make_rc<at_zero>();
  at_zero* const raw = p.get();
  p.reset();
  (void)domain_.collect();
  intrusive_rc<at_zero>(raw).reset();  // another version: it enters anew
  after_load = [&] { p = raw; };       // after the word was found at zero
  EXPECT_EQ(pass(), 0u);
  EXPECT_EQ(p->use_count(), 1u);
  EXPECT_EQ(pass(), 0u);
  EXPECT_FALSE(p->state().is_queued());
  p.reset();
  (void)domain_.collect();
  EXPECT_EQ(pass(), 1u);
}

TEST_F(Interleaving, AnObjectIsRetiredWhileTheCollectorLetsItLeave) {
  auto p = make_rc<when_retired>();
  when_retired* const raw = p.get();
  EXPECT_TRUE(retire(raw));
  p.reset();
  (void)domain_.collect();
  p = raw;
  before_exchange = [&] { EXPECT_FALSE(retire(raw)); };
  EXPECT_EQ(pass(), 0u);
  EXPECT_FALSE(raw->state().is_queued());
  p.reset();
  (void)domain_.collect();
  EXPECT_EQ(pass(), 1u);
}

TEST_F(Interleaving, OfTwoInsertionsIntoARetireSetOneCounts) {
  slamgc::retire_set<by_scan> dead;
  auto* const raw = new by_scan;
  before_exchange = [&] { EXPECT_TRUE(dead.insert(raw)); };
  EXPECT_FALSE(dead.insert(raw));
  EXPECT_EQ(dead.scan(), 1u);
}

}  // namespace
