// The counted pointer: counts, moves, comparisons, hashes.
#include <slamgc/intrusive_rc.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <sstream>
#include <type_traits>
#include <unordered_set>
#include <utility>
#include <vector>

#include "support/instances.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;

struct node : slamgc::rc_object<node>, support::instances<node> {
  explicit node(int v = 0) : value(v) {}
  int value;
  intrusive_rc<node> next;
};

using rc = intrusive_rc<node>;

// Looks, while it is destroyed, at the pointer that held it.
struct observer : slamgc::rc_object<observer> {
  explicit observer(intrusive_rc<observer>& place) : place_(place) {}
  observer(const observer&) = delete;
  observer& operator=(const observer&) = delete;
  ~observer() { seen = place_.get(); }
  intrusive_rc<observer>& place_;
  static inline observer* seen = nullptr;
};

static_assert(sizeof(rc) == sizeof(node*));
static_assert(alignof(rc) == alignof(node*));
static_assert(std::is_nothrow_default_constructible<rc>::value);
static_assert(std::is_nothrow_copy_constructible<rc>::value);
static_assert(std::is_nothrow_move_constructible<rc>::value);
static_assert(std::is_nothrow_copy_assignable<rc>::value);
static_assert(std::is_nothrow_move_assignable<rc>::value);
static_assert(std::is_nothrow_swappable<rc>::value);
static_assert(std::is_same<rc::element_type, node>::value);
static_assert(!std::is_convertible<rc, bool>::value, "only explicitly");

// Null at compile time: no initialisation at run time, so static objects may use it at any time.
#if defined(__clang__)
[[clang::require_constant_initialization]]
#endif
rc null_from_the_start;

// What a test leaves behind.
class IntrusiveRc : public ::testing::Test {
 protected:
  ~IntrusiveRc() override { EXPECT_EQ(node::live(), 0); }
};

TEST_F(IntrusiveRc, NullHoldsNothing) {
  const rc p;
  const rc q(nullptr);
  const rc r(NULL);
  const rc s(0);
  const rc t = nullptr;
  const rc u = NULL;
  const rc v = {};
  const rc* const nulls[] = {&p, &q, &r, &s, &t, &u, &v, &null_from_the_start};
  for (const rc* null : nulls) {
    EXPECT_EQ(null->get(), nullptr);
    EXPECT_FALSE(*null);
    EXPECT_TRUE(!*null);
  }
}

TEST_F(IntrusiveRc, HoldsWhatItPointsTo) {
  auto* const raw = new node(5);
  {
    const rc p(raw);
    EXPECT_EQ(p.get(), raw);
    EXPECT_EQ(&*p, raw);
    EXPECT_EQ(p->value, 5);
    EXPECT_TRUE(p);
    EXPECT_EQ(get_pointer(p), raw);
    EXPECT_EQ(raw->use_count(), 1u);
  }
  EXPECT_EQ(node::live(), 0);
}

TEST_F(IntrusiveRc, ACopyIsAnotherReference) {
  const rc p = make_rc<node>();
  {
    const rc q = p;  // NOLINT(performance-unnecessary-copy-initialization)
    EXPECT_EQ(p->use_count(), 2u);
    EXPECT_EQ(q, p);
  }
  EXPECT_EQ(p->use_count(), 1u);
}

TEST_F(IntrusiveRc, AMoveCountsNothing) {
  rc p = make_rc<node>();
  const auto before = p->state();
  rc q = std::move(p);
  rc r;
  r = std::move(q);
  EXPECT_EQ(r->state().bits, before.bits);
  EXPECT_EQ(p, nullptr);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(q, nullptr);  // NOLINT(bugprone-use-after-move)
}

TEST_F(IntrusiveRc, AssignmentReleasesTheOldObject) {
  rc p = make_rc<node>(1);
  rc q = make_rc<node>(2);
  p = q;
  EXPECT_EQ(node::live(), 1);
  EXPECT_EQ(q->use_count(), 2u);
  p = new node(3);
  EXPECT_EQ(node::live(), 2);
  p = std::move(q);
  EXPECT_EQ(node::live(), 1);
  EXPECT_EQ(p->value, 2);
  p = nullptr;
  EXPECT_EQ(node::live(), 0);
}

TEST_F(IntrusiveRc, NullPointerConstantsCanBeAssigned) {
  for (int i = 0; i != 4; ++i) {
    rc p = make_rc<node>();
    if (i == 0) p = nullptr;
    if (i == 1) p = NULL;
    if (i == 2) p = 0;
    if (i == 3) p = {};
    EXPECT_EQ(node::live(), 0);
  }
}

TEST_F(IntrusiveRc, SelfAssignmentChangesNothing) {
  rc p = make_rc<node>();
  rc& same = p;
  p = same;
  EXPECT_EQ(p->use_count(), 1u);
  p = std::move(same);
  ASSERT_TRUE(p);
  EXPECT_EQ(p->use_count(), 1u);
  p = p.get();
  EXPECT_EQ(p->use_count(), 1u);
  p.swap(same);
  EXPECT_EQ(p->use_count(), 1u);
}

// `p = p->next` releases the object that holds the right side.
TEST_F(IntrusiveRc, MayBeAssignedFromItsOwnObject) {
  rc p = make_rc<node>(1);
  p->next = make_rc<node>(2);
  p->next->next = make_rc<node>(3);
  p = p->next;
  EXPECT_EQ(p->value, 2);
  EXPECT_EQ(p->use_count(), 1u);
  p = std::move(p->next);
  EXPECT_EQ(p->value, 3);
  EXPECT_EQ(node::live(), 1);
}

