// Every allocation of the library fails once, in a program of its own that replaces operator new:
// nothing is lost, and a later collect() reclaims everything.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <random>
#include <slamgc/diagnosis/audit.hpp>
#include <slamgc/slamgc.hpp>
#include <thread>
#include <utility>

#include "support/instances.hpp"
#include "unit/redundancy/world.hpp"

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

// Walks allocate by calloc() and realloc(), which sanitizers want for themselves, and of which a program that is linked statically,
// as that of the aarch64 lane, cannot have two.
#if defined(__has_feature)
#define SANITIZED (__has_feature(address_sanitizer) || __has_feature(thread_sanitizer))
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define SANITIZED 1
#else
#define SANITIZED 0
#endif
#if defined(__GLIBC__) && defined(__x86_64__) && !SANITIZED
extern "C" void* __libc_calloc(std::size_t, std::size_t);
extern "C" void* __libc_realloc(void*, std::size_t);
namespace {
bool fails_now() noexcept {
  ++allocations;
  if (until_failure == 0) {
    if (only_one_fails) until_failure = -1;
    return true;
  }
  if (until_failure > 0) --until_failure;
  return false;
}
}  // namespace
extern "C" void* calloc(std::size_t n, std::size_t size) noexcept {
  return fails_now() ? nullptr : __libc_calloc(n, size);
}
extern "C" void* realloc(void* p, std::size_t size) noexcept {
  return fails_now() ? nullptr : __libc_realloc(p, size);
}
#endif

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

struct anchored : slamgc::rc_object<anchored, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
                  slamgc::enable_anchor<anchored, int>,
                  support::instances<anchored> {
  int record() { return 7; }
};
struct weak : slamgc::rc_object<weak, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
              slamgc::enable_weak_rc<weak>,
              support::instances<weak> {};

TEST(AllocationFailure, TheFirstWeakHandleThrowsAndLeavesTheObjectAlone) {
  domain d;
  {
    const mutator m(d, "m");
    auto p = make_rc<weak>();
    {
      const failing at(0);
      EXPECT_THROW(slamgc::weak_rc<weak>{p}, std::bad_alloc);
    }
    const slamgc::weak_rc<weak> w(p);
    const failing everything{failing::all()};
    EXPECT_EQ(slamgc::weak_rc<weak>(p), w);  // the second one needs no memory
    EXPECT_EQ(w.lock(), p);
  }
  EXPECT_EQ(d.collect().result, outcome::done);
  EXPECT_EQ(weak::live(), 0);
}

TEST(AllocationFailure, AnAnchoredObjectThatFindsNoMemoryIsNotMade) {
  domain d;
  const mutator m(d, "m");
  { const auto first = make_rc<anchored>(); }
  const int before = anchored::live();
  for (int n = 0; n != 2; ++n) {
    const failing at(n);  // the object, and its block
    EXPECT_THROW((void)make_rc<anchored>(), std::bad_alloc);
  }
  EXPECT_EQ(anchored::live(), before);
}

TEST(AllocationFailure, RecordsNeedNoMemoryWhenTheyAreMade) {
  domain d;
  slamgc::anchor<anchored, int> a;
  {
    const mutator m(d, "m");
    for (int i = 0; i != 1000; ++i) a = make_rc<anchored>();
  }
  const failing everything{failing::all()};
  EXPECT_EQ(d.collect().result, outcome::done);
  EXPECT_EQ(anchored::live(), 0);
  ASSERT_NE(a.record(), nullptr);
  EXPECT_EQ(*a.record(), 7);
}

// ---- the graph

struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
               support::instances<frame> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("next", next);
    v.edge("stale", stale, slamgc::on_retire::null);
  }
  slamgc::rc_slot<frame> next, stale;
};
// A map with a chain that has stale edges everywhere.
struct map {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("frames", frames, slamgc::on_retire::erase);
  }
  void fill() {
    frame* last = nullptr;
    for (int i = 0; i != 300; ++i) {
      auto* const p = new frame;
      p->next = last;
      p->stale = new frame;
      frames.insert(p);
      slamgc::retire(p->stale.get());
      last = p;
    }
  }
  slamgc::registry<slamgc::rc_set<frame>> frames;
};

TEST(AllocationFailure, AtEachAllocationOfAPurgeLosesNothing) {
  bool failed = true;
  int n = 0;
  for (; failed; ++n) {
    ASSERT_LT(n, 1000);
    domain d;
    mutator m(d, "m");
    map all;
    slamgc::root root(d, "all", all);
    all.fill();
    m.quiescent();
    {
      const failing at(n);
      for (int calls = 0; calls != 10; ++calls) {
        (void)d.collect();
        m.quiescent();
        if (calls == 4) root.collect_cycles();
      }
      failed = at.happened();
    }
    const mutator::offline_scope offline(m);
    ASSERT_EQ(d.drain(), slamgc::waited::done);
    EXPECT_EQ(frame::live(), static_cast<int>(all.frames.size())) << n;
    root.collect_cycles();
    ASSERT_EQ(d.drain(), slamgc::waited::done);
    EXPECT_EQ(frame::live(), 0) << n;
  }
  EXPECT_GE(n, 3);
}

