/// @file
/// Models of registries: a cleared one is an unlinking that the collector completes before trial deletion decides.
#include "slamgc/containers/rc_vector.hpp"

#include "deferred_model.hpp"

/// Without deallocations, as from_arena.
template <class T>
struct arena_allocator {
  using value_type = T;
  arena_allocator() = default;
  template <class U>
  arena_allocator(const arena_allocator<U>&) noexcept {}
  T* allocate(std::size_t n) { return static_cast<T*>(from_arena::operator new(n * sizeof(T))); }
  void deallocate(T*, std::size_t) noexcept {}
  friend bool operator==(arena_allocator, arena_allocator) { return true; }
  friend bool operator!=(arena_allocator, arena_allocator) { return false; }
};

struct map_object;
struct item : from_arena,
              slamgc::rc_object<item, relacy_fetch_add_counter, slamgc::reclaim_retired> {
  static inline int live = 0;
  plain<int> value;
  slamgc::rc_slot<map_object, relacy_env> of;

  item() {
    value.set(1);
    ++live;
  }
  ~item() {
    require(value.get() == 1, "destroyed once");
    value.set(-1);
    --live;
  }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("of", of);
  }
};
/// A counted map in a ring with what its registry holds.
struct map_object
    : from_arena,
      slamgc::rc_object<map_object, relacy_fetch_add_counter, slamgc::reclaim_retired> {
  relacy_mutex mutex;
  slamgc::registry<slamgc::rc_vector<item, arena_allocator<item*>>, relacy_env> items;

  template <class Visitor>
  void edges(Visitor& v) {
    mutex.lock();
    v.edge("items", items);
    mutex.unlock();
  }
};

/// A mutator that had borrowed the map clears it, while a collector finds the ring unreachable.
template <class Model>
struct clearing : domain_model<Model, 2> {
  static constexpr unsigned random_executions = 10000;
  static constexpr unsigned context_bound = 1;
  slamgc::rc_slot<map_object, relacy_env> root;
  item* first = nullptr;
  bool was_cleared = false;

  clearing() { item::live = 0; }
  void before() {
    const mutator m(this->d, "maker");
    root = new map_object;
    first = new item;
    first->of = root.get();
    root->items.push_back(first);
    if (Model::retired_before) slamgc::retire(first);
    slamgc::retire(root.get());
  }
  void thread(unsigned i) {
    if (i == 1) {
      root.reset();
      this->collect(3);
    } else {
      mutator m(this->d, "clears");
      if (map_object* const borrowed = root) {
        borrowed->mutex.lock();
        borrowed->items.clear();
        borrowed->mutex.unlock();
        was_cleared = true;
      }
      m.quiescent();
    }
  }
  void after() {
    if (!was_cleared && !Model::retired_before) {
      const mutator m(this->d, "retires");
      slamgc::retire(first);
    }
    this->drain();
    require(item::live == 0, "nothing is lost");
  }
};
struct cleared_and_retired : clearing<cleared_and_retired> {
  static constexpr bool retired_before = true;
};
struct cleared : clearing<cleared> {
  static constexpr bool retired_before = false;
};

/// Two threads clear registries of one domain, while it is collected.
struct cleared_at_once : domain_model<cleared_at_once, 3> {
  static constexpr unsigned context_bound = 1;
  using of =
      slamgc::registry<slamgc::rc_vector<kept_node, arena_allocator<kept_node*>>, relacy_env>;
  of* mine[2];

  void before() {
    const mutator m(d, "maker");
    for (int i = 0; i != 2; ++i) {
      mine[i] = ::new (from_arena::operator new(sizeof(of))) of;
      mine[i]->push_back(new kept_node(i + 1));
    }
  }
  void thread(unsigned i) {
    if (i == 2)
      collect(2);
    else
      mine[i]->clear();
  }
  void after() {
    drain();
    for (of* each : mine) each->~of();
  }
};

int main() { return check_models<cleared_and_retired, cleared, cleared_at_once>(); }
