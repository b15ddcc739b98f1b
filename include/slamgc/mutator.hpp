/// @file
/// Threads that hold borrowed pointers.
#pragma once

#include "assert.hpp"
#include "detail/domain_state.hpp"
#include "domain.hpp"
#include "fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// How a mutator registers.
struct mutator_options {
  bool online = true;          ///< Begins online; else with its first online_scope.
  bool never_reclaim = false;  ///< Real-time thread: collect() is refused while it is online.
  /// Used by several threads, one after the other, each with an online_scope of its own; between them it is offline.
  bool roaming = false;
};

/// Registers the calling thread with a domain, for as long as it exists.
///
/// While it is online the thread may hold borrowed pointers: what it read from slots and containers stays
/// valid until its next quiescent(). It must call that regularly, at a point where it holds none, such as
/// the end of its loop; or go offline. Its end, by an exception too, delays nobody and loses nothing.
///
/// Made, used and destroyed by one thread, unless it is roaming. A thread may have several, also of different domains. Registering is
/// O(records ever in use at once); everything else is O(1), plus one compare-and-swap for each type of which objects entered the
/// table since the last quiescent state.
template <class Env>
class basic_mutator {
 public:
  using options = mutator_options;  ///< How it registers.

  /// Registers with @p to. @p name is shown in reports; it has to stay valid, as a string literal does.
  /// Throws std::bad_alloc.
  basic_mutator(basic_domain<Env>& to, const char* name, options how = {})
      : record_(detail::domain_access::state_of(to).enter(name != nullptr ? name : "")),
        me_{nullptr,          &detail::domain_access::state_of(to), &record_, record_.door, false,
            how.never_reclaim},
        roaming_(how.roaming),
        taking_part_(me_, !how.roaming) {
    SLAMGC_ASSERT(!(how.roaming && how.online),
                  (misuse{"makes a roaming mutator that is online", "mutator", this, 0}));
    me_.domain->retain();
    if (how.online && !roaming_) go_online();
  }
  /// Registers with default_domain().
  explicit basic_mutator(const char* name, options how = {})
      : basic_mutator(basic_default_domain<Env>(), name, how) {}
  /// The thread holds no borrowed pointer any more.
  ~basic_mutator() {
    SLAMGC_ASSERT(((roaming_ && !me_.online) || is_of_this_thread()),
                  (misuse{"ends a mutator on another thread than its own", "mutator", this, 0}));
    if (me_.online) go_offline();
    while (me_.roots != nullptr) me_.roots->leave();
    me_.domain->leave(record_);
    me_.domain->release();
  }
  basic_mutator(const basic_mutator&) = delete;
  basic_mutator& operator=(const basic_mutator&) = delete;

  /// The thread holds no borrowed pointer now. A few loads and stores of its own memory in the common case, and one
  /// that others see when a grace period has begun since the last call. Ignored while offline.
  void quiescent() noexcept {
    SLAMGC_ASSERT(me_.online, (misuse{"is quiescent while offline", "mutator", this, 0}));
    if (!me_.online) return;
    me_.publish();
    const bool first_since_a_grace_period_began = me_.domain->quiescent(record_);
    gave_up_borrowed();
    if (first_since_a_grace_period_began && me_.roots != nullptr) me_.join_purge();
  }
  /// Whether the thread may hold borrowed pointers now.
  [[nodiscard]] bool is_online() const noexcept { return me_.online; }

  /// The thread holds no borrowed pointer while this exists: for waits, sleeps, and long computations on
  /// pinned objects.
  class offline_scope {
   public:
    /// Goes offline, if it is not.
    explicit offline_scope(basic_mutator& m) noexcept : mutator_(m), was_online_(m.is_online()) {
      if (was_online_) m.go_offline();
    }
    /// Goes online again, if it was.
    ~offline_scope() {
      if (was_online_) mutator_.go_online();
    }
    offline_scope(const offline_scope&) = delete;
    offline_scope& operator=(const offline_scope&) = delete;

   private:
    basic_mutator& mutator_;
    const bool was_online_;
  };
  /// The thread may hold borrowed pointers while this exists: for a thread that belongs to the caller and
  /// is offline in between, one scope per frame.
  class online_scope {
   public:
    /// Goes online, if it is not.
    explicit online_scope(basic_mutator& m) noexcept : mutator_(m), was_online_(m.is_online()) {
      SLAMGC_ASSERT(!was_online_ || m.is_of_this_thread(),
                    (misuse{"uses a mutator on two threads", "mutator", &m, 0}));
      if (!was_online_) m.go_online();
    }
    /// Goes offline again, if it was.
    ~online_scope() {
      if (!was_online_) mutator_.go_offline();
    }
    online_scope(const online_scope&) = delete;
    online_scope& operator=(const online_scope&) = delete;

   private:
    basic_mutator& mutator_;
    const bool was_online_;
  };

 private:
  friend struct detail::mutator_access;

  bool is_of_this_thread() const noexcept {
    return runtime::participants<Env>::any_in(
        *me_.domain, [this](const runtime::participant<Env>& p) { return &p == &me_; });
  }
  void go_online() noexcept {
    if (roaming_) taking_part_.begin();
    me_.domain->go_online(record_);
    me_.online = true;
    gave_up_borrowed();
    if (me_.roots != nullptr) me_.join_purge();  // one that it has missed
  }
  void go_offline() noexcept {
    if (me_.roots != nullptr) me_.join_purge();
    me_.online = false;
    me_.publish();
    me_.domain->go_offline(record_);
    if (roaming_) taking_part_.end();
  }
  /// Only the checks of borrow.hpp want to know.
  void gave_up_borrowed() noexcept {
#if SLAMGC_DEBUG
    me_.pass_quiescent_state();
#endif
  }

  runtime::mutator_record<Env>& record_;
  runtime::participant<Env> me_;
  const bool roaming_;
  runtime::participation<Env> taking_part_;
};

namespace detail {

struct mutator_access {
  template <class Env>
  static runtime::participant<Env>& part_of(basic_mutator<Env>& m) noexcept {
    return m.me_;
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
