// What the checked flavour reports about mutators, borrowed pointers and collectors, in a program that
// replaces SLAMGC_ASSERT and goes on.
#undef SLAMGC_DEBUG
#include <string>
#include <vector>

namespace {

std::vector<std::string> reports;

template <class Misuse>
void record(const Misuse& m) {
  reports.emplace_back(m.what);
}

}  // namespace

#define SLAMGC_ASSERT(condition, found) ((condition) ? void() : ::record(found))

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <new>
#include <slamgc/slamgc.hpp>
#include <thread>

namespace {

// Its own, so that no other file of the program has these templates with another SLAMGC_ASSERT.
struct env : slamgc::std_env {};
using domain = slamgc::basic_domain<env>;
using mutator = slamgc::basic_mutator<env>;
using outcome = slamgc::collected::outcome;

struct node
    : slamgc::rc_object<node, slamgc::basic_fetch_add_counter<env>, slamgc::reclaim_deferred> {
  ~node() {
    if (at_end) at_end();
  }
  std::function<void()> at_end;
  slamgc::rc_slot<node, env> next;
  int value = 1;
};
using borrowed = slamgc::borrow<node, env>;
using pointer = slamgc::intrusive_rc<node>;

class DeferredMisuse : public ::testing::Test {
 protected:
  DeferredMisuse() { reports.clear(); }
  ~DeferredMisuse() override { EXPECT_TRUE(reports.empty()) << reports.front(); }

  static void expect(const std::string& what) {
    ASSERT_EQ(reports.size(), 1u);
    EXPECT_EQ(reports[0], what);
    reports.clear();
  }
  static void expect_stale() { expect("uses a borrowed pointer after a quiescent state"); }

