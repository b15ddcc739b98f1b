// Two edit scopes of one container at a time are reported, and counts stay exact all the same.
#include <cstring>

namespace {
int reports = 0;
const char* reported = "";
}  // namespace

// This file is a program that brings its own check: the checked flavour, whatever the build is.
#define SLAMGC_ASSERT(condition, found) \
  ((condition) ? void() : static_cast<void>((++reports, reported = (found).what)))

#include "support.hpp"

namespace {

template <class C>
class EditMisuse : public testing::Test {
 protected:
  void SetUp() override { reports = 0; }
  std::vector<node_ptr> nodes = make_nodes(4);
  C c = filled<C>({nodes[0], nodes[1]});
};
TYPED_TEST_SUITE(EditMisuse, all_containers, container_name);

TYPED_TEST(EditMisuse, ASecondScopeIsReportedAndTheFirstCounts) {
  {
    const auto outer = this->c.edit();
    outer->insert(outer->end(), element<TypeParam>(this->nodes[2]));
    EXPECT_EQ(reports, 0);
    {
      const auto inner = this->c.edit();
      EXPECT_EQ(reports, 1);
      EXPECT_STREQ(reported, "edits a container that is being edited");
      inner->erase(inner->begin());
      inner->insert(inner->end(), element<TypeParam>(this->nodes[3]));
    }
    outer->erase(outer->begin());
  }
  EXPECT_EQ(reports, 1);
  EXPECT_EQ(this->c.size(), 2u);
  EXPECT_TRUE(counts_are_exact(1, this->c));
}

TYPED_TEST(EditMisuse, NestedScopesOfDifferentContainersAreFine) {
  TypeParam other = this->c, third;
  {
    const auto a = this->c.edit();
    const auto b = other.edit();
    a->swap(*b);
    { const auto inner = third.edit(); }
  }
  { const auto again = this->c.edit(); }
  EXPECT_EQ(reports, 0);
  EXPECT_TRUE(counts_are_exact(1, this->c, other));
}

// An iterator of a list can write an element: uncounted, so it is a misuse. It is found at the latest
// when the list lets the reference go that nobody counted.
TEST(ListMisuse, AWriteThroughAnIteratorIsFoundWhenTheElementGoes) {
  reports = 0;
  const std::vector<node_ptr> nodes = make_nodes(1);
  auto* const uncounted = new node(7);
  slamgc::rc_list<node> l = filled<slamgc::rc_list<node>>(nodes);
  *l.begin() = uncounted;
  EXPECT_EQ(reports, 0);
  l.pop_front();
  EXPECT_EQ(reports, 1);
  EXPECT_STREQ(reported, "removes a reference that was never counted");
  delete uncounted;
  EXPECT_EQ(nodes[0]->use_count(), 2u);
  *l.insert(l.begin(), nullptr) = nodes[0].get();
  l.clear();
  EXPECT_TRUE(counts_are_exact(1, l));
}

}  // namespace
