// Threads lock weak handles and read anchors all the time, while others drop and retire the objects and a collector decides.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <random>
#include <slamgc/slamgc.hpp>
#include <vector>

#include "support/environments.hpp"
#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

constexpr int alive = 4711;

template <class Env>
struct node;
template <class Env>
struct record_of {
  int poison;
  slamgc::anchor<node<Env>, record_of, Env> parent;
};
template <class Env>
struct node
    : slamgc::rc_object<node<Env>, slamgc::basic_fetch_add_counter<Env>, slamgc::reclaim_retired>,
      slamgc::enable_anchor<node<Env>, record_of<Env>, Env>,
      support::instances<node<Env>> {
  explicit node(int g) : generation(g) {}
  ~node() {
    EXPECT_EQ(poison, alive);  // plain, as is what follows
    poison = 0;
    std::atomic_signal_fence(std::memory_order_seq_cst);  // so that the store is not dropped
  }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("parent", parent);
    v.edge("partner", partner);
  }
  record_of<Env> record() {
    EXPECT_EQ(poison, alive);
    return {poison, slamgc::anchor<node, record_of<Env>, Env>(parent)};
  }
  const int generation;
  int poison = alive;
  slamgc::rc_slot<node, Env> parent, partner;
};

template <class Env>
class WeakStress : public ::testing::Test {};
TYPED_TEST_SUITE(WeakStress, support::environments, support::environment_names);

// Two objects that refer to each other, what followed them, and handles to both.
template <class Env>
struct handles {
  slamgc::weak_rc<node<Env>, Env> first, second;
  slamgc::anchor<node<Env>, record_of<Env>, Env> anchor;
};

TYPED_TEST(WeakStress, PollingLockersMeetACollector) {
  using object = node<TypeParam>;
  slamgc::basic_domain<TypeParam> domain;
  std::mutex mutex;  // of `shared`
  handles<TypeParam> shared[4];
  std::atomic<int> running{1};
  support::in_threads(4, [&](int thread) {
    std::mt19937 random(static_cast<unsigned>(yield_env::seed()) + static_cast<unsigned>(thread));
    if (thread == 0) {  // makes pairs, and retires them
      slamgc::basic_mutator<TypeParam> me(domain, "maker");
      slamgc::rc_slot<object, TypeParam> newest;
      for (int i = 0; i != support::rounds(); ++i) {
        auto first = slamgc::make_rc<object>(i);
        auto second = slamgc::make_rc<object>(i);
        first->partner = second;
        second->partner = first;
        first->parent = newest;
        newest = first;
        {
          const std::lock_guard<std::mutex> lock(mutex);
          auto& h = shared[random() % 4];
          h.first = slamgc::weak_rc<object, TypeParam>(first);
          h.second = slamgc::weak_rc<object, TypeParam>(second);
          h.anchor = slamgc::anchor<object, record_of<TypeParam>, TypeParam>(first);
        }
        slamgc::retire(first.get());
        slamgc::retire(second.get());
        if (random() % 3 == 0) newest = nullptr;
        if (random() % 4 == 0) me.quiescent();
      }
      running = 0;
    } else if (thread == 1) {
      while (running != 0) (void)domain.collect({1 + random() % 20});
    } else {
      slamgc::basic_mutator<TypeParam> me(domain, "locker");
      slamgc::rc_slot<object, TypeParam> kept;
      while (running != 0) {
        handles<TypeParam> mine;
        {
          const std::lock_guard<std::mutex> lock(mutex);
          mine = shared[random() % 4];
        }
        const auto first = mine.first.lock();
        const auto second = mine.second.lock();
        if (first != nullptr) {
          EXPECT_EQ(first->poison, alive);
        }
        if (second != nullptr) {
          EXPECT_EQ(second->poison, alive);
        }
        if (const auto* const record = mine.anchor.record()) {
          EXPECT_EQ(record->poison, alive);
          EXPECT_TRUE(mine.first.expired());
          EXPECT_EQ(mine.first.lock(), nullptr);
        }
        if (mine.anchor) {
          EXPECT_EQ(mine.anchor.read([](object& o) { return o.poison; },
                                     [](const record_of<TypeParam>& r) { return r.poison; }),
                    alive);
        }
        if (random() % 16 == 0) kept = first;
        if (random() % 16 == 0) kept = nullptr;
        me.quiescent();
      }
    }
  });
  EXPECT_EQ(domain.drain(), slamgc::waited::done);
  EXPECT_EQ(object::live(), 0);
  for (const auto& h : shared) {
    EXPECT_TRUE(h.first.expired());
    EXPECT_TRUE(!h.anchor || h.anchor.record() != nullptr);
  }
}

// The first handle of an object is made by several threads at once.
TYPED_TEST(WeakStress, BlocksAreMadeOnce) {
  struct plain_node : slamgc::rc_object<plain_node, slamgc::basic_fetch_add_counter<TypeParam>,
                                        slamgc::reclaim_deferred>,
                      slamgc::enable_weak_rc<plain_node, TypeParam> {};
  using weak = slamgc::weak_rc<plain_node, TypeParam>;
  slamgc::basic_domain<TypeParam> domain;
  slamgc::rc_slot<plain_node, TypeParam> root;
  weak made[2];
  support::barrier turn(2);
  support::in_threads(2, [&](int thread) {
    slamgc::basic_mutator<TypeParam> me(domain, "maker");
    for (int i = 0; i != support::rounds() / 4; ++i) {
      if (thread == 0) root = new plain_node;
      turn.wait();
      made[thread] = weak(root.get());
      turn.wait();
      EXPECT_EQ(made[0], made[1]);
      EXPECT_EQ(made[thread].lock(), root.get());
      turn.wait();
      me.quiescent();
      if (thread == 0) (void)domain.collect();
    }
  });
  root.reset();
  EXPECT_EQ(domain.drain(), slamgc::waited::done);
  EXPECT_TRUE(made[0].expired());
}

}  // namespace
