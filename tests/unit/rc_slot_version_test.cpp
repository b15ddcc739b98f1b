// Moving a reference from one slot to another changes the version: a walk over the graph could else
// see the reference twice, or not at all, and not notice.
#include <slamgc/rc_slot.hpp>

#include <gtest/gtest.h>

#include <optional>
#include <utility>

#include "support/policies.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::rc_slot;
using slamgc::state_word;

template <class Policy>
struct object : slamgc::rc_object<object<Policy>, Policy> {};

template <class Policy>
class RcSlotVersion : public ::testing::Test {
 protected:
  using slot = rc_slot<object<Policy>>;
  using rc = intrusive_rc<object<Policy>>;

  RcSlotVersion() : object_(make_rc<object<Policy>>()) {}

  // Whether @p change moved references of the object, whose number stayed.
  template <class Change>
  ::testing::AssertionResult moves(Change change) {
    const state_word before = object_->state();
    change();
    const state_word after = object_->state();
    if (after.count() != before.count())
      return ::testing::AssertionFailure()
             << before.count() << " references, then " << after.count();
    if (after.same_references(before))
      return ::testing::AssertionFailure() << "the version stayed " << before.version();
    return ::testing::AssertionSuccess();
  }

  rc object_;
};
TYPED_TEST_SUITE(RcSlotVersion, support::all_policies, support::policy_names);

TYPED_TEST(RcSlotVersion, MoveConstructionChangesIt) {
  rc_slot<object<TypeParam>> a(this->object_);
  std::optional<rc_slot<object<TypeParam>>> b;
  EXPECT_TRUE(this->moves([&] { b.emplace(std::move(a)); }));
}

TYPED_TEST(RcSlotVersion, MoveAssignmentChangesIt) {
  rc_slot<object<TypeParam>> a(this->object_);
  rc_slot<object<TypeParam>> b;
  EXPECT_TRUE(this->moves([&] { b = std::move(a); }));
}

TYPED_TEST(RcSlotVersion, SwapChangesIt) {
  rc_slot<object<TypeParam>> a(this->object_);
  rc_slot<object<TypeParam>> b;
  EXPECT_TRUE(this->moves([&] { a.swap(b); }));
  EXPECT_TRUE(this->moves([&] { a.swap(b); }));
  EXPECT_TRUE(this->moves([&] { swap(a, b); }));
}

TYPED_TEST(RcSlotVersion, SwapChangesBothObjects) {
  rc_slot<object<TypeParam>> a(this->object_);
  const auto other = make_rc<object<TypeParam>>();
  rc_slot<object<TypeParam>> b(other);
  const state_word before = other->state();
  EXPECT_TRUE(this->moves([&] { a.swap(b); }));
  EXPECT_EQ(other->use_count(), before.count());
  EXPECT_FALSE(other->state().same_references(before));
}

TYPED_TEST(RcSlotVersion, ExchangeChangesIt) {
  rc_slot<object<TypeParam>> a(this->object_);
  intrusive_rc<object<TypeParam>> out;
  EXPECT_TRUE(this->moves([&] { out = a.exchange(nullptr); }));
}

TYPED_TEST(RcSlotVersion, MovingInFromACountedPointerChangesIt) {
  intrusive_rc<object<TypeParam>> p = this->object_;
  rc_slot<object<TypeParam>> a;
  EXPECT_TRUE(this->moves([&] { a = std::move(p); }));
  p = this->object_;
  std::optional<rc_slot<object<TypeParam>>> b;
  EXPECT_TRUE(this->moves([&] { b.emplace(std::move(p)); }));
}

TYPED_TEST(RcSlotVersion, AdoptingIntoASlotChangesIt) {
  auto* const raw = intrusive_rc<object<TypeParam>>(this->object_).detach();
  rc_slot<object<TypeParam>> a;
  EXPECT_TRUE(this->moves([&] { a = intrusive_rc<object<TypeParam>>::adopt(raw); }));
}

TYPED_TEST(RcSlotVersion, CopyFollowedByRemovalChangesIt) {
  rc_slot<object<TypeParam>> a(this->object_);
  rc_slot<object<TypeParam>> b;
  EXPECT_TRUE(this->moves([&] {
    b = a;
    a = nullptr;
  }));
}

TYPED_TEST(RcSlotVersion, ReadingLeavesIt) {
  const rc_slot<object<TypeParam>> a(this->object_);
  const state_word before = this->object_->state();
  EXPECT_TRUE(a == this->object_.get() && a.get() != nullptr);
  EXPECT_EQ(this->object_->state().bits, before.bits);
}

}  // namespace
