// The purge: what the program left of references to retired objects is dropped, wherever it is, whatever happens meanwhile.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <limits>
#include <optional>
#include <random>
#include <set>
#include <slamgc/slamgc.hpp>
#include <stdexcept>
#include <thread>
#include <vector>

#include "support/instances.hpp"
#include "support/yield_env.hpp"

namespace {

namespace on_retire = slamgc::on_retire;
using slamgc::collected;
using slamgc::waited;
using online = slamgc::mutator::online_scope;

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
              support::instances<node> {
  template <class Visitor>
  void edges(Visitor& v) {
    ++walks;
    if (meanwhile) meanwhile(*this);
    v.edge("next", next);
    v.edge("stale", stale, on_retire::null);
    v.edge("many", many, on_retire::erase);
    if (afterwards) afterwards(*this);
  }
  slamgc::rc_slot<node> next, stale;
  slamgc::rc_set<node> many;
  // What another thread would do while this object is visited, before or after its edges.
  static inline std::function<void(node&)> meanwhile, afterwards;
  static inline long walks = 0;
};

struct Purge : ::testing::Test {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("top", top);
    v.edge("list", list, on_retire::erase);
    v.edge("held", held);
  }
  void TearDown() override {
    node::meanwhile = node::afterwards = nullptr;
    root.reset();
    {
      const online scope(me);
      std::set<node*> all;
      std::vector<node*> next(list.begin(), list.end());
      next.insert(next.end(), {top.get(), held.get()});
      while (!next.empty()) {
        node* const p = next.back();
        next.pop_back();
        if (p == nullptr || !all.insert(p).second) continue;
        next.insert(next.end(), {p->next.get(), p->stale.get()});
        next.insert(next.end(), p->many.begin(), p->many.end());
      }
      for (node* p : all) slamgc::retire(p);
      top = held = nullptr;
      list.clear();
    }
    EXPECT_EQ(domain.drain(), waited::done);
    EXPECT_EQ(node::live(), 0);
  }
  // A chain of @p n nodes; returns its last one.
  node* chain(int n) {
    top = new node;
    node* last = top;
    for (int i = 1; i != n; ++i) {
      last->next = new node;
      last = last->next;
    }
    return last;
  }
  // In slices of @p objects, as far as it goes without waiting.
  void collect_all(std::size_t objects = 1) {
    for (int calls = 0; domain.collect({objects}).result == collected::outcome::partial; ++calls)
      ASSERT_LT(calls, 100000) << "slices make progress";
  }

  slamgc::domain domain;
  slamgc::mutator me{domain, "test", {false, false}};
  slamgc::rc_slot<node> top, held;
  slamgc::rc_vector<node> list;
  std::optional<slamgc::root> root{std::in_place, domain, "test", *this};
};

TEST_F(Purge, AStaleEdgeDeepInTheGraph) {
  node* last = nullptr;
  {
    const online scope(me);
    last = chain(1000);
    last->stale = new node;
    last->many.insert(last->stale.get());
    list.push_back(last->stale.get());
    slamgc::retire(last->stale.get());
  }
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(last->stale, nullptr);
  EXPECT_TRUE(last->many.empty());
  EXPECT_TRUE(list.empty());
  EXPECT_EQ(node::live(), 1000);
  EXPECT_EQ(domain.stats().types.front().stuck, 0U);
}

TEST_F(Purge, SlicesOfEverySizeComeToAnEnd) {
  for (std::size_t objects = 1; objects != 6; ++objects) {
    SCOPED_TRACE(objects);
    {
      const online scope(me);
      node* const last = chain(20);
      last->stale = new node;
      slamgc::retire(last->stale.get());
    }
    for (int calls = 0; domain.collect({objects}).result != collected::outcome::done; ++calls)
      ASSERT_LT(calls, 1000);
    EXPECT_EQ(node::live(), 20);
    {
      const online scope(me);
      for (node* p = top; p != nullptr; p = p->next) slamgc::retire(p);
      top = nullptr;
    }
    ASSERT_EQ(domain.drain(), waited::done);
  }
}

