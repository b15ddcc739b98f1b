/// @file
/// When a keyframe is redundant.
///
/// The rule of ORB-SLAM's keyframe culling. An *eligible* slot of keyframe K holds a point that is not bad, at a
/// usable depth. It is *redundant* when at least `others` keyframes other than K observe its point at the same
/// level, a finer one, or at most `slack` levels coarser. K is redundant when more than `numerator / denominator` of
/// its eligible slots are redundant. Observers count whether or not they are bad themselves, as in ORB-SLAM3.
#pragma once

#include <cstdint>

#include "../fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Keyframe redundancy; see redundancy.hpp.
namespace redundancy {

/// The numbers of the rule. A rule is constant as long as an index uses it, but for the share, which only reading uses.
struct rule {
  int others = 4;     ///< Other observers that make an observation redundant. Not negative.
  int slack = 1;      ///< By how many levels they may be coarser. Not negative.
  int numerator = 9;  ///< With denominator: the share of redundant slots that has to be exceeded.
  int denominator = 10;  ///< See numerator. Not zero.

  /// Whether @p redundant of @p eligible slots are too many. Integers: for up to 20,000 slots the same as ORB-SLAM3's
  /// `redundant > 0.9f * eligible` (0.5f). Never, if no slot is eligible.
  [[nodiscard]] constexpr bool exceeded(std::int64_t redundant,
                                        std::int64_t eligible) const noexcept {
    return redundant * denominator > eligible * numerator;
  }
};

/// ORB-SLAM3: four others (its comment says three, its code asks for more than three); more than 90 %.
inline constexpr rule orb_slam3{};
/// ORB-SLAM3 with IMU and depth: more than 50 %.
inline constexpr rule orb_slam3_inertial_depth{4, 1, 1, 2};
/// ORB-SLAM2, and the thesis: three others; more than 90 %.
inline constexpr rule orb_slam2{3, 1, 9, 10};

/// Whether a slot at this depth is eligible: the comparison of ORB-SLAM3 for stereo and RGB-D, not a number included.
/// With one camera each slot is. Slots of a second camera (fisheye stereo) should not be: ORB-SLAM3 reads their depth
/// and level beyond the end of its arrays, so there is no behaviour to be equal to.
[[nodiscard]] constexpr bool eligible_by_depth(float depth, float farthest) noexcept {
  return !(depth > farthest || depth < 0);
}

/// One observation of a point by a keyframe.
struct observation {
  /// The slot that the observation names, or -1: only a second camera sees the point.
  int slot;
  /// The level: that of the slot, or the one of a second camera if that is finer.
  int level;
};

/// What became of a call. Unless it is `ok`, the index is as it was, and the map should not be changed either.
enum class status {
  ok,                 ///< Done; or there was nothing to do.
  unknown_keyframe,   ///< The keyframe was not added.
  known_keyframe,     ///< The keyframe was added already.
  known_point,        ///< The index knows the point's observers already.
  unknown_point,      ///< The point has observers that the index does not know; see add_point().
  removed_keyframe,   ///< The keyframe was removed, and has no verdict any more.
  no_point,           ///< The point is null.
  no_observation,     ///< The keyframe does not observe the point.
  empty_slot,         ///< The slot that should be cleared is empty.
  slot_out_of_range,  ///< The keyframe has no such slot.
  level_out_of_range,  ///< The map has no such level, or an observation is coarser than the slot it names.
  too_many_observers,  ///< A point of level_histogram has 65,535 observers.
  out_of_memory,       ///< A loose end could not be noted; see detail/loose_ends.hpp.
};

/// The status as a word, for messages.
[[nodiscard]] constexpr const char* name_of(status s) noexcept {
  switch (s) {
    case status::ok:
      return "ok";
    case status::unknown_keyframe:
      return "unknown keyframe";
    case status::known_keyframe:
      return "known keyframe";
    case status::known_point:
      return "known point";
    case status::unknown_point:
      return "unknown point";
    case status::removed_keyframe:
      return "removed keyframe";
    case status::no_point:
      return "no point";
    case status::no_observation:
      return "no observation";
    case status::empty_slot:
      return "empty slot";
    case status::slot_out_of_range:
      return "slot out of range";
    case status::level_out_of_range:
      return "level out of range";
    case status::too_many_observers:
      return "too many observers";
    case status::out_of_memory:
      return "out of memory";
  }
  return "";
}

/// An answer about one keyframe.
struct verdict {
  status result = status::ok;  ///< Unless it is `ok`, the rest is zero.
  bool redundant = false;      ///< Whether the share of redundant slots is exceeded.
  int eligible_slots = 0;      ///< Slots that count.
  int redundant_slots = 0;     ///< Those of them that others see well enough.
};

}  // namespace redundancy
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
