/// @file
/// How a collector decides that objects die while weak handles lead to them: one decision for a whole set.
///
/// **States.** A side block is *alive*, *in decision n*, or *dead*; dead is for ever. A domain has one *decision word*:
/// a number, and whether that decision is open, vetoed, or dead. The collector
/// 1. opens decision n;
/// 2. for each object of the set that has a block: *marks* the block with n, *seals* the object's word (a
///    read-modify-write that changes nothing and finds it as it was noted), and makes the record;
/// 3. *commits*: open becomes dead, by compare-and-swap. If a word had changed, or somebody vetoed, the marks are taken
///    back and nothing has happened;
/// 4. makes the blocks dead, one by one;
/// 5. destroys the objects after another grace period.
///
/// Who *locks* a handle finds the block not dead, adds a reference, and looks at the block again: alive is success; in an
/// open decision, a *veto* is; a dead decision is failure, and the reference is removed again. Nobody ever waits.
///
/// The argument: docs/design.md, "Weak handles and anchors".
#pragma once

#include <cstdint>

#include "../env.hpp"
#include "../fwd.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// The decision word of a domain.
template <class Env>
class decision {
 public:
  enum class outcome { survives, dies, unknown };
  static constexpr std::uint64_t step = 4;  // numbers are multiples of it, from the first one on

  // The collector's:

  void open() noexcept {
    number_ += step;
    // (27) release: who finds this decision finds the marks of those before it taken back.
    word_.store(number_ | is_open, std::memory_order_release);
  }
  std::uint64_t number() const noexcept { return number_; }
  /// False if somebody vetoed.
  bool commit() noexcept {
    std::uint64_t expected = number_ | is_open;
    // (27) release: the records are made; relaxed: a veto tells nothing else.
    return word_.compare_exchange_strong(expected, number_ | is_dead, std::memory_order_release,
                                         std::memory_order_relaxed);  // (27)
  }

  // Of who has added a reference, and found the object in decision n:

  /// What that decision says; unknown if it is over.
  outcome veto(std::uint64_t n) noexcept {
    std::uint64_t found = n | is_open;
    // (27) acquire: who comes too late sees the records, or the marks taken back. (A veto needs no order; g++ wants that of
    // success to be no weaker.)
    if (word_.compare_exchange_strong(found, n | is_vetoed, std::memory_order_acquire,
                                      std::memory_order_acquire))  // (27)
      return outcome::survives;
    if (found == (n | is_vetoed)) return outcome::survives;
    return found == (n | is_dead) ? outcome::dies : outcome::unknown;
  }

 private:
  static constexpr std::uint64_t is_open = 0;
  static constexpr std::uint64_t is_vetoed = 1;
  static constexpr std::uint64_t is_dead = 2;

  typename Env::template atomic<std::uint64_t> word_{0};
  std::uint64_t number_ = 0;
};

/// What is left of an object for its weak handles, as collectors see it.
template <class Env>
class side_block {
 public:
  explicit side_block(const void* owner) noexcept : owner_(owner) {}
  virtual ~side_block() = default;
  side_block(const side_block&) = delete;
  side_block& operator=(const side_block&) = delete;

  /// The object, for as long as the caller may touch it.
  const void* owner() const noexcept { return owner_; }
  bool is_dead() const noexcept {
    // (28) acquire: sees the record.
    return state_.load(std::memory_order_acquire) == dead;
  }
  /// Of who has added a reference to the object, after it had found the block not dead: whether that counts.
  bool survives() const noexcept {
    for (;;) {
      // (28) acquire: sees whose decision it is in, and the record.
      const std::uint64_t now = state_.load(std::memory_order_acquire);
      if (now == alive) return true;
      if (now == dead) return false;
      // (28) the mark published it.
      switch (judge_.load(std::memory_order_relaxed)->veto(now)) {
        case decision<Env>::outcome::survives:
          return true;
        case decision<Env>::outcome::dies:
          return false;
        case decision<Env>::outcome::unknown:  // the block says how it ended
          break;
      }
    }
  }

  // The collector's:

  void mark(decision<Env>& by) noexcept {
    judge_.store(&by, std::memory_order_relaxed);  // (28) published by the mark.
    // (28) release: publishes the judge, and that the decision is open.
    state_.store(by.number(), std::memory_order_release);
  }
  void unmark() noexcept {
    state_.store(alive, std::memory_order_relaxed);  // (28) nothing is read through it.
  }
  bool is_marked() const noexcept {
    const std::uint64_t now = state_.load(std::memory_order_relaxed);  // (28) its own mark.
    return now != alive && now != dead;
  }
  /// For ever. A grace period later nobody but the collector touches the object.
  void expire() noexcept {
    state_.store(dead, std::memory_order_release);  // (28) publishes the record.
  }
  /// Makes the record of an object that is about to die.
  virtual void bury() noexcept {}

  /// A reference came and went while the collector looked at the object, which may have been a lock(). Who is patient for
  /// ever lets a handle that is polled keep its object for ever.
  void disturbed() noexcept {
    if (is_dead() || ++disturbed_ != patience) return;
    bury();
    expire();
  }
  /// The object was found referred to.
  void undisturbed() noexcept { disturbed_ = 0; }

  static constexpr unsigned patience = 4;

 private:
  static constexpr std::uint64_t alive = 0;
  static constexpr std::uint64_t dead = 1;

  const void* const owner_;
  typename Env::template atomic<decision<Env>*> judge_{nullptr};
  typename Env::template atomic<std::uint64_t> state_{alive};
  unsigned disturbed_ = 0;
};

/// Decides on one object, whose word @p sealed looks at. Returns whether it dies.
template <class Env, class Sealed>
bool decide_alone(decision<Env>& by, side_block<Env>& block, Sealed sealed) noexcept {
  by.open();
  block.mark(by);
  bool dies = sealed();
  if (dies) {
    block.bury();
    dies = by.commit();
  }
  if (dies)
    block.expire();
  else
    block.unmark();
  return dies;
}

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
