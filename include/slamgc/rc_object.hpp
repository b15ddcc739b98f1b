/// @file
/// The base class of every counted object.
#pragma once

#include <cstdint>
#include <type_traits>

#include "assert.hpp"
#include "counter.hpp"
#include "detail/header.hpp"
#include "fwd.hpp"
#include "reclaim_at_zero.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Base class of counted objects: `class KeyFrame : public slamgc::rc_object<KeyFrame>`.
///
/// Adds a header of 16 bytes (56 with `mutex_counter`): the state word and a link by which a
/// collector queues the object without allocating. It adds no virtual function, no operator new or
/// delete, and asks for no more than the alignment of a pointer. A copy of an object is a new object
/// with a count of zero; assignment leaves both counts alone.
///
/// An object made by plain `new` has a count of zero and is nobody's: it belongs to the program
/// until its first reference is stored.
///
/// @tparam T         The class that derives from this one. It is deleted as a `T`, so classes
///                   derived from `T` need a virtual destructor there.
/// @tparam Policy    How the count is changed; see basic_fetch_add_counter for the concept.
/// @tparam Reclaimer What happens when the count falls to zero; see reclaim_at_zero
///                   for the concept.
///
/// Thread-safety: counts may be changed by any thread at any time, except under `unsync_counter`.
template <class T, class Policy, class Reclaimer>
class rc_object {
  static_assert(detail::has_storage<Policy>::value,
                "slamgc: the counter policy needs the types `env` and `storage` (default "
                "constructible); see basic_fetch_add_counter in slamgc/counter.hpp");
  static_assert(
      !detail::has_storage<Policy>::value || detail::has_word_operations<Policy>::value,
      "slamgc: the counter policy needs load, add, subtract (returning std::uint64_t) and "
      "compare_exchange (returning bool); see basic_fetch_add_counter in "
      "slamgc/counter.hpp");

 public:
  /// References to this object that are counted now; more than 2^29 mean that the count overflowed.
  ///
  /// When it returns 1 to the holder of that one reference, everything that was done under the other
  /// references happened before: the object may be changed without a lock.
  [[nodiscard]] std::uint32_t use_count() const noexcept { return state().count(); }

  /// A snapshot of the state word.
  [[nodiscard]] state_word state() const noexcept {
    return detail::transitions<Policy>::load(header_.state);
  }

  /// For `boost::intrusive_ptr<T>`, which can hold these objects too: adds a reference.
  friend void intrusive_ptr_add_ref(const T* p) noexcept { detail::add_reference(p); }
  /// For `boost::intrusive_ptr<T>`, which can hold these objects too: removes a reference.
  friend void intrusive_ptr_release(const T* p) noexcept { detail::drop_reference(p); }

 protected:
  /// Starts with a count of zero.
  rc_object() noexcept(noexcept(Reclaimer::template first_link<T>())) {
    // (8) nobody else knows the object yet.
    header_.link.store(Reclaimer::template first_link<T>(), std::memory_order_relaxed);
  }
  /// A copy is a new object: it starts with a count of zero.
  rc_object(const rc_object&) noexcept(noexcept(rc_object())) : rc_object() {}
  /// References belong to the object, not to its value: nothing changes.
  rc_object& operator=(const rc_object&) noexcept { return *this; }
  /// Checks that nobody refers to the object.
  ~rc_object() {
    SLAMGC_ASSERT(use_count() == 0, (misuse{"destroys an object that is still referred to",
                                            detail::type_name<T>::get(), this, use_count()}));
    if constexpr (detail::has_last_link<Reclaimer, T>::value) {
      void* const link = header_.link.load(std::memory_order_relaxed);  // (8)
      if (link == &header_) return;
      SLAMGC_ASSERT(!state().is_queued(), (misuse{"deletes an object that a collector holds",
                                                  detail::type_name<T>::get(), this, 0}));
      if (!state().is_queued()) Reclaimer::template last_link<T>(link);
    }
  }

 private:
  friend struct detail::access;
  mutable detail::header<Policy> header_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
