/// @file
/// Models of the purge: a stale edge is dropped by one thread or the other, once, and what a mutator stores stays.
#include "deferred_model.hpp"

struct linked : from_arena,
                slamgc::rc_object<linked, relacy_fetch_add_counter, slamgc::reclaim_retired> {
  static inline int live = 0;
  plain<int> value;
  slamgc::rc_slot<linked, relacy_env> next;

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
};

/// A root with a slot that refers to a retired object.
template <class Model>
struct stale_model : domain_model<Model, 2> {
  static constexpr unsigned random_executions = 10000;
  slamgc::rc_slot<linked, relacy_env> slot, other;
  linked* child = nullptr;

  stale_model() { linked::live = 0; }
  void before() {
    const mutator m(this->d, "maker");
    other = new linked;
    slot = new linked;
    child = new linked;
    slot->next = child;
    slamgc::retire(slot.get());
  }
  /// The retired one is gone; and so is the rest, once it is retired.
  void finish() {
    require(this->d.drain() == slamgc::waited::done, "nothing waits for ever");
    require(linked::live == 2, "the retired one is gone");
    {
      const mutator m(this->d, "retires");
      slamgc::retire(other.get());
      slamgc::retire(child);
    }
    slot.reset();
    other.reset();
    require(this->d.drain() == slamgc::waited::done, "nothing waits for ever");
    require(linked::live == 0, "nothing is lost");
  }
};
template <class Model>
struct shared_slot : stale_model<Model> {
  slamgc::basic_root<relacy_env> root{this->d, "root", static_cast<Model&>(*this)};

  void thread(unsigned i) {
    if (i == 1) {
      this->collect(3);
    } else {
      const mutator m(this->d, "assigns");
      static_cast<Model*>(this)->assign();
    }
  }
};

/// Another thread assigns the slot meanwhile.
struct nulled : shared_slot<nulled> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("slot", slot, slamgc::on_retire::null);
  }
  void assign() { slot = other.get(); }
  void after() {
    require(slot == other.get(), "what the mutator stored stays");
    require(other->use_count() == 2, "every count is exact");
    finish();
  }
};
/// The same, with an edge that steps over the retired object.
struct stepped_over : shared_slot<stepped_over> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("slot", slot, slamgc::on_retire::bypass([](linked& retired) {
             require(retired.value.get() == 1, "alive while it is stepped over");
             return retired.next.get();
           }));
  }
  void assign() { slot = other.get(); }
  void after() {
    require(slot == other.get(), "what the mutator stored stays");
    finish();
  }
};
/// Another thread takes the reference away.
struct taken : shared_slot<taken> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("slot", slot, slamgc::on_retire::null);
  }
  void assign() {
    const slamgc::intrusive_rc<linked> mine = slot.exchange(nullptr);
    if (mine) require(mine->value.get() == 1, "alive while it is counted");
  }
  void after() {
    require(slot.get() == nullptr, "nobody stored anything");
    finish();
  }
};

/// A root that its owner alone touches, without any lock.
struct owned : stale_model<owned> {
  static constexpr unsigned context_bound = 1;
  plain<int> visits;

  template <class Visitor>
  void edges(Visitor& v) {
    visits.set(visits.get() + 1);
    v.edge("slot", slot, slamgc::on_retire::null);
  }
  void thread(unsigned i) {
    if (i == 1) {
      this->collect(3);
    } else {
      mutator m(d, "owner");
      visits.set(0);
      const slamgc::basic_root<relacy_env> root(m, "owned", *this);
      for (int times = 0; times != 3; ++times) m.quiescent();
    }
  }
  void after() {
    slot.reset();
    finish();
  }
};

int main() { return check_models<nulled, stepped_over, taken, owned>(); }
