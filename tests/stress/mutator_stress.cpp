// Threads that come and go, stall, never register, or collect, all at once.
#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <memory>
#include <mutex>
#include <random>
#include <slamgc/slamgc.hpp>
#include <stdexcept>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/environments.hpp"
#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using support::in_threads;
using support::rounds;

constexpr int alive = 4711;

template <class Env, class Reclaimer>
struct node
    : slamgc::rc_object<node<Env, Reclaimer>, slamgc::basic_fetch_add_counter<Env>, Reclaimer>,
      support::instances<node<Env, Reclaimer>> {
  ~node() {
    EXPECT_EQ(poison, alive);  // plain, as is what follows
    poison = 0;
    std::atomic_signal_fence(std::memory_order_seq_cst);  // so that the store is not dropped
  }
  int poison = alive;
};

template <class Env>
class MutatorStress : public ::testing::Test {
 protected:
  using object = node<Env, slamgc::reclaim_deferred>;
  using bad = node<Env, slamgc::reclaim_retired>;
  using domain_type = slamgc::basic_domain<Env>;
  using mutator_type = slamgc::basic_mutator<Env>;
  using slot = slamgc::rc_slot<object, Env>;

  ~MutatorStress() override {
    EXPECT_EQ(domain_.drain(), slamgc::waited::done);
    EXPECT_TRUE(domain_.stats().mutators.empty());
    EXPECT_EQ(domain_.stats().total(&slamgc::type_stats::live), 0u);
    EXPECT_EQ(object::live() + bad::live(), 0);
  }

  // Without stalls there is time for more.
  static int repeat() { return std::is_same<Env, yield_env>::value ? rounds() : 5 * rounds(); }
  static std::minstd_rand random_of(int thread) {
    return std::minstd_rand(static_cast<unsigned>(yield_env::seed()) +
                            static_cast<unsigned>(thread));
  }
  static void read(const object* p) { ASSERT_EQ(p == nullptr ? alive : p->poison, alive); }
  // Runs f(0) .. f(n - 1), and two collectors as long as they take.
  template <class F>
  void under_collection(int n, F f) {
    std::atomic<int> left{n};
    in_threads(n + 2, [&](int me) {
      if (me < n) {
        f(me);
        --left;
      } else {
        for (unsigned i = 0; left != 0; ++i) {
          (void)domain_.collect(slamgc::budget{i % 20});
          std::this_thread::yield();
        }
      }
    });
  }

  domain_type domain_;
};
TYPED_TEST_SUITE(MutatorStress, support::environments, support::environment_names);

// More than have doors of their own, ending in every way.
TYPED_TEST(MutatorStress, ThreadsComeAndGo) {
  using mutator = typename TestFixture::mutator_type;
  using node_type = typename TestFixture::object;
  typename TestFixture::slot shared[3];
  this->under_collection(6, [&](int me) {
    auto dice = this->random_of(me);
    for (int i = 0; i != this->repeat() / 10 + 1; ++i) {
      intrusive_rc<node_type> dropped_later;
      try {
        mutator m(this->domain_, "short", {dice() % 2 == 0, false});
        for (unsigned frames = dice() % 4; frames != 0; --frames) {
          const typename mutator::online_scope online(m);
          auto& to = shared[dice() % 3];
          auto& from = shared[dice() % 3];
          this->read(to);
          to = new node_type;
          to = from.get();
          from = make_rc<node_type>();
          dropped_later = to;
          slamgc::retire(new node_type);
          if (dice() % 8 == 0) throw std::runtime_error("enough");
          m.quiescent();
        }
        if (dice() % 4 == 0) dropped_later.reset();
      } catch (const std::runtime_error&) {
      }
      this->read(dropped_later.get());
    }
  });
  for (auto& s : shared) s = nullptr;
}

// What one thread unlinks and waits for, nobody reads any more: it may be changed without a lock.
TYPED_TEST(MutatorStress, AfterSynchronizeNobodyReads) {
  using mutator = typename TestFixture::mutator_type;
  struct plain {
    int value = alive;
  };
  typename TypeParam::template atomic<plain*> shared{new plain};
  std::atomic<bool> done{false};
  in_threads(3, [&](int me) {
    if (me == 0) {
      for (int i = 0; i != rounds() / 5 + 1; ++i) {
        plain* const old = shared.exchange(new plain, std::memory_order_acq_rel);
        EXPECT_EQ(this->domain_.synchronize(), slamgc::waited::done);
        old->value = 0;
        delete old;
      }
      done = true;
      return;
    }
    mutator m(this->domain_, "reader");
    for (unsigned i = 0; !done; ++i) {
      const plain* const p = shared.load(std::memory_order_acquire);
      for (int k = 0; k != 3; ++k) ASSERT_EQ(p->value, alive);
      if (i % 4 == 0) {
        const typename mutator::offline_scope offline(m);
      } else {
        m.quiescent();
      }
    }
  });
  delete shared.load(std::memory_order_relaxed);
}

