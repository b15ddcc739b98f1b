// Reports are made while mutators change the graph and another thread collects.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <random>
#include <slamgc/diagnosis/audit.hpp>
#include <slamgc/diagnosis/graphviz.hpp>
#include <slamgc/diagnosis/retention_report.hpp>
#include <slamgc/slamgc.hpp>
#include <sstream>

#include "support/environments.hpp"
#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

template <class Env>
struct node
    : slamgc::rc_object<node<Env>, slamgc::basic_fetch_add_counter<Env>, slamgc::reclaim_retired>,
      support::instances<node<Env>> {
  explicit node(std::uint64_t n) : number(n) {}
  ~node() { number = 0; }
  std::uint64_t report_id() const {
    EXPECT_NE(number, 0u);  // plain: nobody destroys it meanwhile
    return number;
  }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("a", a, slamgc::on_retire::null);
    v.edge("b", b);
  }
  std::uint64_t number;
  slamgc::rc_slot<node, Env> a, b;
};

template <class Env>
struct map {
  template <class Visitor>
  void edges(Visitor& v) {
    for (auto& slot : slots) v.edge("slots", slot, slamgc::on_retire::null);
  }
  slamgc::rc_slot<node<Env>, Env> slots[4];
};

template <class Env>
class DiagnosisStress : public ::testing::Test {};
TYPED_TEST_SUITE(DiagnosisStress, support::environments, support::environment_names);

TYPED_TEST(DiagnosisStress, WhileEverybodyIsAtWork) {
  using object = node<TypeParam>;
  slamgc::basic_domain<TypeParam> domain;
  int captured = 0;
  {
    map<TypeParam> roots;
    const slamgc::basic_root<TypeParam> root(domain, "map", roots);
    std::atomic<int> running{2};
    support::in_threads(4, [&](int thread) {
      std::mt19937 random(static_cast<unsigned>(yield_env::seed()) + static_cast<unsigned>(thread));
      if (thread == 2) {
        while (running != 0) (void)domain.collect({1 + random() % 50});
        return;
      }
      slamgc::basic_mutator<TypeParam> me(domain, "mutator");
      if (thread == 3) {
        for (bool last = false; !last; me.quiescent()) {
          last = running == 0;
          const slamgc::audit found(domain);
          if (found.graph().result == slamgc::heap_graph::outcome::done) ++captured;
          EXPECT_FALSE(found.words().empty());
          std::ostringstream picture;
          if (object* const p = roots.slots[random() % 4]) {
            const slamgc::retention_report report(domain, p);
            EXPECT_FALSE(report.words().empty() || report.json().empty());
            slamgc::write_dot(picture, report.graph(), {p, 2});
          }
        }
        return;
      }
      std::uint64_t number = 0;
      std::deque<slamgc::intrusive_rc<object>> mine;  // to be retired
      const auto retire_all_but = [&mine](std::size_t n) {
        for (; mine.size() > n; mine.pop_front()) slamgc::retire(mine.front().get());
      };
      for (int i = 0; i != 4 * support::rounds(); ++i) {
        object* const p = roots.slots[random() % 4];
        switch (random() % 4) {
          case 0: {
            auto* const made = new object(++number);
            made->a = p;
            made->b = made;
            mine.emplace_back(made);
            roots.slots[random() % 4] = made;
            break;
          }
          case 1:
            slamgc::retire(p);
            break;
          case 2:
            if (p != nullptr) p->a = roots.slots[random() % 4].get();
            break;
          default:
            if (p != nullptr) p->b = nullptr;
        }
        retire_all_but(50);
        if (random() % 8 == 0) me.quiescent();
      }
      retire_all_but(0);
      --running;
    });
    // Nobody changes anything now.
    slamgc::walk_options still;
    still.threads_stand_still = true;
    const slamgc::audit found(domain, still);
    EXPECT_TRUE(found.agrees()) << found.words();
  }
  EXPECT_GT(captured, 0);
  EXPECT_EQ(domain.drain(), slamgc::waited::done);
  EXPECT_EQ(object::live(), 0);
}

}  // namespace
