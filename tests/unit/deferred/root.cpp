// Roots: made and ended by any thread at any time.
#include "slamgc/root.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <slamgc/slamgc.hpp>
#include <thread>
#include <vector>

#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

namespace on_retire = slamgc::on_retire;
using slamgc::waited;
using online = slamgc::mutator::online_scope;

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
              support::instances<node> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("next", next);
  }
  slamgc::rc_slot<node> next;
};

struct members {
  template <class Visitor>
  void edges(Visitor& v) {
    const std::lock_guard<std::mutex> lock(mutex);
    ++visits;
    v.edge("last", last, on_retire::null);
    v.edge("list", list, on_retire::erase);
  }
  std::mutex mutex;
  std::atomic<int> visits{0};
  slamgc::rc_slot<node> last;
  slamgc::rc_vector<node> list;
};

struct Root : ::testing::Test {
  void TearDown() override { EXPECT_EQ(node::live(), 0); }
  // A retired node that @p of refers to.
  void leave_a_stale_edge(members& of) {
    const online scope(me);
    of.last = new node;
    of.list.push_back(of.last.get());
    slamgc::retire(of.last.get());
  }
  slamgc::domain domain;
  slamgc::mutator me{domain, "test", {false, false}};
};

TEST_F(Root, IsVisitedFromItsBeginToItsEnd) {
  members m;
  {
    const slamgc::root root(domain, "m", m);
    leave_a_stale_edge(m);
    ASSERT_EQ(domain.drain(), waited::done);
    EXPECT_EQ(node::live(), 0);
    EXPECT_TRUE(m.list.empty());
  }
  const int visits = m.visits;
  EXPECT_GE(visits, 1);
  leave_a_stale_edge(m);
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(m.visits, visits) << "it has ended";
  EXPECT_EQ(node::live(), 1);
  m.list.clear();
  m.last = nullptr;
  ASSERT_EQ(domain.drain(), waited::done);
}

TEST_F(Root, BelongsToTheDomainThatIsCurrentOnItsThread) {
  slamgc::domain other;
  members here;
  members there;
  const slamgc::root in_mine("here", here);
  std::optional<slamgc::root> in_other;
  {
    const slamgc::mutator inner(other, "inner", {false, false});
    in_other.emplace("there", there);
  }
  leave_a_stale_edge(here);
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_GE(here.visits, 1);
  EXPECT_EQ(there.visits, 0);
  EXPECT_EQ(node::live(), 0);
}

TEST_F(Root, OfADomainThatEndsFirst) {
  members m;
  std::optional<slamgc::domain> brief(std::in_place);
  const slamgc::root root(*brief, "m", m);
  brief.reset();
}

TEST_F(Root, MadeAndEndedByAnyThread) {
  members m[4];
  std::optional<slamgc::root> roots[4];
  support::in_threads(4, [&](int i) { roots[i].emplace(domain, "m", m[i]); });
  for (members& each : m) leave_a_stale_edge(each);
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(node::live(), 0);
  support::in_threads(4, [&](int i) { roots[3 - i].reset(); });
}

TEST_F(Root, WhoseOwnerPassesAQuiescentState) {
  slamgc::mutator owner(domain, "owner");
  members m;
  const slamgc::root root(owner, "m", m);
  auto* const p = new node;
  m.last = p;
  m.list.push_back(p);
  slamgc::retire(p);
  for (int i = 0; i != 6; ++i) {
    std::thread([&] { (void)domain.collect(); }).join();
    if (i == 0) {
      EXPECT_EQ(m.last, p) << "nobody else touches it";
    }
    owner.quiescent();
  }
  EXPECT_EQ(m.last, nullptr);
  EXPECT_TRUE(m.list.empty());
  EXPECT_EQ(node::live(), 0);
}

TEST_F(Root, WhoseOwnerGoesOffline) {
  slamgc::mutator owner(domain, "owner");
  members m;
  const slamgc::root root(owner, "m", m);
  m.last = new node;
  slamgc::retire(m.last.get());
  (void)domain.collect();
  owner.quiescent();
  (void)domain.collect();  // purges
  {
    const slamgc::mutator::offline_scope offline(owner);
    EXPECT_EQ(m.last, nullptr);
    ASSERT_EQ(domain.drain(), waited::done);
  }
  EXPECT_EQ(node::live(), 0);
}

