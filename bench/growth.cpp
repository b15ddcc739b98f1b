// How the cost of retiring and reclaiming grows with threads, with live objects and with what waits.
#include <slamgc/deferred.hpp>
#include <slamgc/mutator.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "contenders.hpp"

namespace {

using namespace bench;

constexpr unsigned batch = 1024;

struct object : slamgc::rc_object<object, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
  std::uint64_t payload[4];
};
struct plain {
  std::uint64_t payload[6];
};
static_assert(sizeof(plain) == sizeof(object));

// What both do; each thread has one.

struct slamgc_worker {
  explicit slamgc_worker(slamgc::domain& d) : domain(d), mutator(d, "worker") {}
  slamgc::domain& domain;
  slamgc::mutator mutator;
  using slot = slamgc::intrusive_rc<object>;

  static slot make() { return slot(new object); }
  static void make_and_retire() { slamgc::retire(new object); }
  static void replace(slot& at) { at = make(); }
  void end_batch() {
    mutator.quiescent();
    domain.collect();
    mutator.quiescent();
    domain.collect();
  }
};
struct plain_worker {
  explicit plain_worker(slamgc::domain&) {}
  std::vector<plain*> dead;
  using slot = std::unique_ptr<plain>;

  static slot make() { return slot(new plain); }
  void make_and_retire() { dead.push_back(new plain); }
  void replace(slot& at) {
    dead.push_back(at.release());
    at = make();
  }
  void end_batch() {
    for (plain* p : dead) delete p;
    dead.clear();
  }
};

template <class Worker>
struct shared_state {
  slamgc::domain domain;
  per_thread<std::optional<Worker>> workers;
};

template <class Worker, class State, class Run>
contender make(const char* name, const std::shared_ptr<State>& s, Run run) {
  contender c{name, run};
  c.prepare = [s](unsigned thread, std::uint64_t) { s->workers[thread].emplace(s->domain); };
  c.finish = [s](unsigned thread) { s->workers[thread].reset(); };
  return c;
}

/// One operation is @p size objects, which all wait at the same time.
template <class Worker>
contender retiring(const char* name, std::size_t size) {
  const auto s = std::make_shared<shared_state<Worker>>();
  return make<Worker>(name, s, [s, size](unsigned thread, std::uint64_t n, unsigned) {
    Worker& w = *s->workers[thread];
    for (; n != 0; --n) {
      for (std::size_t i = 0; i != size; ++i) w.make_and_retire();
      w.end_batch();
    }
  });
}

/// One operation is a batch of replacements in a population of @p live objects.
template <class Worker>
contender replacing(const char* name, std::size_t live) {
  struct state : shared_state<Worker> {
    std::vector<typename Worker::slot> population;
    std::minstd_rand random;
  };
  const auto s = std::make_shared<state>();
  return make<Worker>(name, s, [s, live](unsigned thread, std::uint64_t n, unsigned) {
    Worker& w = *s->workers[thread];
    while (s->population.size() != live) s->population.push_back(Worker::make());
    for (; n != 0; --n) {
      for (unsigned i = 0; i != batch; ++i) w.replace(s->population[s->random() % live]);
      w.end_batch();
    }
  });
}

std::vector<group> all() {
  std::vector<group> groups{{"threads",
                             "batches of 1024",
                             {retiring<slamgc_worker>("slamgc", batch),
                              retiring<plain_worker>("new+delete, batched", batch)},
                             batch,
                             {1, 2, 4, 8, 16, 32, most_threads}}};
  for (const std::size_t live : {1000u, 10000u, 100000u, 1000000u})
    groups.push_back({"live objects",
                      std::to_string(live),
                      {replacing<slamgc_worker>("slamgc", live),
                       replacing<plain_worker>("new+delete, batched", live)},
                      batch,
                      {1}});
  for (const std::size_t size : {1000u, 10000u, 100000u, 1000000u})
    groups.push_back({"backlog",
                      std::to_string(size),
                      {retiring<slamgc_worker>("slamgc", size),
                       retiring<plain_worker>("new+delete, batched", size)},
                      size,
                      {1}});
  return groups;
}

}  // namespace

int main(int argc, char** argv) { return run(argc, argv, all()); }
