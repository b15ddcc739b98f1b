// An object is destroyed when nobody can see it any more: each way there, under each policy.
#include <slamgc/deferred.hpp>

#include <gtest/gtest.h>

#include <slamgc/slamgc.hpp>
#include <stdexcept>
#include <utility>

#include "support/instances.hpp"
#include "support/policies.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::retire;
using outcome = slamgc::collected::outcome;

template <class Policy, class Reclaimer>
struct node : slamgc::rc_object<node<Policy, Reclaimer>, Policy, Reclaimer>,
              support::instances<node<Policy, Reclaimer>> {
  explicit node(int v = 0) : value(v) {
    if (v < 0) throw std::invalid_argument("negative");
  }
  node(const node&) = default;
  node& operator=(const node&) = default;
  virtual ~node() = default;
  int value;
  slamgc::rc_slot<node> next;
};
template <class Policy, class Reclaimer>
struct derived_node : node<Policy, Reclaimer> {
  derived_node() { ++alive; }
  derived_node(const derived_node&) = delete;
  derived_node& operator=(const derived_node&) = delete;
  ~derived_node() override { --alive; }
  static inline int alive = 0;
};

template <class Policy>
class Reclaiming : public ::testing::Test {
 protected:
  using at_zero = node<Policy, slamgc::reclaim_deferred>;
  using when_retired = node<Policy, slamgc::reclaim_retired>;

  ~Reclaiming() override {
    mutator_.quiescent();
    (void)domain_.collect();
    EXPECT_EQ(domain_.stats().total(&slamgc::type_stats::live), 0u);
    EXPECT_EQ(at_zero::live(), 0);
    EXPECT_EQ(when_retired::live(), 0);
  }
  // Notes what has entered.
  void note() { EXPECT_EQ(domain_.collect().result, outcome::waiting); }
  // Ends the grace period, and returns how many objects were reclaimed then.
  std::size_t decide() {
    mutator_.quiescent();
    return domain_.collect().reclaimed;
  }

  slamgc::domain domain_;
  slamgc::mutator mutator_{domain_, "test"};
};
TYPED_TEST_SUITE(Reclaiming, support::all_policies, support::policy_names);

TYPED_TEST(Reclaiming, AnObjectOutlivesThePointersThatMayBeBorrowed) {
  using T = typename TestFixture::at_zero;
  auto p = make_rc<T>(7);
  const T* const borrowed = p.get();
  p.reset();
  EXPECT_EQ(borrowed->use_count(), 0u);
  EXPECT_TRUE(borrowed->state().is_queued());
  this->note();
  EXPECT_EQ(this->domain_.collect().result, outcome::waiting);
  EXPECT_EQ(borrowed->value, 7);
  this->mutator_.quiescent();
  const auto done = this->domain_.collect();
  EXPECT_EQ(done.result, outcome::done);
  EXPECT_EQ(done.reclaimed, 1u);
  EXPECT_EQ(T::live(), 0);
}

TYPED_TEST(Reclaiming, OneCallIsEnoughWhereNobodyIsOnline) {
  using T = typename TestFixture::at_zero;
  auto p = make_rc<T>();
  const slamgc::mutator::offline_scope offline(this->mutator_);
  p.reset();
  const auto done = this->domain_.collect();
  EXPECT_EQ(done.result, outcome::done);
  EXPECT_EQ(done.reclaimed, 1u);
}

TYPED_TEST(Reclaiming, AnObjectThatIsReferredToAgainLeavesTheTable) {
  using T = typename TestFixture::at_zero;
  auto p = make_rc<T>();
  T* const borrowed = p.get();
  p.reset();
  this->note();
  p = borrowed;
  EXPECT_EQ(this->decide(), 0u);
  EXPECT_FALSE(p->state().is_queued());
  EXPECT_EQ(this->domain_.stats().total(&slamgc::type_stats::backlog), 0u);
  p.reset();  // enters a second time
  EXPECT_TRUE(borrowed->state().is_queued());
  this->note();
  EXPECT_EQ(this->decide(), 1u);
}

