/// @file
/// Describing the edges of an object: what a collector needs to know to find cycles.
///
/// ```
/// struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
///   template <class Visitor>
///   void edges(Visitor& v) {
///     {
///       const std::lock_guard<std::mutex> lock(mMutexFeatures);
///       v.edge("mvpMapPoints", mvpMapPoints);
///     }
///     const std::lock_guard<std::mutex> lock(mMutexConnections);
///     v.edge("mpParent", mpParent);
///     for (auto& list : mvGrid) v.edge("mvGrid", list);
///   }
/// ```
///
/// One function per type names each counted member once. It takes the program's own locks, since other threads may
/// change the members meanwhile; it may be called on any thread that collects, at any time while the object exists; it
/// must not change, count or destroy anything itself, nor throw. Edges do not lead into another domain.
/// collect() must not be called under a lock that an edges() takes. A member that is left out, or named twice, makes
/// objects live on that nobody needs; it never makes one die too early.
#pragma once

#include <type_traits>
#include <utility>

#include "detail/header.hpp"
#include "fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// How the references in a counted member are read and dropped.
template <class Member>
struct edge_member {
  static_assert(
      false_for<Member>::value,
      "slamgc: an edge is an rc_slot, an atomic_rc or a counted container; an intrusive_rc is "
      "none, since moving it tells nobody, and a raw pointer is not counted");
};
template <class T, class Env>
struct edge_member<rc_slot<T, Env>> {
  template <class F>
  static void each(const rc_slot<T, Env>& member, F f) {
    if (T* const p = member.get()) f(p);
  }
  static void sever(rc_slot<T, Env>& member) noexcept { member = nullptr; }
};
template <class T, class Env>
struct edge_member<atomic_rc<T, Env>> {
  template <class F>
  static void each(const atomic_rc<T, Env>& member, F f) {
    if (T* const p = member.get()) f(p);
  }
  static void sever(atomic_rc<T, Env>& member) noexcept { member = nullptr; }
};

template <class T, class Std, class Reference, class Iterator>
class counted_container;
template <class T, class Std, class Reference, class Iterator>
Reference reference_in(const counted_container<T, Std, Reference, Iterator>&);

template <class Container>
struct edge_container {
  using reference = decltype(detail::reference_in(std::declval<const Container&>()));

  template <class F>
  static void each(const Container& member, F f) {
    for (const auto& value : member.raw())
      if (auto* const p = reference()(value)) f(p);
  }
  static void sever(Container& member) noexcept { member.clear(); }
};
template <class T, class... Options>
struct edge_member<rc_vector<T, Options...>> : edge_container<rc_vector<T, Options...>> {};
template <class T, class... Options>
struct edge_member<rc_list<T, Options...>> : edge_container<rc_list<T, Options...>> {};
template <class T, class... Options>
struct edge_member<rc_set<T, Options...>> : edge_container<rc_set<T, Options...>> {};
template <class T, class M, class... Options>
struct edge_member<rc_map<T, M, Options...>> : edge_container<rc_map<T, M, Options...>> {};
template <class K, class T, class... Options>
struct edge_member<rc_value_map<K, T, Options...>>
    : edge_container<rc_value_map<K, T, Options...>> {};
template <class T, class... Options>
struct edge_member<rc_unordered_set<T, Options...>>
    : edge_container<rc_unordered_set<T, Options...>> {};
template <class T, class M, class... Options>
struct edge_member<rc_unordered_map<T, M, Options...>>
    : edge_container<rc_unordered_map<T, M, Options...>> {};

/// A visitor that does nothing: whether a type has edges().
struct edge_probe {
  template <class Member>
  void edge(const char*, Member&) {}
};
template <class T, class = void>
struct has_edges : std::false_type {};
template <class T>
struct has_edges<T, std::void_t<decltype(std::declval<T&>().edges(std::declval<edge_probe&>()))>>
    : std::true_type {};

/// A visitor that calls f(p) for each reference.
template <class F>
struct reference_visitor {
  F f;

  template <class Member>
  void edge(const char*, Member& member) {
    edge_member<std::remove_const_t<Member>>::each(member, f);
  }
};
/// A visitor that drops all references.
struct severing_visitor {
  template <class Member>
  void edge(const char*, Member& member) {
    edge_member<Member>::sever(member);
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
