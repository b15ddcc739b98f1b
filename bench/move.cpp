// What moving a counted pointer there and back costs; for rc_slot this is moving an edge.
#include "contenders.hpp"

namespace {

using namespace bench;

template <class Kind>
struct slot_as_pointer : Kind {
  using pointer = typename Kind::slot;
  static pointer make() { return pointer(Kind::make()); }
};

template <std::size_t Objects>
struct move {
  template <class Kind>
  struct of {
    contender operator()(const char* name) const {
      using pointer = typename Kind::pointer;
      const auto pointers = std::make_shared<per_thread<std::vector<pointer>>>();
      if (Objects == 1) {
        std::vector<pointer> choices = make_objects<Kind>(object_choices);
        for (unsigned i = 0; i != max_threads; ++i)
          for (const pointer& object : choices) (*pointers)[i].push_back(object);
      } else {
        for (unsigned i = 0; i != max_threads; ++i)
          (*pointers)[i] = make_objects<Kind>(Objects / max_threads);
      }
      return {name, [pointers](unsigned thread, std::uint64_t n, unsigned round) {
                pointer* const all = (*pointers)[thread].data() + first_object<Objects>(round);
                constexpr std::size_t mine = Objects == 1 ? 1 : Objects / max_threads;
                for (std::size_t i = 0; n != 0; --n) {
                  pointer there(std::move(all[i]));
                  use(&there);
                  all[i] = std::move(there);
                  i = (i + 1) % mine;
                }
              }};
    }
  };
};

template <std::size_t Objects>
std::vector<contender> kinds() {
  std::vector<contender> all = all_kinds<move<Objects>::template of>();
  all.push_back(typename move<Objects>::template of<slot_as_pointer<slamgc_fetch_add>>()(
      "slamgc rc_slot, fetch_add"));
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv,
             {{"move there and back", "one object", kinds<1>()},
              {"move there and back", "spread objects", kinds<spread_objects>()}});
}
