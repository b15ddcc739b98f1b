/// @file
/// What all zero-count tables have in common, whatever the type of their objects.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "../env.hpp"
#include "../fwd.hpp"
#include "../stats.hpp"
#include "clock.hpp"
#include "participant.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// How much one call of collect() may still do.
template <class Env>
class work_limit {
 public:
  using clock = clock_of<Env>;
  using time_point = typename clock::time_point;

  work_limit(std::size_t objects, std::chrono::nanoseconds time, time_point now) noexcept
      : objects_(objects),
        timed_(time < std::chrono::hours(1000000)),  // more could overflow the deadline
        last_(now),
        deadline_(timed_ ? now + time : now) {
    (void)next_check();
  }

  /// Called after each object; false when the limit is reached. The clock costs as much as freeing a
  /// small object, so it is read at growing distances as long as objects are quick to handle.
  bool spend() noexcept {
    if (until_check_ <= 1) return next_check();
    --until_check_;
    return true;
  }

  /// Other objects follow, which may be slower: the clock is read after the first of them.
  void other_objects() noexcept {
    if (!timed_) return;
    objects_ += until_check_ - 1;
    until_check_ = 1;
    stride_ = 1;
  }

 private:
  bool next_check() noexcept {
    if (timed_ && stride_ != 0) {
      const time_point now = clock::now();
      if (now >= deadline_) return false;
      const bool quick = now - last_ < std::chrono::microseconds(20);
      stride_ = quick ? (stride_ < longest_stride ? 2 * stride_ : stride_) : 1;
      last_ = now;
    } else {
      stride_ = 1;
    }
    until_check_ = timed_ && stride_ < objects_ ? stride_ : objects_;
    objects_ -= until_check_;
    return until_check_ != 0;
  }

  /// So many objects that suddenly are slow may be too many.
  static constexpr std::size_t longest_stride = 16;

  std::size_t objects_;
  bool timed_;
  time_point last_;
  time_point deadline_;
  std::size_t stride_ = 0;
  std::size_t until_check_ = 0;
};

/// Where objects of one type enter the table of a domain, with the numbers of who enters there.
///
/// Door 0 is shared. Each other door belongs to one participant, who alone writes its numbers and its
/// chain; what it pushes goes to the chain first, and to the collector when it publishes that.
template <class Env>
struct alignas(cache_line) table_door {
  using number = typename Env::template atomic<std::uint64_t>;
  using link = typename Env::template atomic<void*>;

  link first{nullptr};  // what the collector may take: a stack through the objects' links
  number created{0};
  number ended{0};
  number retired{0};
  number entered{0};
  void* chain = nullptr;      // the owner's: its newest object
  link* chain_end = nullptr;  // the link of its oldest
  table_door* next_pending = nullptr;

  /// Puts a chain of objects on the stack. Lock-free.
  void push(void* newest, link& end) noexcept {
    void* below = first.load(std::memory_order_relaxed);  // (11) a guess.
    do {
      end.store(below, std::memory_order_relaxed);  // (11)
      // (11) release: publishes the links, and what was done to the objects, to take().
    } while (!first.compare_exchange_weak(below, newest, std::memory_order_release,
                                          std::memory_order_relaxed));  // (11)
  }
  /// All that is on the stack.
  void* take() noexcept {
    // (11) relaxed: only whether there is something; acquire: sees the links of all that were pushed.
    if (first.load(std::memory_order_relaxed) == nullptr) return nullptr;
    return first.exchange(nullptr, std::memory_order_acquire);  // (11)
  }
  void publish() noexcept {
    push(chain, *chain_end);
    chain = nullptr;
  }
};

template <class Env>
class trial_deletion;
template <class Env>
class side_block;
template <class Env>
struct described_operations;
template <class Env>
class edge_sink;

/// The part of a domain's zero-count table for objects of one type; see zero_count_table.hpp.
template <class Env>
class table_base {
 public:
  using door = table_door<Env>;
  static constexpr std::size_t shared_door = 0;
  static constexpr std::size_t collectors_door = 1;
  static constexpr std::size_t first_of_mutators = 2;
  static constexpr std::size_t doors = first_of_mutators + Env::mutator_doors;

  table_base(domain_state<Env>& d, const void* t, const char* name, std::size_t size,
             bool blocks) noexcept
      : domain(d), type(t), type_name(name), object_size(size), has_blocks(blocks) {}
  virtual ~table_base() = default;
  table_base(const table_base&) = delete;
  table_base& operator=(const table_base&) = delete;

