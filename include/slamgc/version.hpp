/// @file
/// The version of slamgc. The build reads the numbers from here; they stand nowhere else.
#pragma once

/// Changes with the interface, from 1.0 on.
#define SLAMGC_VERSION_MAJOR 0
/// Changes with additions; before 1.0 also with the interface.
#define SLAMGC_VERSION_MINOR 2
/// Changes with corrections.
#define SLAMGC_VERSION_PATCH 0
