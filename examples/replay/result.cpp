#include "result.hpp"

#include <algorithm>

#include "state.hpp"

namespace replay {

distribution distribution_of(const std::vector<const thinned*>& parts) {
  distribution d;
  std::vector<float> all;
  double sum = 0;
  for (const thinned* const part : parts) {
    d.count += part->count();
    sum += part->mean() * static_cast<double>(part->count());
    d.max = std::max(d.max, part->max());
    all.insert(all.end(), part->kept().begin(), part->kept().end());
  }
  if (all.empty()) return d;
  std::sort(all.begin(), all.end());
  const auto quantile = [&](double q) {
    return static_cast<double>(
        all[static_cast<std::size_t>(q * static_cast<double>(all.size() - 1))]);
  };
  d.mean = sum / static_cast<double>(d.count);
  d.median = quantile(0.5);
  d.p90 = quantile(0.9);
  d.p99 = quantile(0.99);
  return d;
}

std::uint64_t digest_of(const map_state& s) {
  std::uint64_t digest = 0;
  for (const auto& kind : s.kinds)
    for (const auto& e : kind.second) {
      digest = mixed(digest, static_cast<std::uint64_t>(kind.first));
      for (const int n : e) digest = mixed(digest, static_cast<std::uint64_t>(n));
    }
  return digest;
}

std::int64_t growth_of(const run_result& r) {
  return r.lap_live.size() < 3 ? 0 : r.lap_live.back() - r.lap_live[1];
}

void add_ledger(run_result& r) {
  const ledger& l = ledger::now();
  std::vector<const thinned*> deaths;
  for (std::size_t i = 0; i != roles; ++i) {
    const role_ledger& of = l.of(static_cast<role>(i));
    for (std::size_t k = 0; k != 2; ++k) r.made[k] += of.made[k];
    if (of.death_delay.count() != 0) deaths.push_back(&of.death_delay);
    if (of.wall.count() == 0 && of.destroyed[0] + of.destroyed[1] == 0) continue;
    thread_result t;
    t.name = name_of(static_cast<role>(i));
    t.wall = distribution_of({&of.wall});
    t.cpu = distribution_of({&of.cpu});
    for (std::size_t k = 0; k != 2; ++k) t.destroyed[k] = of.destroyed[k];
    t.longest_pause = of.longest_pause;
    t.reclaiming = of.reclaiming;
    r.threads.push_back(t);
  }
  for (std::size_t k = 0; k != 2; ++k) r.marked[k] = l.marked[k].load();
  r.death_delay = distribution_of(deaths);
}

}  // namespace replay
