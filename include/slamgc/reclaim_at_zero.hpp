/// @file
/// The default reclaimer: an object is destroyed as soon as its count falls to zero.
#pragma once

#include <cstdint>

#include "assert.hpp"
#include "detail/header.hpp"
#include "detail/hold_back.hpp"
#include "fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// For reclaimers: uncounts a reference to @p object and returns its state word as it was before.
///
/// Wait-free under `fetch_add_counter`. Uncounting what was never counted is reported and undone.
template <class T>
state_word uncount_reference(T* object) noexcept {
  const state_word before = detail::transitions<detail::policy_of<T>>::decrement(
      detail::access::header_of(*object).state);
  SLAMGC_ASSERT(before.count() != 0,
                (detail::misuse_of(object, "removes a reference that was never counted")));
  return before;
}

/// For reclaimers: runs the destructor and returns the memory, as `delete` does.
///
/// References that are made to the object meanwhile are reported.
template <class T>
void destroy_object(T* object) noexcept {
  detail::mark_dying(object);
#if SLAMGC_DEBUG
  if (auto* const watch = detail::watch())
    if (detail::hold_back(object, *watch)) return;
#endif
  delete object;
}

namespace detail {

/// Objects of one type that the thread has yet to destroy, linked through their headers.
struct doomed_list {
  void* first;
  doomed_list* next;
  void (*destroy_first)(doomed_list&) noexcept;
};

/// What one thread has yet to destroy. Objects know nothing of their type at run time, so there is a
/// list per type.
struct doomed_record {
  doomed_list* lists;
  unsigned scopes;
};

template <class T>
struct doomed_list_of : doomed_list {};

}  // namespace detail

/// Reclaimer: destroys an object when its count falls to zero, on the thread that brought it there.
///
/// Iterative: an object whose last reference goes while another is being destroyed waits in a list
/// of the thread, so that a chain of a million objects needs no more stack than one. Destructors run
/// on the thread that drops the last reference and under the locks it holds; a collector that defers
/// is for programs that cannot have that. An object that is referred to again while it waits stays.
///
/// It is also the example of the concept. A reclaimer is a type with
/// - `release(T*)`, static and `noexcept`: a reference to the object was unlinked. Uncounts it (with
///   uncount_reference, or with a transition of its own) and decides what becomes of an object that
///   nobody refers to; that one's link word is the reclaimer's. It destroys with destroy_object.
/// - `first_link<T>()`, static: the link word of a new object. May throw.
/// - `last_link<T>(void*)`, static and `noexcept`, if wanted: the program itself deletes an object, with
///   that link word.
/// - `scope<T>`: a container keeps one while it changes; no destructor may run inside, so that none
///   meets a half-changed container.
struct reclaim_at_zero {
  /// Removes a reference; destroys the object if it was the last. Never allocates. Amortised O(1).
  template <class T>
  static void release(T* object) noexcept {
    // Not touched any more if it is queued: the thread that has it may destroy it at once.
    const state_word before = slamgc::uncount_reference(object);
    if (before.count() == 1 && !before.is_queued()) destroy_later(object);
  }

  /// New objects are linked to nothing.
  template <class T>
  static void* first_link() noexcept {
    return nullptr;
  }

  /// While a thread has one, nothing is destroyed on it; the end of the outermost one makes up for it.
  template <class T>
  class scope {
   public:
    /// Holds destruction back.
    scope() noexcept : thread_(record()) { ++thread_.scopes; }
    /// Lets it happen, if this is the outermost scope.
    ~scope() {
      if (thread_.scopes == 1)
        while (thread_.lists != nullptr) thread_.lists->destroy_first(*thread_.lists);
      --thread_.scopes;
    }
    scope(const scope&) = delete;
    scope& operator=(const scope&) = delete;

   private:
    static detail::doomed_record& record() noexcept {
      return detail::policy_of<T>::env::template thread_record<detail::doomed_record>();
    }
    detail::doomed_record& thread_;
  };

 private:
  template <class T>
  using word = detail::transitions<detail::policy_of<T>>;

  template <class T>
  static void destroy_later(T* object) noexcept {
    using env = typename detail::policy_of<T>::env;
    auto& header = detail::access::header_of(*object);
    if (!word<T>::enqueue(header.state)) return;
    const scope<T> until_listed;
    auto& list = env::template thread_record<detail::doomed_list_of<T>>();
    if (list.first == nullptr) {
      auto& thread = env::template thread_record<detail::doomed_record>();
      list.destroy_first = &destroy_first<T>;
      list.next = thread.lists;
      thread.lists = &list;
    }
    // (8) the list belongs to this thread.
    header.link.store(list.first, std::memory_order_relaxed);
    list.first = object;
  }

  template <class T>
  static void destroy_first(detail::doomed_list& list) noexcept {
    T* object = static_cast<T*>(list.first);
    auto& header = detail::access::header_of(*object);
    // (8) the list belongs to this thread.
    list.first = header.link.load(std::memory_order_relaxed);
    if (list.first == nullptr) {  // this list is the thread's first, see ~scope
      using env = typename detail::policy_of<T>::env;
      env::template thread_record<detail::doomed_record>().lists = list.next;
    }
    // A destructor that ran meanwhile may have referred to the object again.
    if (!word<T>::dequeue_if_referred_to(header.state)) slamgc::destroy_object(object);
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
