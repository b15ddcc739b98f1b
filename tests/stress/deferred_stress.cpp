// A map that a mapping thread builds and culls, a tracking thread reads, a loop-closing thread changes,
// and others collect: nobody meets an object that is gone, and in the end all are.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <mutex>
#include <random>
#include <slamgc/slamgc.hpp>
#include <thread>
#include <type_traits>
#include <utility>

#include "support/environments.hpp"
#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using support::in_threads;
using support::rounds;

constexpr int alive = 4711;

template <class Env>
struct map_point : slamgc::rc_object<map_point<Env>, slamgc::basic_fetch_add_counter<Env>,
                                     slamgc::reclaim_retired>,
                   support::instances<map_point<Env>> {
  ~map_point() {
    EXPECT_EQ(poison, alive);  // plain, as is what follows
    poison = 0;
    std::atomic_signal_fence(std::memory_order_seq_cst);  // so that the store is not dropped
  }
  int poison = alive;
};

template <class Env>
struct keyframe
    : slamgc::rc_object<keyframe<Env>, slamgc::basic_cas_counter<Env>, slamgc::reclaim_deferred>,
      support::instances<keyframe<Env>> {
  explicit keyframe(int i) : id(i), points(4) {}
  virtual ~keyframe() {
    EXPECT_EQ(poison, alive);
    poison = 0;
    std::atomic_signal_fence(std::memory_order_seq_cst);  // so that the store is not dropped
    for (const auto& element : points)
      if (map_point<Env>* const p = element) slamgc::retire(p);
  }
  int poison = alive;
  const int id;
  slamgc::rc_slot<keyframe, Env> parent;  // has a smaller id: no cycles
  slamgc::rc_vector<map_point<Env>> points;
};
template <class Env>
struct big_keyframe : keyframe<Env> {
  using keyframe<Env>::keyframe;
  ~big_keyframe() override { EXPECT_EQ(end, alive); }
  int end = alive;
};

template <class Env>
class DeferredStress : public ::testing::Test {
 protected:
  using point = map_point<Env>;
  using frame = keyframe<Env>;
  using domain = slamgc::basic_domain<Env>;
  using mutator = slamgc::basic_mutator<Env>;
  using random = std::minstd_rand;

  static random random_of(int thread) {
    return random(static_cast<unsigned>(yield_env::seed()) + static_cast<unsigned>(thread));
  }

  // Reads all that can be reached from a borrowed keyframe.
  static void read(frame* k) {
    for (int depth = 0; k != nullptr && depth != 10; k = k->parent.get(), ++depth) {
      ASSERT_EQ(k->poison, alive);
      for (std::size_t i = 0; i != 4; ++i) {
        const point* const p = k->points[i].get();
        if (p != nullptr) {
          ASSERT_EQ(p->poison, alive);
        }
      }
    }
  }

  void mapping(random dice) {
    mutator m(domain_, "mapping");
    const int frames = std::is_same<Env, yield_env>::value ? rounds() : 10 * rounds();
    for (int i = 0; i != frames; ++i) {
      intrusive_rc<frame> made;
      if (i % 3 == 0)
        made = make_rc<big_keyframe<Env>>(i);
      else
        made = make_rc<frame>(i);
      for (std::size_t k = 0; k != 4; ++k) made->points[k] = new point;
      made->parent = newest_.get();
      newest_.store(made);
      {
        const std::lock_guard<std::mutex> lock(mutex_);
        keyframes_.push_back(made.get());
        if (keyframes_.size() > 8) cull(dice() % 8);
      }
      replace_point(made.get(), dice() % 4, new point);
      made.reset();
      if (i % 16 == 0) (void)domain_.collect(slamgc::budget{20});
      m.quiescent();
    }
  }
  // The old point is bad from now on, wherever else it is.
  void replace_point(frame* k, std::size_t which, point* by) {
    const std::lock_guard<std::mutex> lock(mutex_);
    point* const old = k->points[which].get();
    k->points[which] = by;
    if (old != nullptr && old != by) slamgc::retire(old);
  }
  // With the lock. As ORB-SLAM does it: the children get another parent, then it is bad.
  void cull(std::size_t which) {
    frame* const dead = keyframes_[which].get();
    for (const auto& element : keyframes_) {
      frame* const child = element;
      if (child->parent.get() == dead) child->parent = dead->parent.get();
    }
    keyframes_.erase(keyframes_.begin() + static_cast<std::ptrdiff_t>(which));
    dead->parent = nullptr;
    slamgc::retire(dead);
  }

  void tracking() {
    mutator m(domain_, "tracking", {true, true});
    slamgc::rc_slot<frame, Env> reference;
    while (!done_) {
      read(newest_.get());
      const intrusive_rc<frame> mine = newest_.load();
      read(reference);
      reference = newest_.get();  // maybe dropped and queued by now: it comes back
      if (reference) reference = reference->parent.get();
      m.quiescent();
      if (mine) {
        EXPECT_EQ(mine->poison, alive);
      }
    }
  }

  void loop_closing(random dice) {
    mutator m(domain_, "loop closing");
    while (!done_) {
      {
        slamgc::pin_set<frame> pinned;
        {
          const std::lock_guard<std::mutex> lock(mutex_);
          pinned = keyframes_;
        }
        {
          const typename mutator::offline_scope offline(m);
          for (const auto& element : pinned) {
            const frame* const k = element;
            EXPECT_EQ(k->poison, alive);
          }
        }
        if (pinned.size() > 1) {
          frame* a = pinned[dice() % pinned.size()].get();
          frame* b = pinned[dice() % pinned.size()].get();
          if (a->id < b->id) std::swap(a, b);
          if (a->id != b->id) a->parent = b;
          replace_point(a, dice() % 4, b->points[dice() % 4].get());  // two points are fused
          frame* expected = a;
          (void)newest_.compare_exchange_strong(expected, intrusive_rc<frame>(b));
          (void)newest_.compare_exchange_weak(expected, intrusive_rc<frame>(a));
        }
      }
      m.quiescent();
    }
  }

  void collecting() {
    for (unsigned i = 0; !done_; ++i) {
      (void)domain_.collect(slamgc::budget{i % 50});
      std::this_thread::yield();
    }
  }

  ~DeferredStress() override {
    EXPECT_EQ(frame::live(), 0);
    EXPECT_EQ(point::live(), 0);
  }

  domain domain_;
  std::mutex mutex_;
  slamgc::rc_vector<frame> keyframes_;
  slamgc::atomic_rc<frame, Env> newest_;
  std::atomic<bool> done_{false};
};
TYPED_TEST_SUITE(DeferredStress, support::environments, support::environment_names);

TYPED_TEST(DeferredStress, TrackingMappingLoopClosing) {
  in_threads(5, [&](int me) {
    switch (me) {
      case 0:
        this->mapping(this->random_of(me));
        this->done_ = true;
        break;
      case 1:
        this->tracking();
        break;
      case 2:
        this->loop_closing(this->random_of(me));
        break;
      default:
        this->collecting();
    }
  });
  {
    const typename TestFixture::mutator m(this->domain_, "the end");
    this->keyframes_.clear();
    this->newest_ = nullptr;
  }
  EXPECT_EQ(this->domain_.drain(), slamgc::waited::done);
  const auto stats = this->domain_.stats();
  EXPECT_TRUE(stats.mutators.empty());
  EXPECT_EQ(stats.total(&slamgc::type_stats::live), 0u);
  EXPECT_EQ(stats.total(&slamgc::type_stats::created), stats.total(&slamgc::type_stats::reclaimed));
  EXPECT_EQ(stats.refused_collects, 0u);
}

}  // namespace
