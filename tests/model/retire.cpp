/// @file
/// Models of retire(): against the last decrement, against another retire(), and against the collector.
#include "deferred_model.hpp"

/// Two threads retire an object while a third one drops its last reference and collects.
template <class Reclaimer>
struct retire_and_drop : domain_model<retire_and_drop<Reclaimer>, 3> {
  using object = deferred_object<Reclaimer>;
  static constexpr unsigned context_bound = 1;
  slamgc::rc_slot<object, relacy_env> shared;
  object* made;
  int retired = 0;  // successes

  void before() {
    const mutator m(this->d, "maker");
    shared = made = new object(1);
  }
  void thread(unsigned i) {
    if (i == 2) {
      shared.reset();
      this->collect(2);
    } else {
      const mutator m(this->d, "retires");
      object* const seen = shared;
      if (seen == nullptr) return;
      if (slamgc::retire(seen)) ++retired;
      require(!slamgc::retire(seen), "retired once");
      require(seen->value.get() == 1, "alive while borrowed");
    }
  }
  void after() {
    require(retired <= 1, "only one was the first");
    if (retired == 0 && std::is_same<Reclaimer, slamgc::reclaim_retired>::value) {
      const mutator m(this->d, "retires");
      require(slamgc::retire(made), "is alive, since nobody retired it");
    }
    this->drain();
  }
};

/// An object that was never counted, retired by the thread that made it, and by one that it was shown to.
struct retire_uncounted : domain_model<retire_uncounted, 3> {
  static constexpr unsigned context_bound = 1;
  relacy_env::atomic<node*> shown{nullptr};
  int retired = 0;

  void before() {
    const mutator m(d, "makes the table");
    delete new node(2);
  }
  void thread(unsigned i) {
    if (i == 2) {
      collect(2);
    } else if (i == 1) {
      const mutator m(d, "retires, too");
      node* const seen = shown.load(std::memory_order_acquire);
      if (seen == nullptr) return;
      if (slamgc::retire(seen)) ++retired;
      require(seen->value.get() == 1, "alive while borrowed");
    } else {
      const mutator m(d, "makes and retires");
      node* const made = new node(1);
      shown.store(made, std::memory_order_release);
      shown.store(nullptr, std::memory_order_release);
      if (slamgc::retire(made)) ++retired;
    }
  }
  void after() {
    require(retired == 1, "only one was the first");
    drain();
  }
};

/// The reclaimer that destroys what was retired and nothing else: an object that was not stays at zero, and can
/// be referred to again.
struct keep_what_was_not_retired : domain_model<keep_what_was_not_retired, 2> {
  static constexpr unsigned cases = 2;
  slamgc::rc_slot<kept_node, relacy_env> shared;
  kept_node* made;

  void before() {
    const mutator m(d, "maker");
    shared = made = new kept_node(1);
  }
  void thread(unsigned i) {
    if (i == 1) {
      shared.reset();
      collect(2);
    } else {
      const mutator m(d, "refers again");
      require(made->value.get() == 1, "alive, as nobody retired it");
      if (current_case == 0) slamgc::retire(made);
      shared = made;
      if (current_case == 1) slamgc::retire(made);
      shared.reset();
    }
  }
  void after() {
    shared.reset();
    drain();
  }
};

int main() {
  return check_models<retire_and_drop<slamgc::reclaim_deferred>,
                      retire_and_drop<slamgc::reclaim_retired>, retire_uncounted,
                      keep_what_was_not_retired>();
}
