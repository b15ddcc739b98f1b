/// @file
/// Models of trial deletion: a ring of retired objects is reclaimed when nobody can see it, however its edges
/// were added, moved and removed meanwhile.
#include "deferred_model.hpp"

struct linked : from_arena,
                slamgc::rc_object<linked, relacy_fetch_add_counter, slamgc::reclaim_retired> {
  static inline int live = 0;
  plain<int> value;
  slamgc::rc_slot<linked, relacy_env> next, extra;

  linked() {
    value.set(1);
    ++live;
  }
  ~linked() {
    require(value.get() == 1, "destroyed once");
    value.set(-1);
    --live;
  }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("next", next);
    v.edge("extra", extra);
  }
};

/// Two objects that refer to each other, the first of them referred to by a root, all of it retired.
template <class Model>
struct ring_model : domain_model<Model, 2> {
  static constexpr unsigned random_executions = 20000;
  static constexpr unsigned context_bound = 2;
  slamgc::rc_slot<linked, relacy_env> root, second, third;

  ring_model() { linked::live = 0; }
  void before() {
    const mutator m(this->d, "maker");
    root = new linked;
    root->next = new linked;
    root->next->next = root.get();
    linked* const first = root;
    linked* const other = first->next;
    // What is retired last is noted first, and looked at last.
    slamgc::retire(Model::current_case == 0 ? other : first);
    slamgc::retire(Model::current_case == 0 ? first : other);
  }
  void thread(unsigned i) {
    if (i == 1) {
      root.reset();
      static_cast<Model*>(this)->collect_ring();
    } else {
      mutator m(this->d, "uses");
      if (linked* const borrowed = root) static_cast<Model*>(this)->use(*borrowed);
      m.quiescent();
      if (linked* const kept = second) static_cast<Model*>(this)->use_again(*kept);
      m.quiescent();
      second.reset();
    }
  }
  void collect_ring() { this->collect(3); }
  void use_again(linked& kept) { require(kept.value.get() == 1, "alive while borrowed"); }
  void after() {
    third.reset();
    this->drain();
    require(linked::live == 0, "no ring is lost");
  }
};

/// A reference from outside is added.
struct added : ring_model<added> {
  void use(linked& first) { second = first.next; }
};

/// An edge moves out of the ring.
struct moved_out : ring_model<moved_out> {
  static constexpr unsigned cases = 2;
  void use(linked& first) { second = std::move(first.next); }
};

/// Edges change inside of the ring.
struct turned : ring_model<turned> {
  void use(linked& first) {
    linked* const other = first.next;
    first.next = &first;
    if (other != nullptr) other->next = other;
  }
};

/// An edge into the ring is added in it: counted, then stored, and nothing else happens afterwards.
struct added_inside : ring_model<added_inside> {
  void use(linked& first) { first.extra = &first; }
};
/// The same, while others collect one object at a time.
struct added_in_slices : ring_model<added_in_slices> {
  void use(linked& first) { first.extra = &first; }
  void collect_ring() {
    for (int i = 0; i != 5; ++i) {
      (void)d.collect({1});
      rl::yield(1, RELACY_HERE);
    }
  }
};

/// The same, while others collect again and again.
struct added_meanwhile : ring_model<added_meanwhile> {
  void use(linked& first) { first.extra = &first; }
  void collect_ring() {
    for (int i = 0; i != 4; ++i) (void)d.collect();
  }
};

/// The first object is saved, and the second one is taken out of it, while the collector looks at one after
/// the other.
struct taken_apart : ring_model<taken_apart> {
  void use(linked& first) { second = &first; }
  void use_again(linked& kept) {
    third = std::move(kept.next);
    if (const linked* const other = third) require(other->value.get() == 1, "alive while borrowed");
  }
};

int main() {
  return check_models<added, moved_out, turned, added_inside, added_in_slices, added_meanwhile,
                      taken_apart>();
}
