// How the cost of a whole container grows with its elements. Swapping and moving counted containers
// is linear, where the standard ones just exchange pointers: each reference changes its place.
#include "contenders.hpp"

namespace {

using namespace bench;

/// Operations on two containers of @p n elements.
template <class Kind>
struct containers {
  explicit containers(std::size_t n)
      : objects(make_objects<Kind>(2 * n)),
        content_a(source_of<Kind>({objects.begin(), objects.begin() + static_cast<long>(n)})),
        content_b(source_of<Kind>({objects.begin() + static_cast<long>(n), objects.end()})) {
    a = content_a;
    b = content_b;
  }
  std::vector<typename Kind::pointer> objects;
  typename Kind::source content_a, content_b;
  typename Kind::vector a, b, empty;
};

struct rebuild {
  template <class Containers>
  void operator()(Containers& c) const {
    c.a = c.content_b;
    use(&c.a);
    c.a = c.content_a;
    use(&c.a);
  }
};
struct swap_both {
  template <class Containers>
  void operator()(Containers& c) const {
    using std::swap;
    swap(c.a, c.b);
    use(&c.a);
    swap(c.a, c.b);
    use(&c.a);
  }
};
struct move_there_and_back {
  template <class Containers>
  void operator()(Containers& c) const {
    c.empty = std::move(c.a);
    use(&c.empty);
    c.a = std::move(c.empty);
    use(&c.a);
  }
};

template <class Operation, class Kind>
contender of(const char* name, std::size_t n) {
  const auto c = std::make_shared<containers<Kind>>(n);
  return {name, [c](unsigned, std::uint64_t times, unsigned) {
            for (; times != 0; --times) Operation()(*c);
          }};
}

template <class Operation>
void add(std::vector<group>& groups, const char* operation) {
  for (std::size_t n : std::initializer_list<std::size_t>{10, 100, 1000, 10000})
    groups.push_back({operation,
                      std::to_string(n) + " elements",
                      {of<Operation, slamgc_fetch_add>("slamgc::rc_vector<T>", n),
                       of<Operation, boost_kind>("std::vector<boost::intrusive_ptr<T>>", n),
                       of<Operation, raw_kind>("std::vector<T*>", n)},
                      2,
                      {1}});
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<group> groups;
  add<rebuild>(groups, "vector rebuild");
  add<swap_both>(groups, "vector swap");
  add<move_there_and_back>(groups, "vector move");
  return run(argc, argv, groups);
}
