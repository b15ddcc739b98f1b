/// @file
/// The zero-count table: objects that wait until nobody can see them any more.
///
/// **Life of an entry.** An object enters when its count falls to zero or when it is retired at zero,
/// whichever comes first: the change that makes it so also sets `queued`, and the thread whose change set
/// it pushes the object. So each object is in the table at most once, and whoever pushes it owns its link.
/// While it is not queued, the link names the table that it belongs to.
///
/// The collector *notes* the state word of each object that has entered, advances the epoch, and after the
/// grace period *decides*:
///
/// | count | version | the object |
/// |---|---|---|
/// | 0 | as noted | is reclaimed |
/// | 0 | another | enters anew: a pointer may have been borrowed through the reference that came and went |
/// | more | | leaves the table |
///
/// **An object that is reclaimed is out of everybody's sight.** Its count was zero when the word was noted,
/// and no reference was added since (counter.hpp). So every reference had been unlinked before the epoch
/// was advanced, and after the grace period nobody holds a pointer that was borrowed through one
/// (domain.hpp). Without a pointer nobody adds a reference or retires it either.
///
/// **None is lost.** Leaving the table is one compare-and-swap of the whole word, which clears `queued`. A
/// fall to zero or a retirement after it finds the flag clear and pushes the object again; one before it
/// makes the compare-and-swap fail, and the collector decides again.
///
/// Deferred reference counting: Deutsch and Bobrow 1976; *The Garbage Collection Handbook*, 5.3.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "../reclaim_at_zero.hpp"
#include "described.hpp"
#include "domain_state.hpp"
#include "header.hpp"
#include "note_list.hpp"
#include "side_block.hpp"
#include "trial_deletion.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

template <class T>
class zero_count_table final : public runtime::table_base<typename policy_of<T>::env> {
  using env = typename policy_of<T>::env;
  using base = runtime::table_base<env>;
  using policy = policy_of<T>;
  using typename base::door;
  using candidate = runtime::candidate<env>;

 public:
  explicit zero_count_table(runtime::domain_state<env>& of) noexcept
      : base(of, &type_key<T>, slamgc::detail::type_name<T>::get(), sizeof(T),
             has_block<T>::value) {}

  /// The table of T in @p domain, or null.
  static zero_count_table* find(const runtime::domain_state<env>& domain) noexcept {
    return static_cast<zero_count_table*>(domain.find(&type_key<T>));
  }
  /// The table of T in @p domain. Throws std::bad_alloc, the first time.
  static zero_count_table& in(runtime::domain_state<env>& domain) {
    zero_count_table* found = find(domain);
    if (found == nullptr) {
      found = new zero_count_table(domain);
      domain.add(*found);
    }
    return *found;
  }
  /// The table of an object that is not queued.
  static zero_count_table* of(const T& object) noexcept {
    auto& link = access::header_of(object).link;
    // (13) stored by the object's constructor, or before it left the table.
    return static_cast<zero_count_table*>(link.load(std::memory_order_relaxed));
  }

  /// Takes in an object whose `queued` flag the caller has just set. Lock-free; never allocates.
  void push(T* object) noexcept {
    runtime::participant<env>* me;
    door& at = this->my_door(me);
    push(object, at, me);
  }
  /// The same, where the caller knows the door.
  void push(T* object, door& at, runtime::participant<env>* me) noexcept {
    auto& link = access::header_of(*object).link;
    base::add(at, &door::entered);
    if (me == nullptr || !me->keeps_chains()) {
      at.push(object, link);
      return;
    }
    link.store(at.chain, std::memory_order_relaxed);  // (11)
    if (at.chain == nullptr) {
      at.chain_end = &link;
      at.next_pending = me->pending;
      me->pending = &at;
    }
    at.chain = object;
  }

