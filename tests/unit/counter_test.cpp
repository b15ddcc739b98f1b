// The state word and its transitions, the same for every counter policy.
#include <slamgc/counter.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

#include "support/policies.hpp"

namespace {

using slamgc::state_word;
using support::set_word;

constexpr std::uint32_t sticky = state_word::sticky_count;

constexpr std::uint64_t word_of(std::uint32_t version, std::uint32_t count, unsigned flags) {
  return version * state_word::version_unit + count * state_word::count_unit + flags;
}

static_assert(state_word{}.count() == 0 && state_word{}.version() == 0);
static_assert(state_word{word_of(7, 5, 0)}.count() == 5);
static_assert(state_word{word_of(7, 5, 3)}.version() == 7);
static_assert(state_word{word_of(7, 5, state_word::retired_flag)}.is_retired());
static_assert(!state_word{word_of(7, 5, state_word::retired_flag)}.is_queued());
static_assert(state_word{word_of(7, 5, state_word::queued_flag)}.is_queued());
static_assert(!state_word{word_of(0, sticky - 1, 3)}.is_saturated());
static_assert(state_word{word_of(0, sticky, 0)}.is_saturated());
static_assert(!state_word{word_of(7, 0, 3)}.is_shared());
static_assert(!state_word{word_of(7, 1, 3)}.is_shared());
static_assert(state_word{word_of(7, 2, 0)}.is_shared());
static_assert(state_word{word_of(7, sticky - 1, 3)}.is_shared());
static_assert(!state_word{word_of(7, sticky, 0)}.is_shared());
static_assert(!state_word{word_of(7, 2 * sticky - 1, 3)}.is_shared());
static_assert(state_word{word_of(1, 1, 0)}.same_references({word_of(1, 1, 3)}));
static_assert(!state_word{word_of(1, 1, 0)}.same_references({word_of(2, 1, 0)}));
static_assert(!state_word{word_of(1, 1, 0)}.same_references({word_of(1, 2, 0)}));

template <class Policy>
class Counter : public ::testing::Test {
 protected:
  using transitions = slamgc::detail::transitions<Policy>;

  state_word now() const { return transitions::load(storage_); }
  void set(std::uint32_t version, std::uint32_t count, unsigned flags) {
    set_word<Policy>(storage_, word_of(version, count, flags));
  }
  void increment() { transitions::increment(storage_); }
  std::uint32_t decrement() { return transitions::decrement(storage_).count(); }
  void move() { transitions::move(storage_); }

