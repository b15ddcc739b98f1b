/// @file
/// Models of threads that come and go: nothing that they dropped is lost, their records are used again, and
/// the state of a domain is freed by the last one.
#include "deferred_model.hpp"

/// Two mutators end with objects that they have not published, one after the other or at the same time, while a
/// thread that is none drops the last reference to an object.
struct mutator_exit : domain_model<mutator_exit, 3> {
  static constexpr unsigned context_bound = 1;
  slot kept;

  void before() {
    const mutator m(d, "maker");
    kept = new node(1);
  }
  void thread(unsigned i) {
    if (i == 2) {
      kept.reset();
      collect(1);
    } else {
      const mutator m(d, "makes and drops");
      slot(new node(2)).reset();
    }
  }
  void after() { drain(); }
};

/// Three mutators, of which two share a door. One has objects of two types.
struct shared_door : domain_model<shared_door, 3> {
  static constexpr unsigned context_bound = 1;
  slot made[3];

  void before() {
    const mutator m(d, "maker");
    for (auto& s : made) s = new node(1);
    delete new kept_node(3);
  }
  void thread(unsigned i) {
    const mutator m(d, "drops");
    made[i].reset();
    if (i == 0) slamgc::retire(new kept_node(2));
  }
  void after() { drain(); }
};

/// A mutator that outlives its domain, and frees the state.
struct state_outlives_domain : model_base<state_outlives_domain, 2> {
  domain* d = nullptr;
  relacy_env::atomic<bool> registered{false};
  relacy_env::atomic<bool> ended{false};

  void before() {
    d = new domain;
    const mutator m(*d, "maker");
    const slot dropped(new node(1));
  }
  void thread(unsigned i) {
    if (i == 0) {
      const mutator m(*d, "outlives the domain", {false, false});
      registered.store(true, std::memory_order_release);
      while (!ended.load(std::memory_order_relaxed)) rl::yield(1, RELACY_HERE);
    } else {
      while (!registered.load(std::memory_order_acquire)) rl::yield(1, RELACY_HERE);
      delete d;  // reclaims the object
      ended.store(true, std::memory_order_relaxed);
    }
  }
};

/// Numbers that are read while a mutator registers.
struct read_numbers : domain_model<read_numbers, 2> {
  static constexpr unsigned context_bound = 1;

  void thread(unsigned i) {
    if (i == 0) {
      const mutator m(d, "makes and drops");
      const slot mine(new node(1));
    } else {
      const slamgc::domain_stats seen = d.stats();
      require(seen.mutators.size() <= 1, "one mutator");
      require(seen.total(&slamgc::type_stats::created) <= 1, "one object");
    }
  }
  void after() {
    drain();
    require(d.stats().mutators.empty(), "the mutator has left");
  }
};

int main() {
  return check_models<read_numbers, mutator_exit, shared_door, state_outlives_domain>();
}
