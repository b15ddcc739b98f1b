/// @file
/// Models of anchors, and of sets that die together: what dies together expires together, and leaves its records.
#include "deferred_model.hpp"

/// What is left of an object.
struct linked;
struct record {
  plain<int>* made;
  slamgc::anchor<linked, record, relacy_env> next;
};
struct linked : from_arena,
                slamgc::rc_object<linked, relacy_fetch_add_counter, slamgc::reclaim_retired>,
                slamgc::enable_anchor<linked, record, relacy_env> {
  static inline int live = 0;
  plain<int> value;
  slamgc::rc_slot<linked, relacy_env> next;
  plain<int>* made = nullptr;
  bool is_last = false;

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
  static constexpr unsigned random_executions = 4000;
  static constexpr unsigned context_bound = 1;
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
    if (kept != nullptr)
      require(first.record() == nullptr && second.record() == nullptr,
              "not expired while referred to");
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
  static constexpr unsigned cases = 1;
  void collect_pair() {
    for (int i = 0; i != 12; ++i) (void)d.collect({1});
  }
};
/// One is locked and kept: the other one lives on, too.
struct one_kept : pair_model<one_kept> {
  static constexpr unsigned cases = 1;
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
  static constexpr unsigned cases = 1;
  void use(mutator& m) {
    if (const auto p = second.lock()) kept = p->next;
    m.quiescent();
    if (const linked* const p = kept) require(p->value.get() == 1, "alive while referred to");
  }
};

int main() { return check_models<all_or_nothing, in_slices, one_kept, reached>(); }
