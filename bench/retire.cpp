// What it costs to make an object of 48 bytes, to retire it and to reclaim it, in batches of 1,024.
//
// Each thread has its own objects. "Batched" means that all objects of a batch are made before the first is
// freed, which is what every scheme with grace periods has to do: batching alone costs something, since the
// allocator's quickest memory is used up. Peers that are not installed are left out.
#include <slamgc/deferred.hpp>
#include <slamgc/mutator.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "contenders.hpp"

#if SLAMGC_BENCH_URCU
#include <urcu-qsbr.h>
#include <urcu/defer.h>
#endif
#if SLAMGC_BENCH_XENIUM
#include <xenium/reclamation/quiescent_state_based.hpp>
#endif
#if SLAMGC_BENCH_CDS
#include <cds/gc/hp.h>
#include <cds/init.h>
#endif

namespace {

using namespace bench;

constexpr unsigned batch = 1024;

/// A contender whose threads each have a Worker while they are measured.
template <class Worker>
contender in_batches(const char* name) {
  struct state {
    per_thread<std::optional<Worker>> workers;
  };
  const auto s = std::make_shared<state>();
  contender c{name, [s](unsigned thread, std::uint64_t n, unsigned) {
                Worker& worker = *s->workers[thread];
                for (; n != 0; --n) {
                  for (unsigned i = 0; i != batch; ++i) worker.make_and_retire();
                  worker.end_batch();
                }
              }};
  c.prepare = [s](unsigned thread, std::uint64_t) { s->workers[thread].emplace(); };
  c.finish = [s](unsigned thread) { s->workers[thread].reset(); };
  return c;
}

// ---- slamgc

template <class Reclaimer>
struct deferred_object
    : slamgc::rc_object<deferred_object<Reclaimer>, slamgc::fetch_add_counter, Reclaimer> {
  std::uint64_t payload[4];
};
using object = deferred_object<slamgc::reclaim_deferred>;
static_assert(sizeof(object) == 48);

slamgc::domain& domain() {
  static slamgc::domain d;
  return d;
}

struct slamgc_worker {
  explicit slamgc_worker(slamgc::domain& d = domain()) : own(d), mutator(d, "worker") {}
  slamgc::domain& own;
  slamgc::mutator mutator;
  static void make_and_retire() { slamgc::retire(new object); }
  /// What entered is noted, and after the grace period reclaimed.
  void end_batch() {
    mutator.quiescent();
    own.collect();
    mutator.quiescent();
    own.collect();
  }
};
/// No thread destroys what another one made.
struct slamgc_domain_each_worker : slamgc_worker {
  slamgc_domain_each_worker() : slamgc_worker(domain_of_thread()) {}
  static slamgc::domain& domain_of_thread() {
    static thread_local slamgc::domain d;
    return d;
  }
};

/// The same, but the objects enter the table because their last reference goes.
struct slamgc_count_worker : slamgc_worker {
  static void make_and_retire() { const slamgc::intrusive_rc<object> only(new object); }
};

// ---- without a scheme

struct plain {
  std::uint64_t payload[6];
};
static_assert(sizeof(plain) == 48);

struct pairwise_worker {
  static void make_and_retire() {
    plain* const p = new plain;
    use(p);
    delete p;
  }
  void end_batch() {}
};

struct batched_worker {
  std::vector<plain*> made;
  batched_worker() { made.reserve(batch); }
  void make_and_retire() { made.push_back(new plain); }
  void end_batch() {
    for (plain* p : made) delete p;
    made.clear();
  }
};

/// What one thread made, another one frees, as far as there are others: what the allocator then costs.
struct exchanged_worker {
  using list = std::vector<plain*>;
  std::unique_ptr<list> made = std::make_unique<list>();
  ~exchanged_worker() { free_all(*made); }
  void make_and_retire() { made->push_back(new plain); }
  void end_batch() {
    static std::atomic<list*> waiting{nullptr};
    made.reset(waiting.exchange(made.release(), std::memory_order_acq_rel));
    if (made == nullptr) made = std::make_unique<list>();
    free_all(*made);
  }
  static void free_all(list& l) {
    for (plain* p : l) delete p;
    l.clear();
  }
};

/// The least that a scheme with a link in the object does: the objects are chained.
template <bool Change>
struct chain_worker {
  struct node {
    std::atomic<std::uint64_t> word{0};
    node* next = nullptr;
    std::uint64_t payload[4];
  };
  static_assert(sizeof(node) == 48);
  node* chain = nullptr;
  void make_and_retire() {
    node* const made = new node;
    use(made);
    // A retirement has to be one atomic change, or two threads could retire the same object.
    if (Change) made->word.fetch_or(1, std::memory_order_acq_rel);
    made->next = chain;
    chain = made;
  }
  void end_batch() {
    while (chain != nullptr) delete std::exchange(chain, chain->next);
  }
};

// ---- peers

#if SLAMGC_BENCH_URCU
/// liburcu, QSBR. Not call_rcu(): that frees on a thread of its own, whose time would be missing here.
struct urcu_worker {
  // Registered until the thread ends: the last one to leave stops and joins liburcu's own thread.
  urcu_worker() {
    static thread_local const registration once;
    urcu_qsbr_thread_online();
  }
  ~urcu_worker() { urcu_qsbr_thread_offline(); }
  urcu_worker(const urcu_worker&) = delete;
  urcu_worker& operator=(const urcu_worker&) = delete;

