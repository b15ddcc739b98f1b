// Weak handles: they lead to an object until nobody else refers to it, and say for ever which one it was.
#include <gtest/gtest.h>

#include <slamgc/mutex_counter.hpp>
#include <slamgc/slamgc.hpp>
#include <type_traits>
#include <unordered_set>
#include <vector>

#include "support/instances.hpp"
#include "support/policies.hpp"

namespace {

using slamgc::domain;
using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::mutator;
using slamgc::waited;

template <class Policy, class Reclaimer>
struct node : slamgc::rc_object<node<Policy, Reclaimer>, Policy, Reclaimer>,
              slamgc::enable_weak_rc<node<Policy, Reclaimer>>,
              support::instances<node<Policy, Reclaimer>> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("next", next);
  }
  slamgc::rc_slot<node> next;
};
using deferred_node = node<slamgc::fetch_add_counter, slamgc::reclaim_deferred>;
using retired_node = node<slamgc::fetch_add_counter, slamgc::reclaim_retired>;
using slamgc::weak_rc;

// A type that describes no edges, and has a derived class.
struct base : slamgc::rc_object<base, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
              slamgc::enable_weak_rc<base> {
  virtual ~base() = default;
};
struct other_base {
  virtual ~other_base() = default;
  int padding = 0;
};
struct derived : other_base, base {};

// Collects until nothing waits; the thread holds no borrowed pointer.
void settle(domain& d, mutator& m) {
  const mutator::offline_scope offline(m);
  EXPECT_EQ(d.drain(), waited::done);
}

template <class Policy>
class WeakRcPolicies : public ::testing::Test {};
TYPED_TEST_SUITE(WeakRcPolicies, support::all_policies, support::policy_names);

TYPED_TEST(WeakRcPolicies, LeadToAnObjectAsLongAsItIsReferredTo) {
  using object = node<TypeParam, slamgc::reclaim_deferred>;
  domain d;
  mutator m(d, "m");
  auto p = make_rc<object>();
  const weak_rc<object> w(p);
  settle(d, m);
  EXPECT_EQ(w.lock(), p);
  EXPECT_FALSE(w.expired());
  EXPECT_EQ(p->use_count(), 1U);
  p.reset();
  settle(d, m);
  EXPECT_EQ(w.lock(), nullptr);
  EXPECT_TRUE(w.expired());
  EXPECT_EQ(object::live(), 0);
}

TYPED_TEST(WeakRcPolicies, OfARetiredObjectTooThatSomebodyHolds) {
  using object = node<TypeParam, slamgc::reclaim_retired>;
  domain d;
  mutator m(d, "m");
  auto p = make_rc<object>();
  p->next = p;
  const weak_rc<object> w(p);
  slamgc::retire(p.get());
  settle(d, m);
  EXPECT_EQ(w.lock(), p);
  p.reset();
  settle(d, m);
  EXPECT_EQ(w.lock(), nullptr);
  EXPECT_EQ(object::live(), 0);
}

TEST(WeakRc, IsAsLargeAsAPointerAndAddsOneToTheObject) {
  struct plain : slamgc::rc_object<plain, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};
  EXPECT_EQ(sizeof(weak_rc<base>), sizeof(void*));
  struct weak : slamgc::rc_object<weak, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
                slamgc::enable_weak_rc<weak> {};
  EXPECT_EQ(sizeof(weak), sizeof(plain) + sizeof(void*));
}

TEST(WeakRc, NullIsExpired) {
  const weak_rc<deferred_node> none;
  EXPECT_TRUE(none.expired());
  EXPECT_EQ(none.lock(), nullptr);  // on a thread without a mutator, too
  EXPECT_TRUE(weak_rc<deferred_node>(intrusive_rc<deferred_node>()).expired());
  EXPECT_EQ(none, weak_rc<deferred_node>(nullptr));
}

TEST(WeakRc, CopiesAndMoves) {
  domain d;
  mutator m(d, "m");
  auto p = make_rc<deferred_node>();
  weak_rc<deferred_node> a(p);
  const weak_rc<deferred_node> b = a;  // NOLINT(performance-unnecessary-copy-initialization)
  EXPECT_EQ(a, b);
  weak_rc<deferred_node> c = std::move(a);
  EXPECT_TRUE(a.expired());  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(c, b);
  a.swap(c);
  EXPECT_TRUE(c.expired());
  EXPECT_EQ(a.lock(), p);
  a.reset();
  EXPECT_TRUE(a.expired());
  c = p->next;
  EXPECT_TRUE(c.expired());
  p.reset();
  settle(d, m);
  EXPECT_TRUE(b.expired());
}

