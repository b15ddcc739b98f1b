/// @file
/// Models of weak handles and anchors: who locks one gets an object that stays, or nothing, for ever; and what dies
/// together expires together.
#include "deferred_model.hpp"

/// An object with plain data, which its end poisons.
template <class T>
struct counted_data : from_arena {
  static inline int live = 0;
  plain<int> value;

  counted_data() {
    value.set(1);
    ++live;
  }
  ~counted_data() {
    require(value.get() == 1, "destroyed once");
    value.set(-1);
    --live;
  }
};
struct single : counted_data<single>,
                slamgc::rc_object<single, relacy_fetch_add_counter, slamgc::reclaim_deferred>,
                slamgc::enable_weak_rc<single, relacy_env> {};

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
    kept.reset();
    this->drain();
    require(single::live == 0, "nothing is lost");
    require(weak.expired(), "the handle knows");
  }
};

/// It uses what it locked, and drops it.
struct used : single_model<used> {
  void use(mutator& m) {
    const bool first = is_there(weak);
    m.quiescent();
    const bool second = is_there(weak);
    require(first || !second, "expired for ever");
  }
};

/// It stores what it locked.
struct stored : single_model<stored> {
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

struct linked;
struct record {
  plain<int>* made;
  slamgc::anchor<linked, record, relacy_env> next;
};
struct linked : counted_data<linked>,
                slamgc::rc_object<linked, relacy_fetch_add_counter, slamgc::reclaim_retired>,
                slamgc::enable_anchor<linked, record, relacy_env> {
  slamgc::rc_slot<linked, relacy_env> next;
  plain<int>* made = nullptr;
  bool is_last = false;

  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("next", next);
  }
  ::record record() {
    require(value.get() == 1, "buried alive");
    made->set(2);
    // Not in a circle: records are counted, and nothing else.
    if (is_last) return {made, {}};
    return {made, slamgc::anchor<linked, ::record, relacy_env>(next)};
  }
};
using anchored = slamgc::anchor<linked, record, relacy_env>;

/// Two retired objects that refer to each other, and anchors to both.
template <class Model>
struct pair_model : domain_model<Model, 2> {
  static constexpr unsigned random_executions = 20000;
  static constexpr unsigned cases = 2;
  slamgc::rc_slot<linked, relacy_env> root, kept;
  plain<int> made[2];
  anchored first, second;

  pair_model() { linked::live = 0; }
  void before() {
    const mutator m(this->d, "maker");
    root = new linked;
    root->next = new linked;
    root->next->next = root.get();
    root->made = &made[0];
    root->next->made = &made[1];
    root->next->is_last = true;
    first = anchored(root);
    second = anchored(root->next);
    // What is retired last is noted first, and looked at last.
    slamgc::retire(Model::current_case == 0 ? root->next.get() : root.get());
    slamgc::retire(Model::current_case == 0 ? root.get() : root->next.get());
  }
  void thread(unsigned i) {
    if (i == 1) {
      root.reset();
      static_cast<Model*>(this)->collect_pair();
    } else {
      mutator m(this->d, "locks");
      static_cast<Model*>(this)->use(m);
    }
  }
  void collect_pair() { this->collect(3); }
  /// Whether it is alive; else there is a record.
  static bool read(const anchored& a) {
    return a.read(
        [](linked& alive) {
          require(alive.value.get() == 1, "alive while counted");
          return true;
        },
        [](const record& r) {
          require(r.made->get() == 2, "the record is made");
          return false;
        });
  }
  void after() {
    kept.reset();
    this->drain();
    require(linked::live == 0, "nothing is lost");
    require(!read(first) && !read(second), "both left a record");
    require(first.record()->next == second, "which keeps each hop");
  }
};

/// Both are there, or neither is.
struct all_or_nothing : pair_model<all_or_nothing> {
  void use(mutator& m) {
    require(read(first) == read(second), "both or neither");
    m.quiescent();
    require(read(second) == read(first), "both or neither");
  }
};
/// The same, while the collector stops after each object.
struct in_slices : pair_model<in_slices> {
  void use(mutator&) { require(read(first) == read(second), "both or neither"); }
  void collect_pair() {
    for (int i = 0; i != 12; ++i) (void)d.collect({1});
  }
};
/// One is locked and kept: the other one lives on, too.
struct one_kept : pair_model<one_kept> {
  void use(mutator& m) {
    kept = second.lock();
    m.quiescent();
    if (const linked* const p = kept) {
      require(p->value.get() == 1, "alive while referred to");
      require(read(first) && read(second), "not expired while referred to");
    }
  }
};
/// What was locked leads to the other one.
struct reached : pair_model<reached> {
  void use(mutator& m) {
    if (const auto p = second.lock()) kept = p->next;
    m.quiescent();
    if (const linked* const p = kept) require(p->value.get() == 1, "alive while referred to");
  }
};

int main() {
  return check_models<used, stored, borrowed, made_late, made_twice, all_or_nothing, in_slices,
                      one_kept, reached>();
}