  bool note(runtime::work_limit<env>& limit, std::size_t& noted) noexcept override {
    for (;;) {
      while (taken_ != nullptr) {
        auto& header = access::header_of(*taken_);
        void* const below = header.link.load(std::memory_order_relaxed);  // (11)
        const std::uint64_t word = policy::load(header.state);
        if (is_candidate(word)) {
          if (!become_candidate(taken_, word)) return true;
          base::add(this->left_, 1);
        } else {
          if (!notes_.add({taken_, word})) return true;
          ++noted;
        }
        taken_ = static_cast<T*>(below);
        if (!limit.spend()) return false;
      }
      if (at_door_ == base::doors) break;
      taken_ = static_cast<T*>(this->doors_[at_door_++].take());
    }
    at_door_ = 0;
    return true;
  }

  std::uint64_t word_of(const void* object) const noexcept override {
    return policy::load(access::header_of(*static_cast<const T*>(object)).state);
  }
  runtime::side_block<env>* block_of(void* object) const noexcept override {
    if constexpr (has_block<T>::value)
      return owner_of<env>(*static_cast<const T*>(object)).slamgc_block();
    else
      return nullptr;
  }
  bool seal(void* object, std::uint64_t noted) noexcept override {
    auto& state = access::header_of(*static_cast<T*>(object)).state;
    std::uint64_t now = policy::load(state);
    do {
      if (!state_word{now}.same_references({noted})) return false;
    } while (!policy::compare_exchange(state, now, now));
    return true;
  }
  const runtime::described_operations<env>& operations() const noexcept override {
    return operations_on<std::conditional_t<has_edges<T>::value, T, no_edges>, env>::table;
  }
  bool walk(void* object, runtime::trial_deletion<env>& trial) noexcept override {
    if constexpr (has_edges<T>::value) return operations_on<T, env>::record(object, trial);
    return true;
  }
  bool sever(void* object) noexcept override {
    severing_visitor visitor;
    if constexpr (has_edges<T>::value)
      return detail::visit_edges(*static_cast<T*>(object), visitor);
    return true;
  }
  void destroy(void* object) noexcept override {
    destroy_object(static_cast<T*>(object));
    base::add(this->stuck_, std::uint64_t{0} - 1);
    base::add(this->reclaimed_, 1);
    base::add(this->doors_[base::collectors_door].ended, 1);
  }

  /// Makes a candidate of an object that is neither queued nor retired: see trial_deletion::suspect.
  static void suspect(T& object) noexcept {
    auto& header = access::header_of(object);
    std::uint64_t now = policy::load(header.state);
    do {
      const state_word w{now};
      if (w.is_queued() || w.is_retired() || w.is_saturated()) return;
    } while (!policy::compare_exchange(header.state, now, now | state_word::queued_flag));
    zero_count_table* const mine = of(object);
    if (!mine->become_candidate(&object, now)) mine->leave_table(object);
  }
  void condemn(void* object) noexcept override {
    auto& state = access::header_of(*static_cast<T*>(object)).state;
    std::uint64_t now = policy::load(state);
    do {
      if (state_word{now}.is_retired()) return;
    } while (!policy::compare_exchange(state, now, now | state_word::retired_flag));
    base::add(this->doors_[base::collectors_door].retired, 1);
  }
  void leave(void* object) noexcept override {
    base::add(this->stuck_, std::uint64_t{0} - 1);
    leave_table(*static_cast<T*>(object));
  }

  void report(const void* object, runtime::edge_sink<env>& to) const override {
    to.waiting(operations_on<T, env>::target(*static_cast<const T*>(object)));
  }
  void report_waiting(runtime::edge_sink<env>& to, bool stand_still) const override {
    const auto report_stack = [&](const void* newest) {
      for (auto* at = static_cast<const T*>(newest); at != nullptr;) {
        report(at, to);
        // Collectors alone take from a stack, and who pushes to it writes only links of its own.
        at = static_cast<const T*>(access::header_of(*at).link.load(std::memory_order_seq_cst));
      }
    };
    for (const door& d : this->doors_) {
      report_stack(d.first.load(std::memory_order_seq_cst));
      if (stand_still) report_stack(d.chain);
    }
    report_stack(taken_);
    notes_.each([&](const entry& e) { report(e.object, to); });
  }