// A purge that finds no memory does not keep the rest from being reclaimed.
TEST(AllocationFailure, ReclamationGoesOnWithoutMemoryForAPurge) {
  domain d;
  mutator m(d, "m");
  map all;
  const slamgc::root root(d, "all", all);
  all.fill();
  (void)d.collect({1000});
  m.quiescent();
  for (int i = 0; i != 1000; ++i) slamgc::retire(new node);
  {
    const failing everything{failing::all()};
    for (int calls = 0; calls != 100; ++calls) {
      (void)d.collect();
      m.quiescent();
    }
  }
  EXPECT_EQ(node::live(), 0);
  all.frames.clear();
  const mutator::offline_scope offline(m);
  ASSERT_EQ(d.drain(), slamgc::waited::done);
  EXPECT_EQ(frame::live(), 0);
}

// Nor does a search for cycles keep collect() from its end.
TEST(AllocationFailure, CollectEndsWithoutMemoryForTrialDeletion) {
  domain d;
  {
    const mutator m(d, "m");
    auto* const a = new frame;
    a->next = new frame;
    a->next->next = a;
    slamgc::retire(a->next.get());
    slamgc::retire(a);
  }
  (void)d.collect({2});  // they are candidates
  outcome results[2];
  {
    const failing everything{failing::all()};
    for (outcome& each : results) each = d.collect().result;
  }
  for (const outcome each : results) EXPECT_EQ(each, outcome::waiting);
  EXPECT_EQ(frame::live(), 2);
  ASSERT_EQ(d.drain(), slamgc::waited::done);
  EXPECT_EQ(frame::live(), 0);
}

TEST(AllocationFailure, ARegistryThatFindsNoMemoryRetiresAtOnce) {
  domain d;
  mutator m(d, "m");
  map all;
  all.fill();
  {
    const failing at(0);
    all.frames.clear();
    EXPECT_TRUE(at.happened());
  }
  EXPECT_EQ(d.stats().total(&slamgc::type_stats::retired), 600u);
  const mutator::offline_scope offline(m);
  ASSERT_EQ(d.drain(), slamgc::waited::done);
  EXPECT_EQ(frame::live(), 0);
}

// A loose end cannot be noted: the announcement is refused, and the index is as it was.
TEST(AllocationFailure, OfALooseEndIsRefused) {
  using namespace redundancy_test;
  constexpr int keyframes = 5, points = 4, slots = 4;
  world<8, slamgc::std_env> w(keyframes, points, red::rule{2, 1, 1, 2});
  std::minstd_rand random(1);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  make_keyframes(w, slots, random);
  const auto failing = [&](auto f) {
    until_failure = below(2) == 0 ? -1 : below(2);
    const red::status s = f(w.histogram);
    until_failure = -1;
    return s;
  };
  int refused = 0;
  for (int i = 0; i != 20000; ++i) {
    const int k = below(keyframes), p = below(points), slot = below(slots);
    auto& kf = w.keyframes[world<8, slamgc::std_env>::at(k)];
    auto& pt = w.points[world<8, slamgc::std_env>::at(p)];
    const auto at = static_cast<std::size_t>(slot);
    red::status s = red::status::ok;
    switch (below(5)) {
      case 0:
        if (!kf.known) kf.points[at] = p;
        s = failing([&](auto& index) { return index.add_keyframe(k); });
        kf.known |= s == red::status::ok;
        break;
      case 1:
        s = failing([&](auto& index) {
          return index.set_observation(k, p, {slot, kf.levels[at]});
        });
        if (s == red::status::ok) pt.observers[k] = {slot, kf.levels[at]};
        break;
      case 2:
        s = failing([&](auto& index) { return index.erase_observation(k, p); });
        if (s == red::status::ok) pt.observers.erase(k);
        break;
      case 3:
        s = failing([&](auto& index) { return index.set_slot(k, slot, p); });
        if (s == red::status::ok) kf.points[at] = p;
        break;
      default:
        s = failing([&](auto& index) { return index.clear_slot(k, slot); });
        if (s == red::status::ok) kf.points[at] = none;
        break;
    }
    refused += s == red::status::out_of_memory;
    for (int each = 0; each != keyframes; ++each) {
      const red::verdict expected = w.oracle(each), v = w.histogram.check(each);
      ASSERT_EQ(v.result, expected.result) << "event " << i;
      ASSERT_EQ(v.eligible_slots, expected.eligible_slots) << "event " << i;
      ASSERT_EQ(v.redundant_slots, expected.redundant_slots) << "event " << i;
    }
  }
  EXPECT_GT(refused, 500);
  // The same for a map that is loaded: as often as it takes.
  decltype(w) loaded(keyframes, points, w.rule);
  for (std::size_t k = 0; k != loaded.keyframes.size(); ++k) {
    loaded.keyframes[k].points = w.keyframes[k].points;
    loaded.keyframes[k].levels = w.keyframes[k].levels;
    loaded.keyframes[k].eligible = w.keyframes[k].eligible;
  }
  for (std::size_t p = 0; p != loaded.points.size(); ++p)
    loaded.points[p].observers = w.points[p].observers;
  for (int pass = 0; pass != 2; ++pass)
    for (int i = 0; i != (pass == 0 ? keyframes : points); ++i) {
      int n = 0;
      red::status s = red::status::out_of_memory;
      for (; s == red::status::out_of_memory; ++n) {
        until_failure = n;
        s = pass == 0 ? loaded.histogram.add_keyframe(i) : loaded.histogram.add_point(i);
        until_failure = -1;
      }
      ASSERT_EQ(s, red::status::ok);
      if (pass == 0) loaded.keyframes[static_cast<std::size_t>(i)].known = true;
    }
  for (int k = 0; k != keyframes; ++k)
    EXPECT_EQ(loaded.histogram.check(k).redundant_slots, loaded.oracle(k).redundant_slots);
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
