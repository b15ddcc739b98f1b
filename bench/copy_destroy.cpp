// What a copy of a counted pointer and its destruction cost.
#include "contenders.hpp"

namespace {

using namespace bench;

template <std::size_t Objects>
struct copy_destroy {
  template <class Kind>
  struct of {
    contender operator()(const char* name) const {
      const auto objects = std::make_shared<std::vector<typename Kind::pointer>>(
          make_objects<Kind>(std::max<std::size_t>(Objects, object_choices)));
      return {name, [objects](unsigned thread, std::uint64_t n, unsigned round) {
                const auto* const all = objects->data() + first_object<Objects>(round);
                std::size_t i = first_place<Objects>(thread);
                for (; n != 0; --n) {
                  const typename Kind::pointer copy(all[i]);
                  use(copy.get());
                  i = (i + 1) % Objects;
                }
              }};
    }
  };
};

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv,
             {{"copy+destroy", "one object", all_kinds<copy_destroy<1>::of>()},
              {"copy+destroy", "spread objects", all_kinds<copy_destroy<spread_objects>::of>()}});
}
