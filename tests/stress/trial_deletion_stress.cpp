// Mutators link and unlink objects that were retired at birth, while a third thread finds those out of reach.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <random>
#include <slamgc/slamgc.hpp>

#include "support/environments.hpp"
#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

constexpr int alive = 4711;

template <class Env>
struct node
    : slamgc::rc_object<node<Env>, slamgc::basic_fetch_add_counter<Env>, slamgc::reclaim_retired>,
      support::instances<node<Env>> {
  ~node() {
    EXPECT_EQ(poison, alive);  // plain, as is what follows
    poison = 0;
    std::atomic_signal_fence(std::memory_order_seq_cst);  // so that the store is not dropped
  }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("a", a);
    v.edge("b", b);
  }
  int poison = alive;
  slamgc::rc_slot<node, Env> a, b;
};

template <class Env>
class TrialDeletionStress : public ::testing::Test {};

TYPED_TEST_SUITE(TrialDeletionStress, support::environments, support::environment_names);

TYPED_TEST(TrialDeletionStress, MutatorsChangeTheGraphMeanwhile) {
  using object = node<TypeParam>;
  using slot = slamgc::rc_slot<object, TypeParam>;
  slamgc::basic_domain<TypeParam> domain;
  {
    slot roots[4];
    std::atomic<int> running{2};
    support::in_threads(3, [&](int thread) {
      std::mt19937 random(static_cast<unsigned>(yield_env::seed()) + static_cast<unsigned>(thread));
      if (thread == 2) {
        while (running != 0) (void)domain.collect({1 + random() % 50});
        return;
      }
      slamgc::basic_mutator<TypeParam> me(domain, "mutator");
      const auto borrow = [&]() -> object* {
        object* p = roots[random() % 4];
        for (auto steps = random() % 6; p != nullptr && steps != 0; --steps) {
          EXPECT_EQ(p->poison, alive);
          object* const next = random() % 2 == 0 ? p->a.get() : p->b.get();
          if (next == nullptr) break;
          p = next;
        }
        return p;
      };
      for (int i = 0; i != 4 * support::rounds(); ++i) {
        object* const p = borrow();
        object* const q = borrow();
        switch (random() % 6) {
          case 0: {
            auto* const made = new object;
            made->a = p;
            if (p != nullptr)
              p->b = made;
            else
              roots[random() % 4] = made;
            slamgc::retire(made);
            break;
          }
          case 1:
            if (p != nullptr) p->a = q;
            break;
          case 2:
            if (p != nullptr) p->b = std::move(roots[random() % 4]);
            break;
          case 3:
            roots[random() % 4] = q;
            break;
          case 4:
            if (p != nullptr && q != nullptr) p->a.swap(q->b);
            break;
          default:
            if (p != nullptr) p->a = nullptr;
        }
        if (random() % 8 == 0) me.quiescent();
      }
      --running;
    });
  }
  EXPECT_EQ(domain.drain(), slamgc::waited::done);
  EXPECT_EQ(object::live(), 0);
}

}  // namespace
