// The purge of stale edges: per live edge walked and per stuck object, against the size of the map; and how long the slices
// are when collect() has a budget of a millisecond.
#include <algorithm>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "graph.hpp"

namespace {

using namespace bench;

void measure(std::size_t size, std::size_t stuck, unsigned round) {
  slamgc::domain domain;
  map live(domain);
  std::size_t edges = 0;
  {
    slamgc::mutator me(domain, "main");
    live.grow_to(size);
    me.quiescent();
    domain.collect();
    edges = live.edge_count();
    std::mt19937_64 random(round);
    for (std::size_t i = 0; i != stuck; ++i) slamgc::retire(live.nodes[i * (size / stuck)].get());
  }
  std::vector<double> slices;
  std::size_t reclaimed = 0;
  const double begin = cpu();
  for (;;) {
    const double from = wall(), cpu_from = cpu();
    const auto did = domain.collect({static_cast<std::size_t>(-1), std::chrono::milliseconds(1)});
    slices.push_back(std::min(wall() - from, cpu() - cpu_from));
    reclaimed += did.reclaimed;
    if (did.result == slamgc::collected::outcome::done) break;
  }
  const double all = cpu() - begin;
  std::sort(slices.begin(), slices.end());
  std::printf(
      "{\"map\": %zu, \"edges\": %zu, \"stuck\": %zu, \"round\": %u, \"cpu_ms\": %.5f, "
      "\"slices\": %zu, \"slice_p99_ms\": %.5f, \"slice_max_ms\": %.5f}\n",
      size, edges, stuck, round, all, slices.size(), slices[slices.size() * 99 / 100],
      slices.back());
  expect(reclaimed == stuck, "stuck objects are left");
  {
    slamgc::mutator me(domain, "main");
    live.retire_all();
    live.nodes.clear();
  }
  expect(domain.drain() == slamgc::waited::done, "not drained");
}

}  // namespace

int main(int argc, char** argv) {
  const options o = parse(argc, argv);
  for (unsigned round = 0; round != o.rounds; ++round)
    for (std::size_t size = 1000; size <= (o.smoke ? 1000 : 100000); size *= 10)
      for (std::size_t stuck = 1; stuck <= 100; stuck *= 10) measure(size, stuck, round);
}
