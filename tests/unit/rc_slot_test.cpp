// The counted member: counts, versions, and use as the raw member that it replaces.
#include <slamgc/rc_slot.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/instances.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::rc_slot;

struct node : slamgc::rc_object<node>, support::instances<node> {
  explicit node(int v = 0) : value(v) {}
  virtual ~node() = default;
  int value;
  rc_slot<node> next;
};
struct derived : node {};

using slot = rc_slot<node>;

static_assert(sizeof(slot) == sizeof(node*));
static_assert(alignof(slot) == alignof(node*));
static_assert(std::is_nothrow_default_constructible<slot>::value);
static_assert(std::is_nothrow_copy_constructible<slot>::value);
static_assert(std::is_nothrow_move_constructible<slot>::value);
static_assert(std::is_nothrow_swappable<slot>::value);
static_assert(std::is_same<slot::element_type, node>::value);
static_assert(!std::is_convertible<node*, slot>::value,
              "`condition ? slot : raw` is a raw pointer");
static_assert(!std::is_assignable<slot&, int*>::value);

#if defined(__clang__)
[[clang::require_constant_initialization]]
#endif
slot null_from_the_start;

class RcSlot : public ::testing::Test {
 protected:
  ~RcSlot() override { EXPECT_EQ(node::live(), 0); }
};

TEST_F(RcSlot, NullHoldsNothing) {
  const slot a;
  const slot b(nullptr);
  const slot c(NULL);
  const slot d(0);
  const slot e = nullptr;
  const slot f = {};
  for (const slot* null : {&a, &b, &c, &d, &e, &f, const_cast<const slot*>(&null_from_the_start)})
    EXPECT_EQ(null->get(), nullptr);
}

TEST_F(RcSlot, CountsWhatItRefersTo) {
  const auto p = make_rc<node>();
  {
    const slot s(p.get());
    EXPECT_EQ(p->use_count(), 2u);
    const slot copy = s;  // NOLINT(performance-unnecessary-copy-initialization)
    EXPECT_EQ(p->use_count(), 3u);
    const slot from_rc(p);
    EXPECT_EQ(p->use_count(), 4u);
    EXPECT_EQ(from_rc.get(), p.get());
  }
  EXPECT_EQ(p->use_count(), 1u);
}

TEST_F(RcSlot, AssignmentReleasesTheOldObject) {
  slot s(new node(1));
  s = new node(2);
  EXPECT_EQ(node::live(), 1);
  EXPECT_EQ(s->value, 2);
  const auto third = make_rc<node>(3);
  s = third;
  EXPECT_EQ(node::live(), 1);
  EXPECT_EQ(third->use_count(), 2u);
  const slot other(new node(4));
  s = other;
  EXPECT_EQ(third->use_count(), 1u);
  EXPECT_EQ(other->use_count(), 2u);
  s.reset();
  EXPECT_EQ(other->use_count(), 1u);
}

TEST_F(RcSlot, NullPointerConstantsCanBeAssigned) {
  for (int i = 0; i != 5; ++i) {
    slot s(new node);
    if (i == 0) s = nullptr;
    if (i == 1) s = NULL;
    if (i == 2) s = 0;
    if (i == 3) s = {};
    if (i == 4) s = static_cast<node*>(NULL);
    EXPECT_EQ(s.get(), nullptr);
    EXPECT_EQ(node::live(), 0);
  }
}

TEST_F(RcSlot, TakesReferencesToDerivedObjects) {
  const auto d = make_rc<derived>();
  rc_slot<derived> derived_slot(d);
  slot s(d);
  s = derived_slot;
  s = d;
  s = d.get();
  EXPECT_EQ(d->use_count(), 3u);
  intrusive_rc<derived> moved = d;
  s = std::move(moved);
  EXPECT_EQ(d->use_count(), 3u);
  EXPECT_EQ(moved, nullptr);  // NOLINT(bugprone-use-after-move)
  rc_slot<const node> constant(d);
  EXPECT_EQ(constant.get(), d.get());
}

TEST_F(RcSlot, SelfAssignmentChangesNothing) {
  slot s(new node);
  slot& same = s;
  s = same;
  s = s.get();
  s = std::move(same);
  ASSERT_NE(s.get(), nullptr);
  swap(s, same);
  s.swap(s);
  EXPECT_EQ(s->use_count(), 1u);
}

TEST_F(RcSlot, MovesKeepTheCount) {
  auto p = make_rc<node>();
  node* const raw = p.get();
  slot s(std::move(p));
  EXPECT_EQ(p, nullptr);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(raw->use_count(), 1u);
  slot t(std::move(s));
  EXPECT_EQ(s.get(), nullptr);  // NOLINT(bugprone-use-after-move)
  s = std::move(t);
  EXPECT_EQ(t.get(), nullptr);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(s.get(), raw);
  intrusive_rc<node> q = s.exchange(nullptr);
  EXPECT_EQ(q.get(), raw);
  EXPECT_EQ(s.get(), nullptr);
  s = std::move(q);
  EXPECT_EQ(q, nullptr);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(raw->use_count(), 1u);
}

