/// @file
/// Models of atomic_rc: load() against exchange() against compare_exchange.
#include "deferred_model.hpp"

using atomic_slot = slamgc::atomic_rc<node, relacy_env>;
using reference = slamgc::intrusive_rc<node>;

/// What load() returns outlives the mutator, whatever the others do.
struct load_and_exchange : domain_model<load_and_exchange, 2> {
  atomic_slot shared;

  void before() {
    const mutator m(d, "maker");
    shared = reference(new node(1));
  }
  void thread(unsigned i) {
    if (i == 0) {
      reference mine;
      {
        const mutator m(d, "loads");
        require(shared.get()->value.get() > 0, "alive while borrowed");
        mine = shared.load();
      }
      require(mine != nullptr && mine->value.get() > 0, "alive while counted");
    } else {
      reference made;
      {
        const mutator m(d, "makes");
        made = reference(new node(2));
      }
      const reference old = shared.exchange(std::move(made));
      require(old->value.get() == 1, "what was there");
      collect(2);
    }
  }
  void after() {
    shared.store(nullptr);
    drain();
  }
};

/// Of two exchanges under the same condition one succeeds; the other one learns what is there.
struct compare_exchange : domain_model<compare_exchange, 2> {
  static constexpr unsigned context_bound = 1;
  static constexpr unsigned cases = 2;  // weak, strong
  atomic_slot shared;
  int succeeded = 0;

  void thread(unsigned i) {
    {
      const mutator m(d, "exchanges");
      node* seen = nullptr;
      reference made(new node(static_cast<int>(i) + 1));
      bool done;
      do
        done = current_case == 0 ? shared.compare_exchange_weak(seen, made)
                                 : shared.compare_exchange_strong(seen, made);
      while (!done && seen == nullptr);
      if (done)
        ++succeeded;
      else
        require(seen->value.get() == 2 - static_cast<int>(i), "the other one's");
    }
    collect(1);
  }
  void after() {
    require(succeeded == 1, "one succeeds");
    shared.store(nullptr);
    drain();
  }
};

/// Two exchanges: each gets out what exactly one put in.
struct two_exchanges : domain_model<two_exchanges, 2> {
  atomic_slot shared;
  int taken_out = 0;

  void before() {
    const mutator m(d, "maker");
    shared = reference(new node(1));
  }
  void thread(unsigned i) {
    const mutator m(d, "exchanges");
    const reference old = shared.exchange(reference(new node(i == 0 ? 10 : 100)));
    taken_out += old->value.get();
  }
  void after() {
    require(taken_out == 11 || taken_out == 101, "nothing is taken out twice");
    shared.store(nullptr);
    drain();
  }
};

/// Two threads replace what they have seen: what goes is dropped once.
struct replace : domain_model<replace, 2> {
  static constexpr unsigned context_bound = 1;
  atomic_slot shared;

  void before() {
    const mutator m(d, "maker");
    shared = reference(new node(1));
  }
  void thread(unsigned) {
    const mutator m(d, "replaces");
    node* seen = shared.get();
    (void)shared.compare_exchange_strong(seen, reference(new node(2)));
  }
  void after() {
    shared.store(nullptr);
    drain();
  }
};

int main() { return check_models<load_and_exchange, compare_exchange, two_exchanges, replace>(); }
