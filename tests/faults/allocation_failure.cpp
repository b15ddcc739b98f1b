// Every allocation of the library fails once, in a program of its own that replaces operator new:
// nothing is lost, and a later collect() reclaims everything.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <slamgc/diagnosis/audit.hpp>
#include <slamgc/slamgc.hpp>
#include <thread>
#include <utility>

#include "support/instances.hpp"

namespace {

thread_local int until_failure = -1;  // allocations that succeed; negative: all
thread_local bool only_one_fails = true;
thread_local int allocations = 0;

void* allocate(std::size_t size, std::size_t alignment) noexcept {
  ++allocations;
  if (until_failure == 0) {
    if (only_one_fails) until_failure = -1;
    return nullptr;
  }
  if (until_failure > 0) --until_failure;
  const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
  return alignment <= alignof(std::max_align_t) ? std::malloc(size == 0 ? 1 : size)
                                                : std::aligned_alloc(alignment, rounded);
}
void* allocate_or_throw(std::size_t size, std::size_t alignment) {
  if (void* const p = allocate(size, alignment)) return p;
  throw std::bad_alloc();
}

}  // namespace

// NOLINTBEGIN(misc-new-delete-overloads)
// Not inlined: g++ would see memory of operator new go to free().
__attribute__((noinline)) void* operator new(std::size_t n) { return allocate_or_throw(n, 1); }
__attribute__((noinline)) void* operator new(std::size_t n, std::align_val_t a) {
  return allocate_or_throw(n, static_cast<std::size_t>(a));
}
__attribute__((noinline)) void* operator new(std::size_t n, const std::nothrow_t&) noexcept {
  return allocate(n, 1);
}
__attribute__((noinline)) void* operator new(std::size_t n, std::align_val_t a,
                                             const std::nothrow_t&) noexcept {
  return allocate(n, static_cast<std::size_t>(a));
}
__attribute__((noinline)) void operator delete(void* p) noexcept { std::free(p); }
__attribute__((noinline)) void operator delete(void* p, std::size_t) noexcept { std::free(p); }
__attribute__((noinline)) void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
__attribute__((noinline)) void operator delete(void* p, std::size_t, std::align_val_t) noexcept {
  std::free(p);
}
// NOLINTEND(misc-new-delete-overloads)

