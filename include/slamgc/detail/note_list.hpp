/// @file
/// A queue whose memory can run out without harm.
#pragma once

#include <cstddef>
#include <new>

#include "../fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Filled by one thread, then emptied in the same order, then filled again. The first few notes fit into
/// the list itself, so that work goes on when there is no memory. Blocks are freed as they are emptied, all
/// but one.
template <class Note>
class note_list {
 public:
  note_list() noexcept { start_over(); }
  ~note_list() {
    delete kept_;
    while (near_.next != nullptr) delete unlink_first();
  }
  note_list(const note_list&) = delete;
  note_list& operator=(const note_list&) = delete;

  [[nodiscard]] bool empty() const noexcept { return taken_ == added_; }

  /// False if there is no memory: nothing has changed then.
  [[nodiscard]] bool add(const Note& note) noexcept {
    if (added_ == room_ && !grow()) return false;
    *added_++ = note;
    return true;
  }

  /// A note that take() may return a few calls later, for a prefetch; or one that was taken long ago, or null.
  const Note* soon() const noexcept { return filled_ - taken_ > 8 ? taken_ + 8 : nullptr; }

  /// Calls f(note) for each note, the oldest first.
  template <class F>
  void each(F f) const {
    const link* at = &near_;
    const Note* note = taken_;
    const Note* end = filled_;
    // Where notes are taken from is the first block that there is, near or far.
    if (in_far_block_) at = near_.next;
    for (;;) {
      if (at == last_) end = added_;
      for (; note != end; ++note) f(*note);
      if (at == last_) return;
      at = at->next;
      note = static_cast<const far_block*>(at)->notes;
      end = note + far_size;
    }
  }

  /// Takes the oldest; not of an empty list.
  Note take() noexcept {
    if (taken_ == filled_) next_block();
    const Note note = *taken_++;
    if (taken_ == added_) start_over();
    return note;
  }

 private:
  struct far_block;
  struct link {
    far_block* next = nullptr;
  };
  template <std::size_t Size>
  struct block : link {
    Note notes[Size]{};
  };
  static constexpr std::size_t near_size = 32;
  static constexpr std::size_t far_size = 1023;
  struct far_block : block<far_size> {};

  __attribute__((noinline)) bool grow() noexcept {
    far_block* const more = kept_ != nullptr ? kept_ : new (std::nothrow) far_block{};
    if (more == nullptr) return false;
    kept_ = nullptr;
    more->next = nullptr;
    last_->next = more;
    last_ = more;
    added_ = more->notes;
    room_ = more->notes + far_size;
    return true;
  }
  /// The notes that are taken now are used up, and there are others.
  __attribute__((noinline)) void next_block() noexcept {
    if (in_far_block_) free_first();
    in_far_block_ = true;
    taken_ = near_.next->notes;
    filled_ = taken_ + far_size;
  }
  void start_over() noexcept {
    while (near_.next != nullptr) free_first();
    last_ = &near_;
    taken_ = added_ = near_.notes;
    filled_ = room_ = near_.notes + near_size;
    in_far_block_ = false;
  }
  far_block* unlink_first() noexcept {
    far_block* const first = near_.next;
    near_.next = first->next;
    return first;
  }
  void free_first() noexcept {
    far_block* const first = unlink_first();
    delete kept_;
    kept_ = first;
  }

  Note* taken_;
  Note* filled_;  // the end of the block that notes are taken from
  Note* added_;
  Note* room_;  // the end of the block that notes are added to
  link* last_;
  far_block* kept_ = nullptr;
  bool in_far_block_;
  block<near_size> near_;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