TEST_F(IntrusiveRc, SwapCountsNothing) {
  rc p = make_rc<node>(1);
  rc q = make_rc<node>(2);
  const auto before_p = p->state();
  const auto before_q = q->state();
  p.swap(q);
  EXPECT_EQ(p->value, 2);
  swap(p, q);
  EXPECT_EQ(p->value, 1);
  std::swap(p, q);
  EXPECT_EQ(q->state().bits, before_p.bits);
  EXPECT_EQ(p->state().bits, before_q.bits);
}

TEST_F(IntrusiveRc, DetachAndAdoptHandTheReferenceOver) {
  rc p = make_rc<node>();
  const auto before = p->state();
  node* const raw = p.detach();
  EXPECT_EQ(p, nullptr);
  EXPECT_EQ(raw->state().bits, before.bits);
  rc q = rc::adopt(raw);
  EXPECT_EQ(raw->state().bits, before.bits);
  const rc r(q.detach(), false);
  EXPECT_EQ(raw->state().bits, before.bits);
  EXPECT_EQ(r.get(), raw);
}

TEST_F(IntrusiveRc, ResetReleasesAndRefersAnew) {
  rc p = make_rc<node>(1);
  p.reset();
  EXPECT_EQ(node::live(), 0);
  p.reset(new node(2));
  EXPECT_EQ(p->use_count(), 1u);
  p.reset(p.get());
  EXPECT_EQ(p->use_count(), 1u);
  node* const raw = make_rc<node>(3).detach();
  p.reset(raw, false);
  EXPECT_EQ(p->use_count(), 1u);
  EXPECT_EQ(node::live(), 1);
  p.reset(raw, true);
  EXPECT_EQ(p->use_count(), 1u);
  p.reset(NULL);
  EXPECT_EQ(node::live(), 0);
}

TEST_F(IntrusiveRc, ShowsTheNewObjectBeforeTheOldOneIsDestroyed) {
  intrusive_rc<observer> place;
  place = make_rc<observer>(place);
  auto* const second = new observer(place);
  place = second;
  EXPECT_EQ(observer::seen, second);
  place.reset();
  EXPECT_EQ(observer::seen, nullptr);
}

TEST_F(IntrusiveRc, ComparesByAddressWithoutCounting) {
  const rc p = make_rc<node>();
  const rc q = make_rc<node>();
  node* const raw = p.get();
  const node* const const_raw = p.get();
  const intrusive_rc<const node> const_p = p;
  const auto before = p->state();
  EXPECT_TRUE(p == p);
  EXPECT_FALSE(p == q);
  EXPECT_TRUE(p != q);
  EXPECT_FALSE(p != p);
  EXPECT_TRUE(p == raw && raw == p && p == const_raw && const_raw == p);
  EXPECT_FALSE(p != raw || raw != p || p != const_raw || const_raw != p);
  EXPECT_TRUE(q != raw && raw != q);
  EXPECT_FALSE(q == raw || raw == q);
  EXPECT_TRUE(const_p == p && p == const_p && const_p == raw && raw == const_p);
  EXPECT_EQ(p < q, std::less<>()(p.get(), q.get()));
  EXPECT_EQ(q < p, std::less<>()(q.get(), p.get()));
  EXPECT_EQ(p < q.get(), p < q);
  EXPECT_EQ(p.get() < q, p < q);
  EXPECT_FALSE(p < p || p < raw || raw < p || p < const_raw || const_p < p);
  EXPECT_EQ(p->state().bits, before.bits);
}

TEST_F(IntrusiveRc, ComparesWithEveryNull) {
  const rc null;
  const rc p = make_rc<node>();
  EXPECT_TRUE(null == nullptr && nullptr == null && null == NULL && NULL == null && null == 0);
  EXPECT_FALSE(null != nullptr || nullptr != null || null != NULL || NULL != null || null != 0);
  EXPECT_TRUE(p != nullptr && nullptr != p && p != NULL && NULL != p && p != 0);
  EXPECT_FALSE(p == nullptr || nullptr == p || p == NULL || NULL == p || p == 0);
}

TEST_F(IntrusiveRc, HashesAsTheRawPointer) {
  const rc p = make_rc<node>();
  EXPECT_EQ(std::hash<rc>()(p), std::hash<node*>()(p.get()));
  EXPECT_EQ(hash_value(p), std::hash<node*>()(p.get()));
  EXPECT_EQ(std::hash<rc>()(rc()), std::hash<node*>()(nullptr));
}

TEST_F(IntrusiveRc, LivesInContainers) {
  std::unordered_set<rc> set;
  std::vector<rc> vector;
  for (int i = 0; i != 100; ++i) {
    vector.push_back(make_rc<node>(i));
    set.insert(vector.back());
  }
  EXPECT_EQ(node::live(), 100);
  for (const rc& p : vector) {
    EXPECT_EQ(set.count(p), 1u);
    EXPECT_EQ(p->use_count(), 2u);
  }
  vector.clear();
  EXPECT_EQ(node::live(), 100);
  set.clear();
  EXPECT_EQ(node::live(), 0);
}

TEST_F(IntrusiveRc, PrintsTheAddress) {
  const rc p = make_rc<node>();
  std::ostringstream expected;
  expected << p.get();
  std::ostringstream printed;
  printed << p;
  EXPECT_EQ(printed.str(), expected.str());
  std::wostringstream wide;
  wide << p;
  EXPECT_FALSE(wide.str().empty());
}

}  // namespace
