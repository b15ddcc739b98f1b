// What it costs per element to assign a vector of pointers that is full of others: all of them, or
// one in twenty. Each thread has a vector of its own; the objects are shared.
#include "contenders.hpp"

namespace {

using namespace bench;

constexpr std::size_t size = 1000;

template <bool OneObject, bool MostStay>
struct rebuild {
  template <class Kind>
  struct of {
    contender operator()(const char* name) const {
      struct state {
        std::vector<typename Kind::pointer> roots;
        typename Kind::source a, b;
        per_thread<typename Kind::vector> vectors;
      };
      const auto s = std::make_shared<state>();
      s->roots = make_objects<Kind>(OneObject ? 2 : 2 * size);
      std::vector<typename Kind::pointer> a, b;
      for (std::size_t i = 0; i != size; ++i) {
        a.push_back(s->roots[OneObject ? 0 : i]);
        const bool stays = MostStay && i % 20 != 0;
        b.push_back(stays ? a.back() : s->roots[OneObject ? 1 : size + i]);
      }
      s->a = source_of<Kind>(a);
      s->b = source_of<Kind>(b);
      for (unsigned i = 0; i != max_threads; ++i) s->vectors[i] = s->b;
      return {name, [s](unsigned thread, std::uint64_t n, unsigned) {
                auto& v = s->vectors[thread];
                for (; n != 0; --n) {
                  v = s->a;
                  use(&v);
                  v = s->b;
                  use(&v);
                }
              }};
    }
  };
};

template <bool OneObject, bool MostStay>
group of(const char* operation, const char* shape) {
  using make = rebuild<OneObject, MostStay>;
  group g{operation, shape, all_kinds<make::template of>(), 2 * size};
  g.contenders.push_back(typename make::template of<raw_kind>()("std::vector<T*>"));
  return g;
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv,
             {of<true, false>("container rebuild, all changed", "one object"),
              of<false, false>("container rebuild, all changed", "spread objects"),
              of<true, true>("container rebuild, 5 % changed", "one object"),
              of<false, true>("container rebuild, 5 % changed", "spread objects")});
}
