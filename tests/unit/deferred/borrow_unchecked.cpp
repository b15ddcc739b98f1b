// The unchecked flavour: a borrowed pointer is a pointer, and misuse is refused where that is promised.
#undef SLAMGC_DEBUG
#define SLAMGC_DEBUG 0

#include <gtest/gtest.h>

#include <functional>
#include <slamgc/slamgc.hpp>
#include <thread>
#include <type_traits>

#include "support/instances.hpp"

namespace {

using slamgc::borrow;
using slamgc::domain;
using slamgc::mutator;
using outcome = slamgc::collected::outcome;

struct unchecked_node
    : slamgc::rc_object<unchecked_node, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
      support::instances<unchecked_node> {
  ~unchecked_node() {
    if (at_end) at_end(this);
  }
  std::function<void(unchecked_node*)> at_end;
};

static_assert(sizeof(borrow<unchecked_node>) == sizeof(unchecked_node*));
static_assert(std::is_trivially_copyable<borrow<unchecked_node>>::value);
static_assert(std::is_trivially_destructible<borrow<unchecked_node>>::value);

TEST(BorrowUnchecked, IsAPointer) {
  unchecked_node n;
  borrow<unchecked_node> b = &n;
  const borrow<unchecked_node> copy = b;
  unchecked_node* const raw = b;
  EXPECT_EQ(raw, &n);
  EXPECT_EQ(&*copy, &n);
  EXPECT_EQ(copy->use_count(), 0u);
  b = nullptr;
  EXPECT_EQ(b.get(), nullptr);
}

TEST(DeferredUnchecked, ARealTimeThreadIsRefusedAllTheSame) {
  domain d;
  const mutator m(d, "tracking", {true, true});
  slamgc::retire(new unchecked_node);
  EXPECT_EQ(d.collect().result, outcome::refused);
  EXPECT_EQ(d.collect().reclaimed, 0u);
  EXPECT_EQ(d.stats().refused_collects, 2u);
  EXPECT_EQ(unchecked_node::live(), 1);
}

TEST(DeferredUnchecked, QuiescentWhileOfflineIsIgnored) {
  domain d;
  mutator m(d, "m", {false, false});
  m.quiescent();
  EXPECT_FALSE(d.stats().mutators[0].online);
}

TEST(DeferredUnchecked, WhatADestructorDoesToItsOwnObjectIsHarmless) {
  domain d;
  {
    const mutator m(d, "m");
    auto* const n = new unchecked_node;
    n->at_end = [](unchecked_node* self) {
      slamgc::intrusive_rc<unchecked_node>(self).reset();
      (void)slamgc::retire(self);
      (void)slamgc::retire(self);
    };
    slamgc::intrusive_rc<unchecked_node>(n).reset();
  }
  EXPECT_EQ(d.collect().reclaimed, 1u);
  EXPECT_EQ(d.collect().result, outcome::done);
  EXPECT_EQ(d.delayed().backlog, 0u);
  EXPECT_EQ(unchecked_node::live(), 0);
}

TEST(DeferredUnchecked, ADropWithoutAReferenceLeavesTheWord) {
  domain d;
  const mutator m(d, "m");
  const unchecked_node n;
  intrusive_ptr_release(&n);
  EXPECT_EQ(n.state().bits, 0u);
  EXPECT_EQ(d.delayed().backlog, 0u);
}

}  // namespace
