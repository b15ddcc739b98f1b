/// @file
/// Models of the zero-count table: what falls to zero enters it once, leaves it when it is referred to
/// again, and is reclaimed when nobody can see it.
#include "deferred_model.hpp"

/// Two threads drop the references of one object and of one each, a third one collects.
struct drop : domain_model<drop, 3> {
  static constexpr unsigned context_bound = 1;
  slot both[2], own[2];

  void before() {
    const mutator m(d, "maker");
    both[0] = both[1] = new node(1);
    own[0] = new node(2);
  }
  void thread(unsigned i) {
    if (i == 2) {
      collect(2);
    } else if (i == 1) {
      both[1].reset();  // not a mutator
    } else {
      const mutator m(d, "drops");
      own[0].reset();
      both[0].reset();
    }
  }
  void after() { drain(); }
};

/// A mutator stores the pointer it borrowed, borrows it again from there, and drops it, while the object
/// waits.
struct stored_again : domain_model<stored_again, 2> {
  slot first, second;

  void before() {
    const mutator m(d, "maker");
    first = new node(1);
  }
  void thread(unsigned i) {
    if (i == 1) {
      first.reset();
      collect(2);
    } else {
      mutator m(d, "stores again");
      second = first;
      m.quiescent();
      const node* const seen = second;
      second.reset();
      if (seen != nullptr) require(seen->value.get() == 1, "alive while borrowed");
    }
  }
  void after() { drain(); }
};

/// The same, but the thread that stores again brings the object through the table, while another one, which
/// is no mutator, is at its decrement.
struct stored_meanwhile : domain_model<stored_meanwhile, 2> {
  slot first, second;

  void before() {
    const mutator m(d, "maker");
    first = new node(1);
  }
  void thread(unsigned i) {
    if (i == 1) {
      first.reset();
    } else {
      {
        const mutator m(d, "stores again");
        second = first;
        second.reset();
      }
      collect(2);
    }
  }
  void after() { drain(); }
};

/// An object that waits, but is referred to: the references go while the collector lets it leave the table.
struct leave : domain_model<leave, 3> {
  static constexpr unsigned cases = 2;
  static constexpr unsigned context_bound = 1;
  slot shared[2];

  void before() {
    const mutator m(d, "maker");
    node* const waits = new node(1);
    shared[0] = waits;
    shared[0].reset();
    shared[0] = waits;
    if (current_case == 1) shared[1] = waits;
  }
  void thread(unsigned i) {
    if (i == 2) {
      collect(3);
    } else if (i == 1) {
      const mutator m(d, "drops");
      shared[1].reset();
    } else {
      shared[0].reset();
    }
  }
  void after() { drain(); }
};

int main() { return check_models<drop, stored_again, stored_meanwhile, leave>(); }