// Threads that never registered may drop, copy and drop again, whatever the collectors do.
TYPED_TEST(MutatorStress, ThreadsThatNeverRegisteredDropReferences) {
  using mutator = typename TestFixture::mutator_type;
  using node_type = typename TestFixture::object;
  std::mutex mutex;
  std::vector<intrusive_rc<node_type>> handed_over;
  std::atomic<int> makers{1};
  this->under_collection(3, [&](int me) {
    if (me == 0) {
      mutator m(this->domain_, "maker");
      for (int i = 0; i != 2 * this->repeat(); ++i) {
        auto made = make_rc<node_type>();
        const std::lock_guard<std::mutex> lock(mutex);
        handed_over.push_back(made);
        handed_over.push_back(std::move(made));
        m.quiescent();
      }
      --makers;
      return;
    }
    for (bool more = true; more;) {
      more = makers != 0;
      intrusive_rc<node_type> mine;
      {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!handed_over.empty()) {
          more = true;
          mine = std::move(handed_over.back());
          handed_over.pop_back();
        }
      }
      const auto copy = mine;
      mine.reset();
      this->read(copy.get());
    }
  });
}

// Of many that retire one object, one does it; a reference that goes meanwhile does not make it two.
TYPED_TEST(MutatorStress, AnObjectIsRetiredOnce) {
  using mutator = typename TestFixture::mutator_type;
  using node_type = typename TestFixture::bad;
  constexpr int objects = 50;
  for (int i = 0; i != rounds() / 50 + 1; ++i) {
    std::vector<node_type*> all;
    std::vector<std::vector<intrusive_rc<node_type>>> references(4);
    std::atomic<int> retired{0};
    std::atomic<int> ready{0};
    {
      const mutator m(this->domain_, "maker");
      for (int k = 0; k != objects; ++k) {
        all.push_back(new node_type);
        for (auto& r : references) r.emplace_back(all.back());
      }
    }
    this->under_collection(4, [&](int me) {
      mutator m(this->domain_, "culling");
      auto& mine = references[static_cast<std::size_t>(me)];
      for (++ready; ready != 4;) std::this_thread::yield();  // all are online
      for (std::size_t k = 0; k != objects; ++k) {
        const std::size_t at = me % 2 == 0 ? k : objects - 1 - k;
        if (me < 2) mine[at].reset();
        if (slamgc::retire(all[at])) ++retired;
        mine[at].reset();
      }
    });
    EXPECT_EQ(retired, objects);
    EXPECT_EQ(this->domain_.drain(), slamgc::waited::done);
    ASSERT_EQ(node_type::live(), 0);
  }
  const auto stats = this->domain_.stats();
  EXPECT_EQ(stats.total(&slamgc::type_stats::retired), stats.total(&slamgc::type_stats::created));
  EXPECT_EQ(stats.total(&slamgc::type_stats::reclaimed), stats.total(&slamgc::type_stats::created));
}

// Objects fall to zero and are found again all the time.
TYPED_TEST(MutatorStress, BorrowedPointersBringObjectsBack) {
  using mutator = typename TestFixture::mutator_type;
  using node_type = typename TestFixture::object;
  slamgc::atomic_rc<node_type, TypeParam> shared;
  this->under_collection(3, [&](int me) {
    mutator m(this->domain_, "m");
    auto dice = this->random_of(me);
    node_type* borrowed = nullptr;
    for (int i = 0; i != this->repeat(); ++i) {
      switch (dice() % 5) {
        case 0:
          shared.store(make_rc<node_type>());
          break;
        case 1:
          shared.store(nullptr);
          break;
        case 2:
          shared.store(intrusive_rc<node_type>(borrowed));  // maybe at zero since
          break;
        case 3: {
          node_type* expected = borrowed;
          (void)shared.compare_exchange_weak(expected, make_rc<node_type>());
          this->read(expected);
          break;
        }
        default:
          borrowed = shared.get();
          this->read(shared.load().get());
      }
      this->read(borrowed);
      if (dice() % 4 == 0) {
        borrowed = nullptr;
        m.quiescent();
      }
    }
  });
  shared.store(nullptr);
}

// The thesis's set, with locals that are counted under the slot's lock.
TYPED_TEST(MutatorStress, TheRetireSetNeedsNoMutators) {
  using node_type = node<TypeParam, slamgc::reclaim_by_scan>;
  {
    slamgc::retire_set<node_type> dead;
    std::mutex mutex;
    slamgc::rc_slot<node_type, TypeParam> shared(new node_type);
    in_threads(3, [&](int me) {
      for (int i = 0; i != this->repeat() / 2; ++i) {
        intrusive_rc<node_type> local;
        {
          const std::lock_guard<std::mutex> lock(mutex);
          local = shared.get();
          if (me == 0) shared = new node_type;
        }
        ASSERT_EQ(local->poison, alive);
        if (me != 2) dead.insert(local.get());
        local.reset();
        if (i % 8 == me) (void)dead.scan();
      }
    });
    node_type* const last = shared.get();
    dead.insert(last);
    shared = nullptr;
  }
  EXPECT_EQ(node_type::live(), 0);
}

// The last use of a domain's state is that of a thread without a mutator, which deletes an object of its own.
TEST(MutatorStress, StateThatAThreadWithoutAMutatorUsedLast) {
  struct own : slamgc::rc_object<own, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};
  for (int i = 0; i != rounds(); ++i) {
    auto domain = std::make_unique<slamgc::domain>();
    own* p = nullptr;
    {
      const slamgc::mutator m(*domain, "maker");
      p = new own;
    }
    std::atomic<bool> deleted{false};
    std::thread other([&] {
      delete p;
      deleted.store(true, std::memory_order_relaxed);
    });
    while (!deleted.load(std::memory_order_relaxed)) std::this_thread::yield();
    domain.reset();
    other.join();
  }
}

}  // namespace