TEST(WeakRc, ACopyOfAnObjectIsAnotherOne) {
  domain d;
  mutator m(d, "m");
  auto p = make_rc<deferred_node>();
  const weak_rc<deferred_node> w(p);
  auto q = make_rc<deferred_node>(*p);
  EXPECT_NE(weak_rc<deferred_node>(q), w);
  *q = *p;
  EXPECT_NE(weak_rc<deferred_node>(q), w);
  p.reset();
  settle(d, m);
  EXPECT_TRUE(w.expired());
  q.reset();
  settle(d, m);
}

TEST(WeakRc, IdentityOutlivesTheObjectAndItsAddress) {
  domain d;
  mutator m(d, "m");
  std::vector<weak_rc<deferred_node>> all;
  std::unordered_set<weak_rc<deferred_node>> seen;
  std::unordered_set<const void*> addresses;
  for (int i = 0; i != 100; ++i) {
    auto p = make_rc<deferred_node>();
    addresses.insert(p.get());
    all.emplace_back(p);
    seen.insert(all.back());
    EXPECT_EQ(weak_rc<deferred_node>(p), all.back());
    p.reset();
    settle(d, m);
  }
  EXPECT_EQ(seen.size(), 100U);
  EXPECT_LE(addresses.size(), 100U);
  for (std::size_t i = 1; i != all.size(); ++i) {
    EXPECT_NE(all[i - 1], all[i]);
    EXPECT_NE(all[i - 1] < all[i], all[i] < all[i - 1]);
  }
}

TEST(WeakRc, ToBasesAndConst) {
  domain d;
  mutator m(d, "m");
  auto p = make_rc<derived>();
  const weak_rc<derived> exact(p);
  const weak_rc<base> general = exact;
  const weak_rc<const base> constant = exact;
  EXPECT_TRUE(general == exact);
  EXPECT_TRUE(constant == exact);
  EXPECT_EQ(exact.lock().get(), p.get());
  EXPECT_EQ(general.lock().get(), static_cast<base*>(p.get()));
  EXPECT_EQ(constant.lock().get(), static_cast<base*>(p.get()));
  EXPECT_EQ(weak_rc<base>(p.get()), general);
  p.reset();
  settle(d, m);
  EXPECT_TRUE(exact.expired() && general.expired() && constant.expired());
}

TEST(WeakRc, WhatWasLockedAndStoredLivesOn) {
  domain d;
  mutator m(d, "m");
  auto p = make_rc<deferred_node>();
  const weak_rc<deferred_node> w(p);
  slamgc::rc_slot<deferred_node> kept;
  p.reset();
  kept = w.lock();  // it has fallen to zero, and nobody has collected
  ASSERT_NE(kept, nullptr);
  settle(d, m);
  EXPECT_FALSE(w.expired());
  EXPECT_EQ(w.lock(), kept.get());
  kept.reset();
  settle(d, m);
  EXPECT_TRUE(w.expired());
}

// A ring of described objects, all retired, with a handle to each.
struct ring {
  explicit ring(int n) {
    auto* const first = new retired_node;
    retired_node* last = first;
    handles.emplace_back(first);
    for (int i = 1; i != n; ++i) {
      last->next = new retired_node;
      last = last->next;
      handles.emplace_back(last);
    }
    last->next = first;
    for (const auto& w : handles) slamgc::retire(w.lock().get());
  }
  // How many are alive: all or none.
  int count() const {
    int n = 0;
    for (const auto& w : handles) n += w.lock() != nullptr;
    return n;
  }
  std::vector<weak_rc<retired_node>> handles;
};

TEST(WeakRc, WhatDiesTogetherExpiresTogether) {
  domain d;
  mutator m(d, "m");
  for (std::size_t held = 0; held != 5; ++held) {
    const ring r(5);
    auto p = r.handles[held].lock();
    settle(d, m);
    EXPECT_EQ(r.count(), 5);
    p.reset();
    settle(d, m);
    EXPECT_EQ(r.count(), 0);
    EXPECT_EQ(retired_node::live(), 0);
  }
}

TEST(WeakRc, WhatDiesTogetherExpiresTogetherHoweverSmallTheSteps) {
  domain d;
  mutator m(d, "m");
  const ring r(5);
  for (int i = 0; i != 300; ++i) {
    // Not locked each time: that would disturb the collector.
    int expired = 0;
    for (const auto& w : r.handles) expired += w.expired();
    if (expired != 0) {
      EXPECT_EQ(r.count(), 0) << i;  // the decision counts, not what the blocks say
    }
    m.quiescent();
    (void)d.collect({1});
  }
  EXPECT_EQ(r.count(), 0);
  EXPECT_EQ(retired_node::live(), 0);
}

