/// @file
/// Everything, except mutex_counter.hpp: that one exists for comparison, and `<mutex>` is large.
#pragma once

#include "containers/rc_list.hpp"
#include "containers/rc_map.hpp"
#include "containers/rc_set.hpp"
#include "containers/rc_unordered_map.hpp"
#include "containers/rc_unordered_set.hpp"
#include "containers/rc_value_map.hpp"
#include "containers/rc_vector.hpp"
#include "counter.hpp"
#include "env.hpp"
#include "fwd.hpp"
#include "intrusive_rc.hpp"
#include "rc_object.hpp"
#include "rc_slot.hpp"
#include "reclaim_at_zero.hpp"
#include "scoped_count.hpp"
#include "version.hpp"