TYPED_TEST(Reclaiming, AReferenceThatCameAndWentMeansAnotherGracePeriod) {
  using T = typename TestFixture::at_zero;
  auto p = make_rc<T>();
  T* const borrowed = p.get();
  p.reset();
  this->note();
  intrusive_rc<T>(borrowed).reset();
  EXPECT_EQ(this->decide(), 0u);
  EXPECT_EQ(T::live(), 1);
  EXPECT_TRUE(borrowed->state().is_queued());
  EXPECT_EQ(this->decide(), 1u);
}

TYPED_TEST(Reclaiming, AReferenceThatCameAndWentBeforeItWasNotedDoesNot) {
  using T = typename TestFixture::at_zero;
  auto p = make_rc<T>();
  T* const borrowed = p.get();
  p.reset();
  for (int i = 0; i != 10; ++i) intrusive_rc<T>(borrowed).reset();  // it is in the table once
  EXPECT_EQ(this->domain_.delayed().backlog, 1u);
  this->note();
  EXPECT_EQ(this->decide(), 1u);
}

TYPED_TEST(Reclaiming, AnObjectThatWasNeverCountedIsTheProgrammes) {
  using T = typename TestFixture::at_zero;
  T* const mine = new T;
  EXPECT_EQ(this->domain_.collect().result, outcome::done);
  EXPECT_EQ(T::live(), 1);
  EXPECT_EQ(this->domain_.stats().total(&slamgc::type_stats::live), 1u);
  delete mine;
  const T on_the_stack;
  EXPECT_EQ(this->domain_.stats().total(&slamgc::type_stats::created), 2u);
  EXPECT_EQ(this->domain_.stats().total(&slamgc::type_stats::live), 1u);
}

TYPED_TEST(Reclaiming, AConstructorThatThrowsLeavesNoObject) {
  using T = typename TestFixture::at_zero;
  EXPECT_THROW((void)make_rc<T>(-1), std::invalid_argument);
  EXPECT_EQ(this->domain_.stats().total(&slamgc::type_stats::created), 1u);
  EXPECT_EQ(this->domain_.stats().total(&slamgc::type_stats::live), 0u);
}

TYPED_TEST(Reclaiming, ACopyIsAnObjectOfItsOwn) {
  using T = typename TestFixture::at_zero;
  auto p = make_rc<T>(3);
  auto q = make_rc<T>(*p);
  *q = *p;
  p.reset();
  this->note();
  EXPECT_EQ(this->decide(), 1u);
  EXPECT_EQ(q->value, 3);
  q.reset();
  this->note();
  EXPECT_EQ(this->decide(), 1u);
}

TYPED_TEST(Reclaiming, ARetiredObjectThatWasNeverCountedIsReclaimed) {
  using T = typename TestFixture::at_zero;
  using R = typename TestFixture::when_retired;
  EXPECT_TRUE(retire(new T));
  EXPECT_TRUE(retire(new R));
  this->note();
  EXPECT_EQ(this->decide(), 2u);
}

TYPED_TEST(Reclaiming, ARetiredObjectStaysWhileItIsReferredTo) {
  using T = typename TestFixture::at_zero;
  using R = typename TestFixture::when_retired;
  auto p = make_rc<T>();
  auto q = make_rc<R>();
  EXPECT_TRUE(retire(p.get()));
  EXPECT_TRUE(retire(q.get()));
  EXPECT_TRUE(p->state().is_retired());
  EXPECT_FALSE(p->state().is_queued());
  EXPECT_EQ(this->domain_.collect().result, outcome::done);
  p.reset();
  q.reset();
  this->note();
  EXPECT_EQ(this->decide(), 2u);
}

TYPED_TEST(Reclaiming, TheSecondRetirementDoesNothing) {
  using T = typename TestFixture::at_zero;
  using R = typename TestFixture::when_retired;
  T* const p = new T;
  R* const q = new R;
  EXPECT_TRUE(retire(p));
  EXPECT_FALSE(retire(p));
  EXPECT_TRUE(retire(q));
  EXPECT_FALSE(retire(q));
  this->note();
  EXPECT_FALSE(retire(p));
  EXPECT_FALSE(retire(q));
  EXPECT_EQ(this->decide(), 2u);
  EXPECT_EQ(this->domain_.stats().total(&slamgc::type_stats::retired), 2u);
}

