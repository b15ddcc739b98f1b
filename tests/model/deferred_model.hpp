/// @file
/// What the models of deferred reclamation share: a domain, and objects that poison what readers read.
#pragma once

#include "../support/relacy_env.hpp"

using domain = slamgc::basic_domain<relacy_env>;
using mutator = slamgc::basic_mutator<relacy_env>;
using outcome = slamgc::collected::outcome;

/// Memory of the objects of one execution, none of it used twice. relacy tries each deallocation with and
/// without its reuse, which doubles the search; that an object is used after its end, or not destroyed, it
/// notices by the atomics and the plain data inside.
class from_arena {
 public:
  static void* operator new(std::size_t size) {
    alignas(16) static char memory[4096];
    static unsigned execution = 0;
    static std::size_t used = 0;
    if (std::exchange(execution, relacy_env::execution()) != relacy_env::execution()) used = 0;
    void* const made = memory + used;
    used += (size + 15) / 16 * 16;
    require(used <= sizeof memory, "a model has few objects");
    return made;
  }
  static void operator delete(void*) {}
};

template <class Reclaimer>
struct deferred_object
    : from_arena,
      slamgc::rc_object<deferred_object<Reclaimer>, relacy_fetch_add_counter, Reclaimer> {
  static inline int live = 0;
  plain<int> value;

  explicit deferred_object(int v) {
    value.set(v);
    ++live;
  }
  ~deferred_object() {
    require(value.get() > 0, "destroyed once");
    value.set(-1);
    --live;
  }
};
using node = deferred_object<slamgc::reclaim_deferred>;
using kept_node = deferred_object<slamgc::reclaim_retired>;
using slot = slamgc::rc_slot<node, relacy_env>;

/// A model with a domain of its own. In the end everything has been reclaimed: relacy reports each object
/// that is left as a leak.
template <class Model, rl::thread_id_t Threads>
struct domain_model : model_base<Model, Threads> {
  static constexpr unsigned random_executions = 5000;
  domain d;

  domain_model() { node::live = kept_node::live = 0; }
  /// Collects, and lets others run in between, up to @p times times or until nothing is left.
  void collect(int times) {
    for (; times != 0 && d.collect().result != outcome::done; --times) rl::yield(1, RELACY_HERE);
  }
  /// When the slots are empty.
  void drain() {
    require(d.drain() == slamgc::waited::done, "nothing waits for ever");
    require(node::live == 0 && kept_node::live == 0, "nothing is lost");
  }
};