namespace {

using slamgc::domain;
using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::mutator;
using outcome = slamgc::collected::outcome;

template <int Kind>
struct object
    : slamgc::rc_object<object<Kind>, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
      support::instances<object<Kind>> {
  slamgc::rc_slot<object> next;
};
using node = object<0>;
using other = object<1>;

// While it exists allocations of the thread fail: the n-th one from now, or all.
class failing {
 public:
  explicit failing(int nth) {
    only_one_fails = true;
    until_failure = nth;
  }
  struct all {};
  explicit failing(all) {
    only_one_fails = false;
    until_failure = 0;
  }
  ~failing() { until_failure = -1; }
  failing(const failing&) = delete;
  failing& operator=(const failing&) = delete;
  [[nodiscard]] bool happened() const { return until_failure == -1; }
};

// All that a program may do that allocates, once each.
void use(domain& d) {
  mutator m(d, "m");
  auto a = make_rc<node>();
  a->next = make_rc<node>();
  auto b = make_rc<other>();
  slamgc::retire(new other);
  a.reset();
  const mutator inner(d, "inner");
  b.reset();
  (void)d.collect();
  m.quiescent();
  (void)d.collect();
  EXPECT_FALSE(d.stats().types.empty());
}

TEST(AllocationFailure, AtEachAllocationOfTheLibraryLosesNothing) {
  bool failed = true;
  int thrown = 0;
  int n = 0;
  for (; failed; ++n) {
    ASSERT_LT(n, 1000);
    domain d;
    {
      const failing at(n);
      try {
        use(d);
      } catch (const std::bad_alloc&) {
        ++thrown;
      }
      failed = at.happened();
    }
    EXPECT_TRUE(d.stats().mutators.empty());
    EXPECT_EQ(d.collect().result, outcome::done);
    EXPECT_EQ(d.stats().total(&slamgc::type_stats::live), 0u);
    EXPECT_EQ(node::live() + other::live(), 0);
    use(d);  // it works as before
    EXPECT_EQ(d.collect().result, outcome::done);
    EXPECT_EQ(node::live() + other::live(), 0);
  }
  EXPECT_EQ(thrown, n - 1);  // the last round had no failure
  EXPECT_GE(n, 8);
}

TEST(AllocationFailure, ADomainThatFindsNoMemoryThrows) {
  const failing at(0);
  EXPECT_THROW(domain(), std::bad_alloc);
}

TEST(AllocationFailure, CollectGoesOnWithoutAnyMemory) {
  domain d;
  constexpr int many = 10000;
  {
    const mutator m(d, "m");
    for (int i = 0; i != many; ++i) slamgc::retire(new node);
    for (int i = 0; i != many; ++i) slamgc::retire(new other);
  }
  const failing everything{failing::all()};
  const auto did = d.collect();
  EXPECT_EQ(did.result, outcome::done);
  EXPECT_EQ(did.reclaimed, 2u * many);
}

TEST(AllocationFailure, SlicesKeepTheirBudgetWithoutAnyMemory) {
  domain d;
  constexpr std::size_t many = 3000;
  {
    const mutator m(d, "m");
    for (std::size_t i = 0; i != many; ++i) slamgc::retire(new node);
  }
  const failing everything{failing::all()};
  std::size_t reclaimed = 0;
  for (outcome now = outcome::partial; now != outcome::done;) {
    const auto did = d.collect(slamgc::budget{50});
    ASSERT_LE(did.reclaimed, 50u);
    reclaimed += did.reclaimed;
    now = did.result;
  }
  EXPECT_EQ(reclaimed, many);
}

TEST(AllocationFailure, MemoryThatComesAndGoesLosesNothing) {
  domain d;
  constexpr std::size_t many = 20000;
  {
    const mutator m(d, "m");
    for (std::size_t i = 0; i != many; ++i) slamgc::retire(new node);
  }
  std::size_t reclaimed = 0;
  for (int call = 0; reclaimed != many; ++call) {
    ASSERT_LT(call, 10000);
    if (call % 3 == 0) {
      reclaimed += d.collect(slamgc::budget{777}).reclaimed;
    } else {
      const failing at(call % 2);
      reclaimed += d.collect(slamgc::budget{777}).reclaimed;
    }
  }
  EXPECT_EQ(node::live(), 0);
}

TEST(AllocationFailure, WhatMustNotAllocateDoesNot) {
  domain d;
  mutator m(d, "m");
  auto kept = make_rc<node>();
  auto dropped = make_rc<node>();
  auto* const retired = new node;
  slamgc::atomic_rc<node> shared(make_rc<node>());
  const int before = allocations;
  {
    dropped.reset();
    slamgc::retire(retired);
    slamgc::retire(kept.get());
    kept = shared.load();
    shared.store(nullptr);
    const slamgc::borrow<node> b = kept.get();
    (void)b.get();
    m.quiescent();
    const mutator::offline_scope offline(m);
    (void)d.delayed();
    const mutator again(d, "of a record that is used again", {false, false});
  }
  const int first = allocations - before;
  EXPECT_LE(first, 1);  // a record
  { const mutator again(d, "of a record that is used again", {false, false}); }
  EXPECT_EQ(allocations - before, first);
  kept.reset();
  std::thread([&] { (void)d.collect(); }).join();
}

TEST(AllocationFailure, ShortLivedThreadsDoNotMakeMemoryGrow) {
  domain d;
  const auto live_a_little = [&] {
    const mutator m(d, "short");
    slamgc::retire(new node);
  };
  live_a_little();
  (void)d.collect();
  int in_threads = 0;
  for (int i = 0; i != 1000; ++i) {
    std::thread([&] {
      const int before = allocations;
      live_a_little();
      in_threads += allocations - before;
    }).join();
    if (i % 10 == 0) {
      const int before = allocations;
      (void)d.collect();
      EXPECT_EQ(allocations, before);
    }
  }
  EXPECT_EQ(in_threads, 1000);  // the objects
}

struct listed : slamgc::rc_object<listed, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  unsigned long report_id() const { return 1; }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("a reference with a long name", next);
  }
  slamgc::rc_slot<listed> next;
};

TEST(AllocationFailure, AReportThatFindsNoMemoryIsEmpty) {
  domain d;
  {
    const mutator m(d, "m");
    listed first;
    const slamgc::root root(d, "a root with a name that is allocated", first);
    for (int i = 0; i != 300; ++i) {
      auto* const p = new listed;
      p->next = first.next.get();
      first.next = p;
    }
    int n = 0;
    for (bool failed = true; failed; ++n) {
      ASSERT_LT(n, 10000);
      slamgc::heap_graph graph;
      {
        const failing at(n);
        graph = capture(d);
        failed = at.happened();
      }
      EXPECT_EQ(graph.result == slamgc::heap_graph::outcome::done, !failed);
      EXPECT_EQ(graph.nodes.empty(), failed);
      const slamgc::audit found(std::move(graph));
      EXPECT_EQ(found.agrees(), !failed) << found.words();
    }
    EXPECT_GT(n, 300);
    while (listed* const p = first.next) {
      slamgc::retire(p);
      first.next = p->next.get();
    }
  }
  EXPECT_EQ(d.drain(), slamgc::waited::done);
}

}  // namespace
