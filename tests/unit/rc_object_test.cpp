// The base class: what it adds to a class, and what it leaves alone.
#include <slamgc/rc_object.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <mutex>
#include <slamgc/intrusive_rc.hpp>
#include <type_traits>
#include <utility>

#include "support/instances.hpp"
#include "support/policies.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;

template <class Policy>
struct empty_object : slamgc::rc_object<empty_object<Policy>, Policy> {};

template <class Policy>
struct object : slamgc::rc_object<object<Policy>, Policy>, support::instances<object<Policy>> {
  explicit object(int v = 0) : value(v) {}
  int value;
};

// Layout: promised, and the same in every build.
static_assert(sizeof(empty_object<slamgc::fetch_add_counter>) == 16);
static_assert(sizeof(empty_object<slamgc::cas_counter>) == 16);
static_assert(sizeof(empty_object<slamgc::unsync_counter>) == 16);
static_assert(sizeof(empty_object<slamgc::mutex_counter>) == 16 + sizeof(std::mutex));
#if defined(__x86_64__) && defined(__GLIBCXX__)
static_assert(sizeof(empty_object<slamgc::mutex_counter>) == 56);
#endif

template <class Policy>
class RcObject : public ::testing::Test {};
TYPED_TEST_SUITE(RcObject, support::all_policies, support::policy_names);

TYPED_TEST(RcObject, AsksForTheAlignmentOfAPointerOnly) {
  EXPECT_EQ(alignof(empty_object<TypeParam>), alignof(void*));
}

TYPED_TEST(RcObject, AddsNoVirtualFunction) {
  EXPECT_FALSE(std::is_polymorphic<empty_object<TypeParam>>::value);
  EXPECT_FALSE(std::has_virtual_destructor<empty_object<TypeParam>>::value);
}

TYPED_TEST(RcObject, CanBeMadeOnlyAsABase) {
  using base = slamgc::rc_object<empty_object<TypeParam>, TypeParam>;
  EXPECT_FALSE(std::is_default_constructible<base>::value);
  EXPECT_FALSE(std::is_copy_constructible<base>::value);
  EXPECT_FALSE(std::is_destructible<base>::value);
  EXPECT_TRUE(std::is_copy_constructible<empty_object<TypeParam>>::value);
  EXPECT_TRUE(std::is_nothrow_default_constructible<empty_object<TypeParam>>::value);
}

TYPED_TEST(RcObject, StartsUnreferenced) {
  const object<TypeParam> o;
  EXPECT_EQ(o.use_count(), 0u);
  EXPECT_EQ(o.state().bits, 0u);
}

TYPED_TEST(RcObject, CountsReferences) {
  auto a = make_rc<object<TypeParam>>();
  EXPECT_EQ(a->use_count(), 1u);
  {
    const auto b = a;
    EXPECT_EQ(a->use_count(), 2u);
  }
  EXPECT_EQ(a->use_count(), 1u);
  EXPECT_EQ(object<TypeParam>::live(), 1);
  a = nullptr;
  EXPECT_EQ(object<TypeParam>::live(), 0);
}

TYPED_TEST(RcObject, EveryReferenceAddedIsANewVersion) {
  const auto a = make_rc<object<TypeParam>>();
  const auto before = a->state();
  { const auto b = a; }
  EXPECT_EQ(a->use_count(), before.count());
  EXPECT_EQ(a->state().version(), before.version() + 1);
  EXPECT_FALSE(a->state().same_references(before));
}

TYPED_TEST(RcObject, ACopyStartsUnreferenced) {
  const auto a = make_rc<object<TypeParam>>(5);
  const auto b = a;
  const object<TypeParam> copy = *a;
  EXPECT_EQ(copy.value, 5);
  EXPECT_EQ(copy.state().bits, 0u);
  EXPECT_EQ(a->use_count(), 2u);
}

