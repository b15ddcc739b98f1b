// What assigning a member that is a counted pointer costs. Each thread has a member of its own.
// rc_slot and the two "atomic" contenders may be assigned by several threads, the others may not.
#include "contenders.hpp"

namespace {

using namespace bench;

template <std::size_t Objects>
struct assign {
  template <class Kind>
  struct of {
    contender operator()(const char* name) const {
      using pointer = typename Kind::pointer;
      struct state {
        std::vector<pointer> objects =
            make_objects<Kind>(std::max<std::size_t>(Objects, object_choices));
        per_thread<typename Kind::slot> slots;
      };
      const auto s = std::make_shared<state>();
      return {name, [s](unsigned thread, std::uint64_t n, unsigned round) {
                const pointer* const all = s->objects.data() + first_object<Objects>(round);
                auto& slot = s->slots[thread];
                std::size_t i = first_place<Objects>(thread);
                for (; n != 0; --n) {
                  slot = all[i];
                  use(&slot);
                  i = (i + 1) % Objects;
                }
              }};
    }
  };
};

template <std::size_t Objects>
std::vector<contender> kinds() {
  using of = assign<Objects>;
  std::vector<contender> all = all_kinds<of::template of>();
  all.push_back(
      typename of::template of<hand_atomic_kind<hand_fetch_add>>()("hand fetch_add, atomic"));
  all.push_back(typename of::template of<shared_atomic_kind>()("std::shared_ptr, atomic"));
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv,
             {{"slot assignment", "one object", kinds<1>()},
              {"slot assignment", "spread objects", kinds<spread_objects>()}});
}
