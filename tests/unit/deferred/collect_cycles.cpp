// root::collect_cycles(): what only a registry refers to is found and retired; what anybody needs is not.
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <set>
#include <slamgc/slamgc.hpp>
#include <stdexcept>
#include <vector>

#include "support/instances.hpp"
#include "support/yield_env.hpp"

namespace {

namespace on_retire = slamgc::on_retire;
using slamgc::collected;
using slamgc::waited;
using online = slamgc::mutator::online_scope;

template <class Reclaimer>
struct node : slamgc::rc_object<node<Reclaimer>, slamgc::fetch_add_counter, Reclaimer>,
              support::instances<node<Reclaimer>> {
  template <class Visitor>
  void edges(Visitor& v) {
    ++walks;
    if (meanwhile) meanwhile(*this);
    v.edge("slot", slot);
    v.edge("set", set);
  }
  slamgc::rc_slot<node> slot;
  slamgc::rc_set<node> set;
  static inline std::function<void(node&)> meanwhile;
  static inline long walks = 0;
};

// A registry of all nodes, and another root.
template <class Node>
struct listed {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("all", all, on_retire::erase);
    if (fails) throw std::runtime_error("edges() throws");
  }
  slamgc::rc_set<Node> all;
  bool fails = false;
};
template <class Node>
struct kept {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("list", list, on_retire::erase);
  }
  slamgc::rc_vector<Node> list;
};

template <class Reclaimer>
class CollectCycles : public ::testing::Test {
 protected:
  using object = node<Reclaimer>;

  void TearDown() override {
    object::meanwhile = nullptr;
    {
      const online scope(me_);
      for (object* p : registry_.all) {
        p->slot = nullptr;
        p->set.clear();
        slamgc::retire(p);
      }
    }
    EXPECT_EQ(domain_.drain(), waited::done);
    EXPECT_TRUE(registry_.all.empty());
    EXPECT_EQ(object::live(), 0);
  }
  object* make() {
    auto* const p = new object;
    registry_.all.insert(p);
    return p;
  }
  // A ring in the registry; returns one of it.
  object* ring(int n) {
    const online scope(me_);
    object* const first = make();
    object* last = first;
    for (int i = 1; i != n; ++i) {
      last->slot = make();
      last = last->slot;
    }
    last->slot = first;
    return first;
  }
  void collect_cycles() {
    root_.collect_cycles();
    ASSERT_EQ(domain_.drain(), waited::done);
  }

  slamgc::domain domain_;
  slamgc::mutator me_{domain_, "test", {false, false}};
  listed<object> registry_;
  kept<object> needed_;
  slamgc::root root_{domain_, "registry", registry_};
  slamgc::root other_{domain_, "needed", needed_};
};
using reclaimers = ::testing::Types<slamgc::reclaim_retired, slamgc::reclaim_deferred>;
TYPED_TEST_SUITE(CollectCycles, reclaimers, );

TYPED_TEST(CollectCycles, FindsWhatOnlyTheRegistryRefersTo) {
  this->ring(10);
  auto* const one = this->ring(3);
  {
    const online scope(this->me_);
    this->needed_.list.push_back(one);
    this->make();  // no cycle, but nobody needs it either
  }
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(TestFixture::object::live(), 14) << "nothing is looked for unless asked";
  this->collect_cycles();
  EXPECT_EQ(TestFixture::object::live(), 3);
  EXPECT_EQ(this->registry_.all.size(), 3U);
  this->needed_.list.clear();
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(TestFixture::object::live(), 3) << "one wish, one search";
  this->collect_cycles();
  EXPECT_EQ(TestFixture::object::live(), 0);
}

TYPED_TEST(CollectCycles, TwoRegistriesThatBothAsk) {
  auto* const p = this->ring(5);
  {
    const online scope(this->me_);
    this->needed_.list.push_back(p);
  }
  this->other_.collect_cycles();
  this->collect_cycles();
  EXPECT_EQ(TestFixture::object::live(), 0);
}

TYPED_TEST(CollectCycles, APinKeepsARing) {
  slamgc::intrusive_rc<typename TestFixture::object> pin(this->ring(5));
  this->collect_cycles();
  EXPECT_EQ(TestFixture::object::live(), 5);
  pin.reset();
  this->collect_cycles();
  EXPECT_EQ(TestFixture::object::live(), 0);
}

// What was not found is as it was: it can be dropped or retired, and nothing walks for it.
TYPED_TEST(CollectCycles, SuspectsLeaveTheTable) {
  auto* const p = this->ring(5);
  slamgc::intrusive_rc<typename TestFixture::object> pin(p);
  this->collect_cycles();
  EXPECT_EQ(this->domain_.stats().types.front().stuck, 0U);
  EXPECT_EQ(this->domain_.stats().types.front().backlog, 0U);
  const long walks = TestFixture::object::walks;
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(TestFixture::object::walks, walks);
  {
    const online scope(this->me_);
    auto* q = p;
    for (int i = 0; i != 5; ++i) {
      auto* const next = q->slot.get();
      q->slot = nullptr;
      EXPECT_TRUE(slamgc::retire(q));
      q = next;
    }
  }
  pin.reset();
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(TestFixture::object::live(), 0);
}

