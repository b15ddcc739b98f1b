// Destructors that look at the container that is being changed find it in its final state, and may
// change it.
#include "support.hpp"

#include <algorithm>
#include <memory>

namespace {

/// Five objects that only a container holds. Their destructors note what is in it.
template <class C>
class ContainerReentrancy : public testing::Test {
 protected:
  ContainerReentrancy() : c(new C(filled<C>(make_nodes(5)))) {
    for (const auto& e : *c) pointer_in(e)->at_end = [this] { seen.push_back(pointers_in(*c)); };
  }
  ~ContainerReentrancy() override {
    for (const auto& e : *c) pointer_in(e)->at_end = nullptr;
  }
  /// Whether @p n objects died, and each found what the container holds now.
  testing::AssertionResult all_saw_the_end(std::size_t n) {
    if (seen.size() != n) return testing::AssertionFailure() << seen.size() << " objects died";
    for (const std::vector<node*>& s : seen)
      if (s != pointers_in(*c))
        return testing::AssertionFailure() << "found " << s.size() << " elements";
    return counts_are_exact(0, *c);
  }

  std::unique_ptr<C> c;
  std::vector<std::vector<node*>> seen;
};
TYPED_TEST_SUITE(ContainerReentrancy, all_containers, container_name);

TYPED_TEST(ContainerReentrancy, Clear) {
  this->c->clear();
  EXPECT_TRUE(this->all_saw_the_end(5));
}
TYPED_TEST(ContainerReentrancy, Erase) {
  this->c->erase(std::next(this->c->begin()));
  EXPECT_TRUE(this->all_saw_the_end(1));
}
TYPED_TEST(ContainerReentrancy, EraseRange) {
  this->c->erase(std::next(this->c->begin()), std::next(this->c->begin(), 4));
  EXPECT_TRUE(this->all_saw_the_end(3));
}
TYPED_TEST(ContainerReentrancy, Assignment) {
  const node_ptr other = slamgc::make_rc<node>(9);
  const TypeParam next{element<TypeParam>(other)};
  *this->c = next;
  EXPECT_EQ(this->seen.size(), 5u);
  for (const auto& s : this->seen) EXPECT_EQ(s, std::vector<node*>{other.get()});
  *this->c = {};
}
TYPED_TEST(ContainerReentrancy, MoveAssignment) {
  const node_ptr other = slamgc::make_rc<node>(9);
  *this->c = TypeParam{element<TypeParam>(other)};
  EXPECT_EQ(this->seen.size(), 5u);
  for (const auto& s : this->seen) EXPECT_EQ(s, std::vector<node*>{other.get()});
  *this->c = {};
}
TYPED_TEST(ContainerReentrancy, AssignmentOfPlainContainer) {
  *this->c = typename TypeParam::std_type();
  EXPECT_TRUE(this->all_saw_the_end(5));
}
TYPED_TEST(ContainerReentrancy, AssignmentOfList) {
  const auto kept = *this->c->begin();
  *this->c = {kept};
  EXPECT_TRUE(this->all_saw_the_end(4));
}
TYPED_TEST(ContainerReentrancy, Edit) {
  {
    const auto scope = this->c->edit();
    scope->erase(std::next(scope->begin()), scope->end());
    EXPECT_TRUE(this->seen.empty());
  }
  EXPECT_TRUE(this->all_saw_the_end(4));
}
TYPED_TEST(ContainerReentrancy, Destruction) {
  TypeParam* const dying = this->c.get();
  for (const auto& e : *dying)
    pointer_in(e)->at_end = [this, dying] { this->seen.push_back(pointers_in(*dying)); };
  this->c.reset();
  this->c = std::make_unique<TypeParam>();
  EXPECT_TRUE(this->all_saw_the_end(5));
}
TYPED_TEST(ContainerReentrancy, DestructorsMayFillTheContainerAgain) {
  const std::vector<node_ptr> others = make_nodes(5);
  std::size_t i = 0;
  for (const auto& e : *this->c)
    pointer_in(e)->at_end = [this, p = element<TypeParam>(others[i++])] {
      this->c->insert(this->c->end(), p);
    };
  this->c->clear();
  EXPECT_EQ(this->c->size(), 5u);
  const auto found = pointers_in(*this->c);
  for (const node_ptr& p : others) {
    EXPECT_EQ(p->use_count(), 2u);
    EXPECT_TRUE(std::find(found.begin(), found.end(), p.get()) != found.end());
  }
}
TYPED_TEST(ContainerReentrancy, DestructorsMayEmptyTheContainer) {
  for (const auto& e : *this->c) pointer_in(e)->at_end = [this] { this->c->clear(); };
  this->c->erase(this->c->begin());
  EXPECT_TRUE(this->c->empty());
}

template <class C>
class SequenceReentrancy : public ContainerReentrancy<C> {};
TYPED_TEST_SUITE(SequenceReentrancy, sequences, container_name);

TYPED_TEST(SequenceReentrancy, Resize) {
  this->c->resize(2);
  EXPECT_TRUE(this->all_saw_the_end(3));
}
TYPED_TEST(SequenceReentrancy, Pop) {
  this->c->pop_back();
  EXPECT_TRUE(this->all_saw_the_end(1));
}
TYPED_TEST(SequenceReentrancy, AssignN) {
  this->c->assign(3, this->c->front());
  EXPECT_TRUE(this->all_saw_the_end(4));
}

using ListReentrancy = ContainerReentrancy<slamgc::rc_list<node>>;
TEST_F(ListReentrancy, PopFront) {
  c->pop_front();
  EXPECT_TRUE(all_saw_the_end(1));
}
TEST_F(ListReentrancy, Replace) {
  c->replace(c->begin(), c->back());
  EXPECT_TRUE(all_saw_the_end(1));
}
TEST_F(ListReentrancy, Remove) {
  c->remove(c->front());
  EXPECT_TRUE(all_saw_the_end(1));
}
TEST_F(ListReentrancy, RemoveIf) {
  c->remove_if([](node* p) { return p->id % 2 == 0; });
  EXPECT_TRUE(all_saw_the_end(3));
}
TEST_F(ListReentrancy, Unique) {
  c->unique([](node* a, node* b) { return a->id / 2 == b->id / 2; });
  EXPECT_TRUE(all_saw_the_end(2));
}

using VectorReentrancy = ContainerReentrancy<slamgc::rc_vector<node>>;
TEST_F(VectorReentrancy, ElementAssignment) {
  (*c)[1] = c->back();
  EXPECT_TRUE(all_saw_the_end(1));
}

using SetReentrancy = ContainerReentrancy<slamgc::rc_set<node>>;
TEST_F(SetReentrancy, EraseByKey) {
  c->erase(*c->begin());
  EXPECT_TRUE(all_saw_the_end(1));
}

using ValueMapReentrancy = ContainerReentrancy<slamgc::rc_value_map<int, node>>;
TEST_F(ValueMapReentrancy, Assignment) {
  (*c)[0] = nullptr;
  EXPECT_EQ(seen.size(), 1u);
  c->insert_or_assign(1, nullptr);
  EXPECT_EQ(seen.size(), 2u);
  c->erase(0);
  c->erase(1);
  EXPECT_TRUE(counts_are_exact(0, *c));
}

}  // namespace
