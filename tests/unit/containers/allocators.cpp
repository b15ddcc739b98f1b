// Allocators with a state, and comparators with one.
#include "support.hpp"

#include <memory_resource>

namespace {

/// Memory that is counted.
class arena : public std::pmr::memory_resource {
 public:
  std::size_t blocks = 0;

 private:
  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    ++blocks;
    return std::pmr::new_delete_resource()->allocate(bytes, alignment);
  }
  void do_deallocate(void* p, std::size_t bytes, std::size_t alignment) override {
    --blocks;
    std::pmr::new_delete_resource()->deallocate(p, bytes, alignment);
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }
};

template <class Value>
using in_arena = std::pmr::polymorphic_allocator<Value>;
using key_and_int = std::pair<node* const, int>;
using int_and_value = std::pair<const int, node*>;
using containers_in_arenas = testing::Types<
    slamgc::rc_vector<node, in_arena<node*>>, slamgc::rc_list<node, in_arena<node*>>,
    slamgc::rc_set<node, std::less<node*>, in_arena<node*>>,
    slamgc::rc_map<node, int, std::less<node*>, in_arena<key_and_int>>,
    slamgc::rc_unordered_set<node, std::hash<node*>, std::equal_to<node*>, in_arena<node*>>,
    slamgc::rc_unordered_map<node, int, std::hash<node*>, std::equal_to<node*>,
                             in_arena<key_and_int>>,
    slamgc::rc_value_map<int, node, std::less<int>, in_arena<int_and_value>>>;

/// While a test runs, whoever does not use the container's allocator finds no memory.
template <class C>
class ContainerInArena : public testing::Test {
 protected:
  ContainerInArena() { std::pmr::set_default_resource(std::pmr::null_memory_resource()); }
  ~ContainerInArena() override { std::pmr::set_default_resource(nullptr); }
  C make(arena& a, std::size_t first, std::size_t last) {
    C c{typename C::allocator_type(&a)};
    for (; first != last; ++first) c.insert(c.end(), element<C>(nodes[first]));
    return c;
  }
  std::vector<node_ptr> nodes = make_nodes(6);
  arena one, two;
};
TYPED_TEST_SUITE(ContainerInArena, containers_in_arenas);

TYPED_TEST(ContainerInArena, AllocatesThereOnly) {
  {
    TypeParam c = this->make(this->one, 0, 4);
    EXPECT_TRUE(c.get_allocator().resource() == &this->one);
    EXPECT_GT(this->one.blocks, 0u);
    c.edit()->clear();
    c = {element<TypeParam>(this->nodes[3]), element<TypeParam>(this->nodes[4])};
    c.clear();
    c = {};
    TypeParam moved(std::move(c));
    moved = this->make(this->one, 2, 5).raw();
    moved = typename TypeParam::std_type(moved.raw(), &this->one);
    EXPECT_TRUE(counts_are_exact(1, c, moved));
  }
  EXPECT_EQ(this->one.blocks, 0u);
  EXPECT_TRUE(counts_are_exact(1));
}

TYPED_TEST(ContainerInArena, AssignmentsAndSwapInOneArena) {
  TypeParam a = this->make(this->one, 0, 2), b = this->make(this->one, 1, 5);
  a.swap(b);
  EXPECT_EQ(a.size(), 4u);
  EXPECT_TRUE(counts_are_exact(1, a, b));
  b = a;
  EXPECT_TRUE(counts_are_exact(1, a, b));
  const std::size_t blocks = this->one.blocks;
  b = std::move(a);
  EXPECT_LE(this->one.blocks, blocks);
  EXPECT_TRUE(a.empty());
  EXPECT_TRUE(counts_are_exact(1, a, b));
}

