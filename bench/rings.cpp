// Rings of objects that nobody else refers to: trial deletion against breaking each ring by hand and deleting its objects; how
// that grows; and what it costs, and costs others, while two threads work on the rest of the graph.
#include <slamgc/slamgc.hpp>

#include <atomic>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "graph.hpp"

namespace {

using namespace bench;

struct link : slamgc::rc_object<link, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("next", next);
  }
  slamgc::rc_slot<link> next;
  std::uint64_t payload[5];
};
struct plain {
  plain* next;
  std::uint64_t payload[7];
};
static_assert(sizeof(plain) == sizeof(link));

template <class T>
std::vector<T*> rings(std::size_t n, std::size_t length) {
  std::vector<T*> all;
  all.reserve(n * length);
  for (std::size_t i = 0; i != n; ++i) {
    const std::size_t first = all.size();
    for (std::size_t j = 0; j != length; ++j) all.push_back(new T);
    for (std::size_t j = 0; j != length; ++j) all[first + j]->next = all[first + (j + 1) % length];
  }
  return all;
}

void report(const char* how, std::size_t n, std::size_t length, unsigned round, double ms,
            double throughput = 0) {
  std::printf(
      "{\"how\": \"%s\", \"rings\": %zu, \"length\": %zu, \"round\": %u, \"cpu_ms\": %.5f, "
      "\"throughput\": %.1f}\n",
      how, n, length, round, ms, throughput);
}

struct shared {
  std::shared_ptr<shared> next;
  std::uint64_t payload[4];
};

/// The floor: what is left to do when nothing has to be found out.
void delete_all(std::size_t n, std::size_t length, unsigned round) {
  const std::vector<plain*> all = rings<plain>(n, length);
  const double begin = cpu();
  for (plain* p : all) delete p;
  report("delete", n, length, round, cpu() - begin);
}
/// Counted, and each ring broken by hand; one by one, since the destructors of a ring of a million would recurse.
void by_hand(std::size_t n, std::size_t length, unsigned round) {
  std::vector<std::shared_ptr<shared>> all;
  all.reserve(n * length);
  for (std::size_t i = 0; i != n; ++i) {
    const std::size_t first = all.size();
    for (std::size_t j = 0; j != length; ++j) all.push_back(std::make_shared<shared>());
    for (std::size_t j = 0; j != length; ++j) all[first + j]->next = all[first + (j + 1) % length];
  }
  const double begin = cpu();
  for (auto& p : all) p->next = nullptr;
  for (auto& p : all) p = nullptr;
  report("by hand", n, length, round, cpu() - begin);
}

double collect_rings(slamgc::domain& domain, std::size_t n, std::size_t length) {
  std::vector<link*> all;
  {
    slamgc::mutator me(domain, "main");
    all = rings<link>(n, length);
    const double begin = cpu();
    for (link* p : all) slamgc::retire(p);
    return begin;
  }
}
void trial_deletion(std::size_t n, std::size_t length, unsigned round) {
  slamgc::domain domain;
  const double begin = collect_rings(domain, n, length);
  while (domain.collect().result != slamgc::collected::outcome::done) {
  }
  report("trial deletion", n, length, round, cpu() - begin);
  expect(domain.stats().types.front().live == 0, "objects are left");
}

/// Two threads move edges about in a graph of their own, in the same domain.
class others {
 public:
  explicit others(slamgc::domain& domain) {
    for (unsigned i = 0; i != 2; ++i)
      threads_.emplace_back([this, &domain, i] { work(domain, i); });
    while (ready_ != 2) std::this_thread::yield();
  }
  ~others() {
    ending_ = true;
    for (auto& t : threads_) t.join();
  }
  std::uint64_t done() const { return done_[0].n + done_[1].n; }
  double time() const { return done_[0].cpu_ms + done_[1].cpu_ms; }

 private:
  struct alignas(64) number {
    std::atomic<std::uint64_t> n{0};
    std::atomic<double> cpu_ms{0};
  };
  void work(slamgc::domain& domain, unsigned i) {
    slamgc::mutator me(domain, "other");
    std::vector<slamgc::intrusive_rc<link>> mine;
    for (unsigned j = 0; j != 1000; ++j) mine.emplace_back(new link);
    ++ready_;
    std::uint64_t random = i + 1;
    const double begin = cpu();
    while (!ending_) {
      for (unsigned j = 0; j != 1000; ++j) {
        random = random * 6364136223846793005u + 1442695040888963407u;
        mine[random >> 54 & 511]->next = mine[random >> 44 & 511].get();
      }
      done_[i].n += 1000;
      done_[i].cpu_ms = cpu() - begin;
      me.quiescent();
    }
    for (auto& p : mine) p->next = nullptr;
    for (auto& p : mine) slamgc::retire(p.get());
  }
  std::atomic<unsigned> ready_{0};
  std::atomic<bool> ending_{false};
  number done_[2];
  std::vector<std::thread> threads_;
};

void beside_others(std::size_t n, std::size_t length, unsigned round, bool collects) {
  slamgc::domain domain;
  others two(domain);
  const std::uint64_t before = two.done();
  const double time_before = two.time();
  double spent = 0;
  unsigned repeated = 0;
  const double begin = wall();
  do {
    if (collects) {
      const double from = collect_rings(domain, n, length);
      // Until these are gone: the others' objects stay.
      while (domain.stats().types.front().reclaimed < ++repeated * n * length) {
        --repeated;
        domain.collect();
        std::this_thread::yield();
      }
      spent += cpu() - from;
    } else {
      ++repeated;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  } while (wall() - begin < 300);
  const double per_ms = static_cast<double>(two.done() - before) / (two.time() - time_before);
  report(collects ? "beside two threads" : "two threads alone", n, length, round, spent / repeated,
         per_ms);
}

}  // namespace

int main(int argc, char** argv) {
  const options o = parse(argc, argv);
  for (unsigned round = 0; round != o.rounds; ++round) {
    const std::size_t n = o.smoke ? 10 : 1000;
    delete_all(n, 100, round);
    by_hand(n, 100, round);
    trial_deletion(n, 100, round);
    if (o.smoke) {
      beside_others(n, 100, round, true);
      continue;
    }
    for (std::size_t more = 10; more <= 10000; more *= 10) {
      if (more == n) continue;
      by_hand(more, 100, round);
      trial_deletion(more, 100, round);
    }
    by_hand(1, 1000000, round);
    trial_deletion(1, 1000000, round);
    beside_others(n, 100, round, round % 2 == 0);
    beside_others(n, 100, round, round % 2 != 0);
  }
}
