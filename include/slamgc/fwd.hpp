/// @file
/// Declarations only: include this where a pointer or a reference to a slamgc type is enough.
#pragma once

#include "flavour.hpp"

/// slamgc: concurrent memory reclamation for graph-shaped SLAM maps.
namespace slamgc {
/// Checked and unchecked builds live side by side; see flavour.hpp.
inline namespace SLAMGC_FLAVOUR {

struct std_env;

template <class Env>
struct basic_fetch_add_counter;
template <class Env>
struct basic_cas_counter;
template <class Env>
struct basic_unsync_counter;
template <class Env, class Mutex>
struct basic_mutex_counter;

/// Counter policy: one atomic add per change. The default, and the fastest.
using fetch_add_counter = basic_fetch_add_counter<std_env>;
/// Counter policy: a compare-and-swap loop per change (the thesis's fourth scheme).
using cas_counter = basic_cas_counter<std_env>;
/// Counter policy: plain arithmetic, for objects that one thread alone ever touches.
using unsync_counter = basic_unsync_counter<std_env>;

struct reclaim_at_zero;

template <class T, class Policy = fetch_add_counter, class Reclaimer = reclaim_at_zero>
class rc_object;

template <class T>
class intrusive_rc;
template <class T, class Env = std_env>
class rc_slot;
template <class Container>
class scoped_count;

// The trailing parameters are those of the standard container (allocator, comparator, hash), with
// its defaults.
template <class T, class... Options>
class rc_vector;
template <class T, class... Options>
class rc_list;
template <class T, class... Options>
class rc_set;
template <class T, class Mapped, class... Options>
class rc_map;
template <class Key, class T, class... Options>
class rc_value_map;
template <class T, class... Options>
class rc_unordered_set;
template <class T, class Mapped, class... Options>
class rc_unordered_map;

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