// A slice holds the locks of one object: no more than its budget is visited.
TEST_F(Purge, ASliceVisitsNoMoreThanItsBudget) {
  {
    const online scope(me);
    chain(100)->stale = new node;
    for (node* p = top; p != nullptr; p = p->next)
      if (p->stale) slamgc::retire(p->stale.get());
  }
  for (;;) {
    const long before = node::walks;
    const auto result = domain.collect({3}).result;
    ASSERT_LE(node::walks - before, 3 + 1);  // its first object is visited with the root
    if (result == collected::outcome::done) break;
  }
  EXPECT_EQ(node::live(), 100);
}

TEST_F(Purge, WhatIsHeldStays) {
  {
    const online scope(me);
    held = new node;
    held->next = new node;
    held->next->stale = held.get();
    slamgc::retire(held.get());
  }
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(node::live(), 2);
  EXPECT_NE(held, nullptr);
}

TEST_F(Purge, EdgesOfStuckObjectsArePurgedToo) {
  {
    const online scope(me);
    held = new node;
    node* const other = new node;
    held->stale = other;
    slamgc::retire(held.get());
    slamgc::retire(other);
  }
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(held->stale, nullptr);
  EXPECT_EQ(node::live(), 1);
}

TEST_F(Purge, IsNotRepeatedWhileNothingChanges) {
  {
    const online scope(me);
    chain(50)->next = nullptr;
    held = new node;
    slamgc::retire(held.get());
  }
  ASSERT_EQ(domain.drain(), waited::done);
  const long before = node::walks;
  for (int i = 0; i != 100; ++i) ASSERT_EQ(domain.collect().result, collected::outcome::done);
  EXPECT_EQ(node::walks, before);
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(node::walks, before) << "all references to the one that is held were seen";
}

// A reference that no edges() describes cannot be told from one that was missed: ever fewer attempts.
// What is referred to from where nobody knows is looked for once more by drain(), not again and again, which would take a grace
// period each time.
TEST_F(Purge, DrainEndsBesideAMutatorThatIsOnline) {
  slamgc::pin<node> pinned;
  {
    const online scope(me);
    chain(10);
    pinned = new node;
    slamgc::retire(pinned.get());
  }
  std::atomic<bool> ends{false};
  std::promise<void> is_online;
  std::thread other([&] {
    slamgc::mutator viewer(domain, "viewer", {false, false});
    const online scope(viewer);
    is_online.set_value();
    while (!ends) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));  // its frame
      viewer.quiescent();
    }
  });
  is_online.get_future().wait();
  EXPECT_EQ(domain.drain(std::chrono::seconds(30)), waited::done);
  ends = true;
  other.join();
  EXPECT_EQ(node::live(), 11);
  pinned.reset();
}

// However often something new is stuck, walks through the map take no more than their share.
TEST_F(Purge, RestsAfterEachWalk) {
  node* last = nullptr;
  const auto make_stuck = [&] {
    const online scope(me);
    last->stale = new node;
    slamgc::retire(last->stale.get());
  };
  slamgc::budget paced;
  paced.purge_rest = std::numeric_limits<unsigned>::max();  // times a microsecond: an hour
  {
    const online scope(me);
    last = chain(1000);
  }
  make_stuck();
  (void)domain.collect(paced);
  EXPECT_EQ(node::live(), 1000) << "there was none to rest from";
  for (int i = 0; i != 3; ++i) {
    make_stuck();
    const long before = node::walks;
    for (int calls = 0; calls != 10; ++calls)
      EXPECT_EQ(domain.collect(paced).result, collected::outcome::done);
    EXPECT_LE(node::walks - before, 10) << "only what is retired is looked at";
    EXPECT_EQ(node::live(), 1001) << "what is stuck waits";
    if (i == 0) (void)domain.collect();
    if (i == 1) {
      EXPECT_EQ(domain.drain(), waited::done);
    }
    if (i == 2) {
      // One more than the last walk took is long enough.
      paced.purge_rest = 1;
      while (node::live() != 1000) (void)domain.collect(paced);
    }
    EXPECT_EQ(node::live(), 1000);
  }
}

