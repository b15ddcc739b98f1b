/// @file
/// Handles that keep a small record of their object when it is gone.
#pragma once

#include <cstddef>
#include <optional>
#include <type_traits>
#include <utility>

#include "assert.hpp"
#include "deferred.hpp"
#include "detail/participant.hpp"
#include "detail/side_block.hpp"
#include "fwd.hpp"
#include "intrusive_rc.hpp"
#include "rc_slot.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// A side block with room for the record. Does not depend on T until an object is buried.
template <class T, class Record, class Env>
class record_block final : public counted_block<Env> {
 public:
  using counted_block<Env>::counted_block;

  void bury() noexcept override {
    const auto* const owner = static_cast<const block_owner<T, Env>*>(this->owner());
    bury(const_cast<T&>(static_cast<const T&>(*owner)));
  }
  void bury(T& object) noexcept {
    record_.reset();  // of an earlier decision, which was vetoed
    record_.emplace(object.record());
  }
  /// Of a dead block.
  const Record& record() const noexcept { return *record_; }
  /// Of an object that nobody buried.
  void lose_record() noexcept { record_.emplace(); }

 private:
  std::optional<Record> record_;
};

}  // namespace detail

/// Base class of objects that leave a record, beside rc_object:
///
/// ```
/// class KeyFrame : public slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
///                  public slamgc::enable_anchor<KeyFrame, PoseRecord> {
///  public:
///   PoseRecord record() { return {mnId, mTcp, slamgc::anchor<KeyFrame, PoseRecord>(mpParent)}; }
/// ```
///
/// `record()` is called by a collector when nobody can see the object any more but by handles, before it and what dies with it loses an
/// edge; more than once, if somebody locks the object at the last moment. That thread may use the object at the same time, and so may
/// others if it expires while it is referred to (weak_rc): record() takes the program's locks of what they may change, as
/// edges() does. It must not throw, and should be quick. Weak handles to these objects work, too.
///
/// Adds one pointer; each object has a side block with room for the record, which is allocated with it, so that its end needs
/// no memory. A copy of an object has a block of its own; assignment leaves it alone.
///
/// A program that itself deletes an object to which there are anchors says bury() first, in the class's destructor at the
/// latest, and that no thread uses it then. If it does not, that is reported, and the record is `Record()`.
///
/// @tparam T      The class that derives from rc_object, with reclaim_deferred or reclaim_retired.
/// @tparam Record What `T::record()` returns; default constructible and movable. It may hold anchors, to a parent or a
///                predecessor, but not in a circle: records are counted, and nobody looks for cycles among them.
/// @tparam Env    The environment of T's counter policy.
template <class T, class Record, class Env>
class enable_anchor : public detail::block_owner<T, Env> {
 protected:
  /// Allocates the block. Throws std::bad_alloc.
  enable_anchor() : detail::block_owner<T, Env>(make_block()) {
    static_assert(detail::is_deferred<T>::value,
                  "slamgc: anchors need a deferred reclaimer: another thread could destroy the "
                  "object before it is read");
  }
  /// A copy is a new object.
  enable_anchor(const enable_anchor&) : enable_anchor() {}
  /// Anchors refer to the object, not to its value: nothing changes.
  enable_anchor& operator=(const enable_anchor&) noexcept { return *this; }
  /// Reports if anchors are left and there is no record.
  ~enable_anchor() {
    block& mine = my_block();
    if (mine.is_dead()) return;
    SLAMGC_ASSERT(mine.use_count() == 1,
                  (misuse{"deletes an object that anchors refer to, without bury()",
                          detail::type_name<T>::get(), this, mine.use_count() - 1}));
    mine.lose_record();
  }

  /// For an object that the program itself deletes: makes its record now, and lets its handles expire. Nothing
  /// happens if it has one already.
  void bury() noexcept {
    block& mine = my_block();
    if (mine.is_dead()) return;
    mine.bury(static_cast<T&>(*this));
    mine.expire();
  }

 private:
  using block = detail::record_block<T, Record, Env>;
  friend class anchor<T, Record, Env>;

  intrusive_rc<detail::counted_block<Env>> make_block() const {
    return intrusive_rc<detail::counted_block<Env>>(
        new block(static_cast<const detail::block_owner<T, Env>*>(this)));
  }
  block& my_block() const noexcept { return static_cast<block&>(*this->slamgc_block()); }
};

