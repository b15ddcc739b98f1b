// Several threads assign, read, move and swap the same slots, without a lock.
#include <gtest/gtest.h>

#include <cstddef>
#include <random>
#include <slamgc/slamgc.hpp>
#include <utility>
#include <vector>

#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using support::in_threads;
using support::rounds;

constexpr int magic = 4711;

struct node : slamgc::rc_object<node, support::yielding_fetch_add>, support::instances<node> {
  ~node() {
    EXPECT_EQ(payload, magic);  // plain, as is what follows
    payload = 0;
  }
  int payload = magic;
  slamgc::rc_slot<node, yield_env> next;
};
using slot = slamgc::rc_slot<node, yield_env>;

class RcSlotStress : public ::testing::Test {
 protected:
  ~RcSlotStress() override { EXPECT_EQ(node::live(), 0); }
};

TEST_F(RcSlotStress, TwoThreadsAssignOneSlot) {
  slot shared;
  in_threads(2, [&](int me) {
    for (int i = 0; i != 4 * rounds(); ++i) {
      if (i % 8 == me)
        shared = nullptr;
      else
        shared = new node;
    }
  });
  EXPECT_LE(node::live(), 1);
  shared = nullptr;
  EXPECT_EQ(node::live(), 0);
}

TEST_F(RcSlotStress, ManyThreadsAssignOneSlotInEveryWay) {
  slot shared;
  in_threads(4, [&](int me) {
    for (int i = 0; i != rounds(); ++i) {
      switch ((i + me) % 5) {
        case 0:
          shared = new node;
          break;
        case 1:
          shared = make_rc<node>();
          break;
        case 2: {
          const intrusive_rc<node> old = shared.exchange(new node);
          if (old) {
            EXPECT_EQ(old->payload, magic);
          }
          break;
        }
        case 3: {
          slot mine(new node);
          shared = std::move(mine);
          break;
        }
        default: {
          const slot mine(std::move(shared));
          if (mine) {
            EXPECT_EQ(mine->payload, magic);
          }
        }
      }
    }
  });
  shared.reset();
}

// The new object is published, the old one released: a reader that comes by a published pointer sees
// a whole object. Everything is kept until the readers are done.
TEST_F(RcSlotStress, ReadersSeeWholeObjects) {
  slot shared;
  std::vector<intrusive_rc<node>> kept;
  std::vector<long> sums(3);
  in_threads(4, [&](int me) {
    if (me == 0) {
      for (int i = 0; i != rounds(); ++i) {
        kept.push_back(make_rc<node>());
        kept.back()->next = kept.front();
        shared = kept.back();
      }
      return;
    }
    long& sum = sums[static_cast<std::size_t>(me - 1)];
    for (int i = 0; i != rounds(); ++i) {
      node* const p = shared;
      if (p != nullptr) sum += p->payload + p->next->payload;
      const slot copy(p);
      if (copy) sum += copy->payload;
    }
  });
  for (const long sum : sums) EXPECT_EQ(sum % magic, 0);
  kept.front()->next = nullptr;  // its own reference
  shared = nullptr;
}

// While the objects are kept, two threads may even swap and move the same slots.
TEST_F(RcSlotStress, SwapsAndMovesLoseNoReference) {
  constexpr std::size_t slots = 3;
  constexpr unsigned objects = 4;
  std::vector<intrusive_rc<node>> kept;
  for (unsigned i = 0; i != objects; ++i) kept.push_back(make_rc<node>());
  {
    std::vector<slot> shared(slots);
    in_threads(3, [&](int me) {
      std::minstd_rand random(static_cast<unsigned>(yield_env::seed()) + static_cast<unsigned>(me));
      for (int i = 0; i != rounds(); ++i) {
        slot& a = shared[random() % slots];
        slot& b = shared[random() % slots];
        switch (random() % 4) {
          case 0:
            a.swap(b);
            break;
          case 1:
            a = std::move(b);
            break;
          case 2:
            a = b;
            break;
          default:
            a = kept[random() % objects];
        }
      }
    });
    unsigned held = 0;
    for (const slot& s : shared) held += s != nullptr;
    unsigned counted = 0;
    for (const auto& p : kept) counted += p->use_count() - 1;
    EXPECT_EQ(counted, held);
  }
  for (const auto& p : kept) EXPECT_EQ(p->use_count(), 1u);
}

// A graph in which everything refers to everything comes apart in several threads at once.
TEST_F(RcSlotStress, ThreadsTakeOneGraphApart) {
  constexpr std::size_t size = 60;
  constexpr int threads = 3;
  for (int i = 0; i != rounds() / 10 + 1; ++i) {
    std::minstd_rand random(static_cast<unsigned>(yield_env::seed()) + static_cast<unsigned>(i));
    std::vector<intrusive_rc<node>> nodes;
    for (std::size_t k = 0; k != size; ++k) {
      nodes.push_back(make_rc<node>());
      if (k != 0) nodes.back()->next = nodes[random() % k];  // no cycles
    }
    std::vector<std::vector<intrusive_rc<node>>> parts(threads, nodes);
    nodes.clear();
    in_threads(threads, [&](int me) {
      for (auto& p : parts[static_cast<std::size_t>(me)]) p.reset();
    });
    ASSERT_EQ(node::live(), 0);
  }
}

}  // namespace
