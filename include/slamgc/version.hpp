/// @file
/// The version of slamgc. The build reads the numbers from here; they stand nowhere else.
#pragma once

#define SLAMGC_VERSION_MAJOR 0
#define SLAMGC_VERSION_MINOR 1
#define SLAMGC_VERSION_PATCH 0
