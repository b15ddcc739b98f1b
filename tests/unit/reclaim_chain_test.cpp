// Long chains and deep trees are destroyed with the stack of one object.
#include <slamgc/reclaim_at_zero.hpp>

#include <gtest/gtest.h>
#include <pthread.h>

#include <cstddef>
#include <functional>
#include <slamgc/containers/rc_list.hpp>
#include <slamgc/containers/rc_set.hpp>
#include <slamgc/containers/rc_vector.hpp>
#include <slamgc/intrusive_rc.hpp>
#include <slamgc/rc_slot.hpp>
#include <utility>
#include <vector>

#include "support/instances.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::rc_slot;

constexpr int chain_length = 1000000;

// Runs @p f on a thread with a stack of 256 kB.
void on_a_small_stack(std::function<void()> f) {
  pthread_attr_t attributes;
  ASSERT_EQ(pthread_attr_init(&attributes), 0);
  ASSERT_EQ(pthread_attr_setstacksize(&attributes, std::size_t{256} * 1024), 0);
  pthread_t thread;
  const auto entry = [](void* argument) -> void* {
    (*static_cast<std::function<void()>*>(argument))();
    return nullptr;
  };
  ASSERT_EQ(pthread_create(&thread, &attributes, entry, &f), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
}

struct link : slamgc::rc_object<link>, support::instances<link> {
  rc_slot<link> next;
};

struct keyframe;
struct map_point : slamgc::rc_object<map_point>, support::instances<map_point> {
  rc_slot<keyframe> reference;
};
struct keyframe : slamgc::rc_object<keyframe, slamgc::cas_counter>, support::instances<keyframe> {
  rc_slot<map_point> point;
};

template <class Policy>
struct holder : slamgc::rc_object<holder<Policy>, Policy>, support::instances<holder<Policy>> {
  intrusive_rc<holder> rc;
  slamgc::rc_vector<holder> vector;
  slamgc::rc_list<holder> list;
  slamgc::rc_set<holder> set;
};

struct tree : slamgc::rc_object<tree>, support::instances<tree> {
  rc_slot<tree> left, right;
};

TEST(ReclaimChain, AMillionObjects) {
  on_a_small_stack([] {
    intrusive_rc<link> head;
    for (int i = 0; i != chain_length; ++i) {
      auto p = make_rc<link>();
      p->next = std::move(head);
      head = std::move(p);
    }
    EXPECT_EQ(link::live(), chain_length);
    head.reset();
    EXPECT_EQ(link::live(), 0);
  });
}

TEST(ReclaimChain, AMillionObjectsOfTwoTypesInTurn) {
  on_a_small_stack([] {
    intrusive_rc<keyframe> head;
    for (int i = 0; i != chain_length / 2; ++i) {
      auto point = make_rc<map_point>();
      point->reference = std::move(head);
      head = make_rc<keyframe>();
      head->point = std::move(point);
    }
    EXPECT_EQ(keyframe::live() + map_point::live(), chain_length);
    head.reset();
    EXPECT_EQ(keyframe::live() + map_point::live(), 0);
  });
}

TEST(ReclaimChain, ThroughEveryKindOfMember) {
  on_a_small_stack([] {
    using node = holder<slamgc::fetch_add_counter>;
    intrusive_rc<node> head;
    for (int i = 0; i != 100000; ++i) {
      auto p = make_rc<node>();
      switch (i % 4) {
        case 0:
          p->rc = std::move(head);
          break;
        case 1:
          p->vector.push_back(head.get());
          break;
        case 2:
          p->list.push_back(head.get());
          break;
        default:
          p->set.insert(head.get());
          break;
      }
      head = std::move(p);
    }
    EXPECT_EQ(node::live(), 100000);
    head.reset();
    EXPECT_EQ(node::live(), 0);
  });
}

TEST(ReclaimChain, ABinaryTree) {
  on_a_small_stack([] {
    std::vector<intrusive_rc<tree>> level;
    for (int i = 0; i != 1 << 16; ++i) level.push_back(make_rc<tree>());
    while (level.size() > 1) {
      std::vector<intrusive_rc<tree>> above;
      for (std::size_t i = 0; i != level.size(); i += 2) {
        above.push_back(make_rc<tree>());
        above.back()->left = std::move(level[i]);
        above.back()->right = std::move(level[i + 1]);
      }
      level = std::move(above);
    }
    EXPECT_EQ(tree::live(), (1 << 17) - 1);
    level.clear();
    EXPECT_EQ(tree::live(), 0);
  });
}

TEST(ReclaimChain, AGraphWithSharedObjects) {
  on_a_small_stack([] {
    // Each object refers to the next one twice.
    intrusive_rc<tree> head;
    for (int i = 0; i != 100000; ++i) {
      auto p = make_rc<tree>();
      p->left = head;
      p->right = std::move(head);
      head = std::move(p);
    }
    EXPECT_EQ(tree::live(), 100000);
    head.reset();
    EXPECT_EQ(tree::live(), 0);
  });
}

}  // namespace
