/// @file
/// Models of weak handles: who locks one gets an object that stays, or nothing, for ever.
#include "deferred_model.hpp"

struct single : from_arena,
                slamgc::rc_object<single, relacy_fetch_add_counter, slamgc::reclaim_deferred>,
                slamgc::enable_weak_rc<single, relacy_env> {
  static inline int live = 0;
  plain<int> value;

  single() {
    value.set(1);
    ++live;
  }
  ~single() {
    require(value.get() == 1, "destroyed once");
    value.set(-1);
    --live;
  }
};

/// What thread 0 sees of the handle: once expired, for ever expired.
template <class Handle>
bool is_there(const Handle& handle) {
  if (const auto p = handle.lock()) {
    require(p->value.get() == 1, "alive while counted");
    return true;
  }
  require(handle.lock() == nullptr, "expired for ever");
  return false;
}

/// One thread drops the only reference and collects; another one locks a handle.
template <class Model>
struct single_model : domain_model<Model, 2> {
  slamgc::rc_slot<single, relacy_env> root, kept;
  slamgc::weak_rc<single, relacy_env> weak;

  single_model() { single::live = 0; }
  void before() {
    const mutator m(this->d, "maker");
    root = new single;
    weak = slamgc::weak_rc<single, relacy_env>(root.get());
  }
  void thread(unsigned i) {
    if (i == 1) {
      root.reset();
      this->collect(4);
    } else {
      mutator m(this->d, "locks");
      static_cast<Model*>(this)->use(m);
    }
  }
  void after() {
    if (kept != nullptr) require(!weak.expired(), "not expired while referred to");
    kept.reset();
    this->drain();
    require(single::live == 0, "nothing is lost");
    require(weak.expired(), "the handle knows");
  }
};

/// It uses what it locked, and drops it.
struct used : single_model<used> {
  static constexpr unsigned context_bound = 1;
  void use(mutator& m) {
    const bool first = is_there(weak);
    m.quiescent();
    const bool second = is_there(weak);
    require(first || !second, "expired for ever");
  }
};

/// It stores what it locked.
struct stored : single_model<stored> {
  static constexpr unsigned context_bound = 1;
  void use(mutator& m) {
    kept = weak.lock();
    m.quiescent();
    if (const single* const p = kept) {
      require(p->value.get() == 1, "alive while referred to");
      require(is_there(weak), "not expired while referred to");
    }
  }
};

/// It keeps what it locked, as a borrowed pointer.
struct borrowed : single_model<borrowed> {
  static constexpr unsigned context_bound = 1;
  void use(mutator& m) {
    const single* const p = weak.lock().get();
    if (p != nullptr) require(p->value.get() == 1, "alive while borrowed");
    m.quiescent();
    (void)weak.lock();
  }
};

/// It makes the block itself.
struct made_late : domain_model<made_late, 2> {
  slamgc::rc_slot<single, relacy_env> root;
  slamgc::weak_rc<single, relacy_env> weak;

  made_late() { single::live = 0; }
  void before() {
    const mutator m(d, "maker");
    root = new single;
  }
  void thread(unsigned i) {
    if (i == 1) {
      root.reset();
      collect(4);
    } else {
      mutator m(d, "locks");
      if (single* const p = root) weak = slamgc::weak_rc<single, relacy_env>(p);
      m.quiescent();
      (void)is_there(weak);
    }
  }
  void after() {
    drain();
    require(single::live == 0, "nothing is lost");
    require(weak.expired(), "the handle knows");
  }
};

/// Two threads make the block of one object.
struct made_twice : domain_model<made_twice, 2> {
  slamgc::rc_slot<single, relacy_env> root;
  slamgc::weak_rc<single, relacy_env> weak[2];

  made_twice() { single::live = 0; }
  void before() {
    const mutator m(d, "maker");
    root = new single;
  }
  void thread(unsigned i) {
    mutator m(d, "makes");
    weak[i] = slamgc::weak_rc<single, relacy_env>(root.get());
    require(is_there(weak[i]), "referred to");
  }
  void after() {
    require(weak[0] == weak[1], "one block");
    root.reset();
    drain();
    require(weak[0].expired(), "the handle knows");
  }
};

int main() { return check_models<used, stored, borrowed, made_late, made_twice>(); }
