/// @file
/// Side blocks: what weak handles and anchors refer to.
///
/// A block is a counted object. The object that it belongs to has one reference to it, each handle another; so it
/// outlives the object as long as a handle needs it. A chain of blocks, whose records refer to each other, is destroyed
/// without recursion, as any counted objects are.
#pragma once

#include <memory>
#include <type_traits>

#include "../assert.hpp"
#include "../counter.hpp"
#include "../fwd.hpp"
#include "../intrusive_rc.hpp"
#include "../rc_object.hpp"
#include "../reclaim_at_zero.hpp"
#include "decision.hpp"
#include "header.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

template <class Env>
class counted_block
    : public rc_object<counted_block<Env>, basic_fetch_add_counter<Env>, reclaim_at_zero>,
      public runtime::side_block<Env> {
 public:
  using runtime::side_block<Env>::side_block;
};

/// The part of an object that knows its block. A copy of the object is another object.
template <class T, class Env>
class block_owner {
 public:
  using block = counted_block<Env>;

  /// Null if nobody has made a weak handle yet.
  block* slamgc_block() const noexcept {
    return block_.load(std::memory_order_acquire);  // (29) sees the block that another thread made.
  }
  /// Throws std::bad_alloc, the first time.
  block& get_or_make() const {
    if (block* const made = slamgc_block()) return *made;
    intrusive_rc<block> mine = make_rc<block>(this);
    block* found = nullptr;
    // (29) release: publishes the block; acquire: sees that of who came first.
    if (!block_.compare_exchange_strong(found, mine.get(), std::memory_order_release,
                                        std::memory_order_acquire))  // (29)
      return *found;
    return *mine.detach();
  }

 protected:
  block_owner() noexcept = default;
  explicit block_owner(intrusive_rc<block> mine) noexcept : block_(mine.detach()) {}
  ~block_owner() {
    // (29) nobody else has the object any more.
    if (block* const mine = block_.load(std::memory_order_relaxed)) {
      mine->expire();
      drop_reference(mine);
    }
  }
  block_owner(const block_owner&) = delete;
  block_owner& operator=(const block_owner&) = delete;

 private:
  mutable typename Env::template atomic<block*> block_{nullptr};
};

/// The owner in T, found as base_of() finds the base class: void if there is none, or if there are several.
template <class T, class Env>
block_owner<T, Env> owner_in(const block_owner<T, Env>*);
void owner_in(...);
template <class T>
using owner_type = decltype(detail::owner_in(static_cast<const T*>(nullptr)));
template <class T>
struct has_block : std::bool_constant<!std::is_void<owner_type<T>>::value> {};

/// The owner in *p, which has to be that of the class that derives from rc_object.
template <class Env, class T>
const block_owner<object_of<T>, Env>& owner_of(const T& p) noexcept {
  using object = object_of<T>;
  static_assert(
      std::is_same<owner_type<object>, block_owner<object, Env>>::value,
      "slamgc: the class that derives from rc_object must also derive publicly, and once, from "
      "enable_weak_rc or enable_anchor, with the environment of its counter policy");
  static_assert(
      std::is_same<Env, typename policy_of<T>::env>::value,
      "slamgc: enable_weak_rc and enable_anchor take the environment of the counter policy");
  return p;
}

/// The object with a reference of the caller's own, or null. By an online mutator.
template <class Object, class Env>
Object* lock(const runtime::side_block<Env>& block) noexcept {
  if (block.is_dead()) return nullptr;
  const auto* const owner = static_cast<const block_owner<Object, Env>*>(block.owner());
  auto* const object = const_cast<Object*>(static_cast<const Object*>(owner));
  transitions<policy_of<Object>>::increment_before_look(access::header_of(*object).state);
  if (block.survives()) return object;
  drop_reference(object);
  return nullptr;
}

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
