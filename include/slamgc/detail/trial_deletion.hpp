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

#include <cstddef>
#include <cstdint>
#include <new>

#include "../counter.hpp"
#include "../env.hpp"
#include "../fwd.hpp"
#include "decision.hpp"
#include "table_base.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

template <class Env>
struct candidate;

/// The references that a round has recorded, one candidate's after the other's.
template <class Env>
class edge_list {
  struct block {
    static constexpr std::size_t size = 1023;
    block* next = nullptr;
    candidate<Env>* targets[size];
  };

 public:
  /// Of a reference, or the end.
  class place {
   public:
    candidate<Env>* next() noexcept {
      if (index_ == block::size) {
        block_ = block_->next;
        index_ = 0;
      }
      return block_->targets[index_++];
    }

   private:
    friend class edge_list;
    block* block_;
    std::size_t index_;
  };

  edge_list() noexcept { clear(); }
  ~edge_list() {
    clear();
    delete first_.next;
  }
  edge_list(const edge_list&) = delete;
  edge_list& operator=(const edge_list&) = delete;

  place end() const noexcept { return end_; }
  /// False if there is no memory.
  bool add(candidate<Env>& target) noexcept {
    if (end_.index_ == block::size) {
      if (end_.block_->next == nullptr) end_.block_->next = new (std::nothrow) block;
      if (end_.block_->next == nullptr) return false;
      end_.block_ = end_.block_->next;
      end_.index_ = 0;
    }
    end_.block_->targets[end_.index_++] = &target;
    return true;
  }
  /// Keeps the memory of one block.
  void clear() noexcept {
    if (block* const kept = first_.next) {
      while (block* const more = kept->next) {
        kept->next = more->next;
        delete more;
      }
    }
    end_.block_ = &first_;
    end_.index_ = block::size;  // the first one holds nothing
  }

 private:
  block first_;
  place end_;
};

/// A retired object that is still referred to. Its link names this, with a mark in the lowest bit, which no
/// other value of a link has.
template <class Env>
struct candidate {
  void* object;
  table_base<Env>* table;
  std::uint64_t noted;
  std::uint32_t inner;  // references from candidates
  bool fresh;           // not in a round yet
  bool live;            // excluded
  candidate* next;
  candidate* next_marked;
  typename edge_list<Env>::place first_edge;
  std::size_t edges;

  static void* link_to(candidate* c) noexcept {
    return static_cast<char*>(static_cast<void*>(c)) + 1;
  }
  static candidate* of_link(void* link) noexcept {
    if ((reinterpret_cast<std::uintptr_t>(link) & 1) == 0) return nullptr;
    return static_cast<candidate*>(static_cast<void*>(static_cast<char*>(link) - 1));
  }
};

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
    *c = {object, &table, 0, 0, true, true, first_, nullptr, edges_.end(), 0};
    first_ = c;
    any_blocks_ = any_blocks_ || table.has_blocks;
    return c;
  }
  /// Steps 1 to 3, before the grace period. False if the limit came first.
  bool find(limit_type& limit) noexcept {
    if (phase_ == phase::expired) start(phase::severing);  // after the grace period that follows
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
      // stored it yet will have done so after a grace period: so one more round after the last change.
      const bool worth_it = changed_ || unsettled_;
      unsettled_ = changed_;
      start(worth_it ? phase::recording : phase::idle);
    }
    if (phase_ == phase::recording) {
      while (candidate_type* const c = next()) {
        walked_ = c;
        c->first_edge = edges_.end();
        c->edges = 0;
        if (!c->fresh) c->table->walk(c->object, *this);
        if (out_of_memory_) return give_up();
        if (!limit.spend()) return false;
      }
      start(phase::excluding);
    }
    if (phase_ == phase::excluding) {
      while (exclude_marked(limit)) {
        candidate_type* const c = next();
        if (c == nullptr) {
          start(any_left() ? phase::checking : phase::idle);
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

  runtime::decision<Env>& decision() noexcept { return decision_; }

  /// Steps 4 to 6, after the grace period. False if the limit came first.
  bool decide(limit_type& limit, std::size_t& reclaimed) noexcept {
    if (phase_ == phase::checking) {
      for (;;) {
        if (!exclude_marked(limit)) return false;
        candidate_type* const c = next();
        if (c == nullptr) break;
        if (c->live) continue;
        if (!same_references(c->table->word_of(c->object), c->noted)) {
          disturbed(*c);
          mark(*c);
        }
        if (!limit.spend()) return false;
      }
      if (any_blocks_) decision_.open();
      decided_ = true;
      marked_blocks_ = false;
      start(any_blocks_ ? phase::deciding : phase::severing);
    }
    if (!expire_blocks(limit)) return false;
    if (phase_ == phase::expired) return true;
    if (phase_ == phase::severing) {
      while (candidate_type* const c = next()) {
        if (c->live) continue;
        c->table->sever(c->object);
        if (!limit.spend()) return false;
      }
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

  /// For walks: the candidate that is walked refers to this one.
  void record(candidate_type& target) noexcept {
    if (out_of_memory_ || !edges_.add(target)) {
      out_of_memory_ = true;
      return;
    }
    ++walked_->edges;
    ++target.inner;
  }

 private:
  enum class phase {
    idle,
    beginning,
    recording,
    excluding,
    checking,
    deciding,
    unmarking,
    expiring,
    expired,
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
  bool any_left() const noexcept {
    const candidate_type* c = first_;
    while (c != nullptr && c->live) c = c->next;
    return c != nullptr;
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
  /// Step 5: one decision for all that is left. False if the limit came first.
  bool expire_blocks(limit_type& limit) noexcept {
    if (phase_ == phase::deciding) {
      while (candidate_type* const c = decided_ ? next() : nullptr) {
        side_block<Env>* const block = block_of(*c);
        if (block != nullptr) {
          marked_blocks_ = true;
          block->mark(decision_);
          decided_ = c->table->seal(c->object, c->noted);
          if (decided_) block->bury();
        }
        if (!limit.spend()) return false;
      }
      decided_ = decided_ && (!marked_blocks_ || decision_.commit());
      start(!marked_blocks_ ? phase::severing : decided_ ? phase::expiring : phase::unmarking);
    }
    if (phase_ == phase::expiring || phase_ == phase::unmarking) {
      while (candidate_type* const c = next()) {
        side_block<Env>* const block = block_of(*c);
        if (block != nullptr && block->is_marked()) {
          if (phase_ == phase::expiring) {
            block->expire();
          } else {
            block->unmark();
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
    side_block<Env>* const block = c.table->block_of(c.object);
    return block != nullptr && !block->is_dead() ? block : nullptr;
  }
  static void disturbed(candidate_type& c) noexcept {
    if (!state_word{c.noted}.is_retired())
      return;  // only what is retired may expire while it is referred to
    if (side_block<Env>* const block = block_of(c)) block->disturbed();
  }
  /// Without memory this round finds nothing; another one will.
  bool give_up() noexcept {
    out_of_memory_ = false;
    unsettled_ = true;
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
  bool any_blocks_ = false;     // some candidate's type has them
  bool marked_blocks_ = false;  // in this decision
  bool decided_ = false;        // so far, that all die
  runtime::decision<Env> decision_;
  candidate_type* first_ = nullptr;
  candidate_type* walked_ = nullptr;
  edge_list<Env> edges_;
  candidate_type* at_ = nullptr;      // the next one in this phase
  candidate_type* marked_ = nullptr;  // excluded, not walked yet
  candidate_type* rest_ = nullptr;    // not destroyed or put back yet
  candidate_type* free_ = nullptr;
  block* blocks_ = nullptr;
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