  /// Notes the words of the objects that have entered, before a grace period. What finds no memory is noted the next
  /// time. By the collector; false if the limit came first.
  virtual bool note(work_limit<Env>& limit, std::size_t& noted) noexcept = 0;
  /// Decides on the objects that are noted, after it. By the collector; false if the limit came first.
  virtual bool decide(work_limit<Env>& limit, std::size_t& reclaimed) noexcept = 0;

  // For trial deletion (trial_deletion.hpp), by the collector, of a candidate:

  virtual std::uint64_t word_of(const void* object) const noexcept = 0;
  virtual const described_operations<Env>& operations() const noexcept = 0;
  /// Records each reference to a candidate. False if edges() threw.
  virtual bool walk(void* object, trial_deletion<Env>& trial) noexcept = 0;
  /// Drops all references. False if edges() threw.
  virtual bool sever(void* object) noexcept = 0;
  /// The block of an object to which there may be weak handles, or null.
  virtual side_block<Env>* block_of(void* object) const noexcept = 0;
  /// Whether the word has the references that were noted: by a read-modify-write, which a lock() that it does not see
  /// does see (decision.hpp).
  virtual bool seal(void* object, std::uint64_t noted) noexcept = 0;
  virtual void destroy(void* object) noexcept = 0;
  /// It was a suspect: is retired, and stays.
  virtual void condemn(void* object) noexcept = 0;
  /// It was a suspect: is none any more.
  virtual void leave(void* object) noexcept = 0;

  // For reports, by whoever excludes collectors:

  /// Reports one object.
  virtual void report(const void* object, edge_sink<Env>& to) const = 0;
  /// Reports the objects that have entered and are no candidates; of those that a mutator has not published yet only if
  /// the mutators' threads @p stand_still.
  virtual void report_waiting(edge_sink<Env>& to, bool stand_still) const = 0;

  domain_state<Env>& domain;
  const void* const type;
  const char* const type_name;
  const std::size_t object_size;
  const bool has_blocks;  // whether there may be weak handles to objects of the type
  table_base* next = nullptr;

  /// The calling thread's door, and its part in this domain if it has one.
  door& my_door(participant<Env>*& me) noexcept {
    me = participants<Env>::of_this_thread().innermost;
    if (me != nullptr && me->domain != &domain) me = nullptr;
    return doors_[me != nullptr ? me->door : shared_door];
  }
  bool is_shared(const door& d) const noexcept { return &d == &doors_[shared_door]; }

  /// Adds to a number of a door: of the shared one, or of the calling thread's.
  void add(door& at, typename door::number door::*number, std::uint64_t n = 1) noexcept {
    if (is_shared(at))
      // (26) release: what a thread without a mutator did to its object comes before the end of the table.
      (at.*number).fetch_add(n, std::memory_order_release);
    else
      add(at.*number, n);
  }

  std::uint64_t sum(typename door::number door::*number) const noexcept {
    std::uint64_t total = 0;
    for (const door& d : doors_) total += (d.*number).load(std::memory_order_relaxed);  // (12)
    return total;
  }
  std::uint64_t live() const noexcept {
    std::uint64_t ended = 0;
    for (const door& d : doors_)
      ended += d.ended.load(
          std::memory_order_acquire);  // (26) who finds the last one gone may free this.
    return sum(&door::created) - ended;
  }
  std::uint64_t reclaimed() const noexcept {
    return reclaimed_.load(std::memory_order_relaxed);  // (12)
  }
  /// Candidates.
  std::uint64_t stuck() const noexcept { return stuck_.load(std::memory_order_relaxed); }  // (12)
  type_stats stats() const noexcept {
    type_stats s;
    s.type = type_name;
    s.object_size = object_size;
    s.created = sum(&door::created);
    s.live = live();
    s.retired = sum(&door::retired);
    s.reclaimed = reclaimed();
    s.stuck = stuck();
    s.backlog = backlog();
    return s;
  }
  /// Objects that wait, if nobody changes it meanwhile; never less than none.
  std::uint64_t backlog() const noexcept {
    const std::uint64_t left = left_.load(std::memory_order_relaxed);  // (12)
    const std::uint64_t entered = sum(&door::entered);
    return entered > left ? entered - left : 0;
  }

 protected:
  /// For a number that the calling thread alone writes.
  static void add(typename door::number& number, std::uint64_t n) noexcept {
    number.store(number.load(std::memory_order_relaxed) + n, std::memory_order_relaxed);  // (12)
  }

  door doors_[doors];
  // The collector's:
  typename door::number reclaimed_{0};
  typename door::number left_{0};
  typename door::number stuck_{0};

 public:
  type_stats told;  // what hooks know; behind the doors, whose offsets the instructions depend on
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