 private:
  struct registration {
    registration() {
      urcu_qsbr_register_thread();
      urcu_qsbr_defer_register_thread();
    }
    ~registration() {
      urcu_qsbr_thread_offline();
      urcu_qsbr_defer_unregister_thread();
      urcu_qsbr_unregister_thread();
    }
  };
};
struct urcu_defer_worker : urcu_worker {
  static void make_and_retire() {
    urcu_qsbr_defer_rcu([](void* p) { delete static_cast<plain*>(p); }, new plain);
  }
  static void end_batch() {
    // Offline, or it and liburcu's own thread would wait for each other.
    urcu_qsbr_thread_offline();
    urcu_qsbr_defer_barrier_thread();
    urcu_qsbr_thread_online();
  }
};
/// The program keeps the list itself, and waits.
struct urcu_synchronize_worker : urcu_worker, batched_worker {
  void end_batch() {
    urcu_qsbr_synchronize_rcu();
    batched_worker::end_batch();
  }
};
#endif

#if SLAMGC_BENCH_XENIUM
struct xenium_worker {
  using qsbr = xenium::reclamation::quiescent_state_based;
  struct node : qsbr::enable_concurrent_ptr<node> {
    std::uint64_t payload[4];
  };
  static_assert(sizeof(node) == 48);
  std::optional<qsbr::region_guard> region{std::in_place};
  static void make_and_retire() {
    qsbr::concurrent_ptr<node>::guard_ptr p(new node);
    p.reclaim();
  }
  void end_batch() {
    region.reset();
    region.emplace();
  }
};
#endif

#if SLAMGC_BENCH_CDS
struct cds_worker {
  cds_worker() {
    static const library once;
    cds::threading::Manager::attachThread();
  }
  ~cds_worker() { cds::threading::Manager::detachThread(); }
  cds_worker(const cds_worker&) = delete;
  cds_worker& operator=(const cds_worker&) = delete;
  static void make_and_retire() {
    cds::gc::HP::retire(new plain, [](void* p) { delete static_cast<plain*>(p); });
  }
  static void end_batch() { cds::gc::HP::scan(); }

 private:
  struct library {
    library() {
      cds::Initialize();
      static cds::gc::HP hazard_pointers(4, most_threads, 2 * batch);
    }
  };
};
#endif

std::vector<contender> all() {
  return {
    in_batches<slamgc_worker>("slamgc, retire"),
        in_batches<slamgc_count_worker>("slamgc, count falls to zero"),
        in_batches<slamgc_domain_each_worker>("slamgc, a domain per thread"),
        in_batches<batched_worker>("new+delete, batched"),
        in_batches<exchanged_worker>("new+delete, batched, by another thread"),
        in_batches<pairwise_worker>("new+delete, pairwise"),
        in_batches<chain_worker<false>>("chain"),
        in_batches<chain_worker<true>>("chain, one atomic change each"),
#if SLAMGC_BENCH_URCU
        in_batches<urcu_defer_worker>("liburcu QSBR, defer_rcu"),
        in_batches<urcu_synchronize_worker>("liburcu QSBR, synchronize_rcu"),
#endif
#if SLAMGC_BENCH_XENIUM
        in_batches<xenium_worker>("xenium QSBR"),
#endif
#if SLAMGC_BENCH_CDS
        in_batches<cds_worker>("libcds hazard pointers"),
#endif
  };
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv, {{"retire+reclaim", "48 bytes, batches of 1024", all(), batch, {1, 2}}});
}
