/// @file
/// Redundancy from the number of observers at each level.
#pragma once

#include <array>

#include "../detail/tracking_index.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace redundancy {

/// What level_histogram keeps in a point: with 8 levels 24 bytes.
template <class Keyframe, int Levels = 8>
struct point_levels {
  /// Observers at this level or a finer one.
  std::array<std::uint16_t, static_cast<std::size_t>(Levels)> up_to{};
  /// Where slots and observations do not agree; null as a rule.
  detail::loose_ends<Keyframe> ends;
};

/// Index that counts the observers of each point per level, cumulatively. A slot at level l is redundant iff the
/// count at l + slack, less its own keyframe, is at least `others`: so a change of an observation is one addition to a
/// row of counters, and concerns the slots of other keyframes only where a counter passes that threshold. Then, and only then,
/// it walks the point's observers, and changes the counts of those keyframes whose slot flips. check() is one load.
///
/// 24 bytes per point and 8 per keyframe, in the program's objects; a loose end has 24 more while it lasts.
/// @tparam Map see index.hpp. keyframe_state is keyframe_counts, point_state is point_levels<keyframe, levels>.
template <class Map, class Env = std_env>
class level_histogram : public detail::tracking_index<level_histogram<Map, Env>, Map> {
  using base = detail::tracking_index<level_histogram<Map, Env>, Map>;

 public:
  using typename base::keyframe;
  using typename base::point;
  using keyframe_state = keyframe_counts<Env>;              ///< What a keyframe keeps.
  using point_state = point_levels<keyframe, Map::levels>;  ///< What a point keeps.

  /// An index of the map, by the rule.
  explicit level_histogram(const Map& map, const rule& r = {}) : base(map, r) {}

 private:
  friend base;
  friend index<level_histogram, Map>;
  using base::map_;
  using base::rule_;
  using row = decltype(point_state::up_to);
  static constexpr std::uint16_t most = 65535;

  [[nodiscard]] row& up_to(const point& p) const { return map_.point_state(p).up_to; }
  [[nodiscard]] bool seen(const row& r, int reach, int own) const noexcept {
    return r[at(reach)] - own >= rule_.others;
  }
  [[nodiscard]] static std::size_t at(int level) noexcept {
    return static_cast<std::size_t>(level);
  }

  [[nodiscard]] verdict judge(const keyframe& k) const { return this->counts(k).judge(rule_); }

  void slot_entered(const keyframe& k, int slot, const point& p, int own) {
    this->counts(k).add(1, seen(up_to(p), this->reach(map_.level(k, slot)), own));
  }
  void slot_left(const keyframe& k, int slot, const point& p, int own) {
    this->counts(k).add(-1, -int{seen(up_to(p), this->reach(map_.level(k, slot)), own)});
  }

  [[nodiscard]] status may_observe(const point& p, const observation* before) const {
    const std::uint16_t n = up_to(p).back();
    if (before != nullptr) return n != 0 ? status::ok : status::unknown_point;
    return n != most ? status::ok : status::too_many_observers;
  }
  void observers_changed(const keyframe& k, const point& p, const observation* before,
                         const observation* after) {
    row& now = up_to(p);
    // A slot of an observer is redundant above this.
    const int edge = rule_.others + 1;
    bool flips = false;
    if (after != nullptr)
      for (auto l = at(after->level); l != now.size(); ++l) flips |= ++now[l] == edge;
    if (before != nullptr)
      for (auto l = at(before->level); l != now.size(); ++l) flips |= now[l]-- == edge;
    const auto change = [&](int reach, int own) {
      const int gain = int{after != nullptr && after->level <= reach} -
                       int{before != nullptr && before->level <= reach};
      return int{seen(now, reach, own)} - int{seen(now, reach, own + gain)};
    };
    const auto recount = [&](const keyframe& other, int, int reach, int own) {
      const int by = change(reach, own);
      if (by != 0 && !(other == k)) this->counts(other).add(0, by);
    };
    if (flips)
      this->holders(
          p, [&](int reach) { return change(reach, 1) != 0; }, recount);
    else
      this->loose_holders(p, recount);
  }

  [[nodiscard]] status may_add(const point& p) const {
    if (up_to(p).back() != 0) return status::known_point;
    int n = 0;
    map_.observers(p, [&](const keyframe&, const observation&) { return ++n <= most; });
    return n <= most ? status::ok : status::too_many_observers;
  }
  void count_all(const point& p) {
    row& now = up_to(p);
    const row old = now;
    map_.observers(p, [&](const keyframe&, const observation& o) {
      for (int l = o.level; l != Map::levels; ++l) ++now[at(l)];
      return true;
    });
    this->holders(
        p, [](int) { return true; },
        [&](const keyframe& k, int, int reach, int own) {
          this->counts(k).add(0, int{seen(now, reach, own)} - int{seen(old, reach, own)});
        });
  }
  void count_none(const point& p) {
    row& now = up_to(p);
    this->holders(
        p, [](int) { return true; },
        [&](const keyframe& k, int, int reach, int own) {
          this->counts(k).add(-1, -int{seen(now, reach, own)});
        });
    now = row{};
  }
  void forget_sets(const keyframe&) {}
};

}  // namespace redundancy
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
