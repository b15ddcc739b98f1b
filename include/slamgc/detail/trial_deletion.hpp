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
/// 5. *severs* what is left, and destroys it.
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

#include <cstddef>
#include <cstdint>
#include <new>

#include "../counter.hpp"
#include "../env.hpp"
#include "../fwd.hpp"
#include "candidate.hpp"
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
  ~trial_deletion() {
    while (blocks_ != nullptr) {
      block* const next = blocks_->next;
      delete blocks_;
      blocks_ = next;
    }
  }
  trial_deletion(const trial_deletion&) = delete;
  trial_deletion& operator=(const trial_deletion&) = delete;

  /// The new candidate, or null if there is no memory.
  candidate_type* add(void* object, table_base<Env>& table) noexcept {
    if (free_ == nullptr && !grow()) return nullptr;
    candidate_type* const c = free_;
    free_ = c->next;
    *c = {object, &table, 0, 0,      true,    true,         suspecting_,
          false,  0,      0, first_, nullptr, edges_.end(), 0};
    first_ = c;
    return c;
  }
  /// Steps 1 to 3, before the grace period. False if the limit came first.
  bool find(limit_type& limit) noexcept {
    if (phase_ == phase::idle) {
      changed_ = false;
      start(phase::beginning);
    }
    if (phase_ == phase::beginning) {
      while (candidate_type* const c = next()) {
        const std::uint64_t now = c->table->word_of(c->object);
        changed_ = changed_ || !same_references(now, c->noted);  // a new one was noted as 0
        c->noted = now;
        c->inner = 0;
        c->fresh = c->live = false;
        if (!limit.spend()) return false;
      }
      // Only what changes the word of a candidate can make one unreachable. Who had counted a reference and not
      // stored it yet will have done so after a grace period: so one more round after the last change. A round with suspects
      // comes to its end, even if no root has any: else the suspicion would last.
      const bool worth_it = changed_ || unsettled_ || suspecting_;
      unsettled_ = changed_;
      start(worth_it ? phase::recording : phase::idle);
    }
    if (phase_ == phase::recording) {
      while (candidate_type* const c = next()) {
        walked_ = c;
        c->first_edge = edges_.end();
        c->edges = 0;
        if (!c->fresh && !c->table->walk(c->object, *this)) mark(*c);
        if (out_of_memory_) return give_up();
        if (!limit.spend()) return false;
      }
      if (suspecting_) {
        walked_ = nullptr;
        roots_->visit([this](const root_place<Env>& root) {
          if (root.is_suspected()) root.operations->record(root.described, *this);
        });
      }
      start(phase::excluding);
    }
    if (phase_ == phase::excluding) {
      while (exclude_marked(limit)) {
        candidate_type* const c = next();
        if (c == nullptr) {
          const bool any_left = survey();
          start(any_left ? phase::checking : suspecting_ ? phase::resolving : phase::idle);
          return true;
        }
        if (c->inner != state_word{c->noted}.count()) mark(*c);
      }
      return false;
    }
    return true;
  }
  /// Whether find() has left something for decide().
  bool found() const noexcept { return phase_ >= phase::checking; }
  /// Whether find() has to be called again after a grace period.
  bool unsettled() const noexcept { return unsettled_; }

  /// Steps 4 and 5, after the grace period. False if the limit came first.
  bool decide(limit_type& limit, std::size_t& reclaimed) noexcept {
    if (phase_ == phase::checking) {
      for (;;) {
        if (!exclude_marked(limit)) return false;
        candidate_type* const c = next();
        if (c == nullptr) break;
        if (c->live) continue;
        if (!same_references(c->table->word_of(c->object), c->noted)) mark(*c);
        if (!limit.spend()) return false;
      }
      start(suspecting_ ? phase::resolving : phase::severing);
    }
    if (phase_ == phase::resolving && !resolve(limit)) return false;
    if (phase_ == phase::severing) {
      while (candidate_type* const c = next()) {
        if (c->live) continue;
        if (!c->table->sever(c->object)) mark(*c);
        if (!limit.spend()) return false;
      }
      // What could not be severed stays, with what it refers to.
      if (!exclude_marked(limit)) return false;
      rest_ = first_;
      first_ = nullptr;
      phase_ = phase::destroying;
    }
    if (phase_ == phase::destroying) {
      while (candidate_type* const c = rest_) {
        rest_ = c->next;
        if (c->live) {
          c->next = first_;
          first_ = c;
          continue;
        }
        c->table->destroy(c->object);
        ++reclaimed;
        c->next = free_;
        free_ = c;
        if (!limit.spend()) return false;
      }
      phase_ = phase::idle;
    }
    return true;
  }

  /// Whether a candidate is referred to from elsewhere in a way that no purge has seen yet.
  bool unpurged() const noexcept { return unpurged_; }
  /// Calls f(candidate) for each candidate, before a purge. Another round will see what it changes, a grace period later.
  template <class F>
  void begin_purge(F f) noexcept {
    unpurged_ = false;
    unsettled_ = true;
    for (candidate_type* c = first_; c != nullptr; c = c->next) {
      c->purged = !c->fresh;  // of a fresh one nobody knows how many references are to be explained
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
    severing,
    destroying
  };
  struct block {
    static constexpr std::size_t size = 255;
    block* next;
    candidate_type candidates[size];
  };

  static bool same_references(std::uint64_t a, std::uint64_t b) noexcept {
    return state_word{a}.same_references({b});
  }
  void start(phase p) noexcept {
    phase_ = p;
    at_ = first_;
    if (p == phase::recording) edges_.clear();
  }
  candidate_type* next() noexcept {
    candidate_type* const c = at_;
    if (c != nullptr) at_ = c->next;
    return c;
  }
  /// Whether any is left; and whether one that is not gives reason for a purge.
  bool survey() noexcept {
    bool any_left = false;
    for (const candidate_type* c = first_; c != nullptr; c = c->next) {
      if (!c->live)
        any_left = true;
      else if (!c->fresh && (!c->purged || c->purged_version != state_word{c->noted}.version()))
        unpurged_ = true;
    }
    return any_left;
  }
  void mark(candidate_type& c) noexcept {
    if (c.live) return;
    c.live = true;
    c.next_marked = marked_;
    marked_ = &c;
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
  /// Without memory this round finds nothing; another one will.
  bool give_up() noexcept {
    marked_ = nullptr;
    out_of_memory_ = false;
    unsettled_ = true;
    for (candidate_type* c = first_; c != nullptr; c = c->next) c->live = true;
    start(suspecting_ ? phase::resolving : phase::idle);
    return true;
  }
  /// The end of a round with suspects: what was found is retired, the rest leaves.
  bool resolve(limit_type& limit) noexcept {
    if (resolved_ == nullptr) resolved_ = &first_;
    while (candidate_type* const c = *resolved_) {
      if (c->suspect && (!c->live || state_word{c->table->word_of(c->object)}.is_retired())) {
        c->table->condemn(c->object);
        c->suspect = false;
        c->fresh = true;
        unsettled_ = true;
      }
      if (c->suspect) {
        *resolved_ = c->next;
        c->table->leave(c->object);
        c->next = free_;
        free_ = c;
      } else {
        // Retired and found, but not in a round that destroys: in the next one.
        unsettled_ = unsettled_ || !c->live;
        c->inner = 0;  // counts references of roots, too, which explain nothing to a purge
        resolved_ = &c->next;
      }
      if (!limit.spend()) return false;
    }
    resolved_ = nullptr;
    suspecting_ = false;
    roots_->visit([](root_place<Env>& root) { root.end_suspicion(); });
    start(phase::idle);
    return true;
  }
  bool grow() noexcept {
    block* const more = new (std::nothrow) block;
    if (more == nullptr) return false;
    more->next = blocks_;
    blocks_ = more;
    for (candidate_type& c : more->candidates) {
      c.next = free_;
      free_ = &c;
    }
    return true;
  }

  phase phase_ = phase::idle;
  bool out_of_memory_ = false;
  bool changed_ = false;
  bool unsettled_ = false;
  bool unpurged_ = false;
  candidate_type* first_ = nullptr;
  candidate_type* walked_ = nullptr;
  edge_list<Env> edges_;
  candidate_type* at_ = nullptr;      // the next one in this phase
  candidate_type* marked_ = nullptr;  // excluded, not walked yet
  bool suspecting_ = false;
  root_list<Env>* roots_ = nullptr;
  candidate_type** resolved_ = nullptr;  // up to here
  candidate_type* rest_ = nullptr;       // not destroyed or put back yet
  candidate_type* free_ = nullptr;
  block* blocks_ = nullptr;
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