  typename Policy::storage storage_;
};
TYPED_TEST_SUITE(Counter, support::all_policies, support::policy_names);

TYPED_TEST(Counter, StartsAtZero) { EXPECT_EQ(this->now().bits, 0u); }

TYPED_TEST(Counter, AddReturnsTheWordBefore) {
  EXPECT_EQ(TypeParam::add(this->storage_, 40), 0u);
  EXPECT_EQ(TypeParam::add(this->storage_, 2), 40u);
  EXPECT_EQ(TypeParam::load(this->storage_), 42u);
}

TYPED_TEST(Counter, SubtractReturnsTheWordBefore) {
  TypeParam::add(this->storage_, 42);
  EXPECT_EQ(TypeParam::subtract(this->storage_, 2), 42u);
  EXPECT_EQ(TypeParam::subtract(this->storage_, 40), 40u);
  EXPECT_EQ(TypeParam::subtract(this->storage_, 1), 0u);
  EXPECT_EQ(TypeParam::load(this->storage_), std::numeric_limits<std::uint64_t>::max());
}

TYPED_TEST(Counter, CompareExchangeReplacesTheExpectedWord) {
  set_word<TypeParam>(this->storage_, 5);
  std::uint64_t expected = 5;
  EXPECT_TRUE(TypeParam::compare_exchange(this->storage_, expected, 9));
  EXPECT_EQ(expected, 5u);
  EXPECT_EQ(TypeParam::load(this->storage_), 9u);
}

TYPED_TEST(Counter, CompareExchangeLearnsAnotherWord) {
  set_word<TypeParam>(this->storage_, 5);
  std::uint64_t expected = 6;
  EXPECT_FALSE(TypeParam::compare_exchange(this->storage_, expected, 9));
  EXPECT_EQ(expected, 5u);
  EXPECT_EQ(TypeParam::load(this->storage_), 5u);
}

TYPED_TEST(Counter, IncrementAddsToCountAndVersion) {
  this->increment();
  EXPECT_EQ(this->now().bits, word_of(1, 1, 0));
  this->increment();
  EXPECT_EQ(this->now().bits, word_of(2, 2, 0));
}

TYPED_TEST(Counter, DecrementLeavesTheVersionAndReturnsTheCountBefore) {
  this->set(8, 2, 0);
  EXPECT_EQ(this->decrement(), 2u);
  EXPECT_EQ(this->now().bits, word_of(8, 1, 0));
  EXPECT_EQ(this->decrement(), 1u);
  EXPECT_EQ(this->now().bits, word_of(8, 0, 0));
}

TYPED_TEST(Counter, MoveAddsToTheVersionOnly) {
  this->set(8, 2, 0);
  this->move();
  EXPECT_EQ(this->now().bits, word_of(9, 2, 0));
}

TYPED_TEST(Counter, SnapshotsTellAnAddedAndRemovedReference) {
  this->set(8, 2, 0);
  const state_word before = this->now();
  this->increment();
  this->decrement();
  EXPECT_EQ(this->now().count(), before.count());
  EXPECT_FALSE(this->now().same_references(before));
}

TYPED_TEST(Counter, SnapshotsTellAMovedReference) {
  const state_word before = this->now();
  this->move();
  EXPECT_FALSE(this->now().same_references(before));
}

TYPED_TEST(Counter, CountingLeavesTheFlagsAlone) {
  for (unsigned flags = 0; flags != 4; ++flags) {
    this->set(0, 0, flags);
    for (int i = 0; i != 100; ++i) this->increment();
    this->move();
    for (int i = 0; i != 100; ++i) this->decrement();
    EXPECT_EQ(this->now().bits, word_of(101, 0, flags));
  }
}

TYPED_TEST(Counter, TheVersionWrapsIntoNothing) {
  for (unsigned flags = 0; flags != 4; ++flags) {
    this->set(std::numeric_limits<std::uint32_t>::max(), 6, flags);
    this->increment();
    EXPECT_EQ(this->now().bits, word_of(0, 7, flags));
    this->set(std::numeric_limits<std::uint32_t>::max(), 6, flags);
    this->move();
    EXPECT_EQ(this->now().bits, word_of(0, 6, flags));
  }
}

TYPED_TEST(Counter, UnderflowRestoresTheWord) {
  for (unsigned flags = 0; flags != 4; ++flags) {
    this->set(3, 0, flags);
    EXPECT_EQ(this->decrement(), 0u);
    EXPECT_EQ(this->now().bits, word_of(3, 0, flags));
  }
}

TYPED_TEST(Counter, CountsExactlyBelowTheLimit) {
  this->set(0, sticky - 2, 0);
  this->increment();
  EXPECT_EQ(this->now().count(), sticky - 1);
  EXPECT_FALSE(this->now().is_saturated());
  EXPECT_EQ(this->decrement(), sticky - 1);
  EXPECT_EQ(this->now().count(), sticky - 2);
}

// Nobody has put it into the middle of the sticky range yet.
TYPED_TEST(Counter, ACountThatFallsBackBelowTheLimitIsExact) {
  this->set(0, sticky - 1, 3);
  this->increment();
  EXPECT_EQ(this->decrement(), sticky);
  EXPECT_EQ(this->now().bits, word_of(1, sticky - 1, 3));
}

TYPED_TEST(Counter, OverflowSticks) {
  for (unsigned flags = 0; flags != 4; ++flags) {
    this->set(0, sticky - 1, flags);
    this->increment();
    EXPECT_TRUE(this->now().is_saturated());
    this->increment();
    // More decrements than there were increments above the limit: it would be below without sticking.
    for (int i = 0; i != 1000; ++i) {
      EXPECT_GE(this->decrement(), sticky);
      ASSERT_TRUE(this->now().is_saturated());
    }
    for (int i = 0; i != 1000; ++i) this->increment();
    ASSERT_TRUE(this->now().is_saturated());
    EXPECT_EQ(this->now().bits & 3, flags);
    EXPECT_EQ(this->now().version(), 1002u);
  }
}

// Increments and decrements alike bring it there, so that changes that race do not wear it down.
TYPED_TEST(Counter, AStuckCountIsFarFromBothEnds) {
  constexpr std::uint32_t distance = sticky / 2;
  this->set(0, sticky, 0);
  this->increment();
  EXPECT_GE(this->now().count(), sticky + distance);
  EXPECT_LE(this->now().count(), 2 * sticky - distance);
  this->set(0, sticky + 5, 0);
  this->decrement();
  EXPECT_GE(this->now().count(), sticky + distance);
  EXPECT_LE(this->now().count(), 2 * sticky - distance);
}

TYPED_TEST(Counter, ACarryOutOfTheCountNeverReachesTheFlags) {
  for (unsigned flags = 0; flags != 4; ++flags) {
    this->set(0, 2 * sticky - 1, flags);  // all bits of the count
    this->increment();
    EXPECT_EQ(this->now().bits & 3, flags);
  }
}

}  // namespace
