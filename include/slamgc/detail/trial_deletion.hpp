/// @file
/// Trial deletion: retired objects that nothing but each other refers to.
///
/// The *candidates* are retired objects that are still referred to. A round of trial deletion
/// 1. *begins*: notes the state word of each candidate;
/// 2. *records*, for each candidate, its references to candidates, by a walk of its edges, and counts those that
///    each of them has from candidates;
/// 3. *excludes* each candidate that has others, and what is recorded to be reached from it;
/// 4. after a grace period that began after 2, *checks* the words of all that are left: one that has changed is
///    excluded, as in 3;
/// 5. if there are weak handles to what is left: decides (decision.hpp), and waits for another grace period;
/// 6. *severs* what is left, and destroys it.
///
/// **What is left is out of everybody's sight**: docs/design.md, "Cycles". There, too, is why 3 and 4 must not walk the
/// edges a second time.
///
/// Each phase can stop after any object and goes on in the next call. No thread ever waits for it, but for the locks
/// of the program that edges() takes. Linear in the edges of the candidates; no recursion.
///
/// Trial deletion: Christopher 1984; Bacon and Rajan 2001; *The Garbage Collection Handbook*, 5.5. The use of versions in
/// place of a second, synchronous walk is ours.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>

#include "../counter.hpp"
#include "../env.hpp"
#include "../fwd.hpp"
#include "candidate.hpp"
#include "decision.hpp"
#include "root_list.hpp"
#include "table_base.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

template <class Env>
class trial_deletion {
 public:
  using candidate_type = candidate<Env>;
  using limit_type = work_limit<Env>;

  trial_deletion() noexcept = default;
  trial_deletion(const trial_deletion&) = delete;
  trial_deletion& operator=(const trial_deletion&) = delete;

  /// The new candidate, with its word now, or null if there is no memory.
  candidate_type* add(void* object, table_base<Env>& table, std::uint64_t word) noexcept {
    candidate_type* const c = all_.add();
    if (c == nullptr) return nullptr;
    *c = {object, &table, word, edges_.end(), nullptr,     0,     0,
          0,      0,      true, true,         suspecting_, false, now_};
    any_blocks_ = any_blocks_ || table.has_blocks;
    return c;
  }
  /// A call of collect() begins: candidates that it finds date from @p now.
  void begin_call(std::chrono::nanoseconds now) noexcept { now_ = now; }
  /// Calls f(candidate) for each candidate, while nobody collects.
  template <class F>
  void each(F f) const {
    auto at = all_.begin();
    while (const candidate_type* const c = at.next()) f(*c);
  }
  /// Steps 1 to 3, before the grace period. False if the limit came first.
  bool find(limit_type& limit) noexcept {
    if (phase_ == phase::expired) start(phase::severing);  // after the grace period that follows
    if (phase_ == phase::idle) {
      changed_ = false;
      left_ = 0;
      start(phase::beginning);
    }
    if (phase_ == phase::beginning) {
      const bool all = go_through(limit, [this](candidate_type& c) {
        // A new one was noted when it was added: a while ago is as good.
        const std::uint64_t now = c.fresh ? c.noted : c.table->word_of(c.object);
        changed_ = changed_ || c.fresh || !same_references(now, c.noted);
        c.noted = now;
        c.inner = 0;
        c.fresh = c.live = false;
        ++left_;
      });
      if (!all) return false;
      // Only what changes the word of a candidate can make one unreachable. Who had counted a reference and not
      // stored it yet will have done so after a grace period: so one more round after the last change. A round with suspects
      // comes to its end, even if no root has any: else the suspicion would last.
      const bool worth_it = changed_ || unsettled_ || suspecting_;
      // After a purge, too: owners of roots join it at their next quiescent state.
      unsettled_ = changed_ || std::exchange(purged_, false);
      start(worth_it ? phase::recording : phase::idle);
    }
    if (phase_ == phase::recording) {
      const bool all = go_through(limit, [this](candidate_type& c) {
        walked_ = &c;
        c.first_edge = edges_.end();
        c.edges = 0;
        if (!out_of_memory_ && !c.table->walk(c.object, *this)) has_thrown(c);
      });
      if (out_of_memory_) return give_up();
      if (!all) return false;
      if (suspecting_) {
        walked_ = nullptr;
        roots_->visit([this](const root_place<Env>& root) {
          if (root.is_suspected()) root.operations->record(root.described, *this);
        });
        if (out_of_memory_) return give_up();
      }
      start(phase::excluding);
    }
    if (phase_ == phase::excluding) {
      const bool all = go_through(limit, [this](candidate_type& c) {
        if (c.inner != state_word{c.noted}.count()) mark(c);
      });
      if (!all || !exclude_marked(limit)) return false;
      start(left_ != 0 ? phase::checking : suspecting_ ? phase::resolving : phase::idle);
    }
    return true;
  }
  /// Whether find() has left something for decide().
  bool found() const noexcept { return phase_ >= phase::checking; }
  /// Whether find() has to be called again after a grace period.
  bool unsettled() const noexcept { return unsettled_; }

