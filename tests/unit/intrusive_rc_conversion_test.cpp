// The counted pointer: bases, const, casts, and the way back to raw pointers.
#include <slamgc/intrusive_rc.hpp>

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <type_traits>
#include <utility>

#include "support/instances.hpp"

namespace {

// Opted in while it is only declared.
class keyframe;
class derived_keyframe;

}  // namespace

template <>
inline constexpr bool slamgc::implicit_to_raw<keyframe> = true;
template <>
inline constexpr bool slamgc::implicit_to_raw<derived_keyframe> = true;

namespace {

using slamgc::const_pointer_cast;
using slamgc::dynamic_pointer_cast;
using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::static_pointer_cast;

struct base : slamgc::rc_object<base>, support::instances<base> {
  virtual ~base() = default;
  virtual std::string name() const { return "base"; }
};
struct derived : base {
  std::string name() const override { return "derived"; }
};
struct other : base {};
struct unrelated : slamgc::rc_object<unrelated> {};

class keyframe : public slamgc::rc_object<keyframe> {
 public:
  virtual ~keyframe() = default;
};
class derived_keyframe : public keyframe {};

template <class From, class To>
constexpr bool converts = std::is_convertible<From, To>::value;

static_assert(converts<intrusive_rc<derived>, intrusive_rc<base>>);
static_assert(converts<intrusive_rc<base>, intrusive_rc<const base>>);
static_assert(!converts<intrusive_rc<base>, intrusive_rc<derived>>);
static_assert(!converts<intrusive_rc<const base>, intrusive_rc<base>>);
static_assert(!converts<intrusive_rc<base>, intrusive_rc<unrelated>>);
static_assert(!std::is_assignable<intrusive_rc<unrelated>&, intrusive_rc<base>>::value);
static_assert(converts<base*, intrusive_rc<base>>, "existing code passes raw pointers");

static_assert(!converts<intrusive_rc<base>, base*>, "only where the type opted in");
static_assert(!converts<intrusive_rc<base>, const base*>);
static_assert(!converts<intrusive_rc<base>, void*>);
static_assert(converts<intrusive_rc<keyframe>, keyframe*>);
static_assert(converts<intrusive_rc<keyframe>, const keyframe*>);
static_assert(converts<intrusive_rc<const keyframe>, const keyframe*>);
static_assert(!converts<intrusive_rc<const keyframe>, keyframe*>);
static_assert(converts<intrusive_rc<derived_keyframe>, keyframe*>);
static_assert(!converts<intrusive_rc<keyframe>, derived_keyframe*>);
static_assert(!converts<intrusive_rc<keyframe>, base*>);
static_assert(!converts<intrusive_rc<keyframe>, int>);

class IntrusiveRcConversion : public ::testing::Test {
 protected:
  ~IntrusiveRcConversion() override { EXPECT_EQ(base::live(), 0); }
};

TEST_F(IntrusiveRcConversion, ToABaseByCopy) {
  const auto d = make_rc<derived>();
  const intrusive_rc<base> b = d;
  intrusive_rc<base> c;
  c = d;
  EXPECT_EQ(d->use_count(), 3u);
  EXPECT_EQ(b->name(), "derived");
  EXPECT_EQ(c, d);
}

TEST_F(IntrusiveRcConversion, ToABaseByMoveCountsNothing) {
  auto d = make_rc<derived>();
  const auto before = d->state();
  intrusive_rc<base> b = std::move(d);
  intrusive_rc<const base> c;
  c = std::move(b);
  EXPECT_EQ(c->state().bits, before.bits);
  EXPECT_EQ(d, nullptr);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(b, nullptr);  // NOLINT(bugprone-use-after-move)
}

TEST_F(IntrusiveRcConversion, ToConstKeepsTheObject) {
  intrusive_rc<const base> c;
  {
    const auto p = make_rc<base>();
    c = p;
    EXPECT_EQ(c->use_count(), 2u);
  }
  EXPECT_EQ(c->use_count(), 1u);
}

TEST_F(IntrusiveRcConversion, AssignmentFromABaseReleasesTheOldObject) {
  intrusive_rc<base> b = make_rc<base>();
  b = make_rc<derived>();
  EXPECT_EQ(base::live(), 1);
  EXPECT_EQ(b->name(), "derived");
  b = new derived;
  EXPECT_EQ(base::live(), 1);
}

TEST_F(IntrusiveRcConversion, CastsFromAnLvalueAddAReference) {
  const intrusive_rc<base> b = make_rc<derived>();
  const intrusive_rc<const base> c = b;
  const intrusive_rc<derived> s = static_pointer_cast<derived>(b);
  const intrusive_rc<derived> d = dynamic_pointer_cast<derived>(b);
  const intrusive_rc<base> m = const_pointer_cast<base>(c);
  EXPECT_EQ(b->use_count(), 5u);
  EXPECT_TRUE(s == b && d == b && m == b);
}

TEST_F(IntrusiveRcConversion, CastsFromAnRvalueTakeTheReferenceOver) {
  intrusive_rc<base> b = make_rc<derived>();
  const auto before = b->state();
  intrusive_rc<derived> d = static_pointer_cast<derived>(std::move(b));
  EXPECT_EQ(b, nullptr);  // NOLINT(bugprone-use-after-move)
  intrusive_rc<const base> c = std::move(d);
  intrusive_rc<base> m = const_pointer_cast<base>(std::move(c));
  EXPECT_EQ(c, nullptr);  // NOLINT(bugprone-use-after-move)
  d = dynamic_pointer_cast<derived>(std::move(m));
  EXPECT_EQ(m, nullptr);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(d->state().bits, before.bits);
}

TEST_F(IntrusiveRcConversion, AFailedDynamicCastLeavesTheReference) {
  intrusive_rc<base> b = make_rc<derived>();
  const auto before = b->state();
  EXPECT_EQ(dynamic_pointer_cast<other>(b), nullptr);
  EXPECT_EQ(dynamic_pointer_cast<other>(std::move(b)), nullptr);
  ASSERT_NE(b, nullptr);  // NOLINT(bugprone-use-after-move)
  EXPECT_EQ(b->state().bits, before.bits);
}

TEST_F(IntrusiveRcConversion, CastsOfNullAreNull) {
  intrusive_rc<base> null;
  EXPECT_EQ(static_pointer_cast<derived>(null), nullptr);
  EXPECT_EQ(dynamic_pointer_cast<derived>(null), nullptr);
  EXPECT_EQ(const_pointer_cast<const base>(null), nullptr);
  EXPECT_EQ(static_pointer_cast<derived>(std::move(null)), nullptr);
}

TEST_F(IntrusiveRcConversion, DerivedAndBasePointersCompare) {
  const auto d = make_rc<derived>();
  const intrusive_rc<base> b = d;
  base* const raw = d.get();
  const auto before = d->state();
  EXPECT_TRUE(d == b && b == d && d == raw && raw == d);
  EXPECT_FALSE(d < b || b < d || d < raw || raw < d);
  EXPECT_EQ(d->state().bits, before.bits);
}

// What code that knew only raw pointers does with them.
keyframe* raw_of(keyframe* p) { return p; }
const keyframe* const_raw_of(const keyframe* p) { return p; }

TEST(ImplicitToRaw, ExistingFunctionsTakeTheCountedPointer) {
  const auto p = make_rc<keyframe>();
  const auto d = make_rc<derived_keyframe>();
  EXPECT_EQ(raw_of(p), p.get());
  EXPECT_EQ(const_raw_of(p), p.get());
  EXPECT_EQ(raw_of(d), d.get());
  keyframe* const local = p;
  EXPECT_EQ(local, p);
  std::set<keyframe*> set;
  set.insert(p);
  EXPECT_EQ(set.count(p), 1u);
  EXPECT_EQ(p->use_count(), 1u);
}

TEST(ImplicitToRaw, ComparisonsStayUnambiguous) {
  const auto p = make_rc<keyframe>();
  const auto d = make_rc<derived_keyframe>();
  keyframe* const raw = p;
  EXPECT_TRUE(p == raw && raw == p && p != NULL && NULL != p && p != nullptr && p != d);
  EXPECT_FALSE(p < raw || raw < p || p == 0);
  EXPECT_TRUE(p);
  EXPECT_FALSE(!p);
}

TEST(ImplicitToRaw, AssignmentsStayUnambiguous) {
  intrusive_rc<keyframe> p = make_rc<derived_keyframe>();
  const auto d = make_rc<derived_keyframe>();
  p = d;
  EXPECT_EQ(d->use_count(), 2u);
  const intrusive_rc<keyframe> q(d);
  EXPECT_EQ(d->use_count(), 3u);
  p = nullptr;
  EXPECT_EQ(d->use_count(), 2u);
}

}  // namespace