// Not twice in one call, either.
TEST_F(Purge, RestsWithinACallToo) {
  {
    const online scope(me);
    chain(100)->stale = new node;
    for (node* p = top; p != nullptr; p = p->next)
      if (p->stale) slamgc::retire(p->stale.get());
  }
  node* more = nullptr;
  node::afterwards = [&](node& n) {  // stuck anew as soon as the first is reclaimed
    if (more != nullptr || &n != top) return;
    n.stale = more = new node;
    slamgc::retire(more);
  };
  slamgc::budget paced;
  paced.purge_rest = std::numeric_limits<unsigned>::max();
  (void)domain.collect(paced);
  node::afterwards = nullptr;
  ASSERT_NE(more, nullptr);
  EXPECT_EQ(top->stale, more);
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(top->stale, nullptr);
}

TEST_F(Purge, IsRepeatedEverMoreSeldomWhileAPinExplainsNothing) {
  slamgc::intrusive_rc<node> pin;
  {
    const online scope(me);
    chain(50);
    pin = new node;
    slamgc::retire(pin.get());
  }
  std::vector<int> calls;
  for (int i = 0; i != 200; ++i) {
    const long before = node::walks;
    ASSERT_EQ(domain.collect().result, collected::outcome::done);
    if (node::walks - before >= 50) calls.push_back(i);
  }
  ASSERT_GE(calls.size(), 6U);
  EXPECT_LE(calls.size(), 10U);
  for (std::size_t i = 2; i < calls.size(); ++i)
    EXPECT_EQ(calls[i] - calls[i - 1], 2 * (calls[i - 1] - calls[i - 2])) << i;
  const long before = node::walks;
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_GE(node::walks - before, 50) << "drain() puts nothing off";
}

TEST_F(Purge, AnEdgeThatIsAddedBehindTheWalk) {
  node* dead = nullptr;
  {
    const online scope(me);
    node* const last = chain(20);
    dead = new node;
    last->stale = dead;
    slamgc::retire(dead);
  }
  bool added = false;
  node::meanwhile = [&](node& at) {
    if (at.stale != dead || added) return;
    // The walk has come to the end of the chain.
    added = true;
    top->stale = dead;
  };
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_TRUE(added);
  EXPECT_EQ(node::live(), 20);
  EXPECT_EQ(top->stale, nullptr);
}

// As many references as were seen, but not the same ones: the version tells.
TEST_F(Purge, AnEdgeThatIsAddedInPlaceOfAHeldOne) {
  node* dead = nullptr;
  {
    const online scope(me);
    chain(20);
    held = dead = new node;
    slamgc::retire(dead);
  }
  bool added = false;
  node::afterwards = [&](node& at) {
    if (&at != top->next->next || added) return;
    added = true;
    top->stale = dead;  // behind the walk
    held = nullptr;
  };
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_TRUE(added);
  EXPECT_EQ(top->stale, nullptr);
  EXPECT_EQ(node::live(), 20);
}

TEST_F(Purge, AnEdgeThatMovesPastTheWalkAgainAndAgain) {
  node* dead = nullptr;
  {
    const online scope(me);
    node* const last = chain(20);
    dead = new node;
    last->stale = dead;
    slamgc::retire(dead);
  }
  int moves = 0;
  node::meanwhile = [&](node& at) {
    if (at.stale != dead || moves == 5) return;
    ++moves;
    if (&at == top)
      at.next->stale = std::move(at.stale);  // ahead; moves back as soon as that one is visited
    else
      top->stale = std::move(at.stale);
  };
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(node::live(), 20);
}

// The version of the dead one does not change: its holder is what moves out of the walk's sight.
TEST_F(Purge, AHolderThatMovesPastTheWalk) {
  node* dead = nullptr;
  node* holder = nullptr;
  {
    const online scope(me);
    chain(20);
    dead = new node;
    holder = new node;
    holder->stale = dead;
    top->next->stale = holder;  // not retired
    slamgc::retire(dead);
  }
  bool moved = false;
  node::afterwards = [&](node& at) {
    if (&at != top || moved) return;
    // The walk is over with the first node: the second one's edge goes there.
    moved = true;
    top->stale = std::move(at.next->stale);
  };
  for (int calls = 0; holder->stale != nullptr; ++calls) {
    ASSERT_LT(calls, 10);
    (void)domain.collect();
  }
  EXPECT_TRUE(moved);
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(node::live(), 21);
}