// While it is offline, and when it ends offline, its thread may not follow what is borrowed.
struct chained {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("last", last, on_retire::bypass([this](node& retired) {
             ++asked;
             return retired.next.get();
           }));
  }
  slamgc::rc_slot<node> last;
  int asked = 0;
};
TEST_F(Root, WhoseOwnerIsOfflineIsLeftAlone) {
  chained m;
  {
    slamgc::mutator owner(domain, "owner", {false, false});
    const slamgc::root root(owner, "m", m);
    {
      const online scope(me);
      m.last = new node;
      m.last->next = new node;
      slamgc::retire(m.last.get());
    }
    ASSERT_EQ(domain.drain(), waited::done);
    EXPECT_EQ(m.asked, 0);
  }
  {
    std::optional<slamgc::mutator> owner(std::in_place, domain, "owner",
                                         slamgc::mutator_options{false, false});
    const slamgc::root root(*owner, "m", m);
    ASSERT_EQ(domain.drain(), waited::done);
    owner.reset();
    EXPECT_EQ(m.asked, 0);
  }
  {
    const online scope(me);
    slamgc::retire(m.last->next.get());
  }
  m.last = nullptr;
  ASSERT_EQ(domain.drain(), waited::done);
}

// What a purge that it has missed would have dropped goes when it comes back, however often that was before.
TEST_F(Root, WhoseOwnerHasMissedAPurge) {
  slamgc::mutator owner(domain, "owner");
  members m;
  const slamgc::root root(owner, "m", m);
  for (int i = 0; i != 10; ++i) {
    m.last = new node;
    slamgc::retire(m.last.get());
    {
      const slamgc::mutator::offline_scope offline(owner);
      ASSERT_EQ(domain.drain(), waited::done);
      EXPECT_NE(m.last, nullptr) << "nobody else touches it";
    }
    EXPECT_EQ(m.last, nullptr);
  }
  for (int i = 0; i != 6; ++i) {
    (void)domain.collect();
    owner.quiescent();
  }
  EXPECT_EQ(node::live(), 0);
}

TEST_F(Root, ThatOutlivesItsOwner) {
  members m;
  std::optional<slamgc::mutator> owner(std::in_place, domain, "owner");
  const slamgc::root first(*owner, "m", m);
  std::optional<slamgc::root> second(std::in_place, *owner, "m", m);
  const slamgc::root third(*owner, "m", m);
  second.reset();
  owner.reset();
  const int visits = m.visits;
  leave_a_stale_edge(m);
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(m.visits, visits) << "whom it belonged to is gone: nobody may touch it";
  m.last = nullptr;
  m.list.clear();
  ASSERT_EQ(domain.drain(), waited::done);
}

// The end of a root waits while a collector is in its edges(), and no longer.
struct slow_members {
  template <class Visitor>
  void edges(Visitor& v) {
    inside = true;
    while (!go_on) std::this_thread::yield();
    v.edge("last", last, on_retire::null);
    inside = false;
  }
  std::atomic<bool> inside{false}, go_on{false};
  slamgc::rc_slot<node> last;
};
TEST_F(Root, EndsAfterTheCollectorHasLeftIt) {
  slamgc::rc_slot<node> kept;
  {
    const online scope(me);
    kept = new node;
    slamgc::retire(kept.get());
  }
  std::optional<slow_members> m(std::in_place);
  std::optional<slamgc::root> root(std::in_place, domain, "m", *m);
  std::thread collector([&] { EXPECT_EQ(domain.drain(), waited::done); });
  while (!m->inside) std::this_thread::yield();
  std::atomic<bool> ending{false};
  std::thread ends([&] {
    ending = true;
    root.reset();
    EXPECT_FALSE(m->inside);
    m.reset();
  });
  while (!ending) std::this_thread::yield();
  m->go_on = true;
  ends.join();
  collector.join();
  kept = nullptr;
  ASSERT_EQ(domain.drain(), waited::done);
}

// A place in the list is used again, without the wishes of its last user.
TEST_F(Root, DoesNotInheritAWish) {
  for (int i = 0; i != 3; ++i) {
    members asked;
    members other;
    {
      const online scope(me);
      other.list.push_back(new node);
    }
    {
      slamgc::root root(domain, "asked", asked);
      root.collect_cycles();
    }
    const slamgc::root root(domain, "other", other);
    ASSERT_EQ(domain.drain(), waited::done);
    EXPECT_EQ(other.list.size(), 1U);
    {
      const online scope(me);
      slamgc::retire(other.list.front().get());
    }
    ASSERT_EQ(domain.drain(), waited::done);
    EXPECT_TRUE(other.list.empty());
  }
}

}  // namespace
