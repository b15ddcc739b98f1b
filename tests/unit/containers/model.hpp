/// @file
/// Random operations on counted containers and on standard ones side by side.
#pragma once

#include "support.hpp"

#include <algorithm>
#include <random>

namespace {

/// Three containers C and three standard ones that get the same operations. After each step both are
/// equal, and every count is the number of references in the three.
///
/// With an owner outside (`kept`), objects live from beginning to end. Without, the containers alone
/// hold them, and an object lives exactly as long as one of them refers to it.
template <class C>
class model {
 public:
  using plain = typename C::std_type;

  model(unsigned seed, bool kept) : random_(seed), kept_(kept) {
    if (kept) owner_ = make_nodes(12);
  }

  int below(std::size_t n) {
    return static_cast<int>(std::uniform_int_distribution<std::size_t>(0, n - 1)(random_));
  }
  bool chance(int percent) { return below(100) < percent; }

  /// A pointer to store: one of the living objects, a new one, or null.
  node* pick() {
    if (chance(5)) return nullptr;
    const std::set<node*>& all = node::living();
    if (!kept_ && (all.empty() || chance(all.size() < 12 ? 50 : 5))) {
      fresh_.push_back(slamgc::make_rc<node>(next_id_++));
      return fresh_.back().get();
    }
    return *std::next(all.begin(), below(all.size()));
  }
  typename assignable<typename C::value_type>::type pick_element() {
    return element<C>(pick(), below(8));
  }
  plain pick_plain() {
    plain made;
    for (int n = below(5); n != 0; --n) made.insert(made.end(), pick_element());
    return made;
  }

  // Chooses one or two containers for the step.
  void choose() {
    a_ = static_cast<std::size_t>(below(3));
    b_ = (a_ + 1 + static_cast<std::size_t>(below(2))) % 3;
  }
  C& counted() { return counted_[a_]; }
  std::size_t size() const { return plain_[a_].size(); }

  /// The same on a container of each sort.
  template <class F>
  void both(F f) {
    f(counted_[a_]);
    f(plain_[a_]);
  }
  /// The same on two different containers of each sort.
  template <class F>
  void both_pairs(F f) {
    f(counted_[a_], counted_[b_]);
    f(plain_[a_], plain_[b_]);
  }
  /// An operation of the counted container that has no equal in the standard one.
  template <class F, class G>
  void each(F on_counted, G on_plain) {
    on_counted(counted_[a_]);
    on_plain(plain_[a_]);
  }

  /// What every container can do. @p kind is a random number below `common_kinds`.
  void common_step(int kind) {
    switch (kind) {
      case 0:
        return both([](auto& c) { c.clear(); });
      case 1:
        return both_pairs([](auto& x, auto& y) { x = y; });
      case 2:
        return both_pairs([](auto& x, auto& y) {
          x = std::move(y);
          y.clear();
        });
      case 3:
        return both_pairs([](auto& x, auto& y) { x.swap(y); });
      case 4: {
        const plain p = pick_plain();
        return both([&](auto& c) { c = p; });
      }
      case 5: {
        const plain p = pick_plain();
        return both([&](auto& c) { c = plain(p); });
      }
      case 6:
        return both([](auto& c) {
          auto moved(std::move(c));
          auto copy(moved);
          c = std::move(copy);
        });
      case 7: {
        const auto e = pick_element(), f = pick_element();
        return both([&](auto& c) { c = {e, f}; });
      }
      default: {
        const plain p = pick_plain();
        const bool empties = chance(30);
        const auto change = [&](plain& c) {
          if (empties) c.clear();
          for (const auto& e : p) c.insert(c.begin(), e);
        };
        return each([&](C& c) { change(c.edit()); }, change);
      }
    }
  }
  static constexpr int common_kinds = 9;

  testing::AssertionResult holds() {
    fresh_.clear();
    tally references;
    for (std::size_t i = 0; i != 3; ++i) {
      if (!(counted_[i] == plain_[i])) return testing::AssertionFailure() << "contents differ";
      add_references(references, plain_[i]);
    }
    references.erase(nullptr);
    for (const node* p : node::living())
      if (p->use_count() != references[p] + (kept_ ? 1 : 0))
        return testing::AssertionFailure() << "count " << p->use_count() << " of object " << p->id
                                           << ", references " << references[p];
    if (!kept_ && references.size() != node::living().size())
      return testing::AssertionFailure() << "an object outlived its last reference";
    return testing::AssertionSuccess();
  }

 private:
  std::mt19937 random_;
  bool kept_;
  int next_id_ = 100;
  std::vector<node_ptr> owner_, fresh_;
  std::size_t a_ = 0, b_ = 1;
  C counted_[3];
  plain plain_[3];
};

/// Runs @p step, which changes a model at random, often, and with several seeds.
template <class C, class Step>
void run_model(Step step) {
  for (const bool kept : {true, false}) {
    for (unsigned seed = 1; seed != 9; ++seed) {
      const std::size_t before = node::living().size();
      {
        model<C> m(seed, kept);
        for (int i = 0; i != 500; ++i) {
          m.choose();
          step(m);
          ASSERT_TRUE(m.holds()) << "seed " << seed << ", kept " << kept << ", step " << i;
        }
      }
      ASSERT_EQ(node::living().size(), before) << "seed " << seed;
    }
  }
}

}  // namespace
