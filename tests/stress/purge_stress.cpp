// Mutators link, unlink, move and retire, clear registries and leave stale edges behind, while others collect in slices and
// roots come and go. In the end what was retired or dropped is gone; nothing that is reached was ever destroyed.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <random>
#include <slamgc/slamgc.hpp>
#include <thread>
#include <utility>
#include <vector>

#include "support/environments.hpp"
#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

namespace on_retire = slamgc::on_retire;
constexpr int alive = 4711;

template <class Env>
struct frame
    : slamgc::rc_object<frame<Env>, slamgc::basic_fetch_add_counter<Env>, slamgc::reclaim_retired>,
      support::instances<frame<Env>> {
  ~frame() {
    EXPECT_EQ(canary, alive);  // plain, as is what follows
    canary = 0;
    std::atomic_signal_fence(std::memory_order_seq_cst);  // so that the store is not dropped
  }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("parent", parent,
           on_retire::bypass([](frame& retired) { return retired.parent.get(); }));
    v.edge("previous", previous, on_retire::null);
    const std::lock_guard<std::mutex> lock(mutex);
    v.edge("neighbours", neighbours, on_retire::erase_with(weights));
    v.edge("matches", matches, on_retire::null);
  }
  int canary = alive;
  slamgc::rc_slot<frame, Env> parent, previous;
  std::mutex mutex;
  slamgc::rc_vector<frame> neighbours;
  std::vector<int> weights;
  slamgc::rc_vector<frame> matches;
};

// A map: what it lists lives until it is cleared.
template <class Env>
struct map {
  template <class Visitor>
  void edges(Visitor& v) {
    const std::lock_guard<std::mutex> lock(mutex);
    v.edge("frames", frames, on_retire::erase);
  }
  std::mutex mutex;
  slamgc::registry<slamgc::rc_set<frame<Env>>, Env> frames;
};
// What a thread keeps for itself.
template <class Env>
struct members {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("last", last, on_retire::null);
    v.edge("window", window, on_retire::erase);
  }
  slamgc::rc_slot<frame<Env>, Env> last;
  slamgc::rc_list<frame<Env>> window;
};

template <class Env>
class PurgeStress : public ::testing::Test {};
TYPED_TEST_SUITE(PurgeStress, support::environments, support::environment_names);

TYPED_TEST(PurgeStress, MutatorsLeaveStaleEdgesBehind) {
  using object = frame<TypeParam>;
  slamgc::basic_domain<TypeParam> domain;
  {
    std::optional<slamgc::basic_mutator<TypeParam>> maker(std::in_place, domain, "maker");
    map<TypeParam> maps[2];  // registries of this domain
    maker.reset();
    slamgc::basic_root<TypeParam> roots[2] = {{domain, "first", maps[0]},
                                              {domain, "second", maps[1]}};
    std::atomic<int> running{2};
    support::in_threads(3, [&](int thread) {
      std::mt19937 random(static_cast<unsigned>(yield_env::seed()) + static_cast<unsigned>(thread));
      if (thread == 2) {
        while (running != 0) {
          (void)domain.collect({1 + random() % 50});
          if (random() % 200 == 0) roots[random() % 2].collect_cycles();
        }
        return;
      }
      slamgc::basic_mutator<TypeParam> me(domain, "mutator");
      members<TypeParam> mine;
      const slamgc::basic_root<TypeParam> root(me, "mine", mine);
      const auto borrow = [&]() -> object* {
        object* p = mine.last;
        if (p == nullptr || random() % 2 == 0) {
          auto& from = maps[random() % 2];
          const std::lock_guard<std::mutex> lock(from.mutex);
          if (!from.frames.empty()) {
            auto at = from.frames.begin();
            for (auto steps = random() % 8; steps != 0 && std::next(at) != from.frames.end();
                 --steps)
              ++at;
            p = *at;
          }
        }
        if (p != nullptr) {
          EXPECT_EQ(p->canary, alive);
          object* next = random() % 2 == 0 ? p->parent.get() : p->previous.get();
          if (next != nullptr && random() % 2 == 0) p = next;
          EXPECT_EQ(p->canary, alive);
        }
        return p;
      };
      for (int i = 0; i != 3 * support::rounds(); ++i) {
        object* const p = borrow();
        object* const q = borrow();
        switch (random() % 9) {
          case 0:
          case 1: {
            auto* const made = new object;
            made->parent = p;
            made->previous = q;
            mine.last = made;
            mine.window.push_back(made);
            if (mine.window.size() > 5) mine.window.pop_front();
            auto& into = maps[random() % 2];
            const std::lock_guard<std::mutex> lock(into.mutex);
            into.frames.insert(made);
            break;
          }
          case 2:
            if (p != nullptr && q != nullptr) {
              const std::lock_guard<std::mutex> lock(p->mutex);
              p->neighbours.push_back(q);
              p->weights.push_back(i);
            }
            break;
          case 3:
            if (p != nullptr) {
              const std::lock_guard<std::mutex> lock(p->mutex);
              p->matches.assign({q, nullptr, q});
              EXPECT_EQ(p->neighbours.size(), p->weights.size());
            }
            break;
          case 4:
            if (p != nullptr && q != nullptr) p->parent = std::move(q->previous);
            break;
          case 5:
            if (p != nullptr) p->previous = q;
            break;
          case 6:
          case 7:
            if (p != nullptr) slamgc::retire(p);  // and nothing is taken out
            break;
          default:
            if (random() % 20 == 0) {
              auto& dies = maps[random() % 2];
              const std::lock_guard<std::mutex> lock(dies.mutex);
              dies.frames.clear();
            }
        }
        if (random() % 8 == 0) {
          if (random() % 4 == 0)
            const typename slamgc::basic_mutator<TypeParam>::offline_scope waits(me);
          else
            me.quiescent();
        }
      }
      --running;
    });
    EXPECT_EQ(domain.drain(), slamgc::waited::done);
    // Whoever is not retired is listed, or was cleared away.
    std::size_t listed = 0;
    for (auto& each : maps) {
      listed += each.frames.size();
      for (object* p : each.frames) {
        EXPECT_EQ(p->canary, alive);
        EXPECT_EQ(p->neighbours.size(), p->weights.size());
      }
    }
    EXPECT_EQ(object::live(), static_cast<int>(listed));
  }
  EXPECT_EQ(domain.drain(), slamgc::waited::done);
  EXPECT_EQ(object::live(), 0);
}

TYPED_TEST(PurgeStress, RootsComeAndGo) {
  using object = frame<TypeParam>;
  slamgc::basic_domain<TypeParam> domain;
  {
    std::atomic<int> running{3};
    support::in_threads(4, [&](int thread) {
      if (thread == 3) {
        while (running != 0) (void)domain.collect({20});
        return;
      }
      for (int i = 0; i != support::rounds() / 2; ++i) {
        slamgc::basic_mutator<TypeParam> me(domain, "mutator");
        std::optional<map<TypeParam>> shared(std::in_place);
        members<TypeParam> mine;
        std::optional<slamgc::basic_root<TypeParam>> first, second;
        first.emplace(domain, "shared", *shared);
        second.emplace(me, "mine", mine);
        mine.last = new object;
        {
          const std::lock_guard<std::mutex> lock(shared->mutex);
          shared->frames.insert(mine.last);
        }
        if (i % 2 == 0)
          slamgc::retire(mine.last.get());
        else
          first->collect_cycles();
        me.quiescent();
        first.reset();
        shared.reset();
      }
      --running;
    });
  }
  EXPECT_EQ(domain.drain(), slamgc::waited::done);
  EXPECT_EQ(object::live(), 0);
}

}  // namespace
