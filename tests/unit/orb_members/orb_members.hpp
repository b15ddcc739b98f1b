/// @file
/// The session over plain members, for the comparison in counted.cpp.
#pragma once

#include <vector>

namespace orb_members {

/// Digests of all members after each step.
std::vector<long> run_with_plain_members();

}  // namespace orb_members
