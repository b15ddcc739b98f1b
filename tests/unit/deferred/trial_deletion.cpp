// Cycles: what is retired and out of reach is reclaimed, whatever refers to it; what is in reach is not.
#include <gtest/gtest.h>

#include <cstdint>
#include <mutex>
#include <random>
#include <set>
#include <slamgc/slamgc.hpp>
#include <vector>

#include "support/policies.hpp"

namespace {

using slamgc::collected;
using slamgc::waited;

template <class Policy>
struct node : slamgc::rc_object<node<Policy>, Policy, slamgc::reclaim_retired> {
  node() { ++alive; }
  ~node() { --alive; }

  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("slot", slot);
    v.edge("atomic", atomic);
    v.edge("vector", vector);
    v.edge("list", list);
    v.edge("set", set);
    v.edge("map", map);
    v.edge("value_map", value_map);
    v.edge("unordered_set", unordered_set);
    v.edge("unordered_map", unordered_map);
  }

  // The i-th kind of edge, from here to @p target.
  void refer(unsigned i, node* target) {
    switch (i % 9) {
      case 0:
        slot = target;
        break;
      case 1:
        atomic = slamgc::intrusive_rc<node>(target);
        break;
      case 2:
        vector.push_back(target);
        break;
      case 3:
        list.push_back(target);
        break;
      case 4:
        set.insert(target);
        break;
      case 5:
        map[target] = 1;
        break;
      case 6:
        value_map.insert_or_assign(static_cast<int>(i), target);
        break;
      case 7:
        unordered_set.insert(target);
        break;
      default:
        unordered_map[target] = 1;
        break;
    }
  }
  std::vector<node*> targets() const {
    std::vector<node*> all(vector.begin(), vector.end());
    if (slot) all.push_back(slot);
    if (atomic.get() != nullptr) all.push_back(atomic.get());
    all.insert(all.end(), list.begin(), list.end());
    all.insert(all.end(), set.begin(), set.end());
    all.insert(all.end(), unordered_set.begin(), unordered_set.end());
    for (const auto& [key, value] : map) all.push_back(key);
    for (const auto& [key, value] : unordered_map) all.push_back(key);
    for (const auto& [key, value] : value_map) all.push_back(value);
    return all;
  }

  slamgc::rc_slot<node> slot;
  slamgc::atomic_rc<node> atomic;
  slamgc::rc_vector<node> vector;
  slamgc::rc_list<node> list;
  slamgc::rc_set<node> set;
  slamgc::rc_map<node, int> map;
  slamgc::rc_value_map<int, node> value_map;
  slamgc::rc_unordered_set<node> unordered_set;
  slamgc::rc_unordered_map<node, int> unordered_map;
  static inline long alive = 0;
};

template <class Policy>
class TrialDeletion : public ::testing::Test {
 protected:
  using object = node<Policy>;
  using online = slamgc::mutator::online_scope;

  void TearDown() override { EXPECT_EQ(object::alive, 0); }

  slamgc::domain domain_;
  slamgc::mutator me_{domain_, "test", {false, false}};
};
using policies = ::testing::Types<slamgc::fetch_add_counter, slamgc::cas_counter>;
TYPED_TEST_SUITE(TrialDeletion, policies, );

TYPED_TEST(TrialDeletion, AnObjectThatRefersToItself) {
  using node_type = typename TestFixture::object;
  {
    const typename TestFixture::online scope(this->me_);
    auto* const p = new node_type;
    for (unsigned kind = 0; kind != 9; ++kind) p->refer(kind, p);
    slamgc::retire(p);
  }
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(node_type::alive, 0);
}

