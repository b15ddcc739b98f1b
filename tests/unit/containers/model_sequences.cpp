// rc_vector and rc_list against std::vector and std::list under random operations.
#include "model.hpp"

namespace {

/// What both sequences can do.
template <class C>
bool sequence_step(model<C>& m, int kind) {
  const int i = m.below(m.size() + 1);
  const int j = m.below(m.size() + 1);
  const auto n = static_cast<std::size_t>(m.below(5));
  node* const p = m.pick();
  switch (kind) {
    case 0:
      m.both([&](auto& c) { c.push_back(p); });
      break;
    case 1:
      m.both([&](auto& c) { c.insert(std::next(c.begin(), i), p); });
      break;
    case 2:
      m.both([&](auto& c) { c.insert(std::next(c.begin(), i), n, p); });
      break;
    case 3: {
      const auto plain = m.pick_plain();
      m.both([&](auto& c) { c.insert(std::next(c.begin(), i), plain.begin(), plain.end()); });
      break;
    }
    case 4:
      m.both([&](auto& c) { c.insert(std::next(c.begin(), i), {p, p}); });
      break;
    case 5:
      m.both([&](auto& c) { c.emplace(std::next(c.begin(), i), p); });
      break;
    case 6:
      m.both([&](auto& c) { c.emplace_back(p); });
      break;
    case 7:
      m.both([&](auto& c) {
        c.erase(std::next(c.begin(), std::min(i, j)), std::next(c.begin(), std::max(i, j)));
      });
      break;
    case 8:
      m.both([&](auto& c) { c.resize(n); });
      break;
    case 9:
      m.both([&](auto& c) { c.resize(n, p); });
      break;
    case 10:
      m.both([&](auto& c) { c.assign(n, p); });
      break;
    case 11:
      m.both([&](auto& c) { c.assign({p, p, p}); });
      break;
    case 12: {
      const auto plain = m.pick_plain();
      m.both([&](auto& c) { c.assign(plain.begin(), plain.end()); });
      break;
    }
    case 13:
      m.both_pairs([&](auto& x, auto& y) { x.insert(x.end(), y.begin(), y.end()); });
      break;
    case 14:
      if (m.size() != 0) m.both([&](auto& c) { c.pop_back(); });
      break;
    case 15:
      if (m.size() != 0) m.both([&](auto& c) { c.erase(std::next(c.begin(), i ? i - 1 : 0)); });
      break;
    default:
      return false;
  }
  return true;
}
constexpr int sequence_kinds = 16;

void vector_step(model<slamgc::rc_vector<node>>& m) {
  const int kind = m.below(sequence_kinds + 8 + static_cast<std::size_t>(m.common_kinds));
  if (sequence_step(m, kind)) return;
  if (kind >= sequence_kinds + 8) return m.common_step(kind - sequence_kinds - 8);
  node* const p = m.pick();
  if (m.size() == 0) return m.both([&](auto& c) { c.reserve(7); });
  const auto i = static_cast<std::size_t>(m.below(m.size()));
  const auto j = static_cast<std::size_t>(m.below(m.size()));
  switch (kind - sequence_kinds) {
    case 0:
      return m.both([&](auto& c) { c[i] = p; });
    case 1:
      return m.both([&](auto& c) { c[i] = c[j]; });
    case 2:
      return m.both([&](auto& c) { c.at(i) = nullptr; });
    case 3:
      return m.both([&](auto& c) { c.front() = c.back(); });
    case 4:
      return m.both([&](auto& c) { c.back() = p; });
    case 5:
      return m.each([&](auto& c) { swap(c[i], c[j]); }, [&](auto& c) { std::swap(c[i], c[j]); });
    case 6:
      return m.both([&](auto& c) { c.shrink_to_fit(); });
    default: {
      const auto change = [](auto& c) { std::sort(c.begin(), c.end(), std::greater<node*>()); };
      return m.each(
          [&](auto& c) {
            const auto scope = c.edit();
            change(*scope);
          },
          change);
    }
  }
}

void list_step(model<slamgc::rc_list<node>>& m) {
  const int kind = m.below(sequence_kinds + 14 + static_cast<std::size_t>(m.common_kinds));
  if (sequence_step(m, kind)) return;
  if (kind >= sequence_kinds + 14) return m.common_step(kind - sequence_kinds - 14);
  node* const p = m.pick();
  const int i = m.below(m.size() + 1);
  const std::less<const node*> less;
  switch (kind - sequence_kinds) {
    case 0:
      return m.both([&](auto& c) { c.push_front(p); });
    case 1:
      return m.both([&](auto& c) { c.emplace_front(p); });
    case 2:
      if (m.size() != 0) m.both([&](auto& c) { c.pop_front(); });
      return;
    case 3:
      if (m.size() == 0) return;
      return m.each([&](auto& c) { c.replace(std::next(c.begin(), i ? i - 1 : 0), p); },
                    [&](auto& c) { *std::next(c.begin(), i ? i - 1 : 0) = p; });
    case 4:
      return m.both_pairs([&](auto& x, auto& y) { x.splice(std::next(x.begin(), i), y); });
    case 5:
      return m.both_pairs([&](auto& x, auto& y) {
        if (!y.empty()) x.splice(std::next(x.begin(), i), y, y.begin());
      });
    case 6:
      return m.both_pairs([&](auto& x, auto& y) {
        if (!y.empty()) x.splice(x.begin(), y, std::next(y.begin()), y.end());
      });
    case 7:
      if (i == 0) return;
      return m.both([&](auto& c) { c.splice(c.begin(), c, std::next(c.begin(), i), c.end()); });
    case 8:
      return m.both([&](auto& c) { c.sort(less); });
    case 9:
      return m.both([](auto& c) { c.reverse(); });
    case 10:
      return m.both([](auto& c) { c.unique(); });
    case 11:
      return m.both([&](auto& c) { c.remove(p); });
    case 12: {
      // Chosen beforehand: the second list is changed when the objects may be gone.
      std::set<node*> chosen{nullptr};
      for (node* e : node::living())
        if (e->id % 3 == 0) chosen.insert(e);
      return m.both([&](auto& c) { c.remove_if([&](node* e) { return chosen.count(e) != 0; }); });
    }
    default:
      return m.both_pairs([&](auto& x, auto& y) {
        x.sort(less);
        y.sort(less);
        x.merge(y, less);
      });
  }
}

TEST(ContainerModel, Vector) { run_model<slamgc::rc_vector<node>>(vector_step); }
TEST(ContainerModel, List) { run_model<slamgc::rc_list<node>>(list_step); }

struct late_node
    : slamgc::rc_object<late_node, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};

