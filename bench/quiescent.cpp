// What a thread pays for being a mutator: quiescent states, and going offline and online.
#include <slamgc/mutator.hpp>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "contenders.hpp"

namespace {

using namespace bench;

std::vector<contender> all() {
  struct state {
    slamgc::domain domain;
    per_thread<std::atomic<std::uint64_t>> counters;
    per_thread<std::optional<slamgc::mutator>> mutators;
  };
  const auto s = std::make_shared<state>();
  const auto as_mutator = [s](contender c) {
    c.prepare = [s](unsigned thread, std::uint64_t) {
      s->mutators[thread].emplace(s->domain, "worker");
    };
    c.finish = [s](unsigned thread) { s->mutators[thread].reset(); };
    return c;
  };
  return {
      {"atomic pair",
       [s](unsigned thread, std::uint64_t n, unsigned) {
         // Each thread has its own counter.
         std::atomic<std::uint64_t>& counter = s->counters[thread];
         for (; n != 0; --n) {
           counter.fetch_add(1, std::memory_order_relaxed);
           counter.fetch_sub(1, std::memory_order_acq_rel);
         }
       }},
      as_mutator({"quiescent()",
                  [s](unsigned thread, std::uint64_t n, unsigned) {
                    slamgc::mutator& m = *s->mutators[thread];
                    for (; n != 0; --n) {
                      m.quiescent();
                      use(&m);
                    }
                  }}),
      as_mutator({"offline, online",
                  [s](unsigned thread, std::uint64_t n, unsigned) {
                    slamgc::mutator& m = *s->mutators[thread];
                    for (; n != 0; --n) {
                      const slamgc::mutator::offline_scope offline(m);
                      use(&m);
                    }
                  }}),
  };
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv, {{"quiescent state", "nothing to do", all(), 1, {1, 2}}});
}