TYPED_TEST(TrialDeletion, ARingOutlivesItsLastReferenceFromOutsideAndNoLonger) {
  using node_type = typename TestFixture::object;
  slamgc::intrusive_rc<node_type> root;
  {
    const typename TestFixture::online scope(this->me_);
    std::vector<node_type*> ring;
    for (int i = 0; i != 100; ++i) ring.push_back(new node_type);
    for (unsigned i = 0; i != 100; ++i) ring[i]->refer(i, ring[(i + 1) % 100]);
    root = ring[17];
    for (auto* p : ring) EXPECT_TRUE(slamgc::retire(p));
  }
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(node_type::alive, 100);
  EXPECT_EQ(this->domain_.stats().types.front().stuck, 100U);
  root.reset();
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(node_type::alive, 0);
  EXPECT_EQ(this->domain_.stats().types.front().stuck, 0U);
}

TYPED_TEST(TrialDeletion, WhatIsNotRetiredKeepsWhatItRefersTo) {
  using node_type = typename TestFixture::object;
  node_type* kept = nullptr;
  {
    const typename TestFixture::online scope(this->me_);
    kept = new node_type;
    auto* const a = new node_type;
    auto* const b = new node_type;
    a->slot = b;
    b->slot = a;
    kept->slot = a;
    slamgc::retire(a);
    slamgc::retire(b);
  }
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(node_type::alive, 3);
  kept->slot = nullptr;
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(node_type::alive, 1);
  slamgc::retire(kept);
  ASSERT_EQ(this->domain_.drain(), waited::done);
}

TYPED_TEST(TrialDeletion, ARingWaitsForAMutatorThatMayHaveBorrowedIt) {
  using node_type = typename TestFixture::object;
  slamgc::mutator reader(this->domain_, "reader");
  {
    const typename TestFixture::online scope(this->me_);
    auto* const a = new node_type;
    auto* const b = new node_type;
    a->slot = b;
    b->slot = a;
    slamgc::retire(a);
    slamgc::retire(b);
  }
  for (int i = 0; i != 5; ++i)
    EXPECT_EQ(this->domain_.collect().result, collected::outcome::waiting);
  EXPECT_EQ(node_type::alive, 2);
  reader.quiescent();
  (void)this->domain_.collect();
  EXPECT_EQ(node_type::alive, 0);
}

TYPED_TEST(TrialDeletion, AReferenceThatAppearsDuringTheGracePeriodSavesWhatItReaches) {
  using node_type = typename TestFixture::object;
  slamgc::mutator reader(this->domain_, "reader");
  slamgc::rc_slot<node_type> root;
  node_type* a = nullptr;
  node_type* lone = nullptr;
  {
    const typename TestFixture::online scope(this->me_);
    a = new node_type;
    auto* const b = new node_type;
    auto* const c = new node_type;
    a->slot = b;
    b->slot = c;
    c->slot = a;
    lone = new node_type;
    lone->slot = lone;
    for (auto* p : {a, b, c, lone}) slamgc::retire(p);
  }
  EXPECT_EQ(this->domain_.collect().result, collected::outcome::waiting);
  root = a;  // the reader had borrowed it
  reader.quiescent();
  (void)this->domain_.collect();
  EXPECT_EQ(node_type::alive, 3) << "only the lone one may go";
  root = nullptr;
  {
    const slamgc::mutator::offline_scope offline(reader);
    ASSERT_EQ(this->domain_.drain(), waited::done);
  }
}

// Whatever a call with a small budget had begun when the last reference went: drain() does not stop there.
TYPED_TEST(TrialDeletion, ARootThatGoesBetweenTwoSlices) {
  using node_type = typename TestFixture::object;
  for (int slices = 0; slices != 40; ++slices) {
    slamgc::intrusive_rc<node_type> root;
    {
      const typename TestFixture::online scope(this->me_);
      root = new node_type;
      auto* const other = new node_type;
      root->slot = other;
      other->slot = root.get();
      slamgc::retire(root.get());
      slamgc::retire(other);
    }
    for (int i = 0; i != slices; ++i) (void)this->domain_.collect({1});
    root.reset();
    ASSERT_EQ(this->domain_.drain(), waited::done);
    ASSERT_EQ(node_type::alive, 0) << slices;
  }
}