  runtime::decision<Env>& decision() noexcept { return decision_; }

  /// Steps 4 to 6, after the grace period. False if the limit came first.
  bool decide(limit_type& limit, std::size_t& reclaimed) noexcept {
    if (phase_ == phase::checking) {
      const bool all = go_through(limit, [this](candidate_type& c) {
        if (c.live || same_references(c.table->word_of(c.object), c.noted)) return;
        disturbed(c);
        mark(c);
      });
      if (!all || !exclude_marked(limit)) return false;
      if (any_blocks_ && !suspecting_) decision_.open();
      decided_ = true;
      marked_blocks_ = false;
      start(suspecting_ ? phase::resolving : any_blocks_ ? phase::deciding : phase::severing);
    }
    if (phase_ == phase::resolving && !resolve(limit)) return false;
    if (!expire_blocks(limit)) return false;
    if (phase_ == phase::expired) return true;
    if (phase_ == phase::severing) {
      const bool all = go_through(limit, [this](candidate_type& c) {
        if (!c.live && !c.table->sever(c.object)) has_thrown(c);
      });
      // What could not be severed stays, with what it refers to.
      if (!all || !exclude_marked(limit)) return false;
      start(phase::destroying);
    }
    if (phase_ == phase::destroying) {
      while (candidate_type* const c = next()) {
        if (c->live) continue;
        c->table->destroy(c->object);
        ++reclaimed;
        all_.remove(at_);
        if (!limit.spend()) return false;
      }
      all_.trim();
      phase_ = phase::idle;
    }
    return true;
  }

  /// Whether a candidate is referred to from elsewhere in a way that no purge has seen yet.
  bool unpurged() const noexcept { return unpurged_; }
  /// Whether some edges() threw in the last round: another one may find more, although no word changes.
  bool threw() const noexcept { return threw_; }
  /// Calls f(candidate) for each candidate, before a purge. Another round will see what it changes, a grace period later.
  template <class F>
  void begin_purge(F f) noexcept {
    unpurged_ = false;
    unsettled_ = purged_ = true;
    auto at = all_.begin();
    while (candidate_type* const c = at.next()) {
      c->purged = !c->fresh;  // else the references from candidates are not known yet
      c->purged_version = state_word{c->table->word_of(c->object)}.version();
      c->held = 0;
      f(*c);
    }
  }

  /// For walks: the candidate that is walked refers to this one.
  void record(candidate_type& target) noexcept {
    if (out_of_memory_ || !edges_.add(target)) {
      out_of_memory_ = true;
      return;
    }
    if (walked_ != nullptr) ++walked_->edges;
    ++target.inner;
  }

  /// Makes candidates, for one round, of what the suspected roots refer to: the references of those roots count as inner
  /// ones then, and what is found is not destroyed but retired. By the collector, between two rounds.
  void suspect(root_list<Env>& roots) noexcept {
    if (phase_ != phase::idle || !roots.any_suspected()) return;
    roots_ = &roots;
    suspecting_ = true;
    roots.visit([this](root_place<Env>& root) {
      if (root.begin_suspicion()) root.operations->suspect(root.described, *this);
    });
  }

