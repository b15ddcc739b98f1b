/// @file
/// Registries: containers that own the life of what they hold, and the death of a whole map.
#pragma once

#include <memory>
#include <new>
#include <type_traits>
#include <utility>

#include "deferred.hpp"
#include "detail/collection.hpp"
#include "detail/counted_container.hpp"
#include "detail/domain_state.hpp"
#include "detail/edge_member.hpp"
#include "domain.hpp"
#include "fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// What a registry held when it was cleared: the collector retires and drops it, one by one.
template <class T, class Std, class Reference>
class dropped_content final : public runtime::dropped_base<typename policy_of<T>::env> {
 public:
  explicit dropped_content(Std&& content) noexcept : content_(std::move(content)) {}

  bool drop(runtime::work_limit<typename policy_of<T>::env>& limit) noexcept override {
    while (!content_.empty()) {
      T* gone;
      if constexpr (ends_with_pop_back<Std>::value) {
        gone = Reference()(content_.back());
        content_.pop_back();
      } else {
        gone = Reference()(*content_.begin());
        content_.erase(content_.begin());
      }
      slamgc::retire(gone);
      detail::drop_reference(gone);
      if (!limit.spend()) return false;
    }
    return true;
  }

 private:
  Std content_;
};

}  // namespace detail

/// A counted container that owns the life of its objects: what it holds when it is cleared or destroyed is retired.
/// `registry<rc_set<KeyFrame>>` in the place of ORB-SLAM3's `Map::mspKeyFrames` makes of `Map::clear`, which forgets a whole
/// map, the death of that map.
///
/// clear() and the destructor take O(1), whatever the size: they hand the container over to the domain, whose collectors retire
/// and drop its objects in slices. (If there is no memory for that, if moving the container could throw, or if its allocator has
/// a state, it is done at once, object by object.) Until then the references stay counted. Taking single objects out, by erase() and the like, retires
/// nothing. Not copied, assigned or moved as a whole.
///
/// Belongs to the domain that it is given, or that is current on the thread that makes it, as objects do. It has to be that of
/// its objects: what a registry of another domain held when it was cleared is reclaimed only after that domain has been collected.
/// Thread-safety and costs: otherwise those of @p Container.
template <class Container, class Env>
class registry : public Container {
 public:
  using Container::Container;
  /// Empty. Throws std::bad_alloc.
  registry() = default;
  /// Empty, of the domain @p of. Throws std::bad_alloc.
  explicit registry(basic_domain<Env>& of)
      : state_(retained(detail::domain_access::state_of(of))) {}
  registry(const registry&) = delete;
  registry& operator=(const registry&) = delete;
  /// Retires what it holds. O(1).
  ~registry() {
    clear();
    state_.release();
  }

  /// Retires what it holds, and becomes empty. O(1).
  void clear() noexcept {
    using content = typename Container::std_type;
    using to_pointer = typename detail::edge_container<Container>::reference;
    using object =
        std::remove_pointer_t<decltype(to_pointer()(*std::declval<const content&>().begin()))>;
    static_assert(detail::is_deferred<object>::value,
                  "slamgc: what a registry holds needs a deferred reclaimer");
    content& mine = detail::container_access::content_of(*this);
    if (mine.empty()) return;
    // What an allocator with a state refers to may end with the registry.
    if constexpr (std::is_nothrow_move_constructible<content>::value &&
                  std::allocator_traits<
                      typename Container::allocator_type>::is_always_equal::value) {
      using batch = detail::dropped_content<object, content, to_pointer>;
      if (auto* const dropped = new (std::nothrow) batch(std::move(mine))) {
        mine.clear();
        state_.collection.drop(*dropped);
        return;
      }
    }
    retire_all();
    Container::clear();
  }

 private:
  friend struct detail::edge_member<registry>;

  void retire_all() noexcept {
    detail::edge_container<Container>::each(*this, [](auto* p) { slamgc::retire(p); });
  }
  static runtime::domain_state<Env>& retained(runtime::domain_state<Env>& state) noexcept {
    state.retain();
    return state;
  }

  runtime::domain_state<Env>& state_ = retained(detail::current_domain<Env>());
};

/// Retires all that these registries hold: the death of a whole map. O(registries).
template <class... Registries>
void drop_map(Registries&... registries) noexcept {
  (..., registries.clear());
}

namespace detail {

template <class Container, class Env>
struct edge_member<registry<Container, Env>> : edge_member<Container> {
  /// At once: what else dies with it must not be referred to from elsewhere.
  static void sever(registry<Container, Env>& member) noexcept {
    member.retire_all();
    edge_member<Container>::sever(member);
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