TYPED_TEST(RcObject, AMovedObjectStartsUnreferenced) {
  const auto a = make_rc<object<TypeParam>>(5);
  const object<TypeParam> moved = std::move(*a);
  EXPECT_EQ(moved.state().bits, 0u);
  EXPECT_EQ(a->use_count(), 1u);
}

TYPED_TEST(RcObject, AssignmentLeavesCountsAlone) {
  const auto a = make_rc<object<TypeParam>>(1);
  const auto b = make_rc<object<TypeParam>>(2);
  const auto c = b;
  const auto before_a = a->state();
  const auto before_b = b->state();
  *a = *b;
  EXPECT_EQ(a->value, 2);
  *b = std::move(*a);
  EXPECT_EQ(a->state().bits, before_a.bits);
  EXPECT_EQ(b->state().bits, before_b.bits);
}

TYPED_TEST(RcObject, AnOverflowedCountKeepsTheObjectForEver) {
  auto* const o = new object<TypeParam>;
  intrusive_rc<object<TypeParam>> held(o);
  auto& state = slamgc::detail::access::header_of(*o).state;
  support::set_word<TypeParam>(state, std::uint64_t{slamgc::state_word::sticky_count} << 2);
  for (int i = 0; i != 100; ++i) const intrusive_rc<object<TypeParam>> another(o);
  for (int i = 0; i != 100; ++i) intrusive_ptr_release(o);
  held.reset();
  EXPECT_TRUE(o->state().is_saturated());
  EXPECT_EQ(object<TypeParam>::live(), 1);
  support::set_word<TypeParam>(state, 0);  // so that the test leaks nothing
  delete o;
}

TYPED_TEST(RcObject, HooksOfBoostIntrusivePtrCount) {
  auto* const o = new object<TypeParam>;
  intrusive_ptr_add_ref(o);
  EXPECT_EQ(o->use_count(), 1u);
  intrusive_ptr_add_ref(static_cast<const object<TypeParam>*>(o));
  EXPECT_EQ(o->use_count(), 2u);
  intrusive_ptr_release(static_cast<const object<TypeParam>*>(o));
  EXPECT_EQ(object<TypeParam>::live(), 1);
  intrusive_ptr_release(o);
  EXPECT_EQ(object<TypeParam>::live(), 0);
}

// The base class need not come first.
struct interface {
  virtual ~interface() = default;
  long payload = 7;
};
struct late_base : interface, slamgc::rc_object<late_base>, support::instances<late_base> {};
struct derived_late : late_base {
  derived_late() { ++live_derived; }
  derived_late(const derived_late&) = delete;
  derived_late& operator=(const derived_late&) = delete;
  ~derived_late() override { --live_derived; }
  static inline int live_derived = 0;
};

TEST(RcObjectInheritance, TheBaseNeedNotComeFirst) {
  auto p = make_rc<late_base>();
  EXPECT_NE(static_cast<void*>(p.get()),
            static_cast<void*>(static_cast<slamgc::rc_object<late_base>*>(p.get())));
  const auto q = p;
  EXPECT_EQ(p->use_count(), 2u);
  EXPECT_EQ(p->payload, 7);
}

TEST(RcObjectInheritance, ADerivedObjectIsDestroyedAsAWhole) {
  intrusive_rc<derived_late> p = make_rc<derived_late>();
  intrusive_rc<late_base> base = p;
  p.reset();
  EXPECT_EQ(base->use_count(), 1u);
  EXPECT_EQ(derived_late::live_derived, 1);
  base.reset();
  EXPECT_EQ(derived_late::live_derived, 0);
  EXPECT_EQ(late_base::live(), 0);
}

TEST(RcObjectInheritance, HooksOfBoostIntrusivePtrTakeDerivedObjects) {
  auto* const p = new derived_late;
  intrusive_ptr_add_ref(p);
  EXPECT_EQ(p->use_count(), 1u);
  intrusive_ptr_release(p);
  EXPECT_EQ(late_base::live(), 0);
}

}  // namespace