/// Refers to an object without keeping it, and to the record that it leaves when it is reclaimed.
///
/// Whoever reads it gets one of the two. The records of objects that die together are all there before one of them loses
/// an edge, and records may hold anchors themselves: a chain of them keeps each hop, in whatever order the objects go.
/// `sizeof(anchor<T, Record>) == sizeof(T*)`. For expiry see weak_rc.
///
/// Thread-safety: as `std::shared_ptr`: different anchors by any threads at any time; one that somebody changes needs the
/// program's lock. A record does not change. All operations are lock-free and O(1).
template <class T, class Record, class Env>
class anchor {
 public:
  using element_type = T;      ///< What it refers to.
  using record_type = Record;  ///< What is left of it.

  /// Null: refers to nothing.
  constexpr anchor() noexcept = default;
  /// Null: refers to nothing.
  constexpr anchor(std::nullptr_t) noexcept {}
  /// Refers to @p p. By an online mutator of the object's domain, or who holds a counted reference.
  explicit anchor(T* p) noexcept
      : block_(p != nullptr ? detail::owner_of<Env>(*p).slamgc_block() : nullptr) {
    static_assert(
        std::is_base_of<enable_anchor<T, Record, Env>, T>::value,
        "slamgc: an anchor<T, Record> refers to a T that derives from enable_anchor<T, Record>");
  }
  /// Refers to the same object.
  anchor(const intrusive_rc<T>& p) noexcept : anchor(p.get()) {}
  /// Refers to the same object.
  anchor(const rc_slot<T, Env>& p) noexcept : anchor(p.get()) {}

  /// Whether it refers to an object or a record.
  [[nodiscard]] explicit operator bool() const noexcept { return block_ != nullptr; }

  /// Calls `on_object(T&)`, and keeps the object meanwhile; or `on_record(const Record&)`, if the object has expired.
  /// Returns what they return. On an online mutator of the object's domain. Not of a null anchor.
  template <class OnObject, class OnRecord>
  std::common_type_t<std::invoke_result_t<OnObject, T&>,
                     std::invoke_result_t<OnRecord, const Record&>>
  read(OnObject&& on_object, OnRecord&& on_record) const {
    SLAMGC_ASSERT(block_ != nullptr,
                  (misuse{"reads a null anchor", detail::type_name<T>::get(), nullptr, 0}));
    if (const intrusive_rc<T> object = lock()) return std::forward<OnObject>(on_object)(*object);
    return std::forward<OnRecord>(on_record)(my_block().record());
  }
  /// A reference to the object, or null if it has expired. On an online mutator of the object's domain.
  [[nodiscard]] intrusive_rc<T> lock() const noexcept {
    SLAMGC_ASSERT(block_ == nullptr || runtime::participants<Env>::borrower() != nullptr,
                  (misuse{"reads an anchor on a thread that is no online mutator",
                          detail::type_name<T>::get(), block_.get(), 0}));
    if (block_ == nullptr) return nullptr;
    return intrusive_rc<T>(detail::lock<T>(*block_), false);
  }
  /// The record, or null while the object has not expired. Valid as long as an anchor to it exists. By any thread.
  [[nodiscard]] const Record* record() const noexcept {
    return block_ != nullptr && block_->is_dead() ? &my_block().record() : nullptr;
  }

  /// Becomes null.
  void reset() noexcept { block_.reset(); }
  /// Exchanges two anchors.
  void swap(anchor& other) noexcept { block_.swap(other.block_); }

  /// Whether both refer to the same object, dead or alive, or both are null.
  [[nodiscard]] friend bool operator==(const anchor& a, const anchor& b) noexcept {
    return a.block_ == b.block_;
  }
  /// Whether they refer to different objects.
  [[nodiscard]] friend bool operator!=(const anchor& a, const anchor& b) noexcept {
    return a.block_ != b.block_;
  }

 private:
  const detail::record_block<T, Record, Env>& my_block() const noexcept {
    return static_cast<const detail::record_block<T, Record, Env>&>(*block_);
  }

  intrusive_rc<detail::counted_block<Env>> block_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
