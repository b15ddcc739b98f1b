/// @file
/// What a round of trial deletion knows: candidates, and the references between them.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <new>
#include <utility>

#include "../fwd.hpp"
#include "table_base.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

template <class Env>
struct candidate;

/// The references that a round has recorded, one candidate's after the other's.
template <class Env>
class edge_list {
  struct block {
    static constexpr std::uint32_t size = 1023;
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
    std::uint32_t index_;
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

/// A retired object that is still referred to, or a suspect. Its link names this, with a mark in the lowest bit, which no
/// other value of a link has.
template <class Env>
struct candidate {
  void* object;  // null: unused
  table_base<Env>* table;
  std::uint64_t noted;
  typename edge_list<Env>::place first_edge;  // of those recorded
  candidate* next_marked;                     // also: the next unused one
  std::uint32_t edges;                        // how many
  std::uint32_t inner;                        // references from candidates
  std::uint32_t held;                         // references that the last purge saw and left
  std::uint32_t purged_version;               // when that began
  bool fresh;                                 // not in a round yet
  bool live;                                  // excluded
  bool suspect;                               // not retired: it is in this round only
  bool purged;                                // a purge has looked for its stale edges
  std::chrono::nanoseconds since;             // it became one, by the clock of collections

  static void* link_to(candidate* c) noexcept {
    return static_cast<char*>(static_cast<void*>(c)) + 1;
  }
  static candidate* of_link(void* link) noexcept {
    if ((reinterpret_cast<std::uintptr_t>(link) & 1) == 0) return nullptr;
    return static_cast<candidate*>(static_cast<void*>(static_cast<char*>(link) - 1));
  }
};

/// All candidates, in blocks: each phase goes through them in the order of memory. Blocks without candidates are freed.
template <class Env>
class candidate_list {
  struct block {
    static constexpr std::size_t size = 255;
    static constexpr std::size_t ahead = 8;
    block* next = nullptr;
    candidate<Env>* unused = nullptr;
    std::size_t used = 0;
    candidate<Env> candidates[size + ahead];  // the last ones are never used
  };

 public:
  /// Goes through the candidates.
  class cursor {
   public:
    /// The next one, or null.
    candidate<Env>* next() noexcept {
      for (; block_ != nullptr; block_ = block_->next, index_ = 0) {
        while (index_ != block::size) {
          candidate<Env>& c = block_->candidates[index_++];
          // Objects lie anywhere: their words arrive while others are worked on.
          __builtin_prefetch((&c)[block::ahead].object);
          if (c.object != nullptr) return &c;
        }
      }
      return nullptr;
    }

   private:
    friend class candidate_list;
    block* block_ = nullptr;
    std::size_t index_ = 0;
  };

  candidate_list() noexcept = default;
  ~candidate_list() {
    while (first_ != nullptr) delete std::exchange(first_, first_->next);
  }
  candidate_list(const candidate_list&) = delete;
  candidate_list& operator=(const candidate_list&) = delete;

  cursor begin() const noexcept {
    cursor c;
    c.block_ = first_;
    return c;
  }
  /// An unused one, or null if there is no memory.
  candidate<Env>* add() noexcept {
    while (room_ != nullptr && room_->unused == nullptr) room_ = room_->next;
    if (room_ == nullptr && !grow()) return nullptr;
    candidate<Env>* const c = room_->unused;
    room_->unused = c->next_marked;
    ++room_->used;
    return c;
  }
  /// Removes the one that @p at came to last.
  void remove(cursor& at) noexcept {
    candidate<Env>& c = at.block_->candidates[at.index_ - 1];
    c.object = nullptr;
    c.next_marked = at.block_->unused;
    at.block_->unused = &c;
    --at.block_->used;
  }
  /// Frees what remove() has left empty, but one block.
  void trim() noexcept {
    bool keep = true;
    for (block** at = &first_; *at != nullptr;) {
      if ((*at)->used == 0 && !std::exchange(keep, false))
        delete std::exchange(*at, (*at)->next);
      else
        at = &(*at)->next;
    }
    room_ = first_;
  }

 private:
  bool grow() noexcept {
    block* const more = new (std::nothrow) block;
    if (more == nullptr) return false;
    for (std::size_t i = 0; i != block::ahead; ++i)
      more->candidates[block::size + i].object = nullptr;
    for (std::size_t i = block::size; i-- != 0;) {
      more->candidates[i].object = nullptr;
      more->candidates[i].next_marked = more->unused;
      more->unused = &more->candidates[i];
    }
    more->next = first_;
    first_ = room_ = more;
    return true;
  }

  block* first_ = nullptr;
  block* room_ = nullptr;  // before it no block has room, or all blocks are full
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
