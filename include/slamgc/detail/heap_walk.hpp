/// @file
/// A walk over the live objects of a domain, from its roots along the described edges.
///
/// **Safe without counting.** Objects are destroyed by collectors alone, one of which is at work at a time, and this
/// one destroys nothing from the begin of a walk to its end: so each object that was met through an edge exists until then,
/// whatever mutators do to its edges meanwhile. (An object that the program itself deletes must never have been stored in an
/// edge or a root: those are retired.)
///
/// **What it meets.** An object is met if a path leads to it all the time. While mutators move edges about, one may be
/// missed; those who walk say what that means to them.
///
/// Each step visits one object, so that a walk can be done in slices. O(objects + edges) in all; eight bytes for each
/// object, at a load of at most one half, while it lasts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <type_traits>

#include "../fwd.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// A set of addresses, or a map from addresses to small values. Out of memory it stays as it is.
template <class Entry>
class address_table {
  static_assert(std::is_trivially_copyable<Entry>::value, "is moved by plain copies");

 public:
  address_table() noexcept = default;
  ~address_table() { clear(); }
  address_table(const address_table&) = delete;
  address_table& operator=(const address_table&) = delete;

  std::size_t size() const noexcept { return size_; }
  bool reserve(std::size_t entries) noexcept {
    std::size_t slots = 64;
    while (slots < 2 * entries) slots *= 2;
    return slots <= slots_ || rehash(slots);
  }
  /// The entry with this key, or null.
  Entry* find(const void* key) const noexcept {
    if (size_ == 0) return nullptr;
    Entry* const e = place_of(key);
    return e->key == key ? e : nullptr;
  }
  /// Adds an entry, unless there is one with its key. Null: no memory; else `added` says which.
  Entry* add(const Entry& entry, bool& added) noexcept {
    if (2 * size_ >= slots_ && !rehash(slots_ == 0 ? 64 : 2 * slots_)) return nullptr;
    Entry* const e = place_of(entry.key);
    added = e->key != entry.key;
    if (added) {
      *e = entry;
      ++size_;
    }
    return e;
  }
  template <class F>
  void each(F f) const {
    for (std::size_t i = 0; i != slots_; ++i)
      if (entries_[i].key != nullptr) f(entries_[i]);
  }
  void clear() noexcept {
    std::free(entries_);
    entries_ = nullptr;
    slots_ = size_ = 0;
  }

 private:
  Entry* place_of(const void* key) const noexcept {
    // Fibonacci hashing (Knuth, TAOCP 6.4): objects of one type lie at equal distances.
    std::size_t i = static_cast<std::size_t>(
        ((reinterpret_cast<std::uintptr_t>(key) >> 3) * UINT64_C(0x9e3779b97f4a7c15)) >> 20);
    for (;; ++i) {
      Entry& e = entries_[i & (slots_ - 1)];
      if (e.key == key || e.key == nullptr) return &e;
    }
  }
  bool rehash(std::size_t slots) noexcept {
    // Zero as the system hands it out: large tables cost nothing until they are used.
    auto* const fresh = static_cast<Entry*>(std::calloc(slots, sizeof(Entry)));
    if (fresh == nullptr) return false;
    Entry* const old = entries_;
    const std::size_t old_slots = slots_;
    entries_ = fresh;
    slots_ = slots;
    for (std::size_t i = 0; i != old_slots; ++i)
      if (old[i].key != nullptr) *place_of(old[i].key) = old[i];
    std::free(old);
    return true;
  }

  Entry* entries_ = nullptr;
  std::size_t slots_ = 0;
  std::size_t size_ = 0;
};

/// A stack. Out of memory it stays as it is.
template <class Item>
class growing_stack {
  static_assert(std::is_trivially_copyable<Item>::value, "is moved by plain copies");

 public:
  growing_stack() noexcept = default;
  ~growing_stack() { clear(); }
  growing_stack(const growing_stack&) = delete;
  growing_stack& operator=(const growing_stack&) = delete;

  bool empty() const noexcept { return size_ == 0; }
  bool push(const Item& item) noexcept {
    if (size_ == room_) {
      const std::size_t room = room_ == 0 ? 256 : 2 * room_;
      void* const more = std::realloc(items_, room * sizeof(Item));
      if (more == nullptr) return false;
      items_ = static_cast<Item*>(more);
      room_ = room;
    }
    items_[size_++] = item;
    return true;
  }
  Item pop() noexcept { return items_[--size_]; }
  void clear() noexcept {
    std::free(items_);
    items_ = nullptr;
    size_ = room_ = 0;
  }

 private:
  Item* items_ = nullptr;
  std::size_t size_ = 0;
  std::size_t room_ = 0;
};

template <class Env>
class purge;
template <class Env>
class trial_deletion;
template <class Env>
class edge_sink;

/// What a walk can do with an object, or with a root, of some type that describes its edges. False if edges() threw.
template <class Env>
struct described_operations {
  bool (*purge_by_collector)(void* described, purge<Env>& with);
  /// By the thread that owns a root.
  bool (*purge_by_owner)(void* described);
  bool (*report)(void* described, edge_sink<Env>& to);
  /// Makes suspects of what it refers to.
  bool (*suspect)(void* described, trial_deletion<Env>& trial);
  /// Records its references to candidates.
  bool (*record)(void* described, trial_deletion<Env>& trial);
};

/// What an edge refers to.
template <class Env>
struct edge_target {
  void* object;
  const char* type;
  std::uint64_t word;
  const described_operations<Env>*
      described;                            // null: its type describes no edges, or does not defer
  std::uint64_t (*id)(const void* object);  // null: its type has no report_id()
};

/// Takes what a collector knows, for reports.
template <class Env>
class edge_sink {
 public:
  /// A described reference of an object or a root.
  virtual void edge(const char* name, const char* disposition, const edge_target<Env>& target) = 0;
  /// An object that waits in a table.
  virtual void waiting(const edge_target<Env>& object) = 0;

 protected:
  ~edge_sink() = default;
};

/// The objects that a walk has met and has still to visit.
template <class Env>
class heap_walk {
 public:
  using operations = described_operations<Env>;
  struct item {
    void* object;
    const operations* type;
  };

  bool reserve(std::size_t objects) noexcept { return met_.reserve(objects); }
  /// An object was met. It is visited unless it was met before.
  void meet(void* object, const operations& type) noexcept {
    bool added = false;
    if (met_.add({object}, added) == nullptr || (added && !pending_.push({object, &type})))
      out_of_memory_ = true;
  }
  /// Is never visited.
  void exclude(void* object) noexcept {
    bool ignored;
    if (met_.add({object}, ignored) == nullptr) out_of_memory_ = true;
  }
  void fail() noexcept { out_of_memory_ = true; }
  bool at_end() const noexcept { return pending_.empty(); }
  item next() noexcept { return pending_.pop(); }
  bool out_of_memory() const noexcept { return out_of_memory_; }
  void clear() noexcept {
    met_.clear();
    pending_.clear();
    out_of_memory_ = false;
  }

 private:
  struct entry {
    const void* key;
  };
  address_table<entry> met_;
  growing_stack<item> pending_;
  bool out_of_memory_ = false;
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
