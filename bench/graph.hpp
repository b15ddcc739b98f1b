// What the benchmarks of the graph share: a map of nodes with described edges, times, and the command line.
#pragma once

#include <slamgc/slamgc.hpp>

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <random>
#include <vector>

namespace bench {

/// The calling thread's own time, in ms.
inline double cpu() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}
inline double wall() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

struct options {
  unsigned rounds = 11;
  bool smoke = false;
};
inline options parse(int argc, char** argv) {
  options o;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--smoke") == 0) {
      o.smoke = true;
      o.rounds = 1;
    } else if (std::strncmp(argv[i], "--rounds=", 9) == 0) {
      o.rounds = static_cast<unsigned>(std::strtoul(argv[i] + 9, nullptr, 10));
    } else {
      std::fprintf(stderr, "usage: %s [--smoke] [--rounds=N]\n", argv[0]);
      std::exit(2);
    }
  }
  return o;
}
inline void expect(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "%s\n", what);
  std::exit(1);
}

/// An object of a map, the size of a small map point.
struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("neighbours", neighbours, slamgc::on_retire::erase);
    v.edge("seen_by", seen_by, slamgc::on_retire::null);
  }
  slamgc::rc_set<node> neighbours;
  slamgc::rc_vector<node> seen_by;
};

/// A live map: each node has `degree` edges, half of them to nodes nearby, as in a map that was driven along.
struct map {
  static constexpr unsigned degree = 20;

  explicit map(slamgc::domain& domain) : root(domain, "map", *this) {}
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("nodes", nodes, slamgc::on_retire::null);
  }
  void grow_to(std::size_t size) {
    std::mt19937_64 random(size);
    nodes.reserve(size);
    while (nodes.size() < size) nodes.push_back(new node);
    for (std::size_t i = 0; i != size; ++i) {
      for (unsigned j = 0; j != degree / 2; ++j) {
        nodes[i]->neighbours.insert(nodes[(i + 1 + random() % 100) % size]);
        nodes[i]->seen_by.push_back(nodes[random() % size]);
      }
    }
  }
  std::size_t edge_count() const {
    std::size_t n = nodes.size();
    for (const node* p : nodes.raw()) n += p->neighbours.size() + p->seen_by.size();
    return n;
  }
  void retire_all() {
    for (node* p : nodes.raw())
      if (p != nullptr) slamgc::retire(p);
  }

  slamgc::rc_vector<node> nodes;
  slamgc::root root;
};

}  // namespace bench
