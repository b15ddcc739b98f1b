// Allocations, iterators and comparisons that throw in rc_vector and rc_list.
#include "exceptions.hpp"

namespace {

constexpr guarantee strong = guarantee::strong;
constexpr guarantee basic = guarantee::basic;

/// What both sequences can do; all of it promises the strong guarantee.
template <class C>
void fail_sequence_operations() {
  fail_anywhere<C>("push_back", strong, [](C& a, C&, auto& n) { a.push_back(n[5].get()); });
  fail_anywhere<C>("emplace_back", strong, [](C& a, C&, auto& n) { a.emplace_back(n[5].get()); });
  fail_anywhere<C>("insert n", strong,
                   [](C& a, C&, auto& n) { a.insert(std::next(a.begin()), 40, n[5].get()); });
  fail_anywhere<C>("insert range", strong, [](C& a, C& b, auto&) {
    a.insert(std::next(a.begin()), faulty(b.begin()), faulty(b.end()));
  });
  fail_anywhere<C>("insert list", strong, [](C& a, C&, auto& n) {
    a.insert(a.begin(), {n[0].get(), n[5].get()});
  });
  fail_anywhere<C>("grow", strong, [](C& a, C&, auto& n) { a.resize(9, n[5].get()); });
  fail_anywhere<C>("shrink", strong, [](C& a, C&, auto&) { a.resize(1); });
  fail_anywhere<C>("assign n", strong, [](C& a, C&, auto& n) { a.assign(9, n[5].get()); });
  fail_anywhere<C>("assign range", strong,
                   [](C& a, C& b, auto&) { a.assign(faulty(b.begin()), faulty(b.end())); });
  fail_anywhere<C>("assign list", strong, [](C& a, C&, auto& n) {
    a.assign({n[5].get(), n[0].get()});
  });
  fail_anywhere<C>("pop_back", strong, [](C& a, C&, auto&) { a.pop_back(); });
}

TEST(ContainerExceptions, Vector) {
  using vector = slamgc::rc_vector<node, faulty_allocator<node*>>;
  fail_common_operations<vector>();
  fail_sequence_operations<vector>();
  fail_anywhere<vector>("reserve", strong, [](vector& a, vector&, auto&) { a.reserve(99); });
  fail_anywhere<vector>("write", strong, [](vector& a, vector& b, auto& n) {
    a[0] = n[5].get();
    swap(a[1], b[1]);
    a.shrink_to_fit();
  });
  fail_anywhere<vector>("at", strong, [](vector& a, vector&, auto& n) {
    EXPECT_THROW(a.at(3) = n[5].get(), std::out_of_range);
  });
}

TEST(ContainerExceptions, List) {
  using list = slamgc::rc_list<node, faulty_allocator<node*>>;
  fail_common_operations<list>();
  fail_sequence_operations<list>();
  fail_anywhere<list>("push_front", strong,
                      [](list& a, list&, auto& n) { a.push_front(n[5].get()); });
  fail_anywhere<list>("splice", strong, [](list& a, list& b, auto&) {
    a.splice(a.begin(), b, b.begin());
    a.splice(a.begin(), b);
  });
  fail_anywhere<list>("sort", basic, [](list& a, list&, auto&) { a.sort(faulty_less()); });
  fail_anywhere<list>("merge", basic, [](list& a, list& b, auto&) { a.merge(b, faulty_less()); });
  fail_anywhere<list>("remove_if", basic, [](list& a, list&, auto&) {
    a.remove_if([](node* p) { return (fault::point(), p->id < 2); });
  });
  fail_anywhere<list>("unique", basic, [](list& a, list&, auto& n) {
    a.push_back(n[2].get());
    a.unique(faulty_equal());
  });
}

}  // namespace
