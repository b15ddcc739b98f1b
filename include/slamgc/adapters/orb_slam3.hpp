/// @file
/// slamgc in ORB-SLAM3: what is known of its classes, so that a change of some hundred lines is enough. docs/orb-slam3.md is the guide.
///
/// ORB-SLAM3's members become counted ones, under the names that they have; locals, parameters and return types stay raw pointers.
/// Three base classes make keyframes, points and maps objects; `access`, a friend of ORB-SLAM3's classes, knows what
/// becomes of each member when its target is retired; a `thread` in each Run() and a `frame` in each TrackX() say when the thread
/// holds no pointer; a `session` reclaims in the background.
///
/// Nothing of ORB-SLAM3 is included here, and its classes are template parameters: a fork with other types compiles, too. Members
/// that a system does not have (ORB-SLAM2 has fewer) are left out; a member that it has and that is not counted yet is left
/// out as well, until session::add() and `thread` refuse to compile.
#pragma once

#include "../containers/rc_list.hpp"
#include "../containers/rc_map.hpp"
#include "../containers/rc_set.hpp"
#include "../containers/rc_vector.hpp"
#include "../registry.hpp"
#include "orb_slam3/objects.hpp"
#include "orb_slam3/session.hpp"
#include "orb_slam3/threads.hpp"
