/// @file
/// What a round of trial deletion knows: candidates, and the references between them.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <new>

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

/// A retired object that is still referred to, or a suspect. Its link names this, with a mark in the lowest bit, which no
/// other value of a link has.
template <class Env>
struct candidate {
  void* object;
  table_base<Env>* table;
  std::uint64_t noted;
  std::uint32_t inner;           // references from candidates
  bool fresh;                    // not in a round yet
  bool live;                     // excluded
  bool suspect;                  // not retired: it is in this round only
  bool purged;                   // a purge has looked for its stale edges
  std::uint32_t purged_version;  // when that began
  std::uint32_t held;            // references that it saw and left
  candidate* next;
  candidate* next_marked;
  typename edge_list<Env>::place first_edge;
  std::size_t edges;
  std::chrono::nanoseconds since;  // it became one, by the clock of collections

  static void* link_to(candidate* c) noexcept {
    return static_cast<char*>(static_cast<void*>(c)) + 1;
  }
  static candidate* of_link(void* link) noexcept {
    if ((reinterpret_cast<std::uintptr_t>(link) & 1) == 0) return nullptr;
    return static_cast<candidate*>(static_cast<void*>(static_cast<char*>(link) - 1));
  }
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