// A wrong description keeps objects; it frees none that is in use. (Their count says what the walk must find.)
template <int Times>
struct misdescribed
    : slamgc::rc_object<misdescribed<Times>, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  template <class Visitor>
  void edges(Visitor& v) {
    for (int i = 0; i != Times; ++i) v.edge("next", next);
  }
  slamgc::rc_slot<misdescribed> next;
};
template <int Times>
std::uint64_t left_of_a_ring() {
  slamgc::domain domain;
  std::uint64_t left = 0;
  {
    slamgc::mutator me(domain, "test", {false, false});
    misdescribed<Times>* first = nullptr;
    {
      const slamgc::mutator::online_scope scope(me);
      first = new misdescribed<Times>;
      first->next = new misdescribed<Times>;
      first->next->next = first;
      slamgc::retire(first->next.get());
      slamgc::retire(first);
    }
    EXPECT_EQ(domain.drain(), waited::done);
    left = domain.stats().types.front().live;
    if (left != 0) first->next->next = nullptr;  // the program breaks the ring
    EXPECT_EQ(domain.drain(), waited::done);
    EXPECT_EQ(domain.stats().types.front().live, 0U);
  }
  return left;
}
TEST(TrialDeletionOfMisdescribed, AMemberThatIsLeftOutOrNamedTwiceKeepsARing) {
  EXPECT_EQ(left_of_a_ring<0>(), 2U);
  EXPECT_EQ(left_of_a_ring<1>(), 0U);
  EXPECT_EQ(left_of_a_ring<2>(), 2U);
}

// Random graphs, with retired and other nodes, against reachability on a plain graph; in budgets of a few objects.
TYPED_TEST(TrialDeletion, WhatLivesIsWhatCanBeReached) {
  using node_type = typename TestFixture::object;
  std::mt19937 random(4711);
  for (int round = 0; round != 200; ++round) {
    SCOPED_TRACE(round);
    std::vector<node_type*> all;
    std::set<node_type*> retired;
    slamgc::rc_vector<node_type> roots;
    {
      const typename TestFixture::online scope(this->me_);
      for (int i = 0; i != 40; ++i) all.push_back(new node_type);
      for (unsigned i = 0; i != 60; ++i)
        all[random() % 40]->refer(static_cast<unsigned>(random() % 9), all[random() % 40]);
      for (int i = 0; i != 3; ++i) roots.push_back(all[random() % 40]);
      for (auto* p : all)
        if (random() % 5 != 0) {
          slamgc::retire(p);
          retired.insert(p);
        }
    }
    std::set<node_type*> reached;
    std::vector<node_type*> next(roots.begin(), roots.end());
    for (auto* p : all)
      if (retired.count(p) == 0) next.push_back(p);
    while (!next.empty()) {
      auto* const p = next.back();
      next.pop_back();
      if (!reached.insert(p).second) continue;
      for (auto* q : p->targets()) next.push_back(q);
    }
    while (this->domain_.collect({1 + random() % 9}).result != collected::outcome::done) {
    }
    ASSERT_EQ(node_type::alive, static_cast<long>(reached.size()));
    for (auto* p : all)
      if (retired.count(p) == 0) slamgc::retire(p);
    roots.clear();
    ASSERT_EQ(this->domain_.drain(), waited::done);
    ASSERT_EQ(node_type::alive, 0);
  }
}

// A large ring needs no stack; the slices keep their budget.
TYPED_TEST(TrialDeletion, ALargeRingInSlices) {
  using node_type = typename TestFixture::object;
  constexpr int size = 100000;
  {
    const typename TestFixture::online scope(this->me_);
    auto* const first = new node_type;
    auto* last = first;
    for (int i = 1; i != size; ++i) {
      auto* const p = new node_type;
      last->slot = p;
      slamgc::retire(last);
      last = p;
    }
    last->slot = first;
    slamgc::retire(last);
  }
  collected did;
  do {
    did = this->domain_.collect({1000});
    ASSERT_LE(did.reclaimed, 1000U);
  } while (did.result != collected::outcome::done);
  EXPECT_EQ(node_type::alive, 0);
}

}  // namespace
