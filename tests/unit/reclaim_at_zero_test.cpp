// Destruction at a count of zero: order, re-entry, scopes, the ends of threads and of the program.
#include <slamgc/reclaim_at_zero.hpp>

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <slamgc/containers/rc_vector.hpp>
#include <slamgc/intrusive_rc.hpp>
#include <slamgc/mutex_counter.hpp>
#include <slamgc/rc_slot.hpp>
#include <thread>
#include <utility>
#include <vector>

#include "support/instances.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::rc_slot;

// Does at its end what a test wants.
struct node : slamgc::rc_object<node>, support::instances<node> {
  node() = default;
  explicit node(std::function<void(node&)> f) : at_end(std::move(f)) {}
  node(const node&) = delete;
  node& operator=(const node&) = delete;
  ~node() {
    if (at_end) at_end(*this);
  }
  rc_slot<node> left, right;
  std::function<void(node&)> at_end;
};

using scope = slamgc::reclaim_at_zero::scope<node>;

class ReclaimAtZero : public ::testing::Test {
 protected:
  ~ReclaimAtZero() override { EXPECT_EQ(node::live(), 0); }
};

TEST_F(ReclaimAtZero, DestroysOnTheThreadAndAtTheMomentOfTheLastDrop) {
  std::thread::id destroyed_on;
  auto p = make_rc<node>([&](node&) { destroyed_on = std::this_thread::get_id(); });
  std::thread other([q = std::move(p)]() mutable { q.reset(); });
  const std::thread::id expected = other.get_id();
  other.join();
  EXPECT_EQ(destroyed_on, expected);
}

TEST_F(ReclaimAtZero, AScopeHoldsDestructionBack) {
  auto p = make_rc<node>();
  auto q = make_rc<node>();
  {
    const scope outer;
    {
      const scope inner;
      p.reset();
      EXPECT_EQ(node::live(), 2);
    }
    EXPECT_EQ(node::live(), 2) << "only the outermost scope makes up for it";
    q.reset();
    EXPECT_EQ(node::live(), 2);
  }
  EXPECT_EQ(node::live(), 0);
}

TEST_F(ReclaimAtZero, AScopeIsOneThreadsOwn) {
  auto p = make_rc<node>();
  const scope mine;
  std::thread([&] { p.reset(); }).join();
  EXPECT_EQ(node::live(), 0);
}

TEST_F(ReclaimAtZero, AnObjectIsDestroyedAfterTheDestructorThatDroppedIt) {
  std::vector<int> log;
  auto child = make_rc<node>([&](node&) { log.push_back(3); });
  auto parent = make_rc<node>([&](node& self) {
    log.push_back(1);
    self.left = nullptr;
    log.push_back(2);
  });
  parent->left = std::move(child);
  parent.reset();
  EXPECT_EQ(log, (std::vector<int>{1, 2, 3}));
}

TEST_F(ReclaimAtZero, ADestructorMayDropManyObjectsOfSeveralTypes) {
  struct other : slamgc::rc_object<other, slamgc::cas_counter>, support::instances<other> {};
  struct third : slamgc::rc_object<third, slamgc::mutex_counter>, support::instances<third> {};
  std::vector<intrusive_rc<node>> nodes;
  std::vector<intrusive_rc<other>> others;
  std::vector<intrusive_rc<third>> thirds;
  for (int i = 0; i != 100; ++i) {
    nodes.push_back(make_rc<node>());
    others.push_back(make_rc<other>());
    thirds.push_back(make_rc<third>());
  }
  make_rc<node>([&](node&) {
    while (!nodes.empty()) {
      nodes.pop_back();
      others.pop_back();
      thirds.pop_back();
    }
    EXPECT_EQ(other::live(), 100) << "nothing is destroyed inside a destructor";
  }).reset();
  EXPECT_EQ(other::live(), 0);
  EXPECT_EQ(third::live(), 0);
}

TEST_F(ReclaimAtZero, ADestructorMayMakeAndDropNewObjects) {
  int destroyed = 0;
  std::function<void(node&)> make_another = [&](node&) {
    if (++destroyed < 1000) (void)make_rc<node>(make_another);
  };
  make_rc<node>(make_another).reset();
  EXPECT_EQ(destroyed, 1000);
}

TEST_F(ReclaimAtZero, ADestructorMayLookAtAndKeepWhatItRefersTo) {
  intrusive_rc<node> kept;
  auto parent = make_rc<node>([&](node& self) { kept = intrusive_rc<node>(self.left); });
  parent->left = new node;
  parent.reset();
  EXPECT_EQ(node::live(), 1);
  EXPECT_EQ(kept->use_count(), 1u);
}

TEST_F(ReclaimAtZero, ADestructorMayCopyReferencesToOtherObjects) {
  auto held = make_rc<node>();
  make_rc<node>([&](node&) {
    for (int i = 0; i != 10; ++i) const intrusive_rc<node> copy = held;
  }).reset();
  EXPECT_EQ(held->use_count(), 1u);
}

TEST_F(ReclaimAtZero, AVectorsElementsAreDestroyedAfterItsChange) {
  slamgc::rc_vector<node> v;
  std::size_t seen = 99;
  v.push_back(new node([&](node&) { seen = v.size(); }));
  v.push_back(new node);
  v.erase(v.begin());
  EXPECT_EQ(seen, 1u);
}

// Thread-local objects are destroyed after the thread's function, in unspecified company.
TEST_F(ReclaimAtZero, ObjectsMayBeDroppedByThreadLocalDestructors) {
  std::thread([] {
    static thread_local intrusive_rc<node> last;
    last = make_rc<node>();
    last->left = new node;
    last->left->right = new node;
    static thread_local intrusive_rc<node> later;
    later = make_rc<node>([](node&) { (void)make_rc<node>(); });
    EXPECT_EQ(later->use_count(), 1u);
    EXPECT_EQ(node::live(), 4);
  }).join();
  EXPECT_EQ(node::live(), 0);
}

TEST_F(ReclaimAtZero, AThreadsFirstDropMayBeInAThreadLocalDestructor) {
  auto p = make_rc<node>();
  std::thread([q = std::move(p)]() mutable {
    static thread_local intrusive_rc<node> last;
    last = std::move(q);
  }).join();
  EXPECT_EQ(node::live(), 0);
}

// Dropped after main. The observer is destroyed after the reference, and looks.
struct at_exit_node : slamgc::rc_object<at_exit_node>, support::instances<at_exit_node> {
  rc_slot<at_exit_node> next;
};
struct exit_observer {
  ~exit_observer() {
    if (at_exit_node::live() == 0) return;
    std::fprintf(stderr, "%d objects survive the static destructors\n", at_exit_node::live());
    std::_Exit(1);
  }
};
exit_observer looks_last;
intrusive_rc<at_exit_node> dropped_at_exit;
rc_slot<at_exit_node> slot_dropped_at_exit;

TEST_F(ReclaimAtZero, ObjectsMayBeDroppedByStaticDestructors) {
  dropped_at_exit = make_rc<at_exit_node>();
  dropped_at_exit->next = new at_exit_node;
  slot_dropped_at_exit = new at_exit_node;
  EXPECT_EQ(at_exit_node::live(), 3);
}

}  // namespace