TYPED_TEST(Reclaiming, AnObjectAtZeroMayBeRetired) {
  using T = typename TestFixture::at_zero;
  auto p = make_rc<T>();
  T* const borrowed = p.get();
  p.reset();
  EXPECT_TRUE(retire(borrowed));  // while it is in a chain
  EXPECT_EQ(this->domain_.delayed().backlog, 1u);
  auto q = make_rc<T>();
  T* const noted = q.get();
  q.reset();
  this->note();
  EXPECT_TRUE(retire(noted));  // while a collector holds it; no reference changes by that
  EXPECT_EQ(this->decide(), 2u);
  EXPECT_EQ(this->domain_.stats().total(&slamgc::type_stats::retired), 2u);
}

TYPED_TEST(Reclaiming, WhatWasNotRetiredMayWaitAtZeroForEver) {
  using R = typename TestFixture::when_retired;
  auto p = make_rc<R>(5);
  R* const raw = p.get();
  p.reset();
  EXPECT_FALSE(raw->state().is_queued());
  EXPECT_EQ(this->domain_.collect().result, outcome::done);
  this->mutator_.quiescent();
  EXPECT_EQ(this->domain_.collect().result, outcome::done);
  p = raw;  // somebody finds it again
  EXPECT_EQ(p->value, 5);
  p.reset();
  EXPECT_TRUE(retire(raw));
  this->note();
  EXPECT_EQ(this->decide(), 1u);
}

TYPED_TEST(Reclaiming, ARetiredObjectThatIsReferredToAgainGoesWithThatReference) {
  using R = typename TestFixture::when_retired;
  auto* const raw = new R;
  EXPECT_TRUE(retire(raw));
  this->note();
  intrusive_rc<R> again(raw);
  EXPECT_EQ(this->decide(), 0u);
  EXPECT_FALSE(again->state().is_queued());
  again.reset();
  this->note();
  EXPECT_EQ(this->decide(), 1u);
}

TYPED_TEST(Reclaiming, DerivedObjectsAreDestroyedAsAWhole) {
  using D = derived_node<TypeParam, slamgc::reclaim_deferred>;
  using R = derived_node<TypeParam, slamgc::reclaim_retired>;
  slamgc::rc_slot<typename TestFixture::at_zero> slot(make_rc<D>());
  slot = nullptr;
  EXPECT_TRUE(retire(new D));
  EXPECT_TRUE(retire(new R));
  this->note();
  EXPECT_EQ(D::alive, 2);
  EXPECT_EQ(this->decide(), 3u);
  EXPECT_EQ(D::alive, 0);
  EXPECT_EQ(R::alive, 0);
}

TYPED_TEST(Reclaiming, AGraphGoesLinkByLink) {
  using T = typename TestFixture::at_zero;
  intrusive_rc<T> head;
  for (int i = 0; i != 5; ++i) {
    auto p = make_rc<T>();
    p->next = std::move(head);
    head = std::move(p);
  }
  head.reset();
  for (int left = 5; left != 0; --left) {
    EXPECT_EQ(T::live(), left);
    this->note();
    EXPECT_EQ(this->decide(), 1u);
  }
}

TYPED_TEST(Reclaiming, AnOverflowedCountKeepsTheObject) {
  using T = typename TestFixture::at_zero;
  auto p = make_rc<T>();
  auto& state = slamgc::detail::access::header_of(*p).state;
  support::set_word<TypeParam>(state, std::uint64_t{slamgc::state_word::sticky_count} << 2);
  T* const raw = p.get();
  p.reset();
  EXPECT_TRUE(raw->state().is_saturated());
  EXPECT_EQ(this->domain_.collect().result, outcome::done);
  support::set_word<TypeParam>(state, 0);
  delete raw;
}

}  // namespace