// At each step of the collector once: all live on together, or none does.
TEST(WeakRc, LockedAtAnyStepOfTheCollector) {
  int saved = 0;
  for (int at = 0; at != 60; ++at) {
    domain d;
    mutator m(d, "m");
    const ring r(3);
    for (int i = 0; i != at; ++i) {
      m.quiescent();
      (void)d.collect({1});
    }
    m.quiescent();
    auto p = r.handles[static_cast<std::size_t>(at) % 3].lock();
    EXPECT_EQ(r.count(), p != nullptr ? 3 : 0) << at;
    saved += p != nullptr;
    settle(d, m);
    EXPECT_EQ(r.count(), p != nullptr ? 3 : 0) << at;
    p.reset();
    settle(d, m);
    EXPECT_EQ(r.count(), 0);
    EXPECT_EQ(retired_node::live(), 0);
  }
  EXPECT_GT(saved, 5);
  EXPECT_LT(saved, 55);
}

TEST(WeakRc, AHandleThatIsPolledKeepsNothingForEver) {
  domain d;
  mutator m(d, "m");
  auto p = make_rc<deferred_node>();
  const weak_rc<deferred_node> w(p);
  p.reset();
  for (int i = 0; deferred_node::live() != 0; ++i) {
    ASSERT_LT(i, 50);
    {
      const auto copied = w.lock();
      const auto again = copied;  // NOLINT(performance-unnecessary-copy-initialization)
      EXPECT_EQ(w.expired(), again == nullptr);
    }
    m.quiescent();
    (void)d.collect({1});  // polled at each of its steps
  }
  EXPECT_TRUE(w.expired());
}

TEST(WeakRc, HandlesThatArePolledKeepNoRingForEver) {
  domain d;
  mutator m(d, "m");
  const ring r(3);
  for (int i = 0; retired_node::live() != 0; ++i) {
    ASSERT_LT(i, 1000);
    (void)r.count();
    m.quiescent();
    (void)d.collect({1});
  }
  EXPECT_EQ(r.count(), 0);
}

TEST(WeakRc, AnObjectThatIsFoundReferredToStartsAnew) {
  domain d;
  mutator m(d, "m");
  auto p = make_rc<deferred_node>();
  const weak_rc<deferred_node> w(p);
  for (int i = 0; i != 20; ++i) {
    // Noted at zero, disturbed, decided on at zero; then found referred to.
    auto* const borrowed = p.get();
    p.reset();
    (void)d.collect({1});
    p = borrowed;
    p.reset();
    p = borrowed;
    settle(d, m);
    EXPECT_FALSE(w.expired()) << i;
  }
  p.reset();
  settle(d, m);
  EXPECT_TRUE(w.expired());
}

TEST(WeakRc, OfAnObjectThatTheProgramDeletes) {
  domain d;
  mutator m(d, "m");
  auto* const p = new deferred_node;
  const weak_rc<deferred_node> w(p);
  delete p;
  EXPECT_TRUE(w.expired());
  EXPECT_EQ(w.lock(), nullptr);
}

TEST(WeakRc, OutlivesTheDomain) {
  weak_rc<deferred_node> w;
  {
    domain d;
    mutator m(d, "m");
    auto p = make_rc<deferred_node>();
    w = p;
    EXPECT_FALSE(w.expired());
    p.reset();
  }
  EXPECT_TRUE(w.expired());
  EXPECT_EQ(deferred_node::live(), 0);
}

TEST(WeakRc, InADestructorThatACollectorRuns) {
  struct reader : slamgc::rc_object<reader, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
    explicit reader(weak_rc<deferred_node> handle, bool& found)
        : w(std::move(handle)), there(found) {}
    ~reader() { there = w.lock() != nullptr; }
    weak_rc<deferred_node> w;
    bool& there;
  };
  domain d;
  mutator m(d, "m");
  auto p = make_rc<deferred_node>();
  bool there = false;
  (void)make_rc<reader>(weak_rc<deferred_node>(p), there);
  settle(d, m);
  EXPECT_TRUE(there);
  p.reset();
  settle(d, m);
}

TEST(WeakRc, TwoGracePeriodsForOneWithHandlesAndOneForOneWithout) {
  domain d;
  mutator m(d, "m");
  const auto rounds = [&](bool with_handle) {
    auto p = make_rc<deferred_node>();
    weak_rc<deferred_node> w;
    if (with_handle) w = p;
    p.reset();
    settle(d, m);
    const auto before = d.stats().grace_periods;
    p = make_rc<deferred_node>();
    if (with_handle) w = p;
    p.reset();
    m.quiescent();
    while (deferred_node::live() != 0) {
      (void)d.collect();
      m.quiescent();
    }
    return d.stats().grace_periods - before;
  };
  EXPECT_EQ(rounds(true), rounds(false) + 1);
}

static_assert(std::is_nothrow_move_constructible_v<weak_rc<base>>);
static_assert(std::is_nothrow_copy_constructible_v<weak_rc<base>>);
static_assert(!std::is_convertible_v<base*, weak_rc<base>>);
static_assert(!std::is_constructible_v<weak_rc<derived>, weak_rc<base>>);
static_assert(!std::is_constructible_v<weak_rc<base>, weak_rc<const base>>);

}  // namespace
