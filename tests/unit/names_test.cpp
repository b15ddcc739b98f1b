// Names of the program's own, next to its types, get in nobody's way: slamgc finds its functions, not
// the program's, although argument-dependent lookup would prefer those.
#include <gtest/gtest.h>

#include <slamgc/slamgc.hpp>

#include "support/instances.hpp"

namespace program {
namespace {

struct node : slamgc::rc_object<node>, support::instances<node> {
  virtual ~node() = default;
  // Members named like the library's own.
  struct policy {};
  struct reclaimer {};
  struct object {};
  using env = int;
  int count = 1, state_ = 2, version = 3, link = 4;
};
struct derived : node {};

int called = 0;
template <class T>
const void* hijack(T*) {
  ++called;
  return nullptr;
}

// Better matches than slamgc's templates.
[[maybe_unused]] const void* base_of(const node* p) { return hijack(p); }
[[maybe_unused]] void add_reference(node* p) { hijack(p); }
[[maybe_unused]] void drop_reference(node* p) { hijack(p); }
[[maybe_unused]] void move_reference(node* p) { hijack(p); }
[[maybe_unused]] void mark_dying(const node* p) { hijack(p); }
[[maybe_unused]] bool is_dying(const node* p) { return hijack(p) != nullptr; }
[[maybe_unused]] void misuse_of(const node* p, const char*) { hijack(p); }
[[maybe_unused]] void destroy(node* p) { hijack(p); }
[[maybe_unused]] void destroy_object(node* p) { hijack(p); }
[[maybe_unused]] bool uncount_reference(node* p) { return hijack(p) != nullptr; }
[[maybe_unused]] void release(node* p) { hijack(p); }
[[maybe_unused]] node* moved(node* p) { return (hijack(p), p); }
[[maybe_unused]] bool address_less(node* p, node*) { return hijack(p) != nullptr; }
[[maybe_unused]] node* reference_of(node* p) { return (hijack(p), p); }

template <class Pointer>
void use() {
  const slamgc::intrusive_rc<node> p = slamgc::make_rc<derived>();
  Pointer other(p.get());
  slamgc::rc_slot<node> slot(p);
  slamgc::rc_slot<node> second;
  second = std::move(slot);
  second.swap(slot);
  slamgc::rc_vector<node> vector = {p.get()};
  vector[0] = p.get();
  vector.edit()->push_back(p.get());
  slamgc::rc_list<node> list = {p.get()};
  list.splice(list.end(), list, list.begin());
  slamgc::rc_set<node> set = {p.get()};
  slamgc::rc_map<node, int> map = {{p.get(), 1}};
  slamgc::rc_value_map<int, node> value_map = {{1, p.get()}};
  const slamgc::scoped_count scope(vector.raw());
  EXPECT_EQ(p->use_count(), 11u);
  set.erase(p.get());
  map.clear();
  EXPECT_FALSE(p < other.get());
}

TEST(Names, FunctionsNextToTheTypeAreNotMistakenForTheLibrarys) {
  use<slamgc::intrusive_rc<node>>();
  EXPECT_EQ(called, 0);
  EXPECT_EQ(node::live(), 0);
}

}  // namespace
}  // namespace program
