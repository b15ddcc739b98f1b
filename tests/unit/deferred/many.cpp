// A million objects that die at once, in slices; and what a stalled reader costs those who retire.
#include <slamgc/deferred.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <slamgc/slamgc.hpp>
#include <utility>

#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

using slamgc::budget;
using slamgc::domain;
using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::mutator;
using outcome = slamgc::collected::outcome;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr int slower = 10;
#else
constexpr int slower = 1;
#endif
// Fewer where the machine is emulated or a sanitizer is at work.
const int million = 1000 * support::rounds() / slower;

struct point : slamgc::rc_object<point, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
               support::instances<point> {
  slamgc::rc_slot<point> next;
};

// Collects in slices of @p size until nothing is left; none does more, and none is useless.
void collect_in_slices(domain& d, std::size_t size, std::size_t objects) {
  std::size_t calls = 0;
  std::size_t reclaimed = 0;
  for (outcome now = outcome::partial; now != outcome::done; ++calls) {
    const auto did = d.collect(budget{size});
    now = did.result;
    ASSERT_LE(did.reclaimed, size);
    reclaimed += did.reclaimed;
  }
  EXPECT_EQ(reclaimed, objects);
  EXPECT_GE(calls, 2 * objects / size);
  EXPECT_LE(calls, 2 * objects / size + 2);
  EXPECT_EQ(point::live(), 0);
}

TEST(Million, AWholeMapAtOnce) {
  domain d;
  {
    const mutator m(d, "mapping");
    slamgc::rc_vector<point> map;
    map.edit()->reserve(static_cast<std::size_t>(million));
    for (int i = 0; i != million; ++i) map.push_back(new point);
    map.clear();
    EXPECT_EQ(point::live(), million);
  }
  EXPECT_EQ(d.delayed().backlog, static_cast<std::uint64_t>(million));
  collect_in_slices(d, 10000, static_cast<std::size_t>(million));
}

TEST(Million, SlicesOfOneHundred) {
  domain d;
  {
    const mutator m(d, "mapping");
    for (int i = 0; i != million / 10; ++i) slamgc::retire(new point);
  }
  collect_in_slices(d, 100, static_cast<std::size_t>(million / 10));
}

// Each destructor lets the next one go: no recursion, and as many grace periods as links.
TEST(Million, AChain) {
  domain d;
  {
    const mutator m(d, "mapping");
    intrusive_rc<point> head;
    for (int i = 0; i != million; ++i) {
      auto p = make_rc<point>();
      p->next = std::move(head);
      head = std::move(p);
    }
  }
  EXPECT_EQ(d.collect(budget{1000}).reclaimed, 500u);
  EXPECT_EQ(d.collect().reclaimed, static_cast<std::size_t>(million) - 500);
  EXPECT_EQ(point::live(), 0);
}

// ---- a reader that stalls

thread_local int operations = 0;

// std_env that counts what is done to atomic variables.
struct counting_env : slamgc::std_env {
  template <class T>
  class atomic {
   public:
    constexpr atomic(T value) noexcept : value_(value) {}
    T load(std::memory_order order) const noexcept { return ++operations, value_.load(order); }
    void store(T value, std::memory_order order) noexcept {
      ++operations, value_.store(value, order);
    }
    T exchange(T value, std::memory_order order) noexcept {
      return ++operations, value_.exchange(value, order);
    }
    T fetch_add(T delta, std::memory_order order) noexcept {
      return ++operations, value_.fetch_add(delta, order);
    }
    T fetch_sub(T delta, std::memory_order order) noexcept {
      return ++operations, value_.fetch_sub(delta, order);
    }
    bool compare_exchange_weak(T& expected, T desired, std::memory_order success,
                               std::memory_order failure) noexcept {
      return ++operations, value_.compare_exchange_strong(expected, desired, success, failure);
    }
    bool compare_exchange_strong(T& expected, T desired, std::memory_order success,
                                 std::memory_order failure) noexcept {
      return ++operations, value_.compare_exchange_strong(expected, desired, success, failure);
    }

   private:
    std::atomic<T> value_;
  };
};

struct counted_point
    : slamgc::rc_object<counted_point, slamgc::basic_fetch_add_counter<counting_env>,
                        slamgc::reclaim_deferred> {};

template <class F>
int operations_of(F f) {
  const int before = operations;
  f();
  return operations - before;
}

TEST(StalledReader, RetiringCostsWhatItCostsWithoutOne) {
  slamgc::basic_domain<counting_env> d;
  slamgc::basic_mutator<counting_env> m(d, "mapping");
  const auto retire_one = [] { slamgc::retire(new counted_point); };
  const auto drop_one = [] { make_rc<counted_point>().reset(); };
  const auto frame = [&] {
    m.quiescent();
    retire_one();
    drop_one();
  };
  frame();
  const int retiring = operations_of(retire_one);
  const int dropping = operations_of(drop_one);
  const int per_frame = operations_of(frame);
  { const slamgc::basic_mutator<counting_env> stalled(d, "stalled", {false, false}); }
  {
    const slamgc::basic_mutator<counting_env> stalled(d, "stalled");  // never quiescent
    EXPECT_EQ(d.collect().result, outcome::waiting);
    for (int i = 0; i != 20000; ++i) frame();
    EXPECT_EQ(d.collect().result, outcome::waiting);
    EXPECT_GE(d.delayed().backlog, 40000u);
    EXPECT_STREQ(d.delayed().oldest, "stalled");
  }
  frame();
  EXPECT_EQ(operations_of(retire_one), retiring);
  EXPECT_EQ(operations_of(drop_one), dropping);
  EXPECT_LE(operations_of(frame), per_frame);
  while (d.collect().result != outcome::done) m.quiescent();
}

}  // namespace