// For all policies and one by one: rc_slot_version_test.cpp.
TEST_F(RcSlot, MoveChangesVersion) {
  slot a(new node);
  node* const raw = a;
  slot b;
  std::uint32_t version = raw->state().version();
  const auto changed = [&] { return std::exchange(version, raw->state().version()) != version; };
  b = std::move(a);
  EXPECT_TRUE(changed());
  a.swap(b);
  EXPECT_TRUE(changed());
  intrusive_rc<node> out = a.exchange(nullptr);
  EXPECT_TRUE(changed());
  b = intrusive_rc<node>::adopt(out.detach());
  EXPECT_TRUE(changed());
  EXPECT_EQ(raw->use_count(), 1u);
}

TEST_F(RcSlot, ExchangeGivesTheOldReferenceToTheCaller) {
  slot s(new node(1));
  {
    const intrusive_rc<node> old = s.exchange(new node(2));
    EXPECT_EQ(old->value, 1);
    EXPECT_EQ(old->use_count(), 1u);
    EXPECT_EQ(node::live(), 2);
  }
  EXPECT_EQ(node::live(), 1);
  EXPECT_EQ(s->value, 2);
}

TEST_F(RcSlot, SwapExchangesTheReferences) {
  slot a(new node(1));
  slot b(new node(2));
  slot null;
  a.swap(b);
  EXPECT_EQ(a->value, 2);
  swap(a, b);
  EXPECT_EQ(a->value, 1);
  std::swap(a, b);
  EXPECT_EQ(a->value, 2);
  a.swap(null);
  EXPECT_EQ(a.get(), nullptr);
  null.swap(a);
  EXPECT_EQ(a->use_count(), 1u);
  EXPECT_EQ(b->use_count(), 1u);
}

TEST_F(RcSlot, ShowsTheNewObjectBeforeTheOldOneIsDestroyed) {
  struct observer : slamgc::rc_object<observer> {
    observer(rc_slot<observer>& place, observer*& seen) : place_(place), seen_(seen) {}
    observer(const observer&) = delete;
    observer& operator=(const observer&) = delete;
    ~observer() { seen_ = place_; }
    rc_slot<observer>& place_;
    observer*& seen_;
  };
  observer* seen = nullptr;
  rc_slot<observer> place;
  auto* const second = new observer(place, seen);
  place = new observer(place, seen);
  place = second;
  EXPECT_EQ(seen, second);
  place = make_rc<observer>(place, seen);
  EXPECT_EQ(seen, place.get());
  {
    rc_slot<observer> other;
    other = new observer(place, seen);
    place = std::move(other);
    EXPECT_EQ(seen, place.get());
  }
  place.reset();
  EXPECT_EQ(seen, nullptr);
}

// `s = s->next` releases the object that holds the right side.
TEST_F(RcSlot, MayBeAssignedFromItsOwnObject) {
  slot s(new node(1));
  s->next = new node(2);
  s->next->next = new node(3);
  s = s->next;
  EXPECT_EQ(s->value, 2);
  s = std::move(s->next);
  EXPECT_EQ(s->value, 3);
  EXPECT_EQ(node::live(), 1);
}

// The code around what was `node* member`.
int value_of(node* p) { return p->value; }
int value_of_const(const node* p) { return p->value; }

TEST_F(RcSlot, IsUsedLikeTheRawMember) {
  const auto owner = make_rc<node>(1);
  owner->next = new node(2);
  slot& member = owner->next;
  node* const raw = member;
  const auto before = raw->state();

  EXPECT_TRUE(member);
  EXPECT_FALSE(!member);
  EXPECT_TRUE(member == raw && raw == member && member == member);
  EXPECT_TRUE(member != NULL && NULL != member && member != nullptr && member != 0);
  EXPECT_FALSE(member == NULL || NULL == member || member == nullptr || member != raw);
  EXPECT_FALSE(member < raw || member > raw);
  EXPECT_EQ(member->value + (*member).value + value_of(member) + value_of_const(member), 8);

  const bool yes = member != NULL;
  node* const chosen = yes ? member : raw;
  node* const chosen_too = !yes ? owner.get() : member;
  node* const chosen_null = yes ? member : static_cast<node*>(NULL);
  EXPECT_TRUE(chosen == raw && chosen_too == raw && chosen_null == raw);

  std::set<node*> set;
  set.insert(member);
  std::vector<node*> vector(1, member);
  vector.push_back(member);
  std::map<node*, int> map;
  map[member] = 1;
  map.insert(std::make_pair(raw, 2));
  EXPECT_TRUE(set.count(member) == 1 && map.count(member) == 1 && set.find(member) != set.end());
  EXPECT_EQ(std::count(vector.begin(), vector.end(), member), 2);
  EXPECT_EQ(static_cast<void*>(member), raw);
  EXPECT_EQ(dynamic_cast<derived*>(member.get()), nullptr);
  for (node* p = owner.get(); p; p = p->next) EXPECT_GT(p->value, 0);

  EXPECT_EQ(raw->state().bits, before.bits) << "reading counted something";
}

}  // namespace
