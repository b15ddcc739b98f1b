// Arguments that lie in the container that they change, in particular where nobody else holds them.
#include "support.hpp"

#include <algorithm>

namespace {

using vector = slamgc::rc_vector<node>;
using list = slamgc::rc_list<node>;
using set = slamgc::rc_set<node>;
using map = slamgc::rc_map<node, int>;

std::vector<int> ids(const std::vector<node*>& pointers) {
  std::vector<int> found;
  for (const node* p : pointers) found.push_back(p->id);
  return found;
}

/// A container that alone holds three objects, 0 to 2.
template <class C>
C alone() {
  return filled<C>(make_nodes(3));
}

template <class C>
class SequenceAliasing : public testing::Test {
 protected:
  void expect(const std::vector<int>& numbers) {
    EXPECT_EQ(ids(pointers_in(c)), numbers);
    EXPECT_TRUE(counts_are_exact(0, c));
    EXPECT_EQ(node::living().size(), std::set<int>(numbers.begin(), numbers.end()).size());
  }
  C c = alone<C>();
};
TYPED_TEST_SUITE(SequenceAliasing, sequences, container_name);

TYPED_TEST(SequenceAliasing, PushBackOfAnElement) {
  this->c.push_back(this->c.front());
  this->expect({0, 1, 2, 0});
}
TYPED_TEST(SequenceAliasing, InsertOfAnElement) {
  this->c.insert(this->c.begin(), this->c.back());
  this->expect({2, 0, 1, 2});
}
TYPED_TEST(SequenceAliasing, InsertOfCopiesOfAnElement) {
  this->c.insert(this->c.begin(), 3, this->c.back());
  this->expect({2, 2, 2, 0, 1, 2});
}
TYPED_TEST(SequenceAliasing, InsertOfItself) {
  this->c.insert(std::next(this->c.begin()), this->c.begin(), this->c.end());
  this->expect({0, 0, 1, 2, 1, 2});
}
TYPED_TEST(SequenceAliasing, AssignOfCopiesOfAnElement) {
  this->c.assign(5, this->c.back());
  this->expect({2, 2, 2, 2, 2});
}
TYPED_TEST(SequenceAliasing, AssignOfAPartOfItself) {
  this->c.assign(std::next(this->c.begin()), this->c.end());
  this->expect({1, 2});
}
TYPED_TEST(SequenceAliasing, AssignOfAListOfElements) {
  this->c = {this->c.back(), this->c.front()};
  this->expect({2, 0});
}
TYPED_TEST(SequenceAliasing, ResizeWithAnElement) {
  this->c.resize(5, this->c.front());
  this->expect({0, 1, 2, 0, 0});
  this->c.resize(1, this->c.back());
  this->expect({0});
}
TYPED_TEST(SequenceAliasing, AssignmentOfAReorderedCopy) {
  std::vector<node*> copy(this->c.begin(), this->c.end());
  std::rotate(copy.begin(), copy.begin() + 1, copy.end());
  this->c = typename TypeParam::std_type(copy.begin(), copy.end());
  this->expect({1, 2, 0});
  std::reverse(copy.begin(), copy.end());
  const typename TypeParam::std_type plain(copy.begin(), copy.end());
  this->c = plain;
  this->expect({0, 2, 1});
}

TEST(VectorAliasing, ElementsOfItself) {
  vector v = alone<vector>();
  v[0] = v[0];
  v[0] = v[1];
  v.front() = v.back();
  EXPECT_EQ(ids(v), (std::vector<int>{2, 1, 2}));
  swap(v[0], v[0]);
  swap(v[0], v[1]);
  EXPECT_EQ(ids(v), (std::vector<int>{1, 2, 2}));
  v.push_back(v[0]);
  v.insert(v.begin(), v[1]);
  v.emplace(v.begin(), v[2]);
  v.emplace_back(v[0]);
  EXPECT_EQ(ids(v), (std::vector<int>{2, 2, 1, 2, 2, 1, 2}));
  v.assign(2, v[2]);
  EXPECT_EQ(ids(v), (std::vector<int>{1, 1}));
  EXPECT_TRUE(counts_are_exact(0, v));
  EXPECT_EQ(node::living().size(), 1u);
}

TEST(VectorAliasing, AnAssignmentKeepsWhatMovesToALaterPlace) {
  vector v = alone<vector>();
  node* const first = v[0];
  v = std::vector<node*>{nullptr, first};
  EXPECT_EQ(node::living().size(), 1u);
  v = std::vector<node*>{nullptr, nullptr, nullptr, first};
  EXPECT_EQ(first->use_count(), 1u);
  v = std::vector<node*>{first};
  EXPECT_TRUE(counts_are_exact(0, v));
}

TEST(VectorAliasing, AReferenceToAnElementIsNotItsPointer) {
  vector v = alone<vector>();
  auto element = v[0];  // not a node*
  node* const pointer = v[0];
  v[0] = v[1];
  EXPECT_NE(pointer, element);
  EXPECT_EQ(element, v[1]);
}

TEST(ListAliasing, SpliceAndMergeWithItself) {
  list l = alone<list>();
  l.splice(l.begin(), l);
  l.splice(l.end(), l, l.begin());
  EXPECT_EQ(ids(pointers_in(l)), (std::vector<int>{1, 2, 0}));
  l.splice(l.begin(), l, std::next(l.begin()), l.end());
  EXPECT_EQ(ids(pointers_in(l)), (std::vector<int>{2, 0, 1}));
  l.merge(l);
  l.swap(l);
  EXPECT_EQ(l.size(), 3u);
  EXPECT_TRUE(counts_are_exact(0, l));
}

TEST(ListAliasing, ReplaceAndRemoveOfAnElement) {
  list l = alone<list>();
  l.replace(l.begin(), l.front());
  l.replace(l.begin(), l.back());
  EXPECT_EQ(ids(pointers_in(l)), (std::vector<int>{2, 1, 2}));
  node* const& inside = l.front();
  EXPECT_EQ(l.remove(inside), 2u);
  EXPECT_EQ(ids(pointers_in(l)), std::vector<int>{1});
  EXPECT_TRUE(counts_are_exact(0, l));
}

TEST(KeyedAliasing, EraseOfAKeyInside) {
  set s = alone<set>();
  EXPECT_EQ(s.erase(*s.begin()), 1u);
  map m = alone<map>();
  EXPECT_EQ(m.erase(m.begin()->first), 1u);
  slamgc::rc_unordered_set<node> u = alone<slamgc::rc_unordered_set<node>>();
  EXPECT_EQ(u.erase(*u.begin()), 1u);
  slamgc::rc_value_map<int, node> v = alone<slamgc::rc_value_map<int, node>>();
  EXPECT_EQ(v.erase(v.begin()->first), 1u);
  EXPECT_TRUE(counts_are_exact(0, s, m, u, v));
  EXPECT_EQ(node::living().size(), 8u);
}

TEST(KeyedAliasing, MergeAndInsertOfItself) {
  set s = alone<set>();
  s.merge(s);
  s.insert(s.begin(), s.end());
  s.insert(s.end(), *s.begin());
  s = {*s.begin()};
  EXPECT_EQ(s.size(), 1u);
  slamgc::rc_unordered_map<node, int> u = alone<slamgc::rc_unordered_map<node, int>>();
  u.merge(u);
  u[u.begin()->first] = 5;
  EXPECT_EQ(u.size(), 3u);
  EXPECT_TRUE(counts_are_exact(0, s, u));
}

TEST(KeyedAliasing, ValuesOfItself) {
  slamgc::rc_value_map<int, node> m = alone<slamgc::rc_value_map<int, node>>();
  m[0] = m[1];
  m[7] = m[0];
  m.insert_or_assign(2, m.at(7));
  m.try_emplace(8, m[2]);
  EXPECT_EQ(ids(pointers_in(m)), (std::vector<int>{1, 1, 1, 1, 1}));
  EXPECT_TRUE(counts_are_exact(0, m));
  EXPECT_EQ(node::living().size(), 1u);
}

}  // namespace
