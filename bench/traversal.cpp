// What following borrowed pointers costs: a walk over a graph of 10,000 nodes, by slots under a mutator and by
// raw pointers.
#include <slamgc/deferred.hpp>
#include <slamgc/mutator.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>
#include <vector>

#include "contenders.hpp"

namespace {

using namespace bench;

constexpr std::size_t nodes = 10000;
constexpr std::size_t edges = 4;

struct counted_node
    : slamgc::rc_object<counted_node, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
  std::array<slamgc::rc_slot<counted_node>, edges> to;
  std::uint32_t id = 0;
  std::uint32_t degree = edges;  // what compilers do not know, as with a vector of neighbours
};
/// As large as the other.
struct raw_node {
  std::uint64_t header[2] = {};
  std::array<raw_node*, edges> to{};
  std::uint32_t id = 0;
  std::uint32_t degree = edges;
};
static_assert(sizeof(raw_node) == sizeof(counted_node));

struct graphs {
  std::vector<slamgc::intrusive_rc<counted_node>> counted;
  std::vector<std::unique_ptr<raw_node>> raw;

  graphs() {
    // In turn, so that both graphs have the same places in memory.
    for (std::size_t i = 0; i != nodes; ++i) {
      counted.emplace_back(new counted_node);
      raw.push_back(std::make_unique<raw_node>());
      raw[i]->id = counted[i]->id = static_cast<std::uint32_t>(i);
    }
    std::mt19937 random(1);
    for (std::size_t i = 0; i != nodes; ++i)
      for (std::size_t k = 0; k != edges; ++k) {
        // The first edges are a tree: every node is reached.
        const std::size_t next = k == 0 ? (i + 1) % nodes : random() % nodes;
        counted[i]->to[k] = counted[next];
        raw[i]->to[k] = raw[next].get();
      }
  }
  ~graphs() {
    for (const auto& n : counted)
      for (auto& slot : n->to) slot = nullptr;
  }
  graphs(const graphs&) = delete;
  graphs& operator=(const graphs&) = delete;
};

/// What a thread keeps while it walks.
struct walker {
  std::vector<std::uint32_t> seen = std::vector<std::uint32_t>(nodes);
  std::uint32_t walk = 0;
  std::optional<slamgc::mutator> mutator;

  /// `Constant`: compilers know how many edges a node has, and unroll the loop over raw pointers.
  template <bool Constant, class Node>
  [[gnu::noinline]] std::uint64_t visit_all(Node* root) {
    std::vector<Node*> open;
    open.reserve(nodes);
    ++walk;
    seen[root->id] = walk;
    open.push_back(root);
    std::uint64_t sum = 0;
    while (!open.empty()) {
      Node* const n = open.back();
      open.pop_back();
      const std::size_t degree = Constant ? edges : n->degree;
      sum += degree;
      for (std::size_t k = 0; k != degree; ++k) {
        Node* const next = n->to[k];
        if (seen[next->id] == walk) continue;
        seen[next->id] = walk;
        open.push_back(next);
      }
    }
    return sum;
  }
};

struct state {
  slamgc::domain domain;
  slamgc::mutator builder{domain, "builder", {false, false}};
  // Another one each round: where the nodes are decides more than how they are read.
  std::array<graphs, 16> places;
  per_thread<walker> walkers;
};

template <bool Constant>
std::vector<contender> both(const std::shared_ptr<state>& s) {
  contender borrowed{"slots, under a mutator",
                     [s](unsigned thread, std::uint64_t n, unsigned round) {
                       graphs& g = s->places[round % 16];
                       walker& w = s->walkers[thread];
                       for (; n != 0; --n) {
                         use(w.visit_all<Constant>(g.counted[0].get()));
                         w.mutator->quiescent();
                       }
                     }};
  borrowed.prepare = [s](unsigned thread, std::uint64_t) {
    s->walkers[thread].mutator.emplace(s->domain, "walker");
  };
  borrowed.finish = [s](unsigned thread) { s->walkers[thread].mutator.reset(); };
  return {{"raw pointers",
           [s](unsigned thread, std::uint64_t n, unsigned round) {
             graphs& g = s->places[round % 16];
             walker& w = s->walkers[thread];
             for (; n != 0; --n) use(w.visit_all<Constant>(g.raw[0].get()));
           }},
          borrowed};
}

}  // namespace

int main(int argc, char** argv) {
  const auto s = std::make_shared<state>();
  return run(argc, argv,
             {{"traversal", "10000 nodes", both<false>(s), nodes, {1, 2}},
              {"traversal", "10000 nodes, constant degree", both<true>(s), nodes, {1, 2}}});
}
