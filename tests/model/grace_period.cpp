/// @file
/// Model of the grace period: a mutator reads a slot and uses what it borrowed, while another thread
/// unlinks the object and collects.
#include "deferred_model.hpp"

struct grace_period : domain_model<grace_period, 2> {
  static constexpr unsigned cases = 3;
  slot shared;

  void before() {
    const mutator m(d, "maker");
    shared = new node(1);
  }
  void thread(unsigned i) {
    if (i == 1) {
      shared.reset();
      collect(2);
    } else if (current_case == 0) {
      mutator m(d, "has quiescent states");
      use();
      m.quiescent();
      use();
    } else if (current_case == 1) {
      mutator m(d, "goes offline");
      use();
      { const mutator::offline_scope offline(m); }
      use();
    } else {
      mutator m(d, "goes online", {false, false});
      for (int times = 0; times != 2; ++times) {
        const mutator::online_scope online(m);
        use();
      }
    }
  }
  void use() {
    if (const node* const seen = shared) require(seen->value.get() == 1, "alive while borrowed");
  }
  void after() { drain(); }
};

/// A quiescent state in one grace period is none in the next.
struct two_grace_periods : domain_model<two_grace_periods, 2> {
  static constexpr unsigned context_bound = 1;
  slot shared[2];

  void before() {
    const mutator m(d, "maker");
    for (auto& s : shared) s = new node(1);
  }
  void thread(unsigned i) {
    if (i == 1) {
      for (auto& s : shared) {
        s.reset();
        collect(2);
      }
    } else {
      mutator m(d, "reads");
      for (auto& s : shared) {
        if (const node* const seen = s) require(seen->value.get() == 1, "alive while borrowed");
        m.quiescent();
      }
    }
  }
  void after() { drain(); }
};

/// Two threads use one record, one after the other: the second one's going online does not hide the uses of the
/// first.
struct record_used_again : domain_model<record_used_again, 3> {
  static constexpr unsigned context_bound = 1;
  slot shared;

  void before() {
    const mutator m(d, "maker");
    shared = new node(1);
  }
  void thread(unsigned i) {
    if (i == 2) {
      shared.reset();
      collect(2);
    } else {
      const mutator m(d, "reads");
      if (const node* const seen = shared) require(seen->value.get() == 1, "alive while borrowed");
    }
  }
  void after() { drain(); }
};

/// After synchronize() an object that was taken out is its holder's alone.
struct synchronize : domain_model<synchronize, 2> {
  slot shared;

  void before() {
    const mutator m(d, "maker");
    shared = new node(1);
  }
  void thread(unsigned i) {
    if (i == 1) {
      const slamgc::intrusive_rc<node> mine = shared.exchange(nullptr);
      require(d.synchronize() == slamgc::waited::done, "every mutator ends");
      mine->value.set(2);
    } else {
      mutator m(d, "reads");
      if (const node* const seen = shared)
        require(seen->value.get() == 1, "not changed while borrowed");
      m.quiescent();
    }
  }
  void after() { drain(); }
};

/// A mutator that drops an object and ends only when that is reclaimed: its quiescent states, or being offline,
/// have to be enough.
struct grace_period_ends : domain_model<grace_period_ends, 2> {
  static constexpr unsigned cases = 4;
  static constexpr unsigned context_bound = 1;
  slot shared;
  relacy_env::atomic<bool> dropped{false};
  relacy_env::atomic<bool> reclaimed{false};

  void before() {
    const mutator m(d, "maker");
    shared = new node(1);
  }
  void thread(unsigned i) {
    if (i == 1) {
      while (!dropped.load(std::memory_order_acquire)) rl::yield(1, RELACY_HERE);
      drain();
      reclaimed.store(true, std::memory_order_release);
      return;
    }
    mutator m(d, "drops", {current_case < 2, false});
    if (current_case == 0) {
      drop();
      while (!is_reclaimed()) m.quiescent();
    } else if (current_case == 1) {
      drop();
      const mutator::offline_scope offline(m);
      while (!is_reclaimed()) {
      }
    } else {
      if (current_case == 2) {
        const mutator::online_scope online(m);
        drop();
      } else {
        drop();
      }
      while (!is_reclaimed()) {
      }
    }
  }
  void drop() {
    shared.reset();
    dropped.store(true, std::memory_order_release);
  }
  bool is_reclaimed() {
    rl::yield(1, RELACY_HERE);
    return reclaimed.load(std::memory_order_acquire);
  }
};

int main() {
  return check_models<grace_period, two_grace_periods, record_used_again, synchronize,
                      grace_period_ends>();
}
