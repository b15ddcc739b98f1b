/// @file
/// Model of assigning one rc_slot from two threads while others read it: each old pointer is released
/// once, readers see finished objects.
#include "../support/relacy_env.hpp"

struct node : slamgc::rc_object<node, relacy_fetch_add_counter> {
  plain<int> value;
  explicit node(int v) { value.set(v); }
  ~node() {
    require(value.get() > 0, "destroyed once");
    value.set(-1);
  }
};
using slot = slamgc::rc_slot<node, relacy_env>;

/// The slot holds the only reference: whoever takes an object out destroys it.
struct assign_last : model_base<assign_last, 3> {
  static constexpr unsigned random_executions = 50000;
  slot shared;

  void thread(unsigned i) {
    if (i == 2)
      shared.reset();
    else
      shared = slamgc::make_rc<node>(static_cast<int>(i) + 1);
  }
};

/// Each object has another reference, so a reader may follow what it reads.
struct assign_and_read : model_base<assign_and_read, 3> {
  static constexpr unsigned random_executions = 50000;
  slot shared;
  slamgc::intrusive_rc<node> kept[2];

  void thread(unsigned i) {
    if (i == 2) {
      for (int times = 0; times != 2; ++times)
        if (node* const seen = shared) require(seen->value.get() > 0, "the object is finished");
    } else {
      kept[i] = slamgc::make_rc<node>(static_cast<int>(i) + 1);
      shared = kept[i];
    }
  }
  void after() {
    shared.reset();
    for (auto& reference : kept) require(reference->use_count() == 1, "every count is exact");
  }
};

/// What exchange() returns is a reference of the caller's own, whatever the others do to the slot.
struct exchange_and_assign : model_base<exchange_and_assign, 3> {
  static constexpr unsigned random_executions = 50000;
  slot shared{new node(4)};

  void thread(unsigned i) {
    if (i == 0) {
      shared = slamgc::make_rc<node>(1).get();
    } else {
      const auto made = slamgc::make_rc<node>(static_cast<int>(i) + 1);
      const slamgc::intrusive_rc<node> taken = shared.exchange(made.get());
      require(taken != nullptr && taken->value.get() > 0, "the old object is finished and alive");
    }
  }
};

/// Two slots that are swapped, assigned, copied and moved at the same time, with objects that live on.
struct swap_and_assign : model_base<swap_and_assign, 3> {
  static constexpr unsigned random_executions = 50000;
  slamgc::intrusive_rc<node> kept[3];
  slot a, b;

  void before() {
    for (int i = 0; i != 3; ++i) kept[i] = slamgc::make_rc<node>(i + 1);
    a = kept[0];
    b = kept[1];
  }
  void thread(unsigned i) {
    if (i == 0) {
      a.swap(b);
    } else if (i == 1) {
      a = kept[2];
      b = a;
    } else {
      const slot moved(std::move(b));
      require(moved != nullptr, "no reader of a swap sees null");
    }
  }
  void after() {
    a.reset();
    b.reset();
    for (auto& reference : kept) require(reference->use_count() == 1, "every count is exact");
  }
};

int main() {
  return check_models<assign_last, assign_and_read, exchange_and_assign, swap_and_assign>();
}