TYPED_TEST(ContainerInArena, AssignmentsBetweenArenasKeepTheArena) {
  TypeParam a = this->make(this->one, 0, 2), b = this->make(this->two, 1, 5);
  const TypeParam expected = this->make(this->one, 1, 5);
  static_assert(!std::is_nothrow_move_assignable<TypeParam>::value, "");
  a = b;
  EXPECT_TRUE(a == expected);
  a.clear();
  a = std::move(b);
  EXPECT_TRUE(a == expected);
  EXPECT_TRUE(b.empty());
  EXPECT_TRUE(a.get_allocator().resource() == &this->one);
  EXPECT_TRUE(counts_are_exact(1, a, b, expected));
  b = typename TypeParam::std_type(a.raw(), &this->one);
  EXPECT_TRUE(b == expected);
  EXPECT_TRUE(b.get_allocator().resource() == &this->two);
  EXPECT_TRUE(counts_are_exact(1, a, b, expected));
}

template <class C>
void use_a_sequence(C& c, const std::vector<node_ptr>& nodes) {
  node* const p = nodes[0].get();
  node* const range[] = {p, nullptr, nodes[1].get()};
  c.insert(c.begin(), 3, p);
  c.insert(c.begin(), range, range + 3);
  c.insert(c.end(), {p, p});
  c.resize(20, p);
  c.push_back(nodes[1].get());
  c.assign(4, p);
  c.assign(range, range + 3);
  c.assign({p, p});
  c.emplace_back(p);
  c.erase(c.begin());
  EXPECT_TRUE(counts_are_exact(1, c));
  c.clear();
}
TEST(SequenceInArena, AllocatesThereOnly) {
  const std::vector<node_ptr> nodes = make_nodes(2);
  arena a;
  std::pmr::set_default_resource(std::pmr::null_memory_resource());
  slamgc::rc_vector<node, in_arena<node*>> v(&a);
  use_a_sequence(v, nodes);
  v.shrink_to_fit();
  slamgc::rc_list<node, in_arena<node*>> l(&a);
  use_a_sequence(l, nodes);
  l.sort();
  l.unique();
  std::pmr::set_default_resource(nullptr);
  EXPECT_TRUE(counts_are_exact(1, v, l));
}

/// An order that is chosen when the container is made.
struct by_id {
  bool descending = false;
  bool operator()(const node* a, const node* b) const {
    return descending ? b->id < a->id : a->id < b->id;
  }
};
using ordered_set = slamgc::rc_set<node, by_id>;

TEST(ContainerComparator, IsKeptByListsAndTakenFromContainers) {
  const std::vector<node_ptr> nodes = make_nodes(3);
  node *const a = nodes[0].get(), *const b = nodes[1].get(), *const c = nodes[2].get();
  ordered_set down(by_id{true});
  down = {a, c, b};
  EXPECT_EQ(pointers_in(down), (std::vector<node*>{c, b, a}));
  down.clear();
  down.insert({b, a});
  EXPECT_EQ(pointers_in(down), (std::vector<node*>{b, a}));

  ordered_set up{a, b};
  EXPECT_EQ(pointers_in(up), (std::vector<node*>{a, b}));
  up.swap(down);
  EXPECT_TRUE(up.key_comp().descending && !down.key_comp().descending);
  up.swap(down);

  ordered_set copied(down), assigned, moved_to;
  assigned = down;
  EXPECT_TRUE(copied.key_comp().descending && assigned.key_comp().descending);
  moved_to = std::move(copied);
  EXPECT_TRUE(moved_to.key_comp().descending);
  copied = {a, b};
  EXPECT_TRUE(counts_are_exact(1, down, up, copied, assigned, moved_to));

  up = std::set<node*, by_id>({a, c}, by_id{true});
  EXPECT_EQ(pointers_in(up), (std::vector<node*>{c, a}));
  const std::set<node*, by_id> plain_up{a, b};
  up = plain_up;
  EXPECT_FALSE(up.value_comp().descending);
  EXPECT_TRUE(counts_are_exact(1, down, up, copied, assigned, moved_to));
}

}  // namespace
