/// @file
/// Model of reclaim_at_zero: the last references to a chain of objects of different types go in several
/// threads; each object is destroyed once, after everything that was done to it, by one thread.
#include "../support/relacy_env.hpp"

template <int Kind>
struct chain_link : slamgc::rc_object<chain_link<Kind>, relacy_fetch_add_counter> {
  slamgc::rc_slot<chain_link<Kind + 1>, relacy_env> next;
  plain<int> part[2];

  chain_link() {
    for (auto& p : part) p.set(0);
  }
  ~chain_link() {
    for (auto& p : part) {
      require(p.get() == 1, "each thread's work is there");
      p.set(-1);
    }
  }
};
/// The end of each chain.
template <>
struct chain_link<2> : slamgc::rc_object<chain_link<2>, relacy_fetch_add_counter> {
  plain<int> value;
  chain_link() { value.set(0); }
  ~chain_link() {
    require(value.get() == 0, "destroyed once");
    value.set(-1);
  }
};

/// Both threads hold the head, the second also the middle.
struct drop_chain : model_base<drop_chain, 2> {
  static constexpr unsigned context_bound = 4;
  slamgc::intrusive_rc<chain_link<0>> heads[2];
  slamgc::intrusive_rc<chain_link<1>> middle;

  void before() {
    heads[0] = heads[1] = slamgc::make_rc<chain_link<0>>();
    middle = slamgc::make_rc<chain_link<1>>();
    middle->next = slamgc::make_rc<chain_link<2>>();
    heads[0]->next = middle;
  }
  void thread(unsigned i) {
    heads[i]->part[i].set(1);
    heads[i]->next->part[i].set(1);
    heads[i].reset();
    if (i == 1) middle.reset();
  }
};

/// Two threads destroy different chains of the same types at the same time, and share the last object.
struct drop_chains : model_base<drop_chains, 2> {
  static constexpr unsigned context_bound = 3;
  slamgc::intrusive_rc<chain_link<0>> heads[2];

  void before() {
    const auto end = slamgc::make_rc<chain_link<2>>();
    for (auto& head : heads) {
      head = slamgc::make_rc<chain_link<0>>();
      head->next = slamgc::make_rc<chain_link<1>>();
      head->next->next = end;
      for (auto& p : head->part) p.set(1);
      for (auto& p : head->next->part) p.set(1);
    }
  }
  void thread(unsigned i) { heads[i].reset(); }
};

int main() { return check_models<drop_chain, drop_chains>(); }
