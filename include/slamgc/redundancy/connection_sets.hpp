/// @file
/// Redundancy from the set of connected keyframes of each slot: the thesis's idea, made exact.
#pragma once

#include <algorithm>
#include <mutex>
#include <vector>

#include "../detail/tracking_index.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace redundancy {

/// What connection_sets keeps in a keyframe: a vector per slot, and 8 bytes per connection.
template <class Keyframe, class Env = std_env>
struct keyframe_connections : keyframe_counts<Env> {
  std::mutex mutex;  ///< Guards connected. A leaf: nothing is called while it is held.
  /// For each slot the others that observe its point well enough.
  std::vector<std::vector<Keyframe>> connected;
};

/// What connection_sets keeps in a point.
template <class Keyframe>
struct point_connections {
  /// Where slots and observations do not agree; null as a rule.
  detail::loose_ends<Keyframe> ends;
  bool known = false;  ///< Whether observers were told.
};

/// Index that keeps for each slot the set of other keyframes that observe its point well enough (thesis, chapter 5). A
/// change of an observation changes the sets of all slots that hold the point: O(observers). check() is one load.
///
/// Unlike the thesis's pseudo code it asks for each of two keyframes by its own level whether the other one counts, and
/// counts when a set passes the threshold, once, in both directions; see connection_sets_as_published. The sets lie in
/// vectors, by slot: quicker than the hash maps of the thesis. If memory for a set runs out, std::bad_alloc is thrown
/// (or the program ends, without exceptions) and the index is no longer exact.
/// @tparam Map see index.hpp. keyframe_state is keyframe_connections, point_state is point_connections.
template <class Map, class Env = std_env>
class connection_sets : public detail::tracking_index<connection_sets<Map, Env>, Map> {
  using base = detail::tracking_index<connection_sets<Map, Env>, Map>;

 public:
  using typename base::keyframe;
  using typename base::point;
  using keyframe_state = keyframe_connections<keyframe, Env>;  ///< What a keyframe keeps.
  using point_state = point_connections<keyframe>;             ///< What a point keeps.

  /// An index of the map, by the rule.
  explicit connection_sets(const Map& map, const rule& r = {}) : base(map, r) {}

 private:
  friend base;
  friend index<connection_sets, Map>;
  using base::map_;
  using base::rule_;
  using set = std::vector<keyframe>;

  [[nodiscard]] verdict judge(const keyframe& k) const { return this->counts(k).judge(rule_); }
  [[nodiscard]] bool seen(const set& s) const noexcept {
    return s.size() >= static_cast<std::size_t>(rule_.others);
  }

  // change(set) with the set of a slot; the counts follow. Nothing, if the keyframe was removed.
  template <class Change>
  void change_set(const keyframe& k, int slot, bool was_counted, bool is_counted, Change change) {
    keyframe_state& state = map_.keyframe_state(k);
    const std::lock_guard<std::mutex> lock(state.mutex);
    if (state.removed()) return;
    if (state.connected.empty()) state.connected.resize(static_cast<std::size_t>(map_.slots(k)));
    set& s = state.connected[static_cast<std::size_t>(slot)];
    const bool was_seen = was_counted && seen(s);
    change(s);
    const bool is_seen = is_counted && seen(s);
    if (was_counted != is_counted || was_seen != is_seen)
      state.add(int{is_counted} - int{was_counted}, int{is_seen} - int{was_seen});
  }
  void collect(const keyframe& k, const point& p, int reach, set& s) const {
    s.clear();
    map_.observers(p, [&](const keyframe& other, const observation& o) {
      if (!(other == k) && o.level <= reach) s.push_back(other);
      return true;
    });
  }

  void slot_entered(const keyframe& k, int slot, const point& p, int) {
    change_set(k, slot, false, true,
               [&](set& s) { collect(k, p, this->reach(map_.level(k, slot)), s); });
  }
  void slot_left(const keyframe& k, int slot, const point&, int) {
    change_set(k, slot, true, false, [](set& s) { s.clear(); });
  }
  [[nodiscard]] status may_observe(const point& p, const observation* before) const {
    return before == nullptr || map_.point_state(p).known ? status::ok : status::unknown_point;
  }
  void observers_changed(const keyframe& k, const point& p, const observation* before,
                         const observation* after) {
    map_.point_state(p).known = true;
    const auto counts_at = [](const observation* o, int reach) {
      return o != nullptr && o->level <= reach;
    };
    this->holders(
        p, [&](int reach) { return counts_at(before, reach) != counts_at(after, reach); },
        [&](const keyframe& other, int slot, int reach, int) {
          if (other == k || counts_at(before, reach) == counts_at(after, reach)) return;
          change_set(other, slot, true, true, [&](set& s) {
            if (counts_at(after, reach)) return s.push_back(k);
            const auto it = std::find(s.begin(), s.end(), k);
            if (it == s.end()) return;
            *it = s.back();
            s.pop_back();
          });
        });
  }
  [[nodiscard]] status may_add(const point& p) const {
    return map_.point_state(p).known ? status::known_point : status::ok;
  }
  void count_all(const point& p) {
    map_.observers(p, [&](const keyframe&, const observation&) {
      return !(map_.point_state(p).known = true);
    });
    this->holders(
        p, [](int) { return true; },
        [&](const keyframe& k, int slot, int reach, int) {
          change_set(k, slot, true, true, [&](set& s) { collect(k, p, reach, s); });
        });
  }
  void count_none(const point& p) {
    this->holders(
        p, [](int) { return true; },
        [&](const keyframe& k, int slot, int, int) { slot_left(k, slot, p, 0); });
  }
  void forget_sets(const keyframe& k) {
    keyframe_state& state = map_.keyframe_state(k);
    const std::lock_guard<std::mutex> lock(state.mutex);
    std::vector<set>().swap(state.connected);
  }
};

}  // namespace redundancy
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