// On a thread that is no mutator its references alone keep objects: not even for a moment may one be missing.
// 600: more places change than wait for their turn.
TEST(ContainerModel, AVectorOfDeferredObjectsIsAssigned) {
  const auto waiting = [] {
    std::uint64_t all_types = 0;
    for (const auto& type : slamgc::default_domain().stats().types) all_types += type.backlog;
    return all_types;
  };
  for (const std::size_t size : {5, 255, 256, 257, 600}) {
    SCOPED_TRACE(size);
    slamgc::rc_vector<late_node> counted;
    std::vector<late_node*> all;
    for (std::size_t i = 0; i != size; ++i) all.push_back(new late_node);
    counted = all;
    const std::uint64_t before = waiting();
    std::mt19937 random(1);
    for (std::size_t step = 0; step != 100; ++step) {
      std::vector<late_node*> next = all;
      std::shuffle(next.begin(), next.end(), random);
      next.resize(size + step % 9, nullptr);
      counted = next;
      ASSERT_EQ(counted.raw(), next);
      for (late_node* p : all) ASSERT_EQ(p->use_count(), 1u);
    }
    EXPECT_EQ(waiting(), before);  // none was queued at zero
    counted.clear();
    EXPECT_EQ(slamgc::default_domain().drain(), slamgc::waited::done);
  }
}

TEST(ContainerModel, AVectorIsAssignedWhereOnePlaceAloneChanges) {
  for (const std::size_t size : {1, 31, 32, 33, 64, 100}) {
    SCOPED_TRACE(size);
    const slamgc::intrusive_rc<late_node> old = slamgc::make_rc<late_node>(),
                                          other = slamgc::make_rc<late_node>();
    slamgc::rc_vector<late_node> counted(size, old.get());
    for (std::size_t i = 0; i != size; ++i) {
      std::vector<late_node*> next(size, old.get());
      next[i] = other.get();
      counted = next;
      ASSERT_EQ(counted.raw(), next);
      ASSERT_EQ(old->use_count(), size);
      ASSERT_EQ(other->use_count(), 2u);
    }
  }
  EXPECT_EQ(slamgc::default_domain().drain(), slamgc::waited::done);
}

}  // namespace
