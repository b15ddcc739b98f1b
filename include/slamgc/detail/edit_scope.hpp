/// @file
/// Editing the plain container inside a counted one.
#pragma once

#include <cstddef>
#include <memory>  // std::allocator_traits; every container brings it along
#include <vector>

#include "header.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Holds destruction back while a container of T changes; see reclaim_at_zero::scope.
template <class T>
using counted_scope = typename reclaimer_of<T>::template scope<object_of<T>>;

/// The edit scopes that a thread has open; kept in the checked flavour only.
struct open_edit {
  const void* container;
  open_edit* outer;
};
struct edit_record {
  open_edit* innermost;
};

/// Hands out the plain container and counts, at its end, what was changed.
///
/// What was put in is counted at the end only: it must be kept by something else until then (under a
/// deferred collector: the thread passes no quiescent state). What was taken out stays counted until
/// then. One scope per container at a time, and no other change of it meanwhile; a second scope is
/// reported in the checked flavour, and leaves the counting to the first.
template <class T, class Std, class Reference>
class edit_scope {
 public:
  /// Notes what the container refers to, in memory of its allocator. Throws what the allocation
  /// throws, and nothing has changed.
  explicit edit_scope(Std& content)
      : content_(content), before_(content.get_allocator()), scope_{&content, nullptr} {
    before_.reserve(content.size());
    for (const auto& value : content) before_.push_back(Reference()(value));
    check_in();
  }
  /// Counts what came, uncounts what went: O(size) comparisons, and two counts per change. Neither
  /// allocates nor throws.
  ~edit_scope() {
    if (!check_out()) return;
    // Pair the references then and now by position: where a pair is equal nothing is to be done, and
    // any other pairing would give the same counts.
    std::size_t i = 0;
    for (const auto& value : content_) {
      T* const now = Reference()(value);
      if (i >= before_.size() || before_[i] != now) detail::add_reference(now);
      ++i;
    }
    i = 0;
    for (const auto& value : content_) {
      if (i == before_.size()) break;
      T* const now = Reference()(value);
      if (before_[i] == now) before_[i] = nullptr;
      ++i;
    }
    for (T* p : before_) detail::drop_reference(p);
  }
  edit_scope(const edit_scope&) = delete;
  edit_scope& operator=(const edit_scope&) = delete;

  /// The plain container, valid until the scope ends.
  [[nodiscard]] Std& get() const& noexcept { return content_; }
  /// Refused: a reference that is kept would outlive the scope. Name the scope.
  Std& get() const&& = delete;
  /// The plain container, valid until the scope ends.
  [[nodiscard]] operator Std&() const noexcept { return content_; }
  /// The plain container, valid until the scope ends.
  [[nodiscard]] Std& operator*() const& noexcept { return content_; }
  /// Refused: a reference that is kept would outlive the scope. Name the scope.
  Std& operator*() const&& = delete;
  /// The plain container, valid until the scope ends.
  [[nodiscard]] Std* operator->() const noexcept { return &content_; }

 private:
#if SLAMGC_DEBUG
  static edit_record& open() noexcept {
    return policy_of<T>::env::template thread_record<edit_record>();
  }
  void check_in() noexcept {
    for (const open_edit* e = open().innermost; e != nullptr; e = e->outer) {
      if (e->container != &content_) continue;
      scope_.container = nullptr;
      SLAMGC_ASSERT(false, (misuse{"edits a container that is being edited", type_name<T>::get(),
                                   &content_, 0}));
    }
    scope_.outer = open().innermost;
    open().innermost = &scope_;
  }
  /// Returns whether this scope has to count.
  bool check_out() noexcept {
    open_edit** link = &open().innermost;
    while (*link != &scope_ && *link != nullptr) link = &(*link)->outer;
    if (*link != nullptr) *link = scope_.outer;
    return scope_.container != nullptr;
  }
#else
  static void check_in() noexcept {}
  static bool check_out() noexcept { return true; }
#endif

  // First, so that it ends last. Nothing is destroyed on this thread while it edits: what one scope
  // takes out, another may put in.
  const counted_scope<T> until_final_;
  Std& content_;
  std::vector<
      T*, typename std::allocator_traits<typename Std::allocator_type>::template rebind_alloc<T*>>
      before_;
  open_edit scope_;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
