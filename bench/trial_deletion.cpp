// Trial deletion of 100 retired objects in live maps of 1,000 to 100,000: what it costs must not depend on the map.
//
// The 100 form a ring, refer to live objects, and are referred to by none.
#include <cstdio>
#include <vector>

#include "graph.hpp"

namespace {

using namespace bench;

void measure(std::size_t size, unsigned round) {
  constexpr std::size_t retired = 100;
  slamgc::domain domain;
  map live(domain);
  double begin = 0;
  {
    slamgc::mutator me(domain, "main");
    live.grow_to(size);
    me.quiescent();
    domain.collect();
    std::vector<node*> dead;
    for (std::size_t i = 0; i != retired; ++i) dead.push_back(new node);
    for (std::size_t i = 0; i != retired; ++i) {
      dead[i]->seen_by.push_back(dead[(i + 1) % retired]);
      for (unsigned j = 1; j != map::degree; ++j)
        dead[i]->seen_by.push_back(live.nodes[i * 37 * j % size]);
    }
    me.quiescent();
    begin = cpu();
    for (node* p : dead) slamgc::retire(p);
  }
  std::size_t reclaimed = 0;
  for (;;) {
    const auto did = domain.collect();
    reclaimed += did.reclaimed;
    if (did.result == slamgc::collected::outcome::done) break;
  }
  std::printf("{\"map\": %zu, \"round\": %u, \"cpu_ms\": %.5f}\n", size, round, cpu() - begin);
  expect(reclaimed == retired, "objects are left");
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
      measure(size, round);
}
