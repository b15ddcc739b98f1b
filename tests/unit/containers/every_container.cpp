// What holds for each of the seven containers: counts after every way to fill, copy, move and empty.
#include "support.hpp"

namespace {

template <class C>
class EveryContainer : public testing::Test {
 protected:
  std::vector<node_ptr> nodes = make_nodes(4);
};
TYPED_TEST_SUITE(EveryContainer, all_containers, container_name);

TYPED_TEST(EveryContainer, IsEmptyAtFirst) {
  const TypeParam c;
  EXPECT_TRUE(c.empty());
  EXPECT_EQ(c.size(), 0u);
  EXPECT_TRUE(c.begin() == c.end());
  EXPECT_TRUE(c.cbegin() == c.cend());
  EXPECT_GT(c.max_size(), 0u);
}

TYPED_TEST(EveryContainer, CountsWhatIsInserted) {
  const TypeParam c = filled<TypeParam>(this->nodes);
  EXPECT_EQ(c.size(), 4u);
  EXPECT_TRUE(counts_are_exact(1, c));
}

TYPED_TEST(EveryContainer, EraseUncountsOnce) {
  TypeParam c = filled<TypeParam>(this->nodes);
  node* const gone = pointer_in(*c.begin());
  c.erase(c.begin());
  EXPECT_EQ(gone->use_count(), 1u);
  EXPECT_TRUE(counts_are_exact(1, c));
}

TYPED_TEST(EveryContainer, EraseOfARangeUncountsItsElementsOnly) {
  TypeParam c = filled<TypeParam>(this->nodes);
  node* const first = pointer_in(*c.begin());
  const auto next = c.erase(std::next(c.begin()), c.end());
  EXPECT_TRUE(next == c.end());
  EXPECT_EQ(pointers_in(c), std::vector<node*>{first});
  EXPECT_TRUE(counts_are_exact(1, c));
  EXPECT_TRUE(c.erase(c.begin(), c.begin()) == c.begin());
  EXPECT_TRUE(counts_are_exact(1, c));
}

TYPED_TEST(EveryContainer, ClearUncountsEverything) {
  TypeParam c = filled<TypeParam>(this->nodes);
  c.clear();
  EXPECT_TRUE(c.empty());
  EXPECT_TRUE(counts_are_exact(1, c));
  c.clear();
  EXPECT_TRUE(counts_are_exact(1, c));
}

TYPED_TEST(EveryContainer, DestructionUncountsEverything) {
  { const TypeParam c = filled<TypeParam>(this->nodes); }
  EXPECT_TRUE(counts_are_exact(1));
}

TYPED_TEST(EveryContainer, IsDestroyedWithItsObjectsIfNobodyElseHoldsThem) {
  const std::size_t before = node::living().size();
  {
    const TypeParam c = filled<TypeParam>(make_nodes(3));
    EXPECT_EQ(node::living().size(), before + 3);
  }
  EXPECT_EQ(node::living().size(), before);
}

TYPED_TEST(EveryContainer, CopiesCountAnew) {
  const TypeParam c = filled<TypeParam>(this->nodes);
  TypeParam constructed(c);
  TypeParam assigned;
  assigned = c;
  EXPECT_TRUE(constructed == c);
  EXPECT_TRUE(assigned == c);
  EXPECT_TRUE(counts_are_exact(1, c, constructed, assigned));
  assigned = TypeParam();
  EXPECT_TRUE(counts_are_exact(1, c, constructed, assigned));
}

TYPED_TEST(EveryContainer, MovesKeepCountsAndLeaveTheSourceEmpty) {
  TypeParam c = filled<TypeParam>(this->nodes);
  TypeParam constructed(std::move(c));
  EXPECT_TRUE(c.empty());
  EXPECT_TRUE(counts_are_exact(1, constructed));
  TypeParam assigned = filled<TypeParam>(this->nodes);
  assigned = std::move(constructed);
  EXPECT_TRUE(constructed.empty());
  EXPECT_EQ(assigned.size(), 4u);
  EXPECT_TRUE(counts_are_exact(1, assigned));
}

TYPED_TEST(EveryContainer, SwapKeepsCounts) {
  TypeParam a = filled<TypeParam>(this->nodes);
  TypeParam b = filled<TypeParam>({this->nodes[0]});
  a.swap(b);
  EXPECT_EQ(a.size(), 1u);
  EXPECT_EQ(b.size(), 4u);
  EXPECT_TRUE(counts_are_exact(1, a, b));
  swap(a, b);
  EXPECT_EQ(a.size(), 4u);
  using std::swap;
  swap(a, b);
  EXPECT_EQ(b.size(), 4u);
  EXPECT_TRUE(counts_are_exact(1, a, b));
}

TYPED_TEST(EveryContainer, TakesAPlainContainer) {
  using std_type = typename TypeParam::std_type;
  const TypeParam source = filled<TypeParam>(this->nodes);
  const std_type plain(source);
  TypeParam copied(plain);
  TypeParam moved{std_type(plain)};
  TypeParam assigned, move_assigned;
  assigned = plain;
  move_assigned = std_type(plain);
  EXPECT_TRUE(copied == plain && moved == plain && assigned == plain && move_assigned == plain);
  EXPECT_TRUE(counts_are_exact(1, source, copied, moved, assigned, move_assigned));
  assigned = std_type();
  move_assigned = plain;
  EXPECT_TRUE(counts_are_exact(1, source, copied, moved, assigned, move_assigned));
}

TYPED_TEST(EveryContainer, TakesListsAndRanges) {
  auto e = [this](std::size_t i) { return element<TypeParam>(this->nodes[i]); };
  TypeParam listed{e(0), e(1)};
  const std::vector<typename assignable<typename TypeParam::value_type>::type> values{e(1), e(2)};
  TypeParam ranged(values.begin(), values.end());
  EXPECT_TRUE(counts_are_exact(1, listed, ranged));
  listed = {e(3)};
  EXPECT_EQ(listed.size(), 1u);
  EXPECT_TRUE(counts_are_exact(1, listed, ranged));
  ranged = {};
  EXPECT_TRUE(ranged.empty());
  EXPECT_TRUE(counts_are_exact(1, listed, ranged));
}

TYPED_TEST(EveryContainer, AssignmentToItselfChangesNothing) {
  TypeParam c = filled<TypeParam>(this->nodes);
  const TypeParam before = c;
  TypeParam& same = c;
  c = same;
  EXPECT_TRUE(c == before);
  c = c.raw();
  EXPECT_TRUE(c == before);
  c.swap(same);
  EXPECT_TRUE(c == before);
  c = std::move(same);
  EXPECT_TRUE(c == before);
  EXPECT_TRUE(counts_are_exact(1, c, before));
}

TYPED_TEST(EveryContainer, AssignmentToItselfKeepsObjectsThatOnlyItHolds) {
  TypeParam c = filled<TypeParam>(make_nodes(3));
  const std::size_t alive = node::living().size();
  TypeParam& same = c;
  c = same;
  c = std::move(same);
  c = c.raw();
  c.swap(same);
  EXPECT_EQ(node::living().size(), alive);
  EXPECT_EQ(c.size(), 3u);
  const typename TypeParam::std_type plain = c;
  c = plain;
  EXPECT_EQ(node::living().size(), alive);
  c = typename TypeParam::std_type(plain);
  EXPECT_EQ(node::living().size(), alive);
}

TYPED_TEST(EveryContainer, HoldsNull) {
  TypeParam c;
  c.insert(c.end(), element<TypeParam>(nullptr, 9));
  TypeParam copy = c;
  copy.swap(c);
  c = std::move(copy);
  EXPECT_EQ(pointers_in(c), std::vector<node*>{nullptr});
  c.erase(c.begin());
  EXPECT_TRUE(c.empty());
}

TYPED_TEST(EveryContainer, IsReadAsTheStandardOne) {
  using std_type = typename TypeParam::std_type;
  const TypeParam c = filled<TypeParam>(this->nodes);
  const std_type& plain = c;
  EXPECT_EQ(&plain, &c.raw());
  const auto size = [](const std_type& s) { return s.size(); };
  EXPECT_EQ(size(c), 4u);
  const std_type copy = c;
  const std_type direct(c);
  std_type assigned;
  assigned = c;
  EXPECT_TRUE(c == copy && copy == c && direct == c && assigned == c);
  EXPECT_FALSE(c != copy || copy != c || c != TypeParam(c));
  EXPECT_TRUE(c != std_type() && std_type() != c && c != TypeParam());
  EXPECT_TRUE(counts_are_exact(1, c));
  static_assert(
      std::is_same<typename TypeParam::const_iterator, typename std_type::const_iterator>::value,
      "");
  static_assert(std::is_convertible<TypeParam&, const std_type&>::value, "");
  static_assert(!std::is_convertible<TypeParam&, std_type&>::value, "");
  static_assert(std::is_nothrow_move_constructible<TypeParam>::value, "");
  static_assert(std::is_nothrow_move_assignable<TypeParam>::value, "");
  static_assert(sizeof(TypeParam) == sizeof(std_type), "");
}

TYPED_TEST(EveryContainer, NestsInAVector) {
  std::vector<TypeParam> nested(3);
  nested[0] = filled<TypeParam>(this->nodes);
  nested[2] = nested[0];
  nested.resize(20);
  nested.erase(nested.begin());
  EXPECT_TRUE(counts_are_exact(1, nested[1]));
  nested.insert(nested.begin(), nested[1]);
  EXPECT_TRUE(counts_are_exact(1, nested[0], nested[2]));
  nested.clear();
  EXPECT_TRUE(counts_are_exact(1));
}

}  // namespace