TEST_F(Purge, WhatIsRetiredMeanwhileIsPurgedNext) {
  for (int when = 0; when != 25; ++when) {
    SCOPED_TRACE(when);
    node* first = nullptr;
    node* second = nullptr;
    {
      const online scope(me);
      node* const last = chain(20);
      first = new node;
      second = new node;
      last->stale = first;
      top->stale = second;
      top->many.insert(second);
      first->stale = second;
      slamgc::retire(first);
    }
    int visits = 0;
    node::afterwards = [&](node&) {
      if (visits++ == when) slamgc::retire(second);
    };
    ASSERT_EQ(domain.drain(), waited::done);
    node::afterwards = nullptr;
    EXPECT_EQ(node::live(), visits > when ? 20 : 21);
    {
      const online scope(me);
      slamgc::retire(top->stale.get());  // null, mostly
      for (node* p = top; p != nullptr; p = p->next) slamgc::retire(p);
      top = nullptr;
    }
    ASSERT_EQ(domain.drain(), waited::done);
    ASSERT_EQ(node::live(), 0);
  }
}

TEST_F(Purge, WhatIsRetiredBetweenSlicesIsPurgedNext) {
  for (int when = 0; when != 60; ++when) {
    SCOPED_TRACE(when);
    node* second = nullptr;
    {
      const online scope(me);
      node* const last = chain(10);
      last->stale = new node;
      second = new node;
      top->stale = second;
      slamgc::retire(last->stale.get());
    }
    for (int i = 0; i != when; ++i) (void)domain.collect({1});
    {
      const online scope(me);
      slamgc::retire(second);
    }
    collect_all();
    ASSERT_EQ(domain.drain(), waited::done);
    ASSERT_EQ(node::live(), 10);
    {
      const online scope(me);
      for (node* p = top; p != nullptr; p = p->next) slamgc::retire(p);
      top = nullptr;
    }
    ASSERT_EQ(domain.drain(), waited::done);
  }
}

// While a walk is under way nothing is destroyed, not even what nobody refers to any more.
TEST_F(Purge, DestroysNothingUntilItsEnd) {
  {
    const online scope(me);
    chain(10)->stale = new node;
    for (node* p = top; p != nullptr; p = p->next)
      if (p->stale) slamgc::retire(p->stale.get());
  }
  int unlinked = 0;
  node::afterwards = [&](node& at) {
    if (at.next == nullptr || unlinked != 0) return;
    ++unlinked;  // the rest of the chain is met already or never
    node* const rest = at.next;
    for (node* p = rest; p != nullptr; p = p->next) {
      if (p->stale) p->stale = nullptr;
      slamgc::retire(p);
    }
    at.next = nullptr;
  };
  while (domain.collect({1}).result != collected::outcome::done) {
  }
  node::afterwards = nullptr;
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(node::live(), 1);
}

// ---- edges() that throws: it must not, but nothing is lost or freed too early for it.

TEST_F(Purge, EdgesThatThrowOnce) {
  for (int when = 0; when != 80; ++when) {
    SCOPED_TRACE(when);
    int visits = 0;
    {
      const online scope(me);
      node* const last = chain(5);
      auto* const a = new node;
      auto* const b = new node;
      a->next = b;
      b->next = a;
      last->stale = a;
      last->many.insert(b);
      slamgc::retire(a);
      slamgc::retire(b);
    }
    const auto throws = [&](node&) {
      if (visits++ == when) throw std::runtime_error("edges() throws");
    };
    (when % 2 == 0 ? node::meanwhile : node::afterwards) = throws;
    ASSERT_EQ(domain.drain(), waited::done);
    node::meanwhile = node::afterwards = nullptr;
    EXPECT_EQ(node::live(), 5) << visits;
    {
      const online scope(me);
      for (node* p = top; p != nullptr; p = p->next) slamgc::retire(p);
      top = nullptr;
    }
    ASSERT_EQ(domain.drain(), waited::done);
    ASSERT_EQ(node::live(), 0);
  }
}

// No word changes when they stop.
TEST_F(Purge, EdgesThatThrowForAWhile) {
  {
    const online scope(me);
    auto* const a = new node;
    a->next = new node;
    a->next->next = a;
    slamgc::retire(a->next.get());
    slamgc::retire(a);
  }
  node::afterwards = [](node&) { throw std::runtime_error("edges() throws"); };
  for (int i = 0; i != 10; ++i) ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(node::live(), 2);
  node::afterwards = nullptr;
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(node::live(), 0);
}

