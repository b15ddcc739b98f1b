/// @file
/// What becomes of an edge when its target is retired.
///
/// ```
/// v.edge("mpParent", mpParent);                                        // hold: nothing
/// v.edge("mvpMapPoints", mvpMapPoints, slamgc::on_retire::null);       // the element becomes null
/// v.edge("mObservations", mObservations, slamgc::on_retire::erase);    // the key or element goes
/// v.edge("mvpOrderedConnectedKeyFrames", mvpOrderedConnectedKeyFrames, // so do those that belong to it
///        slamgc::on_retire::erase_with(mvOrderedWeights));
/// v.edge("mNextKF", mNextKF, slamgc::on_retire::bypass([](KeyFrame& retired) {
///          return retired.mNextKF.get();                               // the slot refers to this instead
///        }));
/// v.edge("mObservations", mObservations,                              // somebody is told before
///        slamgc::on_retire::announce(tell, slamgc::on_retire::erase));
/// ```
///
/// An edge of a live object to a retired one is *stale*: the program has declared the target dead and left a
/// reference to it behind. A purge (detail/purge.hpp) finds stale edges and does with each what its description says.
#pragma once

#include <tuple>
#include <utility>

namespace slamgc {
namespace on_retire {

/// Nothing: whoever described the edge needs the object, retired or not. The default.
struct hold_edge {};
inline constexpr hold_edge hold{};  ///< See hold_edge.

/// The slot, the element of an rc_vector or the value of an rc_value_map becomes null.
struct null_edge {};
inline constexpr null_edge null{};  ///< See null_edge.

/// The key or element is erased from its container.
struct erase_edge {};
inline constexpr erase_edge erase{};  ///< See erase_edge.

/// As erase_edge, from an rc_vector or rc_list; and so is what stands at the same place in each companion. See
/// erase_with().
template <class... Companions>
struct erase_edge_with {
  std::tuple<Companions&...> companions;  ///< What loses the same elements.
};
/// The element is erased from its rc_vector or rc_list, and with it what stands at the same place in each of
/// @p companions: sequences of the same length, under the same lock. Of another length: nothing happens, and the checked
/// flavour reports it.
template <class... Companions>
erase_edge_with<Companions...> erase_with(Companions&... companions) noexcept {
  return {std::tuple<Companions&...>(companions...)};
}

/// See bypass().
template <class Next>
struct bypass_edge {
  Next next;  ///< What comes after a retired object.
};
/// The slot or element refers to what @p next(retired) returns instead, which may be null; and if that is retired too,
/// to what comes next (in a retired object that is still referred to: at most 64 of them, then null). For chains, whose
/// retired members are to be stepped over. @p next is called with the locks of edges() held; it may do what belongs to it,
/// such as adding the retired keyframe's measurements to those of its neighbour, but must not throw. (Another thread may
/// assign the slot at the same time: then it was called in vain.)
template <class Next>
bypass_edge<Next> bypass(Next next) noexcept {
  return {std::move(next)};
}

/// See announce().
template <class F, class How>
struct announced_edge {
  F f;      ///< Is told.
  How how;  ///< What happens then.
};
/// As @p how, which is null, erase or erase_with; but before a reference to a retired object goes, @p f(retired) is called, with the
/// locks of edges() held and the reference still there. For a program that keeps an index over the member, and tells it of its own
/// changes, too. @p f must not throw and must not change the member; of a sequence that elements are erased from it must not
/// even read it. (An element that another thread assigns without the lock may be announced in vain.) Erasing by key takes a
/// walk then, not a look-up.
template <class F, class How>
announced_edge<F, How> announce(F f, How how) noexcept {
  return {std::move(f), std::move(how)};
}

/// For reports.
constexpr const char* name_of(const hold_edge*) noexcept { return "hold"; }
/// For reports.
constexpr const char* name_of(const null_edge*) noexcept { return "null"; }
/// For reports.
constexpr const char* name_of(const erase_edge*) noexcept { return "erase"; }
/// For reports.
template <class... Companions>
constexpr const char* name_of(const erase_edge_with<Companions...>*) noexcept {
  return "erase";
}
/// For reports.
template <class Next>
constexpr const char* name_of(const bypass_edge<Next>*) noexcept {
  return "bypass";
}
/// For reports.
template <class F, class How>
constexpr const char* name_of(const announced_edge<F, How>*) noexcept {
  return name_of(static_cast<const How*>(nullptr));
}

}  // namespace on_retire
}  // namespace slamgc
