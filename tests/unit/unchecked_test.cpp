// The unchecked flavour: misuse is not reported, and does not corrupt what is next to the count.
#undef SLAMGC_DEBUG
#define SLAMGC_DEBUG 0

#include <gtest/gtest.h>
#include <slamgc/slamgc.hpp>

#include <cstdint>
#include <type_traits>

#include "support/instances.hpp"
#include "support/policies.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;

static_assert(std::is_same<slamgc::misuse, slamgc::unchecked::misuse>::value);

template <class Policy>
struct node : slamgc::rc_object<node<Policy>, Policy>, support::instances<node<Policy>> {
  slamgc::rc_slot<node> next;
};

template <class Policy>
class Unchecked : public ::testing::Test {
 protected:
  ~Unchecked() override { EXPECT_EQ(node<Policy>::live(), 0); }

  static void set_word(const node<Policy>& o, std::uint64_t word) {
    support::set_word<Policy>(slamgc::detail::access::header_of(o).state, word);
  }
};
TYPED_TEST_SUITE(Unchecked, support::all_policies, support::policy_names);

TYPED_TEST(Unchecked, ADropWithoutAReferenceLeavesTheWord) {
  const node<TypeParam> o;
  for (std::uint64_t flags = 0; flags != 4; ++flags) {
    const std::uint64_t word = flags + 5 * slamgc::state_word::version_unit;
    this->set_word(o, word);
    intrusive_ptr_release(&o);
    EXPECT_EQ(o.state().bits, word);
  }
}

TYPED_TEST(Unchecked, AnAdoptedReferenceThatNobodyCountedLeavesTheWord) {
  node<TypeParam> o;
  for (std::uint64_t flags = 0; flags != 4; ++flags) {
    this->set_word(o, flags);
    intrusive_rc<node<TypeParam>>::adopt(&o).reset();
    EXPECT_EQ(o.state().bits, flags);
  }
}

TYPED_TEST(Unchecked, AReferencedObjectMayBeDestroyed) {
  const node<TypeParam> o;
  intrusive_ptr_add_ref(&o);
  EXPECT_EQ(o.use_count(), 1u);
}

TYPED_TEST(Unchecked, WorksLikeTheCheckedFlavour) {
  auto p = make_rc<node<TypeParam>>();
  p->next = new node<TypeParam>;
  p->next->next = p.get();
  EXPECT_EQ(p->use_count(), 2u);
  p->next->next = nullptr;
  p.reset();
  EXPECT_EQ(node<TypeParam>::live(), 0);
}

}  // namespace
