// Allocations, comparisons, hashes and iterators that throw in counted sets and maps.
#include "exceptions.hpp"

namespace {

constexpr guarantee strong = guarantee::strong;
constexpr guarantee basic = guarantee::basic;

/// What sets and maps can do.
template <class C>
void fail_keyed_operations() {
  fail_common_operations<C>();
  fail_anywhere<C>("insert one", strong, [](C& a, C&, auto& n) { a.insert(element<C>(n[5])); });
  fail_anywhere<C>("emplace one", strong, [](C& a, C&, auto& n) { a.emplace(element<C>(n[5])); });
  fail_anywhere<C>("emplace hint", strong,
                   [](C& a, C&, auto& n) { a.emplace_hint(a.begin(), element<C>(n[5])); });
  fail_anywhere<C>("insert range", basic,
                   [](C& a, C& b, auto&) { a.insert(faulty(b.begin()), faulty(b.end())); });
  fail_anywhere<C>("insert list", basic, [](C& a, C&, auto& n) {
    a.insert({element<C>(n[2]), element<C>(n[3]), element<C>(n[5])});
  });
  fail_anywhere<C>("insert many", basic, [](C& a, C&, auto& n) {
    for (std::size_t i = 5; i != 30; ++i) a.insert(element<C>(n[i]));
  });
}

/// Hashed containers only: libstdc++ terminates when a comparison throws in the merge of ordered ones,
/// and before version 12 when a hash does in that of hashed ones.
template <class C>
void fail_merge() {
#if !defined(_GLIBCXX_RELEASE) || _GLIBCXX_RELEASE >= 12
  fail_anywhere<C>("merge", basic, [](C& a, C& b, auto&) { a.merge(b); });
  fail_anywhere<C>("merge many", basic, [](C& a, C& b, auto& n) {
    for (std::size_t i = 5; i != 30; ++i) b.insert(element<C>(n[i]));
    a.merge(b);
  });
#endif
}

template <class C>
void fail_map_operations() {
  fail_keyed_operations<C>();
  fail_anywhere<C>("index", strong, [](C& a, C&, auto& n) { a[element<C>(n[5]).first]; });
  fail_anywhere<C>("index and write", basic, [](C& a, C&, auto& n) {
    a[element<C>(n[5]).first] = element<C>(n[5]).second;
    a[element<C>(n[0]).first] = element<C>(n[5]).second;
  });
  fail_anywhere<C>("try_emplace", strong, [](C& a, C&, auto& n) {
    a.try_emplace(element<C>(n[5]).first, element<C>(n[5]).second);
  });
  fail_anywhere<C>("insert_or_assign", strong, [](C& a, C&, auto& n) {
    a.insert_or_assign(element<C>(n[5]).first, element<C>(n[5]).second);
  });
  fail_anywhere<C>("assign", strong, [](C& a, C&, auto& n) {
    a.insert_or_assign(element<C>(n[0]).first, element<C>(n[5]).second);
  });
  fail_anywhere<C>("erase key", strong, [](C& a, C&, auto& n) { a.erase(element<C>(n[1]).first); });
  fail_anywhere<C>("at", strong, [](C& a, C&, auto& n) {
    try {
      a.at(element<C>(n[5]).first) = element<C>(n[0]).second;
      ADD_FAILURE();
    } catch (const std::out_of_range&) {
    }
  });
}

TEST(ContainerExceptions, Set) {
  using set = slamgc::rc_set<node, faulty_less, faulty_allocator<node*>>;
  fail_keyed_operations<set>();
  fail_anywhere<set>("erase key", strong, [](set& a, set&, auto& n) { a.erase(n[1].get()); });
}

TEST(ContainerExceptions, Map) {
  fail_map_operations<
      slamgc::rc_map<node, int, faulty_less, faulty_allocator<std::pair<node* const, int>>>>();
}

TEST(ContainerExceptions, ValueMap) {
  fail_map_operations<slamgc::rc_value_map<int, node, faulty_less,
                                           faulty_allocator<std::pair<const int, node*>>>>();
}

TEST(ContainerExceptions, UnorderedSet) {
  using set = slamgc::rc_unordered_set<node, faulty_hash, faulty_equal, faulty_allocator<node*>>;
  fail_keyed_operations<set>();
  fail_merge<set>();
  fail_anywhere<set>("erase key", strong, [](set& a, set&, auto& n) { a.erase(n[1].get()); });
  fail_anywhere<set>("rehash", strong, [](set& a, set& b, auto&) {
    a.rehash(100);
    b.reserve(100);
  });
}

TEST(ContainerExceptions, UnorderedMap) {
  using map = slamgc::rc_unordered_map<node, int, faulty_hash, faulty_equal,
                                       faulty_allocator<std::pair<node* const, int>>>;
  fail_map_operations<map>();
  fail_merge<map>();
}

/// A mapped value whose construction or assignment throws.
struct faulty_value {
  faulty_value() { fault::point(); }
  explicit faulty_value(int v) : value(v) { fault::point(); }
  faulty_value(const faulty_value& other) : value(other.value) { fault::point(); }
  faulty_value& operator=(const faulty_value& other) {
    fault::point();
    value = other.value;
    return *this;
  }
  int value = 0;
};

template <class C>
void fail_mapped_values() {
  for (int n = 0, failed = 1; failed != 0; ++n) {
    const std::vector<node_ptr> nodes = make_nodes(2);
    C c;
    c[nodes[0].get()].value = 7;
    fault::arm(n);
    try {
      c.insert_or_assign(nodes[0].get(), faulty_value(1));
      c[nodes[1].get()] = faulty_value(2);
      c.erase(nodes[1].get());
      c.insert({nodes[1].get(), faulty_value(3)});
      c.try_emplace(nodes[1].get(), 4);
      C copy(c);
      c = copy;
      failed = 0;
    } catch (const fault&) {
    }
    fault::disarm();
    ASSERT_TRUE(counts_are_exact(1, c)) << "fault " << n;
  }
}
TEST(ContainerExceptions, MappedValuesThatThrow) {
  fail_mapped_values<slamgc::rc_map<node, faulty_value>>();
  fail_mapped_values<slamgc::rc_unordered_map<node, faulty_value>>();
}

}  // namespace
