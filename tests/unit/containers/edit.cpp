// edit(): the plain container for code that insists on it, counted when the scope ends.
#include "support.hpp"

#include <algorithm>

namespace {

template <class C>
class ContainerEdit : public testing::Test {
 protected:
  std::vector<node_ptr> nodes = make_nodes(6);
  C c = filled<C>({nodes[0], nodes[1], nodes[2]});
};
TYPED_TEST_SUITE(ContainerEdit, all_containers, container_name);

TYPED_TEST(ContainerEdit, CountsWhatWasPutInAndTakenOut) {
  {
    const auto scope = this->c.edit();
    scope->erase(scope->begin());
    scope->insert(scope->end(), element<TypeParam>(this->nodes[4]));
    scope->insert(scope->end(), element<TypeParam>(this->nodes[5]));
  }
  EXPECT_EQ(this->c.size(), 4u);
  EXPECT_TRUE(counts_are_exact(1, this->c));
  this->c.edit()->clear();
  EXPECT_TRUE(counts_are_exact(1, this->c));
}

TYPED_TEST(ContainerEdit, CountsAssignment) {
  using std_type = typename TypeParam::std_type;
  const TypeParam other = filled<TypeParam>({this->nodes[4], this->nodes[2], this->nodes[3]});
  {
    const auto scope = this->c.edit();
    *scope = other.raw();
  }
  EXPECT_TRUE(counts_are_exact(1, this->c, other));
  std_type plain = filled<TypeParam>(this->nodes);
  this->c.edit()->swap(plain);
  EXPECT_EQ(this->c.size(), 6u);
  EXPECT_TRUE(counts_are_exact(1, this->c, other));
}

TYPED_TEST(ContainerEdit, IsATemporaryArgument) {
  using std_type = typename TypeParam::std_type;
  const auto clear = [](std_type& plain) { plain.clear(); };
  const auto exchange = [](std_type& a, std_type& b) { a.swap(b); };
  TypeParam other = filled<TypeParam>({this->nodes[5]});
  exchange(this->c.edit(), other.edit());
  EXPECT_EQ(this->c.size(), 1u);
  EXPECT_EQ(other.size(), 3u);
  EXPECT_TRUE(counts_are_exact(1, this->c, other));
  clear(other.edit());
  EXPECT_TRUE(counts_are_exact(1, this->c, other));
}

TYPED_TEST(ContainerEdit, CountsASwapOfTwoEditedContainers) {
  TypeParam other = filled<TypeParam>({this->nodes[2], this->nodes[5]});
  {
    const auto a = this->c.edit();
    const auto b = other.edit();
    a->swap(*b);
    a->erase(a->begin());
  }
  EXPECT_EQ(this->c.size(), 1u);
  EXPECT_EQ(other.size(), 3u);
  EXPECT_TRUE(counts_are_exact(1, this->c, other));
}

TYPED_TEST(ContainerEdit, CountsWhenAnExceptionLeavesTheScope) {
  try {
    const auto scope = this->c.edit();
    scope->erase(scope->begin());
    scope->insert(scope->end(), element<TypeParam>(this->nodes[5]));
    throw 1;
  } catch (int) {
  }
  EXPECT_TRUE(counts_are_exact(1, this->c));
}

TYPED_TEST(ContainerEdit, KeepsWhatItTookOutUntilTheScopeEnds) {
  TypeParam owner = filled<TypeParam>(make_nodes(2));
  const std::size_t alive = node::living().size();
  {
    const auto scope = owner.edit();
    const typename TypeParam::std_type old = *scope;
    scope->clear();
    EXPECT_EQ(node::living().size(), alive);
    for (const auto& e : old) scope->insert(scope->end(), e);
    scope->erase(scope->begin());
  }
  EXPECT_EQ(node::living().size(), alive - 1);
}

TYPED_TEST(ContainerEdit, OfOneContainerAfterTheOther) {
  {
    auto scope = this->c.edit();
    typename TypeParam::std_type& plain = scope;
    EXPECT_EQ(&plain, &this->c.raw());
    EXPECT_EQ(&plain, &scope.get());
    EXPECT_EQ(&plain, &*scope);
  }
  { const auto scope = this->c.edit(); }
  EXPECT_TRUE(counts_are_exact(1, this->c));
}

/// Ways to change a vector, by the number of elements and where they stand.
TEST(VectorEdit, CountsWhateverHappens) {
  const std::vector<node_ptr> nodes = make_nodes(4);
  slamgc::rc_vector<node> v = filled<slamgc::rc_vector<node>>(nodes);
  const auto edit = [&](auto change) {
    {
      const auto scope = v.edit();
      change(*scope);
    }
    EXPECT_TRUE(counts_are_exact(1, v));
  };
  using plain = std::vector<node*>;
  edit([](plain& p) { std::sort(p.begin(), p.end(), std::greater<node*>()); });
  edit([](plain& p) { std::reverse(p.begin(), p.end()); });
  edit([](plain& p) { p.resize(40); });
  edit([&](plain& p) { std::fill(p.begin() + 3, p.end(), nodes[1].get()); });
  edit([](plain& p) { p.erase(std::unique(p.begin(), p.end()), p.end()); });
  edit([](plain& p) { std::rotate(p.begin(), p.begin() + 1, p.end()); });
  edit([](plain& p) { std::swap(p[0], p[1]); });
  edit([](plain& p) { p.insert(p.begin(), p[0]); });
  edit([](plain& p) { std::fill(p.begin(), p.end(), nullptr); });
  edit([&](plain& p) { p.assign(3, nodes[2].get()); });
  edit([](plain& p) { p = plain(); });
}

TEST(ListEdit, TakesAListOver) {
  const std::vector<node_ptr> nodes = make_nodes(3);
  slamgc::rc_list<node> l = filled<slamgc::rc_list<node>>(nodes);
  std::list<node*> plain{nodes[0].get(), nodes[0].get()};
  l.edit()->splice(l.begin(), plain);
  EXPECT_EQ(l.size(), 5u);
  EXPECT_TRUE(counts_are_exact(1, l));
  *l.edit()->begin() = nodes[2].get();
  EXPECT_TRUE(counts_are_exact(1, l));
}

TEST(NestedEdit, OfAContainerInAVector) {
  const std::vector<node_ptr> nodes = make_nodes(3);
  std::vector<slamgc::rc_list<node>> words(2);
  const auto add = [](std::list<node*>& l, node* p) { l.push_back(p); };
  add(words[0].edit(), nodes[0].get());
  add(words[1].edit(), nodes[0].get());
  EXPECT_TRUE(counts_are_exact(1, words[0], words[1]));
}

}  // namespace
