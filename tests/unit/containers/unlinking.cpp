// A reference is unlinked before it is uncounted: seen from inside of each operation, by a counter policy
// that looks at the container whenever a count is about to fall.
#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <utility>

#include <slamgc/slamgc.hpp>

namespace {

/// Calls @p before_subtract first, with the word that is going to change.
struct watched_counter : slamgc::unsync_counter {
  static std::function<void(const storage&, std::uint64_t)>& before_subtract() {
    static std::function<void(const storage&, std::uint64_t)> function;
    return function;
  }
  static std::uint64_t subtract(storage& s, std::uint64_t delta) noexcept {
    if (before_subtract()) before_subtract()(s, delta);
    return slamgc::unsync_counter::subtract(s, delta);
  }
};

struct node : slamgc::rc_object<node, watched_counter> {
  explicit node(int i) : id(i) {}
  int id;
};

struct by_id {
  bool operator()(const node* a, const node* b) const { return a->id < b->id; }
};

node* pointer_in(node* element) { return element; }
node* pointer_in(const std::pair<node* const, int>& element) { return element.first; }
node* pointer_in(const std::pair<const int, node*>& element) { return element.second; }

template <class Value>
struct maker {
  static node* make(node* p) { return p; }
};
template <>
struct maker<std::pair<node* const, int>> {
  static std::pair<node* const, int> make(node* p) { return {p, 0}; }
};
template <>
struct maker<std::pair<const int, node*>> {
  static std::pair<const int, node*> make(node* p) { return {p->id, p}; }
};

template <class C>
class Unlinking : public ::testing::Test {
 protected:
  static typename C::value_type element(node* p) { return maker<typename C::value_type>::make(p); }
  static void add(C& c, node* p) { c.insert(c.end(), element(p)); }

  /// A container with the objects numbered from @p first on, held by it alone.
  static C filled(int n, int first = 0) {
    C made;
    for (int i = 0; i != n; ++i) add(made, new node(first + i));
    return made;
  }

  /// Checks each decrement in @p change.
  template <class F>
  static void watch(const C& c, F change) {
    int uncounted = 0;
    watched_counter::before_subtract() = [&](const watched_counter::storage& s,
                                             std::uint64_t delta) {
      if (delta != slamgc::state_word::count_unit) return;
      ++uncounted;
      std::uint32_t linked = 0;
      for (const auto& e : c) {
        const node* const p = pointer_in(e);  // null: a vector that is being cleared
        if (p != nullptr) linked += &slamgc::detail::access::header_of(*p).state == &s;
      }
      EXPECT_LT(linked, slamgc::state_word{s.word}.count());
    };
    change();
    watched_counter::before_subtract() = nullptr;
    EXPECT_GT(uncounted, 0);
  }
};

struct names {
  template <class C>
  static std::string GetName(int) {
    const std::string name = slamgc::detail::type_name<C>::get();
    const std::size_t begin = name.find("rc_");
    return name.substr(begin, name.find('<') - begin);
  }
};
using all =
    ::testing::Types<slamgc::rc_vector<node>, slamgc::rc_list<node>, slamgc::rc_set<node, by_id>,
                     slamgc::rc_map<node, int, by_id>, slamgc::rc_unordered_set<node>,
                     slamgc::rc_unordered_map<node, int>, slamgc::rc_value_map<int, node>>;
TYPED_TEST_SUITE(Unlinking, all, names);

TYPED_TEST(Unlinking, ComesFirstWhenElementsAreErased) {
  TypeParam c = this->filled(6);
  this->watch(c, [&] { c.erase(c.begin()); });
  this->watch(c, [&] { c.erase(std::next(c.begin()), c.end()); });
  this->watch(c, [&] { c.clear(); });
}

TYPED_TEST(Unlinking, ComesFirstInAssignments) {
  TypeParam c = this->filled(3);
  const TypeParam other = this->filled(2, 10);
  this->watch(c, [&] { c = other; });
  this->watch(c, [&] { c = this->filled(4, 20); });
  this->watch(c, [&] { c = other.raw(); });
  this->watch(c, [&] { c = typename TypeParam::std_type(); });
}

TYPED_TEST(Unlinking, ComesFirstInDestruction) {
  alignas(TypeParam) unsigned char place[sizeof(TypeParam)];
  auto* const c = ::new (place) TypeParam(this->filled(3));
  this->watch(*c, [&] { c->~TypeParam(); });
}

TYPED_TEST(Unlinking, ComesFirstInAnEditScope) {
  TypeParam c = this->filled(3);
  this->watch(c, [&] { c.edit()->clear(); });
}

using UnlinkingInVector = Unlinking<slamgc::rc_vector<node>>;
TEST_F(UnlinkingInVector, ComesFirst) {
  slamgc::rc_vector<node> v = filled(6);
  watch(v, [&] { v.pop_back(); });
  watch(v, [&] { v.resize(3); });
  watch(v, [&] { v[0] = new node(20); });
  watch(v, [&] { v = {v[2], v[0], v[0]}; });
  watch(v, [&] { swap(v[0], v[1]); });
}

using UnlinkingInList = Unlinking<slamgc::rc_list<node>>;
TEST_F(UnlinkingInList, ComesFirst) {
  slamgc::rc_list<node> l = filled(9);
  watch(l, [&] { l.remove_if([](node* p) { return p->id < 2; }); });
  watch(l, [&] { l.resize(4); });
  watch(l, [&] { l.pop_front(); });
  watch(l, [&] { l.pop_back(); });
  watch(l, [&] { l.replace(l.begin(), new node(20)); });
  l.push_front(l.front());
  watch(l, [&] { l.unique(); });
}

}  // namespace
