/// @file
/// Everything, except mutex_counter.hpp, which exists for comparison, and background_reclaimer.hpp, which a
/// program includes in one place: `<mutex>` is large.
#pragma once

#include "atomic_rc.hpp"
#include "borrow.hpp"
#include "containers/rc_list.hpp"
#include "containers/rc_map.hpp"
#include "containers/rc_set.hpp"
#include "containers/rc_unordered_map.hpp"
#include "containers/rc_unordered_set.hpp"
#include "containers/rc_value_map.hpp"
#include "containers/rc_vector.hpp"
#include "counter.hpp"
#include "deferred.hpp"
#include "domain.hpp"
#include "env.hpp"
#include "fwd.hpp"
#include "intrusive_rc.hpp"
#include "mutator.hpp"
#include "pin.hpp"
#include "rc_object.hpp"
#include "rc_slot.hpp"
#include "reclaim_at_zero.hpp"
#include "retire_set.hpp"
#include "scoped_count.hpp"
#include "stats.hpp"
#include "version.hpp"
