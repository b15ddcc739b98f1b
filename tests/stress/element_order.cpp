// Elements of containers that several threads assign at once: the orders of env.hpp, (1) and (2), which
// act on plain pointers, where relacy cannot see them. ThreadSanitizer does.
#include <gtest/gtest.h>

#include <slamgc/slamgc.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "support/stress.hpp"

namespace {

using support::in_threads;
using support::rounds;

struct node : slamgc::rc_object<node, support::yielding_fetch_add> {
  explicit node(int v) : value(v) {}
  ~node() {
    EXPECT_EQ(value, 1);  // plain, as is what follows: a race is reported if nothing orders them
    value = -1;
  }
  int value;
};

template <class Container>
class ElementOrder : public ::testing::Test {};
using containers = ::testing::Types<slamgc::rc_vector<node>, slamgc::rc_value_map<int, node>>;
struct names {
  template <class Container>
  static std::string GetName(int) {
    return std::is_same<Container, slamgc::rc_vector<node>>::value ? "rc_vector" : "rc_value_map";
  }
};
TYPED_TEST_SUITE(ElementOrder, containers, names);

template <class Container>
Container one_element() {
  Container made;
  made.insert(made.end(), typename Container::value_type{});
  return made;
}

// The element holds the only reference: who replaces a pointer destroys what the other thread made.
TYPED_TEST(ElementOrder, TheLastReferenceInAnElementIsReleasedOnce) {
  TypeParam shared = one_element<TypeParam>();
  in_threads(2, [&](int) {
    for (int i = 2 * rounds(); i != 0; --i) shared[0] = new node(1);
  });
}

// Other references keep the objects, and the other thread reads what it finds, without a lock.
TYPED_TEST(ElementOrder, WhoReadsAnElementSeesTheWholeObject) {
  TypeParam shared = one_element<TypeParam>();
  std::vector<slamgc::intrusive_rc<node>> kept[2];
  in_threads(2, [&](int thread) {
    for (int i = 2 * rounds(); i != 0; --i) {
      kept[thread].push_back(slamgc::make_rc<node>(1));
      shared[0] = kept[thread].back().get();
      if (const node* const seen = shared[0].get()) {
        ASSERT_EQ(seen->value, 1);
      }
    }
  });
  shared.clear();
  for (const auto& references : kept)
    for (const auto& reference : references) EXPECT_EQ(reference->use_count(), 1u);
}

// One thread only reads: nothing but the load of the element orders it after the writer.
TYPED_TEST(ElementOrder, WhoOnlyReadsAnElementSeesTheWholeObject) {
  TypeParam shared = one_element<TypeParam>();
  std::vector<slamgc::intrusive_rc<node>> kept;
  in_threads(2, [&](int thread) {
    for (int i = 2 * rounds(); i != 0; --i) {
      if (thread == 0) {
        kept.push_back(slamgc::make_rc<node>(1));
        shared[0] = kept.back().get();
      } else if (const node* const seen = shared[0].get()) {
        ASSERT_EQ(seen->value, 1);
      }
    }
  });
}

}  // namespace
