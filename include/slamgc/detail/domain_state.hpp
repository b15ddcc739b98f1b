/// @file
/// What outlives a domain: its epoch, the records of its mutators, and its tables.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "../env.hpp"
#include "../fwd.hpp"
#include "collection.hpp"
#include "participant.hpp"
#include "table_base.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// See domain.hpp for the argument. Freed when neither the domain, nor a mutator, nor an object needs it.
template <class Env>
class domain_state {
 public:
  using record = mutator_record<Env>;
  using table = table_base<Env>;
  template <class T>
  using atomic = typename Env::template atomic<T>;

  domain_state() noexcept = default;
  domain_state(const domain_state&) = delete;
  domain_state& operator=(const domain_state&) = delete;

  // ---- who needs it: made with one reference, the domain's

  void retain() noexcept {
    references_.fetch_add(1, std::memory_order_relaxed);  // (22) the caller has one already.
  }
  void release() noexcept {
    // (22) release: my use of the state is over; acquire: so are all others'.
    if (references_.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
    // Objects that are left name their table. They stay as they are, and so does it.
    for (table* t = tables(); t != nullptr; t = t->next)
      if (t->live() != 0) return;
    delete this;
  }

  // ---- mutators

  /// Takes a record that nobody uses, or makes one. Throws std::bad_alloc.
  record& enter(const char* name) {
    for (record* r = records_.load(std::memory_order_acquire); r != nullptr; r = r->next) {  // (14)
      // (15) acquire: the record's last owner has finished with it, and with its doors.
      if (!r->taken.exchange(true, std::memory_order_acquire)) {
        r->name.store(name, std::memory_order_relaxed);  // (12)
        return *r;
      }
    }
    record* const made = new record;
    const std::size_t before = records_made_.fetch_add(1, std::memory_order_relaxed);  // (12)
    made->door =
        before < Env::mutator_doors ? table::first_of_mutators + before : table::shared_door;
    made->name.store(name, std::memory_order_relaxed);  // (12)
    push(records_, made);
    return *made;
  }
  void leave(record& r) noexcept {
    r.taken.store(false, std::memory_order_release);  // (15)
  }
  /// Before the thread reads any pointer.
  void go_online(record& r) noexcept {
    // (16) release: the collector may read this in place of the 0 (18) that it replaces, by the record's last
    // owner even; relaxed would take the release of that 0 back. The epoch itself is a guess.
    r.epoch.store(epoch_.load(std::memory_order_relaxed), std::memory_order_release);
    // (16) acq_rel: of this and the collector's advance (17), the later one sees the earlier: this one what
    // was unlinked, or that one the record.
    epoch_.fetch_add(0, std::memory_order_acq_rel);
  }
  /// After the thread gave all its borrowed pointers up.
  static void go_offline(record& r) noexcept {
    // (18) release: what it did with borrowed pointers comes before their reclamation (20).
    r.epoch.store(record::offline, std::memory_order_release);
  }
  bool quiescent(record& r) noexcept {
    // (19) acquire: sees whatever was unlinked before the collector wrote this epoch (17).
    const std::uint64_t now = epoch_.load(std::memory_order_acquire);
    // (12) relaxed: nobody else writes the record.
    if (r.epoch.load(std::memory_order_relaxed) == now) return false;
    r.epoch.store(now, std::memory_order_release);  // (18)
    return true;
  }

  // ---- grace periods

  /// Begins a grace period: what was unlinked before it cannot be read by a mutator that has seen it.
  std::uint64_t advance() noexcept {
    // (17) release: publishes what was unlinked before to (19) and (16); acquire: sees the records of all
    // who went online before (16).
    return epoch_.fetch_add(1, std::memory_order_acq_rel) + 1;
  }
  /// The first record that the grace period of @p target waits for, or null: it is over.
  const record* behind(std::uint64_t target) const noexcept {
    for (const record* r = records_.load(std::memory_order_acquire); r != nullptr;  // (14)
         r = r->next) {
      // (20) acquire: what the mutator did before its quiescent state (18) is over.
      const std::uint64_t at = r->epoch.load(std::memory_order_acquire);
      if (at != record::offline && at < target) return r;
    }
    return nullptr;
  }
  /// Of those, the one that has passed no quiescent state for the longest time.
  const record* oldest(std::uint64_t target) const noexcept {
    const record* found = nullptr;
    for (const record* r = first_record(); r != nullptr; r = r->next) {
      const std::uint64_t at = r->epoch.load(std::memory_order_relaxed);  // (12)
      if (at == record::offline || at >= target) continue;
      found = r;
      target = at;
    }
    return found;
  }
  const record* first_record() const noexcept {
    return records_.load(std::memory_order_acquire);  // (14)
  }

  // ---- tables

  table* find(const void* type) const noexcept {
    for (table* t = tables(); t != nullptr; t = t->next)
      if (t->type == type) return t;
    return nullptr;
  }
  /// Two threads may add one for the same type at once: both serve.
  void add(table& made) noexcept { push(tables_, &made); }
  table* tables() const noexcept { return tables_.load(std::memory_order_acquire); }  // (14)

  runtime::collection<Env> collection;

 private:
  ~domain_state() {
    for (table* t = tables(); t != nullptr;) {
      table* const next = t->next;
      delete t;
      t = next;
    }
    for (record* r = records_.load(std::memory_order_relaxed); r != nullptr;) {  // (14) alone here.
      record* const next = r->next;
      delete r;
      r = next;
    }
  }
  template <class Node>
  static void push(atomic<Node*>& list, Node* made) noexcept {
    Node* first = list.load(std::memory_order_relaxed);  // (14) a guess.
    do {
      made->next = first;
    } while (!list.compare_exchange_weak(
        first, made, std::memory_order_release,  // (14) publishes the node to who walks the list.
        std::memory_order_relaxed));             // (14) a guess.
  }

  alignas(cache_line) atomic<std::uint64_t> epoch_{1};
  alignas(cache_line) atomic<record*> records_{nullptr};
  atomic<table*> tables_{nullptr};
  atomic<std::size_t> records_made_{0};
  atomic<std::size_t> references_{1};
};

template <class Env>
void participant<Env>::join_purge() noexcept {
  const std::uint64_t now = domain->collection.purging().number();
  if (now == purged) return;
  purged = now;
  for (const root_place<Env>* root = roots; root != nullptr; root = root->next_of_owner)
    root->operations->purge_by_owner(root->described);
}

/// The state of the default domain: made on first use, never destroyed.
template <class Env>
domain_state<Env>& default_state() {
  static domain_state<Env>& forever = *new domain_state<Env>;
  return forever;
}

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
