/// @file
/// The two flavours of slamgc: with checks of misuse and without.
///
/// `SLAMGC_DEBUG` chooses: 1 turns the checks on, 0 turns them off. Unless the program says
/// otherwise they are on when `NDEBUG` is not defined, or when the program brings a `SLAMGC_ASSERT`
/// of its own. Layout is the same in both, but for slamgc::borrow, which is for locals. The functions are not, so each flavour lives in an inline
/// namespace of its own, and a program that links both holds two sets of slamgc's functions. (A class
/// of the program's own that two files see in two flavours is still two definitions of one class: they
/// agree in layout, which is what programs rely on, and not to the letter of the one-definition rule.) A program that brings a `SLAMGC_ASSERT` brings it in every
/// file of the checked flavour.
#pragma once

#ifndef SLAMGC_DEBUG
#if !defined(NDEBUG) || defined(SLAMGC_ASSERT)
#define SLAMGC_DEBUG 1
#else
#define SLAMGC_DEBUG 0
#endif
#endif

#if SLAMGC_DEBUG
#define SLAMGC_FLAVOUR checked
#else
#define SLAMGC_FLAVOUR unchecked
#endif

/// Of namespace slamgc::runtime: what all flavours and all shared libraries of a process have in common,
/// under `-fvisibility=hidden`, too.
#define SLAMGC_SHARED __attribute__((visibility("default")))
