/// @file
/// What the indices that keep counts share: which slots hold a point.
#pragma once

#include "../redundancy/index.hpp"
#include "loose_ends.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// An index that knows for each point the slots that hold it; see loose_ends.hpp. The scheme has, each called under the
/// lock of the point's observations:
///
/// - slot_entered, slot_left(k, slot, p, own): one slot; `own` is 1 if k itself is an observer that counts at its level;
/// - observers_changed(k, p, before, after): an observation of k, for the slots of others (never for those of k);
/// - count_all, count_none(p): all of its observers come or go, for all slots;
/// - may_observe(p, before), may_add(p): whether that can be counted;
/// - forget_sets(k): k is removed.
template <class Scheme, class Map>
class tracking_index : public redundancy::index<Scheme, Map> {
  using base = redundancy::index<Scheme, Map>;

 public:
  using typename base::keyframe;
  using typename base::point;

 protected:
  friend base;
  using base::map_;
  using base::rule_;
  using observation = redundancy::observation;
  using status = redundancy::status;
  using spare_ends = loose_ends<keyframe>;

  tracking_index(const Map& map, const redundancy::rule& r) : base(map, r) {}
  ~tracking_index() = default;

  [[nodiscard]] auto& ends(const point& p) const { return map_.point_state(p).ends; }
  /// Whether k itself is among the observers that count for a slot.
  [[nodiscard]] int own(const keyframe& k, const point& p, int reach) const {
    observation o{};
    return map_.find(p, k, o) && o.level <= reach;
  }

  /// f(keyframe, slot, reach, own) for each slot that holds the point, if its reach is wanted.
  template <class Wanted, class F>
  void holders(const point& p, Wanted wanted, F f) const {
    const auto& loose = ends(p);
    map_.observers(p, [&](const keyframe& k, const observation& o) {
      if (o.slot < 0) return true;
      const int reach = this->reach(map_.level(k, o.slot));
      if (wanted(reach) && map_.eligible(k, o.slot) && !loose.has(k, o.slot, false))
        f(k, o.slot, reach, 1);
      return true;
    });
    loose_holders(p, f);
  }
  /// The same for the loose slots alone, whatever their reach.
  template <class F>
  void loose_holders(const point& p, F f) const {
    for (const auto* end = ends(p).first(); end != nullptr; end = end->next) {
      if (!end->holds) continue;
      const int reach = this->reach(map_.level(end->keyframe, end->slot));
      f(end->keyframe, end->slot, reach, own(end->keyframe, p, reach));
    }
  }

 private:
  [[nodiscard]] Scheme& scheme() noexcept { return static_cast<Scheme&>(*this); }

  [[nodiscard]] bool enter(const keyframe& k, int slot, const point& p, spare_ends& spare) {
    const auto observations_stay = map_.lock_observations(p);
    if (map_.bad(p)) return true;
    const auto tied = ends(p).tie(k, slot, true, true, spare);
    if (tied == tie_result::no_memory) return false;
    scheme().slot_entered(k, slot, p, own_if(tied == tie_result::tied, k, slot, p));
    return true;
  }
  [[nodiscard]] bool leave(const keyframe& k, int slot, const point& p, spare_ends& spare) {
    const auto observations_stay = map_.lock_observations(p);
    if (map_.bad(p)) return true;
    const auto tied = ends(p).tie(k, slot, true, false, spare);
    if (tied == tie_result::no_memory) return false;
    scheme().slot_left(k, slot, p, own_if(tied == tie_result::loose, k, slot, p));
    return true;
  }
  // An observation that names the slot is never coarser than the slot: no need to look it up.
  [[nodiscard]] int own_if(bool named, const keyframe& k, int slot, const point& p) const {
    return named ? 1 : own(k, p, this->reach(map_.level(k, slot)));
  }

  [[nodiscard]] status enter_all(const keyframe& k, int slots) {
    spare_ends spare;
    for (int i = 0; i != slots; ++i) {
      if (!has_point(k, i) || enter(k, i, map_.slot(k, i), spare)) continue;
      // What tied up gave its memory to spare, so that undoing needs none.
      while (i-- != 0)
        if (has_point(k, i)) (void)leave(k, i, map_.slot(k, i), spare);
      return status::out_of_memory;
    }
    return status::ok;
  }
  [[nodiscard]] bool has_point(const keyframe& k, int slot) const {
    return map_.eligible(k, slot) && !map_.is_null(map_.slot(k, slot));
  }

  // From now on the loose ends of k are of no interest, but loose observations, which go with their observation.
  void forget(const keyframe& k) {
    spare_ends spare;
    const int n = map_.slots(k);
    for (int i = 0; i != n; ++i) {
      if (!has_point(k, i)) continue;
      const point p = map_.slot(k, i);
      const auto observations_stay = map_.lock_observations(p);
      if (!map_.bad(p)) (void)ends(p).take(k, i, true, spare);
    }
    scheme().forget_sets(k);
  }

  [[nodiscard]] status slot_changed(const keyframe& k, int slot, const point& old, const point* p) {
    spare_ends spare;
    if (!map_.is_null(old) && !leave(k, slot, old, spare)) return status::out_of_memory;
    if (p == nullptr || enter(k, slot, *p, spare)) return status::ok;
    // Leaving made a loose observation, or there would have been spare memory; it ties up again.
    if (!map_.is_null(old)) (void)enter(k, slot, old, spare);
    return status::out_of_memory;
  }

  [[nodiscard]] status observed(const keyframe& k, const point& p, const observation* before,
                                const observation* after) {
    const status s = scheme().may_observe(p, before);
    if (s != status::ok) return s;
    spare_ends spare;
    if (!retie(k, p, before, after, spare)) return status::out_of_memory;
    if (before == nullptr || after == nullptr || before->level != after->level)
      scheme().observers_changed(k, p, before, after);
    return status::ok;
  }
  [[nodiscard]] bool retie(const keyframe& k, const point& p, const observation* before,
                           const observation* after, spare_ends& spare) {
    const bool same = before != nullptr && after != nullptr && before->slot == after->slot;
    const bool goes = !same && names_slot(k, before);
    const bool comes = !same && names_slot(k, after);
    if (this->counts(k).removed()) {
      if (goes) (void)ends(p).take(k, before->slot, false, spare);
      return true;
    }
    if (goes && ends(p).tie(k, before->slot, false, false, spare) == tie_result::no_memory)
      return false;
    if (!comes || ends(p).tie(k, after->slot, false, true, spare) != tie_result::no_memory)
      return true;
    if (goes) (void)ends(p).tie(k, before->slot, false, true, spare);
    return false;
  }
  [[nodiscard]] bool names_slot(const keyframe& k, const observation* o) const {
    return o != nullptr && o->slot >= 0 && map_.eligible(k, o->slot);
  }

  [[nodiscard]] status point_added(const point& p) {
    status s = scheme().may_add(p);
    if (s != status::ok) return s;
    spare_ends spare;
    int tied = 0;
    map_.observers(p, [&](const keyframe& k, const observation& o) {
      if (!retie(k, p, nullptr, &o, spare)) s = status::out_of_memory;
      tied += s == status::ok;
      return s == status::ok;
    });
    if (s == status::ok) {
      scheme().count_all(p);
    } else {
      map_.observers(p, [&](const keyframe& k, const observation& o) {
        if (tied-- != 0) (void)retie(k, p, &o, nullptr, spare);
        return tied > 0;
      });
    }
    return s;
  }

  void dropped(const point& p) {
    scheme().count_none(p);
    ends(p).clear();
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