  domain domain_;
};

TEST_F(DeferredMisuse, CorrectUseIsNotReported) {
  mutator m(domain_, "m");
  pointer p = slamgc::make_rc<node>();
  {
    borrowed b = p.get();
    borrowed c = b;
    b = c;
    EXPECT_EQ(b->value + (*c).value, 2);
    EXPECT_EQ(b.get(), p.get());
    node* const raw = c;
    EXPECT_EQ(raw, p.get());
    p.reset();
    EXPECT_TRUE(slamgc::retire(raw));
    EXPECT_EQ(b->value, 1);
  }
  m.quiescent();
  const mutator::offline_scope offline(m);
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
}

TEST_F(DeferredMisuse, SlotsAndElementsAreBorrowedAsTheyAre) {
  mutator m(domain_, "m");
  pointer p = slamgc::make_rc<node>();
  p->next = p.get();
  const borrowed of_slot = p->next;
  const slamgc::rc_vector<node> elements{p.get()};
  const borrowed of_element = elements[0];
  EXPECT_EQ(of_slot.get(), of_element.get());
  const slamgc::borrow<const node, env> as_const = p->next;
  EXPECT_EQ(as_const->value, 1);
  m.quiescent();
  EXPECT_EQ(of_slot.get(), p.get());
  expect_stale();
  p->next = nullptr;
}

TEST_F(DeferredMisuse, ABorrowedPointerEndsWithTheQuiescentState) {
  mutator m(domain_, "m");
  const pointer p = slamgc::make_rc<node>();
  const borrowed b = p.get();
  const borrowed copy = b;
  m.quiescent();
  EXPECT_EQ(b->value, 1);
  expect_stale();
  EXPECT_EQ((*copy).value, 1);  // a copy is as old as its original
  expect_stale();
  EXPECT_EQ(b.get(), p.get());
  expect_stale();
  borrowed again = p.get();
  EXPECT_EQ(again->value, 1);
  again = b;
  EXPECT_EQ(again->value, 1);
  expect_stale();
}

TEST_F(DeferredMisuse, ABorrowedPointerEndsWhenTheThreadGoesOffline) {
  mutator m(domain_, "m");
  const pointer p = slamgc::make_rc<node>();
  const borrowed b = p.get();
  {
    const mutator::offline_scope offline(m);
    EXPECT_EQ(b.get(), p.get());
    expect_stale();
    const borrowed early = p.get();
    expect("borrows on a thread that is no online mutator");
    (void)early;
  }
  EXPECT_EQ(b.get(), p.get());
  expect_stale();
}

TEST_F(DeferredMisuse, ABorrowedPointerBelongsToItsThreadAndItsMutator) {
  const pointer p = slamgc::make_rc<node>();
  {
    const mutator outer(domain_, "outer");
    const borrowed of_outer = p.get();
    borrowed of_inner;
    {
      const mutator inner(domain_, "inner");
      EXPECT_EQ(of_outer.get(), p.get());
      of_inner = p.get();
      EXPECT_EQ(of_inner.get(), p.get());
    }
    EXPECT_EQ(of_outer.get(), p.get());
    EXPECT_EQ(of_inner.get(), p.get());
    expect_stale();
    std::thread([&] {
      EXPECT_EQ(of_outer.get(), p.get());
      expect_stale();
    }).join();
  }
}

TEST_F(DeferredMisuse, NullMayBeBorrowedByAnyone) {
  const borrowed none;
  const borrowed null = nullptr;
  EXPECT_EQ(none.get(), nullptr);
  EXPECT_EQ(null.get(), nullptr);
  mutator m(domain_, "m");
  m.quiescent();
  EXPECT_FALSE(none);
}

TEST_F(DeferredMisuse, BorrowingWithoutAMutatorIsReported) {
  const pointer p = slamgc::make_rc<node>();
  const borrowed b = p.get();
  expect("borrows on a thread that is no online mutator");
  EXPECT_EQ(b.get(), p.get());
  expect_stale();
}

TEST_F(DeferredMisuse, QuiescentWhileOfflineIsReportedAndIgnored) {
  mutator m(domain_, "m", {false, false});
  m.quiescent();
  expect("is quiescent while offline");
  EXPECT_FALSE(m.is_online());
  EXPECT_FALSE(domain_.stats().mutators[0].online);
}

TEST_F(DeferredMisuse, CollectingOnARealTimeThreadIsReportedRefusedAndCounted) {
  mutator m(domain_, "tracking", {true, true});
  slamgc::retire(new node);
  EXPECT_EQ(domain_.collect().result, outcome::refused);
  expect("collects on a thread that never reclaims");
  {
    domain other;
    const mutator inner(other, "inner");
    EXPECT_EQ(other.collect().result, outcome::refused);  // it is the thread that never reclaims
    expect("collects on a thread that never reclaims");
    EXPECT_EQ(other.stats().refused_collects, 1u);
    const mutator::offline_scope offline(m);
    EXPECT_NE(other.collect().result, outcome::refused);
  }
  EXPECT_EQ(domain_.stats().refused_collects, 1u);
  EXPECT_EQ(domain_.stats().total(&slamgc::type_stats::live), 1u);
  const mutator::offline_scope offline(m);
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
}

TEST_F(DeferredMisuse, ARoamingMutatorOnTwoThreadsIsReported) {
  mutator m(domain_, "m", {false, false, true});
  const mutator::online_scope here(m);
  std::thread([&] { const mutator::online_scope there(m); }).join();
  expect("uses a mutator on two threads");
}

TEST_F(DeferredMisuse, AMutatorThatEndsOnAnotherThreadIsReported) {
  std::thread([this] {  // of its own: it is not fit for use afterwards
    auto here = std::make_unique<mutator>(domain_, "here");
    std::thread([&here] { here.reset(); }).join();
    expect("ends a mutator on another thread than its own");
  })
      .join();
  EXPECT_TRUE(domain_.stats().mutators.empty());
}

TEST_F(DeferredMisuse, ADomainThatEndsWhileItIsCollectedIsReported) {
  auto owner = std::make_unique<domain>();
  mutator m(*owner, "outlives the domain", {false, false});
  {
    const mutator::online_scope online(m);
    auto* const n = new node;
    n->at_end = [&owner] { owner.reset(); };
    slamgc::retire(n);
  }
  domain* const collected = owner.get();
  testing::internal::CaptureStderr();  // the object whose destructor runs still exists
  (void)collected->collect();
  (void)testing::internal::GetCapturedStderr();
  expect("ends a domain that is being collected");
}

TEST_F(DeferredMisuse, RetiringAnObjectOfAnotherDomainIsReported) {
  domain other;
  const mutator m(domain_, "m");
  node* n = nullptr;
  {
    const mutator there(other, "there");
    n = new node;
  }
  slamgc::retire(n);
  expect("retires an object of another domain than the thread's");
  EXPECT_EQ(other.collect().reclaimed, 1u);
}

TEST_F(DeferredMisuse, ADestructorMayRetireWhateverTheCollectingThreadIs) {
  domain other;
  const mutator m(other, "of another domain");
  {
    const mutator here(domain_, "here");
    auto* const first = new node;
    auto* const second = new node;
    first->at_end = [second] { EXPECT_TRUE(slamgc::retire(second)); };
    slamgc::retire(first);
  }
  EXPECT_EQ(domain_.collect().reclaimed, 2u);
}

TEST_F(DeferredMisuse, ReadingAnAtomicWithoutAMutatorIsReported) {
  slamgc::atomic_rc<node, env> shared(slamgc::make_rc<node>());
  const pointer p = shared.load();
  expect("reads an atomic_rc on a thread that is no online mutator");
  node* expected = p.get();
  EXPECT_TRUE(shared.compare_exchange_strong(expected, nullptr));
  expect("reads an atomic_rc on a thread that is no online mutator");
  shared.store(p);  // any thread may
  EXPECT_EQ(shared.exchange(nullptr), p);
}

TEST_F(DeferredMisuse, ADropWithoutAReferenceIsReportedAndUndone) {
  const mutator m(domain_, "m");
  const node n;
  intrusive_ptr_release(&n);
  expect("removes a reference that was never counted");
  EXPECT_EQ(n.state().bits, 0u);
}

TEST_F(DeferredMisuse, DeletingAnObjectThatACollectorHoldsIsReported) {
  // Neither the domain nor the memory ends: the table still has the pointer.
  static domain& forever = *new domain;
  alignas(node) static unsigned char memory[sizeof(node)];
  const mutator m(forever, "m");
  auto* const n = new (memory) node;
  pointer(n).reset();
  n->~node();
  expect("deletes an object that a collector holds");
}

TEST_F(DeferredMisuse, AReferenceToAnObjectInItsDestructorIsReported) {
  const mutator m(domain_, "m", {false, false});
  auto* const n = new node;
  n->at_end = [n] {
    pointer self(n);
    expect("refers to an object that is being destroyed");
  };
  slamgc::retire(n);
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
}

}  // namespace
