// Moving a reference changes the version of its object; reading changes nothing in the word.
#include "support.hpp"

#include <algorithm>

namespace {

/// The state words of @p nodes.
std::vector<std::uint64_t> words(const std::vector<node_ptr>& nodes) {
  std::vector<std::uint64_t> bits;
  for (const node_ptr& p : nodes) bits.push_back(p->state().bits);
  return bits;
}

/// Whether each of @p nodes has the count that it had, and another version.
testing::AssertionResult moved(const std::vector<node_ptr>& nodes,
                               const std::vector<std::uint64_t>& before) {
  for (std::size_t i = 0; i != nodes.size(); ++i) {
    const slamgc::state_word was{before[i]}, is = nodes[i]->state();
    if (is.count() != was.count())
      return testing::AssertionFailure() << "count " << was.count() << " became " << is.count();
    if (is.version() == was.version() || is.same_references(was))
      return testing::AssertionFailure() << "object " << i << " moved unnoticed";
  }
  return testing::AssertionSuccess();
}

template <class C>
class ContainerVersion : public testing::Test {
 protected:
  std::vector<node_ptr> nodes = make_nodes(4);
  C full = filled<C>(nodes);
  std::vector<std::uint64_t> before = words(nodes);
};
TYPED_TEST_SUITE(ContainerVersion, all_containers, container_name);

TYPED_TEST(ContainerVersion, ChangesWhenAContainerIsMoved) {
  TypeParam to(std::move(this->full));
  EXPECT_TRUE(moved(this->nodes, this->before));
  const auto between = words(this->nodes);
  this->full = std::move(to);
  EXPECT_TRUE(moved(this->nodes, between));
}

TYPED_TEST(ContainerVersion, ChangesWhenContainersAreSwapped) {
  TypeParam to;
  this->full.swap(to);
  EXPECT_TRUE(moved(this->nodes, this->before));
  const auto between = words(this->nodes);
  swap(this->full, to);
  EXPECT_TRUE(moved(this->nodes, between));
}

TYPED_TEST(ContainerVersion, ChangesOnAnyAddition) {
  const auto version = this->nodes[0]->state().version();
  TypeParam copy(this->full);
  EXPECT_EQ(this->nodes[0]->state().version(), version + 1);
  copy.clear();
  EXPECT_EQ(this->nodes[0]->state().version(), version + 1);
}

TYPED_TEST(ContainerVersion, StaysWhenAContainerIsRead) {
  using std_type = typename TypeParam::std_type;
  TypeParam& c = this->full;
  const TypeParam& constant = c;
  node* seen = nullptr;
  for (const auto& e : c) seen = pointer_in(e);
  for (auto i = constant.begin(); i != constant.end(); ++i) seen = pointer_in(*i);
  const std_type copy = c;
  const std_type& converted = c;
  std::vector<node*> sorted = pointers_in(constant);
  std::sort(sorted.begin(), sorted.end());
  EXPECT_TRUE(c == copy && seen != nullptr && converted.size() == c.size() && !c.empty());
  EXPECT_EQ(std::distance(c.cbegin(), c.cend()), 4);
  EXPECT_EQ(words(this->nodes), this->before);
}

TYPED_TEST(ContainerVersion, StaysWhenAnEditChangesNothing) {
  { const auto scope = this->full.edit(); }
  EXPECT_EQ(words(this->nodes), this->before);
}

TYPED_TEST(ContainerVersion, StaysWhenAContainerIsAssignedToItself) {
  TypeParam& same = this->full;
  this->full = std::move(same);
  this->full.swap(same);
  EXPECT_EQ(words(this->nodes), this->before);
}

template <class C>
class KeyedVersion : public ContainerVersion<C> {};
TYPED_TEST_SUITE(KeyedVersion, keyed_containers, container_name);

TYPED_TEST(KeyedVersion, ChangesOnMerge) {
  TypeParam to;
  to.merge(this->full);
  EXPECT_TRUE(this->full.empty());
  EXPECT_TRUE(moved(this->nodes, this->before));
}

TYPED_TEST(KeyedVersion, StaysOnLookUp) {
  TypeParam& c = this->full;
  const TypeParam& constant = c;
  for (const auto& e : std::vector<typename TypeParam::value_type>(c.begin(), c.end())) {
    const typename TypeParam::key_type key = key_in(e);
    EXPECT_TRUE(c.contains(key) && constant.find(key) != constant.end() && c.find(key) != c.end());
    EXPECT_EQ(c.count(key), 1u);
    EXPECT_TRUE(c.equal_range(key).first == c.find(key));
    EXPECT_FALSE(c.insert(e).second);
    EXPECT_FALSE(c.emplace(e).second);
  }
  EXPECT_EQ(words(this->nodes), this->before);
}

using ListVersion = ContainerVersion<slamgc::rc_list<node>>;

TEST_F(ListVersion, ChangesOnSplice) {
  slamgc::rc_list<node> to;
  to.splice(to.end(), full);
  EXPECT_TRUE(moved(nodes, before));
}
TEST_F(ListVersion, ChangesOnSpliceOfOneElement) {
  slamgc::rc_list<node> to;
  while (!full.empty()) to.splice(to.end(), full, full.begin());
  EXPECT_TRUE(moved(nodes, before));
}
TEST_F(ListVersion, ChangesOnSpliceOfARange) {
  slamgc::rc_list<node> to;
  to.splice(to.end(), full, full.begin(), full.end());
  EXPECT_TRUE(moved(nodes, before));
}
TEST_F(ListVersion, ChangesOnMerge) {
  slamgc::rc_list<node> to;
  to.merge(full, [](node* a, node* b) { return a->id < b->id; });
  EXPECT_TRUE(moved(nodes, before));
}
TEST_F(ListVersion, StaysWhileTheOrderChanges) {
  full.sort();
  full.reverse();
  full.splice(full.begin(), full, --full.end());
  full.splice(full.begin(), full);
  full.merge(full);
  EXPECT_EQ(full.front(), full.raw().front());
  EXPECT_EQ(full.back(), *full.rbegin());
  EXPECT_EQ(words(nodes), before);
}

using VectorVersion = ContainerVersion<slamgc::rc_vector<node>>;

TEST_F(VectorVersion, StaysWhenElementsAreRead) {
  for (std::size_t i = 0; i != full.size(); ++i) {
    node* const p = full[i];
    EXPECT_TRUE(p == full.at(i) && p == full.data()[i] && full[i]->id == (*full[i]).id && full[i]);
    EXPECT_EQ(full[i].get(), p);
  }
  EXPECT_TRUE(full.front() == full[0] && full.back() == *full.rbegin());
  full.reserve(100);
  full.shrink_to_fit();
  EXPECT_EQ(words(nodes), before);
}
TEST_F(VectorVersion, StaysForWhatAnAssignmentLeavesWhereItIs) {
  std::vector<node*> next = full;
  next.pop_back();
  full = next;
  EXPECT_EQ(nodes[0]->state().bits, before[0]);
  EXPECT_EQ(nodes[3]->use_count(), 1u);
}
TEST_F(VectorVersion, ChangesWhenElementsAreSwapped) {
  swap(full[0], full[3]);
  swap(full[1], full[2]);
  EXPECT_TRUE(moved(nodes, before));
}

}  // namespace