 private:
  enum class phase {
    idle,
    beginning,
    recording,
    excluding,
    checking,
    resolving,
    deciding,
    unmarking,
    expiring,
    expired,
    severing,
    destroying
  };
  static bool same_references(std::uint64_t a, std::uint64_t b) noexcept {
    return state_word{a}.same_references({b});
  }
  void start(phase p) noexcept {
    phase_ = p;
    at_ = all_.begin();
    if (p != phase::recording) return;
    edges_.clear();
    threw_ = false;
  }
  candidate_type* next() noexcept { return at_.next(); }
  /// Calls f(candidate) for each that is left in this phase. False if the limit came first.
  template <class F>
  bool go_through(limit_type& limit, F f) noexcept {
    auto at = at_;  // in registers
    bool more = true;
    while (more) {
      candidate_type* const c = at.next();
      if (c == nullptr) break;
      f(*c);
      more = limit.spend();
    }
    at_ = at;
    return more;
  }
  void mark(candidate_type& c) noexcept {
    if (c.live) return;
    c.live = true;
    --left_;
    if (phase_ <= phase::excluding && !c.suspect &&
        (!c.purged || c.purged_version != state_word{c.noted}.version()))
      unpurged_ = true;
    c.next_marked = marked_;
    marked_ = &c;
  }
  void has_thrown(candidate_type& c) noexcept {
    threw_ = true;
    mark(c);
  }
  /// Marks what the marked ones refer to. False if the limit came first.
  bool exclude_marked(limit_type& limit) noexcept {
    while (candidate_type* const c = marked_) {
      marked_ = c->next_marked;
      auto edge = c->first_edge;
      for (std::size_t i = 0; i != c->edges; ++i) mark(*edge.next());
      if (!limit.spend()) return false;
    }
    return true;
  }
  /// Step 5: one decision for all that is left. False if the limit came first.
  bool expire_blocks(limit_type& limit) noexcept {
    if (phase_ == phase::deciding) {
      while (candidate_type* const c = decided_ ? next() : nullptr) {
        side_block<Env>* const side = block_of(*c);
        if (side != nullptr) {
          marked_blocks_ = true;
          side->mark(decision_);
          decided_ = c->table->seal(c->object, c->noted);
          if (decided_) side->bury();
        }
        if (!limit.spend()) return false;
      }
      decided_ = decided_ && (!marked_blocks_ || decision_.commit());
      start(!marked_blocks_ ? phase::severing : decided_ ? phase::expiring : phase::unmarking);
    }
    if (phase_ == phase::expiring || phase_ == phase::unmarking) {
      while (candidate_type* const c = next()) {
        side_block<Env>* const side = block_of(*c);
        if (side != nullptr && side->is_marked()) {
          if (phase_ == phase::expiring) {
            side->expire();
          } else {
            side->unmark();
            if (!same_references(c->table->word_of(c->object), c->noted)) disturbed(*c);
          }
        }
        if (!limit.spend()) return false;
      }
      // What made the decision fail has changed a word: there will be another round.
      phase_ = phase_ == phase::expiring ? phase::expired : phase::idle;
    }
    return true;
  }
  /// Of a candidate that nothing else refers to, if weak handles may lead to it.
  static side_block<Env>* block_of(const candidate_type& c) noexcept {
    if (c.live || !c.table->has_blocks) return nullptr;
    side_block<Env>* const side = c.table->block_of(c.object);
    return side != nullptr && !side->is_dead() ? side : nullptr;
  }
  static void disturbed(candidate_type& c) noexcept {
    if (!state_word{c.noted}.is_retired())
      return;  // only what is retired may expire while it is referred to
    if (side_block<Env>* const side = block_of(c)) side->disturbed();
  }
  /// Without memory this round finds nothing; another one will.
  bool give_up() noexcept {
    marked_ = nullptr;
    out_of_memory_ = false;
    unsettled_ = true;
    auto at = all_.begin();
    while (candidate_type* const c = at.next()) c->live = true;
    start(suspecting_ ? phase::resolving : phase::idle);
    return true;
  }
  /// The end of a round with suspects: what was found is retired, the rest leaves.
  bool resolve(limit_type& limit) noexcept {
    while (candidate_type* const c = next()) {
      if (c->suspect && (!c->live || state_word{c->table->word_of(c->object)}.is_retired())) {
        c->table->condemn(c->object);
        c->suspect = false;
        c->fresh = true;
      }
      if (c->suspect) {
        c->table->leave(c->object);
        all_.remove(at_);
      }
      if (!limit.spend()) return false;
    }
    all_.trim();
    suspecting_ = false;
    unsettled_ = true;  // what was found among the retired ones was only left out
    roots_->visit([](root_place<Env>& root) { root.end_suspicion(); });
    start(phase::idle);
    return true;
  }
  phase phase_ = phase::idle;
  bool out_of_memory_ = false;
  bool changed_ = false;
  bool unsettled_ = false;
  bool unpurged_ = false;
  bool threw_ = false;          // some edges(), in the last round
  bool purged_ = false;         // since the last round began
  bool any_blocks_ = false;     // some candidate's type has them
  bool marked_blocks_ = false;  // in this decision
  bool decided_ = false;        // so far, that all die
  runtime::decision<Env> decision_;
  candidate_list<Env> all_;
  typename candidate_list<Env>::cursor at_;  // in this phase
  candidate_type* walked_ = nullptr;
  edge_list<Env> edges_;
  std::size_t left_ = 0;              // candidates of this round that are not excluded
  candidate_type* marked_ = nullptr;  // excluded, not walked yet
  bool suspecting_ = false;
  root_list<Env>* roots_ = nullptr;
  std::chrono::nanoseconds now_{0};
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
