// Many threads count references to the same objects, under each policy.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <slamgc/slamgc.hpp>
#include <utility>
#include <vector>

#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::state_word;
using support::in_threads;
using support::rounds;

constexpr int threads = 4;

template <class Policy>
struct object : slamgc::rc_object<object<Policy>, Policy>, support::instances<object<Policy>> {
  ~object() {
    // Plain reads: ThreadSanitizer reports them unless every use came before.
    for (const int w : written) EXPECT_EQ(w, expected);
  }
  int written[threads] = {};
  int expected = 0;
};

template <class Policy>
class CountingStress : public ::testing::Test {};
TYPED_TEST_SUITE(CountingStress, support::stress_policies, support::stress_policy_names);

TYPED_TEST(CountingStress, CopiesAndDrops) {
  const auto shared = make_rc<object<TypeParam>>();
  const auto before = shared->state();
  in_threads(threads, [&](int) {
    for (int i = 0; i != rounds(); ++i) {
      const auto copy = shared;
      slamgc::rc_slot<object<TypeParam>> slot(copy);
      slamgc::rc_vector<object<TypeParam>> vector(3, slot);
      slot = nullptr;
    }
  });
  EXPECT_EQ(shared->use_count(), 1u);
  EXPECT_EQ(shared->state().version() - before.version(),
            static_cast<unsigned>(threads * rounds() * 5));
}

TYPED_TEST(CountingStress, TheLastOfManyDropsDestroys) {
  support::barrier barrier(threads);
  std::vector<intrusive_rc<object<TypeParam>>> held(threads);
  in_threads(threads, [&](int me) {
    for (int i = 1; i <= rounds(); ++i) {
      if (me == 0) {
        held[0] = make_rc<object<TypeParam>>();
        held[0]->expected = i;
        for (auto& h : held) h = held[0];
      }
      barrier.wait();
      auto mine = std::move(held[static_cast<std::size_t>(me)]);
      mine->written[me] = i;
      mine.reset();
      barrier.wait();
      if (me == 0) {
        EXPECT_EQ(object<TypeParam>::live(), 0);
      }
    }
  });
}

// Each of many objects is dropped by two threads that come from opposite ends.
TYPED_TEST(CountingStress, TwoThreadsDropManyObjectsFromBothEnds) {
  for (int i = 0; i != rounds() / 10 + 1; ++i) {
    std::vector<intrusive_rc<object<TypeParam>>> forwards;
    for (int k = 0; k != 50; ++k) forwards.push_back(make_rc<object<TypeParam>>());
    std::vector<intrusive_rc<object<TypeParam>>> backwards(forwards.rbegin(), forwards.rend());
    in_threads(2, [&](int me) {
      for (auto& p : me == 0 ? forwards : backwards) p.reset();
    });
    ASSERT_EQ(object<TypeParam>::live(), 0);
  }
}

// Whoever finds that it holds the only reference may change the object without a lock.
TYPED_TEST(CountingStress, TheOnlyHolderSeesWhatTheOthersDid) {
  for (int i = 0; i != rounds() / 10 + 1; ++i) {
    auto mine = make_rc<object<TypeParam>>();
    auto other = mine;
    in_threads(2, [&](int me) {
      if (me == 0) {
        other->written[0] = i + 1;
        other.reset();
      } else {
        while (mine->use_count() != 1) std::this_thread::yield();
        EXPECT_EQ(mine->written[0], i + 1);
        mine->written[0] = 0;
      }
    });
  }
}

// Around 2^29 a count is exact or sticks: changes that race with the overflow lose nothing.
TYPED_TEST(CountingStress, AnOverflowingCountIsExactOrSticks) {
  using transitions = slamgc::detail::transitions<TypeParam>;
  for (int i = 0; i != rounds() / 10 + 1; ++i) {
    typename TypeParam::storage storage;
    constexpr std::uint32_t start = state_word::sticky_count - 2;
    support::set_word<TypeParam>(storage, (std::uint64_t{start} << 2) | 3);
    in_threads(threads, [&](int) {
      for (int k = 0; k != 20; ++k) {
        transitions::increment(storage);
        transitions::decrement(storage);
      }
    });
    const state_word found = transitions::load(storage);
    EXPECT_TRUE(found.count() == start || found.is_saturated()) << found.count();
    EXPECT_EQ(found.bits & 3, 3u);
    EXPECT_EQ(found.version(), 80u);
  }
}

TYPED_TEST(CountingStress, RacingUnderflowsAreAllUndone) {
  using transitions = slamgc::detail::transitions<TypeParam>;
  typename TypeParam::storage storage;
  support::set_word<TypeParam>(storage, 3);
  std::atomic<int> undone{0};
  in_threads(threads, [&](int) {
    for (int k = 0; k != rounds(); ++k)
      if (transitions::decrement(storage).count() == 0) ++undone;
  });
  EXPECT_GT(undone.load(), 0);
  EXPECT_EQ(transitions::load(storage).bits & 3, 3u);
}

}  // namespace
