/// @file
/// Roots: where references from outside the graph are, for those who look for stale edges and for reports.
#pragma once

#include "detail/described.hpp"
#include "detail/domain_state.hpp"
#include "detail/root_list.hpp"
#include "domain.hpp"
#include "fwd.hpp"
#include "mutator.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Tells a domain of a part of the program that keeps counted references: a registry, a queue, the members of a thread.
///
/// ```
/// struct Map {
///   template <class Visitor>
///   void edges(Visitor& v) {
///     const std::lock_guard<std::mutex> lock(mMutexMap);
///     v.edge("mspKeyFrames", mspKeyFrames, slamgc::on_retire::erase);
///   }
///   std::mutex mMutexMap;
///   slamgc::rc_set<KeyFrame> mspKeyFrames;
///   slamgc::root root_{"Map", *this};  // last: ends first
/// };
/// ```
///
/// The part describes its references as an object does its edges (edges.hpp). Purges start here: what no path of described edges
/// leads to from a root is not purged of stale edges. Nothing else depends on roots: what they refer to is counted.
///
/// Thread-safety: made and ended by any thread at any time. Without an owner, edges() is called by whichever thread collects, and
/// takes the program's locks; the root's end waits for such a call, so it must not come under one of these locks. With an
/// owner, edges() is called by the owner's thread alone, at its quiescent states and when it goes offline or online, and needs no lock;
/// the root is made and ended by that thread. Made in O(roots ever at once).
template <class Env>
class basic_root {
 public:
  /// A root of @p of. @p described has `template <class V> void edges(V&)` and stays where it is; @p name
  /// stays valid, as a string literal does. Throws std::bad_alloc.
  template <class Described>
  basic_root(basic_domain<Env>& of, const char* name, Described& described)
      : state_(detail::domain_access::state_of(of)), place_(state_.collection.roots().take()) {
    put(name, described);
  }
  /// A root of the domain that is current on the calling thread: where the objects that it makes belong.
  template <class Described>
  basic_root(const char* name, Described& described)
      : state_(detail::current_domain<Env>()), place_(state_.collection.roots().take()) {
    put(name, described);
  }
  /// A root of @p owner's domain that only the owner's thread touches.
  template <class Described>
  basic_root(basic_mutator<Env>& owner, const char* name, Described& described)
      : state_(*detail::mutator_access::part_of(owner).domain),
        place_(state_.collection.roots().take()) {
    place_.join(detail::mutator_access::part_of(owner));
    put(name, described);
  }
  /// Waits while a collector is in edges().
  ~basic_root() {
    place_.leave();
    runtime::root_list<Env>::remove(place_);
    state_.release();
  }
  /// Asks the domain's collections to find, among the objects that this root refers to, those that nothing else needs:
  /// referred to by this root, by one another, and by other roots for which the same was asked, and by nobody else. They are
  /// *retired*; so a purge takes them out of the root, if its description says so, and they are reclaimed.
  ///
  /// For a registry that lists all objects of a graph: a safety net for what the program dropped and forgot to retire. (Not
  /// for one that is the only thing that keeps a map, such as ORB-SLAM3's `Map::mspKeyFrames` while no thread holds any of
  /// them.) Returns at once. It takes O(objects of the root + their edges) of collect(), in slices but for the root's own
  /// containers, and two grace periods. Objects with a pin, or in a container that no edges() describes, stay. Not for a root
  /// with an owner: it does nothing there.
  void collect_cycles() noexcept {
    if (!place_.owned) state_.collection.roots().want_suspicion(place_);
  }

  basic_root(const basic_root&) = delete;
  basic_root& operator=(const basic_root&) = delete;

 private:
  template <class Described>
  void put(const char* name, Described& described) noexcept {
    static_assert(detail::has_edges<Described>::value,
                  "slamgc: a root needs `template <class V> void edges(V& v)`");
    state_.retain();
    place_.name = name;
    place_.described = &described;
    place_.operations = &detail::operations_on<Described, Env>::table;
    place_.owned = place_.owner != nullptr;
    runtime::root_list<Env>::put(place_);
  }

  runtime::domain_state<Env>& state_;
  runtime::root_place<Env>& place_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
