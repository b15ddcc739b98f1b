// atomic_rc: what std::atomic<std::shared_ptr<T>> does, with exact counts, under each policy.
#include <slamgc/atomic_rc.hpp>

#include <gtest/gtest.h>

#include <slamgc/slamgc.hpp>
#include <type_traits>
#include <utility>

#include "support/instances.hpp"
#include "support/policies.hpp"

namespace {

using slamgc::atomic_rc;
using slamgc::intrusive_rc;
using slamgc::make_rc;

template <class Policy>
struct node : slamgc::rc_object<node<Policy>, Policy, slamgc::reclaim_deferred>,
              support::instances<node<Policy>> {
  virtual ~node() = default;
  atomic_rc<node> next;
};
template <class Policy>
struct derived_node : node<Policy> {};

template <class Policy>
class AtomicRc : public ::testing::Test {
 protected:
  ~AtomicRc() override {
    while (domain_.collect().result != slamgc::collected::outcome::done) mutator_.quiescent();
    EXPECT_EQ(node<Policy>::live(), 0);
  }
  slamgc::domain domain_;
  slamgc::mutator mutator_{domain_, "m"};
};
TYPED_TEST_SUITE(AtomicRc, support::all_policies, support::policy_names);

TYPED_TEST(AtomicRc, IsAsLargeAsAPointerAndNobodyCopiesIt) {
  using shared = atomic_rc<node<TypeParam>>;
  EXPECT_EQ(sizeof(shared), sizeof(void*));
  EXPECT_FALSE(std::is_copy_constructible<shared>::value);
  EXPECT_FALSE(std::is_copy_assignable<shared>::value);
  EXPECT_TRUE((std::is_same<typename shared::value_type, intrusive_rc<node<TypeParam>>>::value));
}

TYPED_TEST(AtomicRc, StartsAsNull) {
  const atomic_rc<node<TypeParam>> shared;
  EXPECT_EQ(shared.get(), nullptr);
  EXPECT_EQ(shared.load(), nullptr);
}

TYPED_TEST(AtomicRc, LoadGivesAReferenceOfTheReadersOwn) {
  const auto p = make_rc<node<TypeParam>>();
  {
    const atomic_rc<node<TypeParam>> shared(p);
    EXPECT_EQ(p->use_count(), 2u);
    EXPECT_EQ(shared.get(), p);
    const auto loaded = shared.load();
    EXPECT_EQ(loaded, p);
    EXPECT_EQ(p->use_count(), 3u);
  }
  EXPECT_EQ(p->use_count(), 1u);
}

TYPED_TEST(AtomicRc, StoreAndAssignmentTakeTheReferenceOver) {
  atomic_rc<node<TypeParam>> shared;
  auto p = make_rc<node<TypeParam>>();
  auto* const raw = p.get();
  const auto before = raw->state();
  shared.store(std::move(p));
  EXPECT_EQ(p, nullptr);
  EXPECT_EQ(raw->use_count(), 1u);
  EXPECT_NE(raw->state().version(), before.version());  // it moved
  shared = make_rc<derived_node<TypeParam>>();
  EXPECT_TRUE(raw->state().is_queued());
  shared = nullptr;
  EXPECT_EQ(shared.get(), nullptr);
}

TYPED_TEST(AtomicRc, ExchangeGivesTheOldReference) {
  atomic_rc<node<TypeParam>> shared(make_rc<node<TypeParam>>());
  auto* const first = shared.get();
  const auto version = first->state().version();
  const auto old = shared.exchange(make_rc<node<TypeParam>>());
  EXPECT_EQ(old.get(), first);
  EXPECT_EQ(old->use_count(), 1u);
  EXPECT_NE(old->state().version(), version);  // it moved
  EXPECT_EQ(shared.exchange(nullptr)->use_count(), 1u);
  EXPECT_EQ(shared.exchange(nullptr), nullptr);
}

TYPED_TEST(AtomicRc, CompareExchangeThatSucceeds) {
  const auto p = make_rc<node<TypeParam>>();
  const auto q = make_rc<node<TypeParam>>();
  atomic_rc<node<TypeParam>> shared(p);
  auto* expected = p.get();
  EXPECT_TRUE(shared.compare_exchange_strong(expected, q));
  EXPECT_EQ(expected, p.get());
  EXPECT_EQ(p->use_count(), 1u);
  EXPECT_EQ(q->use_count(), 2u);
  expected = q.get();
  while (!shared.compare_exchange_weak(expected, p)) ASSERT_EQ(expected, q.get());
  EXPECT_EQ(p->use_count(), 2u);
  EXPECT_EQ(q->use_count(), 1u);
  expected = p.get();
  EXPECT_TRUE(shared.compare_exchange_strong(expected, p));  // by itself
  EXPECT_EQ(p->use_count(), 2u);
  EXPECT_TRUE(shared.compare_exchange_strong(expected, nullptr));
  EXPECT_EQ(p->use_count(), 1u);
  expected = nullptr;
  EXPECT_TRUE(shared.compare_exchange_strong(expected, q));
  EXPECT_EQ(q->use_count(), 2u);
}

TYPED_TEST(AtomicRc, CompareExchangeThatFails) {
  const auto p = make_rc<node<TypeParam>>();
  const auto q = make_rc<node<TypeParam>>();
  atomic_rc<node<TypeParam>> shared(p);
  auto* expected = q.get();
  EXPECT_FALSE(shared.compare_exchange_strong(expected, q));
  EXPECT_EQ(expected, p.get());
  expected = nullptr;
  EXPECT_FALSE(shared.compare_exchange_weak(expected, make_rc<node<TypeParam>>()));
  EXPECT_EQ(expected, p.get());
  EXPECT_EQ(p->use_count(), 2u);
  EXPECT_EQ(q->use_count(), 1u);
}

TYPED_TEST(AtomicRc, LoadingAnObjectThatWaitsKeepsIt) {
  atomic_rc<node<TypeParam>> shared(make_rc<node<TypeParam>>());
  auto* const borrowed = shared.get();
  shared = nullptr;
  (void)this->domain_.collect();  // notes it
  shared.store(intrusive_rc<node<TypeParam>>(borrowed));
  this->mutator_.quiescent();
  EXPECT_EQ(this->domain_.collect().reclaimed, 0u);
  EXPECT_EQ(shared.load()->use_count(), 2u);
}

TYPED_TEST(AtomicRc, MayBeAMember) {
  auto p = make_rc<node<TypeParam>>();
  p->next = make_rc<node<TypeParam>>();
  p->next.load()->next = make_rc<derived_node<TypeParam>>();
  EXPECT_EQ(node<TypeParam>::live(), 3);
}

TYPED_TEST(AtomicRc, AThreadThatNeverRegisteredMayStore) {
  atomic_rc<node<TypeParam>> shared;
  auto p = make_rc<node<TypeParam>>();
  const slamgc::mutator::offline_scope offline(this->mutator_);
  shared.store(std::move(p));
  shared.store(nullptr);
  EXPECT_EQ(this->domain_.collect().reclaimed, 1u);
}

}  // namespace
