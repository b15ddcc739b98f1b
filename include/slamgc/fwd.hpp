/// @file
/// Declarations only: include this where a pointer or a reference to a slamgc type is enough.
#pragma once

#include "flavour.hpp"

/// slamgc: concurrent memory reclamation for graph-shaped SLAM maps.
namespace slamgc {

/// What a process has once, whatever the flavours of its parts: threads register with a domain, not with a
/// flavour of it.
namespace runtime SLAMGC_SHARED {
struct std_env;
template <class Env>
class domain_state;
}  // namespace SLAMGC_SHARED
using runtime::std_env;

/// Checked and unchecked builds live side by side; see flavour.hpp.
inline namespace SLAMGC_FLAVOUR {

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
struct reclaim_deferred;
struct reclaim_retired;
struct reclaim_by_scan;

template <class T, class Policy = fetch_add_counter, class Reclaimer = reclaim_at_zero>
class rc_object;

template <class T>
class intrusive_rc;
template <class T, class Env = std_env>
class rc_slot;
template <class T, class Env = std_env>
class atomic_rc;
template <class T, class Env = std_env>
class borrow;
template <class T, class Env = std_env>
class enable_weak_rc;
template <class T, class Env = std_env>
class weak_rc;
template <class T, class Record, class Env = std_env>
class enable_anchor;
template <class T, class Record, class Env = std_env>
class anchor;
template <class Container>
class scoped_count;

template <class Env>
class basic_domain;
template <class Env>
class basic_mutator;
template <class Env>
class basic_root;
template <class T>
class retire_set;
class background_reclaimer;

/// What the objects, threads and collectors of a SLAM system share.
using domain = basic_domain<std_env>;
/// Registers a thread with a domain.
using mutator = basic_mutator<std_env>;
/// Tells a domain where references from outside of the graph are.
using root = basic_root<std_env>;

namespace detail {
struct domain_access;
struct mutator_access;
}  // namespace detail

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
template <class Container, class Env = std_env>
class registry;
template <class T, class... Options>
class rc_unordered_set;
template <class T, class Mapped, class... Options>
class rc_unordered_map;

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
