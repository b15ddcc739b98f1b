/// @file
/// Redundancy by the thesis's pseudo code, to the letter. Not for use: it exists to measure how often it is wrong.
#pragma once

#include <algorithm>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "index.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace redundancy {

/// What connection_sets_as_published keeps in a keyframe.
template <class Keyframe, class Point, class Env = std_env>
struct keyframe_published : keyframe_counts<Env> {
  std::mutex mutex;                                            ///< Guards connected. A leaf.
  std::unordered_map<Point, std::vector<Keyframe>> connected;  ///< Redundant_mappoint_connections.
  typename Env::template atomic<int> redundant{0};             ///< nRedundantObservations.
};

/// Index that follows the pseudo code of the thesis, chapter 5: AddMapPoint() when a slot is set,
/// EraseMapPointMatch() when it is cleared, both when it is replaced. "Three" is the rule's `others`.
///
/// It is not equal to the rule, in four ways. Both keyframes are connected by the level test of the one that comes, though
/// the rule asks each by its own level. The count goes up at *each* connection from the threshold on, instead of once.
/// It goes down by one, and only from above the threshold. And an observation that is made or erased without the slot,
/// or a point that becomes bad, changes nothing. Where the text leaves open what is meant, the better reading
/// is taken: a keyframe is not connected with itself, and slots that are eligible and points that are not bad are counted afresh
/// for each answer, as the rule says.
/// @tparam Map see index.hpp. keyframe_state is keyframe_published; point_state is not asked for.
template <class Map, class Env = std_env>
class connection_sets_as_published : public index<connection_sets_as_published<Map, Env>, Map> {
  using base = index<connection_sets_as_published<Map, Env>, Map>;

 public:
  using typename base::keyframe;
  using typename base::point;
  using keyframe_state = keyframe_published<keyframe, point, Env>;  ///< What a keyframe keeps.

  /// An index of the map, by the rule.
  explicit connection_sets_as_published(const Map& map, const rule& r = orb_slam2) : base(map, r) {}

 private:
  friend base;
  using base::map_;
  using base::rule_;
  using set = std::vector<keyframe>;
  // (70) memory_order_relaxed: as for the other counts.
  static constexpr std::memory_order order = std::memory_order_relaxed;

  status enter_all(const keyframe& k, int slots) {
    for (int i = 0; i != slots; ++i) {
      const point p = map_.slot(k, i);
      if (!map_.is_null(p) && map_.eligible(k, i)) add_map_point(k, i, p);
    }
    return status::ok;
  }
  void forget(const keyframe&) {}
  status point_added(const point&) { return status::ok; }
  status observed(const keyframe&, const point&, const observation*, const observation*) {
    return status::ok;
  }
  void dropped(const point&) {}
  status slot_changed(const keyframe& k, int slot, const point& old, const point* p) {
    if (!map_.is_null(old)) erase_map_point_match(k, old);
    if (p != nullptr) add_map_point(k, slot, *p);
    return status::ok;
  }

  void add_map_point(const keyframe& k, int slot, const point& p) {
    const auto observations_stay = map_.lock_observations(p);
    const int reach = map_.level(k, slot) + rule_.slack;
    map_.observers(p, [&](const keyframe& other, const observation& o) {
      if (other == k || o.level > reach) return true;
      connect(k, p, other);
      connect(other, p, k);
      return true;
    });
  }
  void connect(const keyframe& k, const point& p, const keyframe& other) {
    keyframe_state& state = map_.keyframe_state(k);
    const std::lock_guard<std::mutex> lock(state.mutex);
    set& s = state.connected[p];
    if (std::find(s.begin(), s.end(), other) == s.end()) s.push_back(other);
    if (s.size() >= threshold()) state.redundant.fetch_add(1, order);
  }
  void erase_map_point_match(const keyframe& k, const point& p) {
    const auto observations_stay = map_.lock_observations(p);
    {
      keyframe_state& state = map_.keyframe_state(k);
      const std::lock_guard<std::mutex> lock(state.mutex);
      const auto it = state.connected.find(p);
      if (it != state.connected.end()) {
        if (it->second.size() > threshold()) state.redundant.fetch_sub(1, order);
        state.connected.erase(it);
      }
    }
    map_.observers(p, [&](const keyframe& other, const observation&) {
      keyframe_state& state = map_.keyframe_state(other);
      const std::lock_guard<std::mutex> lock(state.mutex);
      const auto it = state.connected.find(p);
      if (it == state.connected.end()) return true;
      set& s = it->second;
      const auto found = std::find(s.begin(), s.end(), k);
      if (found == s.end()) return true;
      s.erase(found);
      if (s.size() < threshold()) state.redundant.fetch_sub(1, order);
      return true;
    });
  }
  [[nodiscard]] std::size_t threshold() const noexcept {
    return static_cast<std::size_t>(rule_.others);
  }

  [[nodiscard]] verdict judge(const keyframe& k) const {
    verdict v = this->counts(k).judge(rule_);
    if (v.result != status::ok) return v;
    const auto slots_stay = map_.lock_slots(k);
    const int n = map_.slots(k);
    for (int i = 0; i != n; ++i) {
      const point p = map_.slot(k, i);
      if (map_.is_null(p) || !map_.eligible(k, i)) continue;
      const auto observations_stay = map_.lock_observations(p);
      v.eligible_slots += !map_.bad(p);
    }
    v.redundant_slots = map_.keyframe_state(k).redundant.load(order);
    v.redundant = rule_.exceeded(v.redundant_slots, v.eligible_slots);
    return v;
  }
};

}  // namespace redundancy
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
