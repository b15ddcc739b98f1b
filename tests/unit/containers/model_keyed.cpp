// Counted sets and maps against the standard ones under random operations.
#include "model.hpp"

namespace {

/// What all sets and maps can do.
template <class C>
bool keyed_step(model<C>& m, int kind) {
  const auto e = m.pick_element();
  const auto key = key_in(e);
  switch (kind) {
    case 0:
    case 1:
      m.both([&](auto& c) { c.insert(e); });
      break;
    case 2:
      m.both([&](auto& c) { c.insert(c.find(key), e); });
      break;
    case 3:
      m.both([&](auto& c) { c.emplace(e); });
      break;
    case 4:
      m.both([&](auto& c) { c.emplace_hint(c.end(), e); });
      break;
    case 5: {
      const auto plain = m.pick_plain();
      m.both([&](auto& c) { c.insert(plain.begin(), plain.end()); });
      break;
    }
    case 6:
      m.both_pairs([](auto& x, auto& y) { x.insert(y.begin(), y.end()); });
      break;
    case 7:
      m.both([&](auto& c) { c.insert({e, e}); });
      break;
    case 8: {
      std::size_t erased[2] = {}, *n = erased;
      m.both([&](auto& c) { *n++ = c.erase(key); });
      EXPECT_EQ(erased[0], erased[1]);
      break;
    }
    case 9:
      m.both([&](auto& c) {
        const auto found = c.find(key);
        if (found != c.end()) c.erase(found);
      });
      break;
    case 10:
      m.both([&](auto& c) {
        const auto range = c.equal_range(key);
        c.erase(range.first, range.second);
      });
      break;
    case 11:
      m.both_pairs([](auto& x, auto& y) { x.merge(y); });
      break;
    default:
      return false;
  }
  return true;
}
constexpr int keyed_kinds = 12;

/// What the maps can do.
template <class C>
void map_step(model<C>& m, int kind) {
  const auto e = m.pick_element();
  switch (kind) {
    case 0:
      return m.both([&](auto& c) { c[e.first] = e.second; });
    case 1:
      return m.both([&](auto& c) { c.try_emplace(e.first, e.second); });
    case 2:
      return m.both([&](auto& c) { c.insert_or_assign(e.first, e.second); });
    case 3:
      return m.both([&](auto& c) { c.try_emplace(e.first); });
    default:
      return m.both([&](auto& c) {
        if (c.count(e.first) != 0) c.at(e.first) = e.second;
      });
  }
}

template <class C>
void set_step(model<C>& m) {
  const int kind = m.below(keyed_kinds + static_cast<std::size_t>(m.common_kinds));
  if (!keyed_step(m, kind)) m.common_step(kind - keyed_kinds);
}
template <class C>
void set_or_map_step(model<C>& m) {
  if (m.chance(30))
    map_step(m, m.below(5));
  else
    set_step(m);
}
template <class C, class Step>
void hashed_step(model<C>& m, Step step) {
  if (m.chance(95)) return step(m);
  const auto n = static_cast<std::size_t>(m.below(40));
  if (m.chance(50))
    m.both([&](auto& c) { c.rehash(n); });
  else
    m.both([&](auto& c) { c.reserve(n); });
}

TEST(ContainerModel, Set) { run_model<slamgc::rc_set<node>>(set_step<slamgc::rc_set<node>>); }
TEST(ContainerModel, Map) {
  using map = slamgc::rc_map<node, int>;
  run_model<map>(set_or_map_step<map>);
}
TEST(ContainerModel, ValueMap) {
  using map = slamgc::rc_value_map<int, node>;
  run_model<map>(set_or_map_step<map>);
}
TEST(ContainerModel, UnorderedSet) {
  using set = slamgc::rc_unordered_set<node>;
  run_model<set>([](model<set>& m) { hashed_step(m, set_step<set>); });
}
TEST(ContainerModel, UnorderedMap) {
  using map = slamgc::rc_unordered_map<node, int>;
  run_model<map>([](model<map>& m) { hashed_step(m, set_or_map_step<map>); });
}

}  // namespace
