// An object that a destructor refers to again while it waits to be destroyed, and that another thread
// takes from there and drops.
#include "../support/relacy_env.hpp"

struct leaf : slamgc::rc_object<leaf, relacy_fetch_add_counter> {
  plain<int> value;
  leaf() { value.set(1); }
  ~leaf() {
    require(value.get() == 1, "destroyed once");
    value.set(-1);
  }
};
using slot = slamgc::rc_slot<leaf, relacy_env>;

struct head : slamgc::rc_object<head, relacy_fetch_add_counter> {
  slot next;
  slot& shared;
  explicit head(slot& s) : next(new leaf), shared(s) {}
  ~head() {
    leaf* const waits = next;
    next.reset();  // its count is zero now: it waits until this destructor is over
    shared = waits;
  }
};

struct referred_again : model_base<referred_again, 2> {
  static constexpr unsigned context_bound = 3;
  slot shared;
  slamgc::intrusive_rc<head> first;

  void before() { first = slamgc::make_rc<head>(shared); }
  void thread(unsigned i) {
    if (i == 0) {
      first.reset();
    } else {
      const auto taken = shared.exchange(nullptr);
      if (taken) require(taken->value.get() == 1, "alive");
    }
  }
  void after() { shared.reset(); }
};

int main() { return check_models<referred_again>(); }
