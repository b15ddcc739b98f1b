/// @file
/// Models of two threads that collect, one at a time, and of destructors that do.
#include "deferred_model.hpp"

/// One collector goes on where the other has stopped.
struct two_collectors : domain_model<two_collectors, 3> {
  static constexpr unsigned context_bound = 1;
  slot first, second;

  void before() {
    const mutator m(d, "maker");
    first = new node(1);
    second = new node(2);
  }
  void thread(unsigned i) {
    if (i == 2) {
      const mutator m(d, "drops");
      first.reset();
      second.reset();
    } else {
      for (int times = 0; times != 3; ++times) d.collect({1});
    }
  }
  void after() { drain(); }
};

/// A destructor that collects, drops a reference and retires an object.
struct parent : from_arena,
                slamgc::rc_object<parent, relacy_fetch_add_counter, slamgc::reclaim_deferred> {
  domain& d;
  slot child{new node(1)};
  node* const uncounted = new node(2);

  explicit parent(domain& of) : d(of) {}
  ~parent() {
    require(d.collect().result == outcome::busy, "one collection at a time");
    require(d.drain() == slamgc::waited::refused, "would wait for itself");
    require(slamgc::retire(uncounted), "retired once");
    child.reset();
  }
};
struct collecting_destructor : domain_model<collecting_destructor, 2> {
  slamgc::rc_slot<parent, relacy_env> shared;

  void before() {
    const mutator m(d, "maker");
    shared = new parent(d);
  }
  void thread(unsigned i) {
    if (i == 0) shared.reset();
    for (int times = 0; times != 2; ++times) d.collect({2});  // ends behind a destructor
  }
  void after() { drain(); }
};

int main() { return check_models<two_collectors, collecting_destructor>(); }
