// Destructors that a collector runs: they may do what any code may, and find no lock held.
#include <slamgc/deferred.hpp>

#include <gtest/gtest.h>

#include <functional>
#include <slamgc/slamgc.hpp>
#include <thread>
#include <utility>
#include <vector>

#include "support/instances.hpp"

namespace {

using slamgc::domain;
using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::mutator;
using outcome = slamgc::collected::outcome;

template <int Kind>
struct object
    : slamgc::rc_object<object<Kind>, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
      support::instances<object<Kind>> {
  ~object() {
    if (at_end) at_end();
  }
  std::function<void()> at_end;
  slamgc::rc_vector<object> edges;
};
using node = object<0>;
using fresh = object<1>;  // of a type that the domain does not know before

class DeferredDestructors : public ::testing::Test {
 protected:
  ~DeferredDestructors() override { EXPECT_EQ(node::live() + fresh::live(), 0); }
  // Whose destructor does that.
  void doomed(std::function<void()> does) {
    const mutator m(domain_, "maker");
    auto p = make_rc<node>();
    p->at_end = std::move(does);
  }
  domain domain_;
};

TEST_F(DeferredDestructors, TheyMayRetire) {
  node* other = nullptr;
  {
    const mutator m(domain_, "maker");
    other = new node;
  }
  doomed([&] {
    EXPECT_TRUE(slamgc::retire(other));
    EXPECT_FALSE(slamgc::retire(other));
  });
  EXPECT_EQ(domain_.collect().reclaimed, 2u);  // in a second round
  EXPECT_EQ(domain_.stats().total(&slamgc::type_stats::retired), 1u);
}

TEST_F(DeferredDestructors, TheyMayMakeObjectsWhichBelongToTheCollectorsDomain) {
  intrusive_rc<fresh> kept;
  const std::uint64_t elsewhere = slamgc::default_domain().stats().total(&slamgc::type_stats::live);
  doomed([&] {
    kept = make_rc<fresh>();
    auto dropped = make_rc<fresh>();
    dropped->edges.push_back(kept.get());
  });
  const auto done = domain_.collect();
  EXPECT_EQ(done.result, outcome::done);
  EXPECT_EQ(done.reclaimed, 2u);
  EXPECT_EQ(kept->use_count(), 1u);
  EXPECT_EQ(domain_.stats().total(&slamgc::type_stats::live), 1u);
  EXPECT_EQ(slamgc::default_domain().stats().total(&slamgc::type_stats::live), elsewhere);
  kept.reset();
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
}

TEST_F(DeferredDestructors, TheyMayStoreEdgesToObjectsThatWait) {
  slamgc::rc_slot<node> rescued;
  node* waiting = nullptr;
  {
    const mutator m(domain_, "maker");
    auto first = make_rc<node>();
    auto second = make_rc<node>();
    waiting = second.get();
    // Of two in one round the one that entered last is destroyed first.
    second->at_end = [] { FAIL(); };
    first->at_end = [&] { rescued = waiting; };
    second.reset();
    first.reset();
  }
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
  EXPECT_EQ(rescued.get(), waiting);
  EXPECT_EQ(rescued->use_count(), 1u);
  rescued->at_end = nullptr;
  rescued.reset();
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
}

TEST_F(DeferredDestructors, TheyMayDeleteWhatTheyOwn) {
  node* owned = nullptr;
  {
    const mutator m(domain_, "maker");
    owned = new node;
  }
  doomed([&] { delete owned; });
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
  EXPECT_EQ(domain_.stats().total(&slamgc::type_stats::live), 0u);
}

TEST_F(DeferredDestructors, CollectDoesNothingInThem) {
  int asked = 0;
  for (int i = 0; i != 3; ++i)
    doomed([&] {
      const auto did = domain_.collect();
      EXPECT_EQ(did.result, outcome::busy);
      EXPECT_EQ(did.reclaimed, 0u);
      ++asked;
    });
  EXPECT_EQ(domain_.collect().reclaimed, 3u);
  EXPECT_EQ(asked, 3);
}

TEST_F(DeferredDestructors, TheyMayCollectAnotherDomain) {
  domain other;
  doomed([&] {
    {
      const mutator m(other, "inside");
      slamgc::retire(new node);
    }
    EXPECT_EQ(other.collect().reclaimed, 1u);
    slamgc::retire(new fresh);  // of the outer collector's domain again
  });
  EXPECT_EQ(domain_.collect().reclaimed, 2u);
  EXPECT_EQ(other.stats().types.size(), 1u);
}

TEST_F(DeferredDestructors, TheyMayRegister) {
  doomed([&] {
    mutator m(domain_, "inside");
    EXPECT_TRUE(m.is_online());
    slamgc::retire(new node);
    m.quiescent();
    const mutator::offline_scope offline(m);
  });
  EXPECT_EQ(domain_.collect().reclaimed, 2u);
  EXPECT_TRUE(domain_.stats().mutators.empty());
}

TEST_F(DeferredDestructors, TheyMayAskForNumbers) {
  doomed([&] {
    EXPECT_EQ(domain_.stats().types.size(), 1u);
    EXPECT_EQ(domain_.delayed().oldest, nullptr);
  });
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
}

TEST_F(DeferredDestructors, TheyMayWaitForAnotherThreadThatCountsAndRetires) {
  doomed([&] {
    std::thread([&] {
      mutator m(domain_, "other");
      auto p = make_rc<node>();
      slamgc::retire(new node);
      m.quiescent();
    }).join();
  });
  EXPECT_EQ(domain_.collect().reclaimed, 3u);
}

TEST_F(DeferredDestructors, TheyMayBorrowFromWhatTheObjectRefersTo) {
  {
    const mutator m(domain_, "maker");
    auto p = make_rc<node>();
    p->edges.push_back(new node);
    node* const self = p.get();
    p->at_end = [self] {
      const slamgc::borrow<node> edge(self->edges[0].get());
      EXPECT_EQ(edge->use_count(), 1u);
      slamgc::atomic_rc<node> shared(self->edges[0].get());
      EXPECT_EQ(shared.load()->use_count(), 3u);
    };
  }
  EXPECT_EQ(domain_.collect().reclaimed, 2u);
}

TEST_F(DeferredDestructors, OneThatKeepsMakingGarbageComesToAnEnd) {
  int left = 100;
  std::function<void()> again = [&] {
    if (--left == 0) return;
    auto p = make_rc<node>();
    p->at_end = again;
  };
  doomed(again);
  EXPECT_EQ(domain_.collect().reclaimed, 100u);
}

}  // namespace