TYPED_TEST(CollectCycles, ASearchWalksNoMoreThanItNeeds) {
  slamgc::intrusive_rc<typename TestFixture::object> pin(this->ring(50));
  const long walks = TestFixture::object::walks;
  this->collect_cycles();
  EXPECT_EQ(TestFixture::object::walks - walks, 50) << "there is nothing to purge";
}

// Rings of retired objects that are found in the same round are not forgotten.
TYPED_TEST(CollectCycles, AmongWhatIsRetiredAnyway) {
  for (int when = 0; when != 60; ++when) {
    SCOPED_TRACE(when);
    {
      const online scope(this->me_);
      auto* const a = new typename TestFixture::object;
      a->slot = new typename TestFixture::object;
      a->slot->slot = a;
      slamgc::retire(a->slot.get());
      slamgc::retire(a);
    }
    for (int i = 0; i != when; ++i) (void)this->domain_.collect({1});
    this->collect_cycles();  // of an empty registry
    ASSERT_EQ(TestFixture::object::live(), 0);
  }
}

// Each step of a search meets a graph that has changed; what the program needs then is spared.
TYPED_TEST(CollectCycles, SuspectsThatChangeMeanwhile) {
  using node_type = typename TestFixture::object;
  for (int what = 0; what != 4; ++what)
    for (int when = 0; when != 40; ++when) {
      SCOPED_TRACE(what * 1000 + when);
      {
        slamgc::mutator uses(this->domain_, "uses");
        auto* const p = this->ring(4);
        node_type* const q = p->slot;
        this->root_.collect_cycles();
        for (int i = 0; i != 80; ++i) {
          if (i == when) {
            if (what == 0) slamgc::retire(q);
            if (what == 1) this->registry_.all.erase(q);
            if (what == 2) this->needed_.list.push_back(q);
            if (what == 3) q->set.insert(this->make());
          }
          (void)this->domain_.collect({1});
          if (i > when) uses.quiescent();
        }
        if (what == 2) {
          ASSERT_EQ(this->needed_.list.size(), 1U);
          ASSERT_NE(q->slot, nullptr) << "nobody severed it";
          this->needed_.list.clear();
        }
      }
      ASSERT_EQ(this->domain_.drain(), waited::done);
      this->collect_cycles();
      // What left the registry unretired can be in a cycle that no registry knows: the program's to retire.
      if (what == 1 && node_type::live() != 0) {
        const online scope(this->me_);
        for (node_type* p : this->registry_.all) {
          for (node_type* r = p->slot; r != nullptr;) {
            node_type* const next = r->slot;
            r->slot = nullptr;
            slamgc::retire(r);
            r = next;
          }
        }
      }
      ASSERT_EQ(this->domain_.drain(), waited::done);
      ASSERT_EQ(node_type::live(), 0);
    }
}

TYPED_TEST(CollectCycles, EdgesThatThrowFindLess) {
  using node_type = typename TestFixture::object;
  for (int when = 0; when != 20; ++when) {
    SCOPED_TRACE(when);
    this->ring(5);
    int visits = 0;
    node_type::meanwhile = [&](node_type&) {
      if (visits++ == when) throw std::runtime_error("edges() throws");
    };
    this->registry_.fails = when == 19;
    this->collect_cycles();
    node_type::meanwhile = nullptr;
    this->registry_.fails = false;
    this->collect_cycles();
    ASSERT_EQ(node_type::live(), 0);
  }
}

TYPED_TEST(CollectCycles, RandomGraphsAgainstReachability) {
  using node_type = typename TestFixture::object;
  std::mt19937 random(static_cast<unsigned>(yield_env::seed()));  // printed; SLAMGC_SEED replays
  for (int round = 0; round != 150; ++round) {
    SCOPED_TRACE(round);
    constexpr unsigned n = 30;
    std::vector<node_type*> all;
    {
      const online scope(this->me_);
      for (unsigned i = 0; i != n; ++i) all.push_back(this->make());
      for (unsigned i = 0; i != n + n / 2; ++i) {
        if (random() % 2 == 0)
          all[random() % n]->slot = all[random() % n];
        else
          all[random() % n]->set.insert(all[random() % n]);
      }
      for (auto i = random() % 4; i != 0; --i) this->needed_.list.push_back(all[random() % n]);
    }
    std::set<node_type*> reached;
    std::vector<node_type*> next(this->needed_.list.begin(), this->needed_.list.end());
    while (!next.empty()) {
      node_type* const p = next.back();
      next.pop_back();
      if (p == nullptr || !reached.insert(p).second) continue;
      next.push_back(p->slot);
      next.insert(next.end(), p->set.begin(), p->set.end());
    }
    this->root_.collect_cycles();
    for (auto slices = random() % 200; slices != 0; --slices)
      (void)this->domain_.collect({1 + random() % 5});
    ASSERT_EQ(this->domain_.drain(), waited::done);
    ASSERT_EQ(node_type::live(), static_cast<int>(reached.size()));
    for (node_type* p : reached) ASSERT_EQ(this->registry_.all.count(p), 1U);
    this->needed_.list.clear();
    this->collect_cycles();
    ASSERT_EQ(node_type::live(), 0);
  }
}

}  // namespace