  bool decide(runtime::work_limit<env>& limit, std::size_t& reclaimed) noexcept override {
    std::size_t left = 0;
    std::size_t destroyed = 0;
    bool more = true;
    limit.other_objects();
    for (; more && !notes_.empty(); more = limit.spend()) {
      if (const entry* const soon = notes_.soon()) __builtin_prefetch(soon->object, 1);
      const entry e = notes_.take();
      ++left;
      if (!is_dead(e) || !has_expired(e)) continue;
      // The destructor may do anything, push objects of this type included.
      destroy_object(e.object);
      ++destroyed;
    }
    base::add(this->left_, left);
    base::add(this->reclaimed_, destroyed);
    base::add(this->doors_[base::collectors_door].ended, destroyed);
    reclaimed += destroyed;
    return more;
  }

 private:
  struct entry {
    T* object;
    std::uint64_t noted;
  };

  /// Else the object is where it belongs afterwards.
  bool is_dead(const entry& e) noexcept {
    auto& header = access::header_of(*e.object);
    std::uint64_t now = policy::load(header.state);
    for (;;) {
      const state_word w{now};
      if (w.count() == 0) {
        if (w.same_references({e.noted})) return true;
        if (auto* const block = this->block_of(e.object)) block->disturbed();
        push(e.object);
        return false;
      }
      if (is_candidate(now)) {
        if (!become_candidate(e.object, now)) push(e.object);
        return false;
      }
      if (auto* const block = this->block_of(e.object)) block->undisturbed();
      if (clear_queued(header, now)) return false;
    }
  }

  /// Clears `queued`, or pushes the object.
  void leave_table(T& object) noexcept {
    auto& header = access::header_of(object);
    std::uint64_t now = policy::load(header.state);
    do {
      const state_word w{now};
      if (w.is_retired() || (w.count() == 0 && reclaimer_of<T>::at_zero)) {
        push(&object);
        return;
      }
    } while (!clear_queued(header, now));
  }
  /// The object leaves, or @p now is its word.
  template <class Header>
  bool clear_queued(Header& header, std::uint64_t& now) noexcept {
    // (13) published by clearing the flag: compare_exchange (6) releases.
    header.link.store(this, std::memory_order_relaxed);
    return policy::compare_exchange(header.state, now, now & ~state_word::queued_flag);
  }

  /// Whether no weak handle leads to the object any more, which is dead otherwise. Else they expire now, unless
  /// somebody locks one; and the object enters anew.
  bool has_expired(const entry& e) noexcept {
    auto* const block = this->block_of(e.object);
    if (block == nullptr || block->is_dead()) return true;
    if (!runtime::decide_alone(this->domain.collection.trial().decision(), *block,
                               [&] { return seal(e.object, e.noted); }) &&
        state_word{word_of(e.object)}.count() == 0)
      block->disturbed();
    push(e.object);
    return false;
  }

  /// Retired, described, and still referred to: in place of leaving, it is tried.
  static constexpr bool is_candidate(std::uint64_t word) noexcept {
    return has_edges<T>::value && state_word{word}.count() != 0 && state_word{word}.is_retired();
  }
  /// False if there is no memory.
  bool become_candidate(T* object, std::uint64_t word) noexcept {
    auto* const c = this->domain.collection.trial().add(object, *this, word);
    if (c == nullptr) return false;
    // (11) read by collectors alone.
    access::header_of(*object).link.store(candidate::link_to(c), std::memory_order_relaxed);
    base::add(this->stuck_, 1);
    return true;
  }

  // The collector's:
  note_list<entry> notes_;
  T* taken_ = nullptr;       // what is left of a door's stack
  std::size_t at_door_ = 0;  // the next door
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
