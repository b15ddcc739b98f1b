/// @file
/// Lets operations on counted containers fail wherever they can.
#pragma once

#include "support.hpp"

#include <string>

namespace {

enum class guarantee {
  strong,  ///< If it throws, nothing has changed.
  basic    ///< If it throws, counts are exact.
};

/// Runs `operation(a, b, nodes)` again and again: with an allocation, comparison, hash or iterator
/// that fails at the first opportunity, at the second, and so on, until it succeeds.
///
/// `a` holds the objects 0 to 2 and `b` 2 to 4; the objects 5 to 29 are in neither.
template <class C, class Operation>
void fail_anywhere(const char* name, guarantee promised, Operation operation) {
  SCOPED_TRACE(name);
  for (int n = 0, failed = 1; failed != 0; ++n) {
    SCOPED_TRACE("fault " + std::to_string(n));
    const std::vector<node_ptr> nodes = make_nodes(30);
    C a, b;  // copies, so that a vector has no room left
    a = filled<C>({nodes[0], nodes[1], nodes[2]}).raw();
    b = filled<C>({nodes[2], nodes[3], nodes[4]}).raw();
    const typename C::std_type a_before = a, b_before = b;
    fault::arm(n);
    try {
      operation(a, b, nodes);
      failed = 0;
    } catch (const fault&) {
    }
    fault::disarm();
    ASSERT_TRUE(counts_are_exact(1, a, b));
    if (failed != 0 && promised == guarantee::strong) {
      ASSERT_TRUE(a == a_before && b == b_before);
    }
    ASSERT_LT(n, 1000);
  }
}

/// What all containers can do.
template <class C>
void fail_common_operations() {
  using plain = typename C::std_type;
  constexpr guarantee strong = guarantee::strong, basic = guarantee::basic;
  fail_anywhere<C>("copy", strong, [](C& a, C& b, auto&) { C c(a), d(b); });
  fail_anywhere<C>("move", strong, [](C& a, C& b, auto&) {
    C c(std::move(a));
    a = std::move(c);
    a.swap(b);
    a.swap(b);
  });
  fail_anywhere<C>("from plain", strong, [](C& a, C&, auto&) {
    plain p(a.raw());
    C c(p), d(std::move(p));
  });
  fail_anywhere<C>("from list", strong, [](C&, C&, auto& n) {
    C c{element<C>(n[0]), element<C>(n[5]), element<C>(n[0])};
  });
  fail_anywhere<C>("from range", strong,
                   [](C& a, C&, auto&) { C c(faulty(a.begin()), faulty(a.end())); });
  fail_anywhere<C>("assign", strong, [](C& a, C& b, auto&) { a = b; });
  fail_anywhere<C>("move assign", strong, [](C& a, C& b, auto&) { a = std::move(b); });
  fail_anywhere<C>("assign plain", strong, [](C& a, C& b, auto&) { a = b.raw(); });
  fail_anywhere<C>("assign temporary", strong, [](C& a, C& b, auto&) { a = plain(b); });
  fail_anywhere<C>("assign list", strong, [](C& a, C&, auto& n) {
    a = {element<C>(n[2]), element<C>(n[5]), element<C>(n[0]), element<C>(n[3])};
  });
  fail_anywhere<C>("insert", strong,
                   [](C& a, C&, auto& n) { a.insert(a.begin(), element<C>(n[5])); });
  fail_anywhere<C>("emplace", basic, [](C& a, C& b, auto& n) {
    auto made = element<C>(n[5]);
    b.insert(b.end(), made);
    a.insert(a.end(), std::move(made));
  });
  fail_anywhere<C>("erase", strong, [](C& a, C&, auto&) { a.erase(a.begin()); });
  fail_anywhere<C>("erase range", basic,
                   [](C& a, C&, auto&) { a.erase(std::next(a.begin()), a.end()); });
  fail_anywhere<C>("clear", strong, [](C& a, C&, auto&) { a.clear(); });
  fail_anywhere<C>("edit", strong, [](C& a, C&, auto&) { a.edit()->clear(); });
  fail_anywhere<C>("throw in edit", basic, [](C& a, C& b, auto& n) {
    const auto e = a.edit();
    e->erase(e->begin());
    e->insert(e->end(), element<C>(n[5]));
    const auto f = b.edit();
    f->insert(f->end(), element<C>(n[0]));
    fault::point();
    e->clear();
  });
}

}  // namespace