// A ring of one: nothing else's severing changes its word.
TEST_F(Purge, EdgesThatThrowWhenAnObjectIsSevered) {
  for (int failures = 1; failures != 8; ++failures) {
    SCOPED_TRACE(failures);
    {
      const online scope(me);
      auto* const a = new node;
      a->next = a;
      slamgc::retire(a);
    }
    int visits = 0;
    int thrown = 0;
    node::meanwhile = [&](node&) {
      if (visits++ % 2 == 0 || thrown == failures) return;  // recorded
      ++thrown;
      throw std::runtime_error("edges() throws");
    };
    for (int i = 0; i != 20 && thrown != failures; ++i) ASSERT_EQ(domain.drain(), waited::done);
    EXPECT_EQ(thrown, failures);
    ASSERT_EQ(domain.drain(), waited::done);
    EXPECT_EQ(node::live(), 0);
  }
}

// What cannot be severed stays, with what it refers to, until it can.
TEST_F(Purge, EdgesThatThrowWhileTheyAreSevered) {
  for (int which = 0; which != 3; ++which) {
    SCOPED_TRACE(which);
    node* ring[3] = {};
    {
      const online scope(me);
      for (auto& p : ring) p = new node;
      for (int i = 0; i != 3; ++i) ring[i]->next = ring[(i + 1) % 3];
      for (auto* p : ring) slamgc::retire(p);
    }
    int failures = 0;
    node* const bad = ring[which];
    bool walked = false;
    node::meanwhile = [&](node& at) {
      if (&at != bad) return;
      // Walks and severing alternate.
      if (!walked) {
        walked = true;
        return;
      }
      walked = false;
      ++failures;
      throw std::runtime_error("edges() throws");
    };
    ASSERT_EQ(domain.drain(), waited::done);
    EXPECT_GE(failures, 1);
    EXPECT_GE(node::live(), 2) << "the one, and what it refers to";
    node::meanwhile = nullptr;
    ASSERT_EQ(domain.drain(), waited::done);
    ASSERT_EQ(node::live(), 0);
  }
}

// ---- random programs against an oracle

TEST_F(Purge, RandomGraphsAgainstReachability) {
  std::mt19937 random(static_cast<unsigned>(yield_env::seed()));  // printed; SLAMGC_SEED replays
  for (int round = 0; round != 150; ++round) {
    SCOPED_TRACE(round);
    constexpr unsigned n = 40;
    std::vector<node*> all;
    std::set<node*> dead;
    {
      const online scope(me);
      for (unsigned i = 0; i != n; ++i) all.push_back(new node);
      top = all[0];
      for (unsigned i = 0; i + 1 != n; ++i) all[i]->next = all[i + 1];
      // The chain is of the living; the dead are referred to by stale edges, and refer to anybody.
      for (unsigned i = 0; i != n; ++i)
        if (random() % 3 == 0) dead.insert(all[i]);
      dead.erase(all[0]);
      node* last = nullptr;
      for (node* p : all) {
        p->next = nullptr;
        if (dead.count(p) != 0) continue;
        if (last != nullptr) last->next = p;
        last = p;
      }
      for (unsigned i = 0; i != 2 * n; ++i) {
        node* const from = all[random() % n];
        node* const to = all[random() % n];
        if (random() % 2 == 0)
          from->stale = to;
        else
          from->many.insert(to);
        if (random() % 4 == 0) list.push_back(to);
      }
      for (node* p : dead) slamgc::retire(p);
    }
    for (int slices = static_cast<int>(random() % 50); slices != 0; --slices)
      (void)domain.collect({1 + random() % 4});
    ASSERT_EQ(domain.drain(), waited::done);
    ASSERT_EQ(node::live(), static_cast<int>(n - dead.size()));
    {
      const online scope(me);
      for (node* p : all)
        if (dead.count(p) == 0) slamgc::retire(p);
      top = nullptr;
      list.clear();
    }
    ASSERT_EQ(domain.drain(), waited::done);
    ASSERT_EQ(node::live(), 0);
  }
}

}  // namespace
