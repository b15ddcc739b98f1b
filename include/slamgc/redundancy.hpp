/// @file
/// Which keyframes are redundant, without walking keyframes, points and observers in every pass of culling.
///
/// A keyframe is redundant when most of the points in its slots are seen well enough by others; see redundancy/rule.hpp.
/// Four indices answer that, with one interface (redundancy/index.hpp):
///
/// - slamgc::redundancy::recompute walks the map for each answer, as ORB-SLAM3 does;
/// - slamgc::redundancy::level_histogram counts observers per level at each point, and answers by one load;
/// - slamgc::redundancy::connection_sets keeps the set of connected keyframes of each slot, as the thesis proposes;
/// - slamgc::redundancy::connection_sets_as_published follows the thesis's pseudo code to the letter. It answers
///   differently from the others, and exists to measure how often.
///
/// It needs nothing of the rest of slamgc: keyframes and points are whatever the program uses, pointers or ids.
/// Therefore slamgc.hpp does not include it. docs/redundancy.md is the guide.
#pragma once

#include "redundancy/connection_sets.hpp"
#include "redundancy/connection_sets_as_published.hpp"
#include "redundancy/index.hpp"
#include "redundancy/level_histogram.hpp"
#include "redundancy/recompute.hpp"
#include "redundancy/rule.hpp"
