// Random events for a world: all that a program may announce, in any order, and what it may not.
#pragma once

#include <gtest/gtest.h>

#include <random>

#include "unit/redundancy/world.hpp"

namespace redundancy_test {

using red::status;

template <class World>
class events {
 public:
  // Of a world whose keyframes have as many slots each.
  events(World& w, unsigned seed)
      : w_(w), random_(seed), slots_(static_cast<int>(w.keyframes.front().points.size())) {}

  // Errors included: unknown keyframes, nothing to erase, numbers out of range.
  void one() {
    const int k = keyframe(), p = point(), slot = below(slots_);
    switch (below(32)) {
      case 0:
      case 1:
        w_.add_keyframe(k);
        break;
      case 2:
        below(12) == 0 ? w_.remove_keyframe(k) : w_.add_keyframe(k);
        break;
      case 3:
        below(6) == 0 ? w_.mark_bad(p) : status::ok;
        break;
      case 4:
      case 5:
      case 6:
      case 7:
      case 8:
      case 9:
        see(k, p, slot);
        break;
      case 10:
      case 11:
      case 12:
      case 13:
        w_.erase_observation(k, p);
        break;
      case 14:
      case 15:
        w_.clear_slot(k, slot);
        break;
      case 16:
      case 17:
      case 18:
        w_.set_slot(k, slot, p);
        break;
      case 19:
      case 20:
      case 21:
      case 22:  // as most of ORB-SLAM3 does
        if (see(k, p, slot) == status::ok) w_.set_slot(k, slot, p);
        break;
      case 23:
      case 24:
      case 25:  // as CreateInitialMapMonocular and CorrectLoop do
        if (w_.set_slot(k, slot, p) == status::ok) see(k, p, slot);
        break;
      case 26:
        erase_match(k, p);
        break;
      case 27:
        if (below(6) == 0) replace(p, point());
        break;
      case 28:
        if (below(12) == 0) cull(k);
        break;
      case 29:
        wrong(k, p, slot);
        break;
      case 30:
        before_it_is_known(k, p, slot);
        break;
      default:
        see_by_the_other_camera(k, p);
        break;
    }
  }
  int keyframe() { return below(static_cast<int>(w_.keyframes.size())); }
  int point() { return below(static_cast<int>(w_.points.size())); }
  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }

 private:
  auto& kf(int k) { return w_.keyframes[World::at(k)]; }
  // The slot's level, or by a second camera's leave a finer one.
  status see(int k, int p, int slot) {
    const int level = kf(k).levels[World::at(slot)];
    return w_.set_observation(k, p, {slot, below(4) == 0 ? below(level + 1) : level});
  }
  void see_by_the_other_camera(int k, int p) {
    w_.set_observation(k, p, {-1, below(World::view::levels)});
  }
  // The optimizer drops an outlier.
  void erase_match(int k, int p) {
    const auto observers = w_.observers_of(p);
    const auto it = observers.find(k);
    if (it == observers.end()) return;
    if (it->second.slot >= 0) w_.clear_slot(k, it->second.slot);
    w_.erase_observation(k, p);
  }
  // MapPoint::Replace: the old point is marked, its slots get the new one, or are cleared if the keyframe has that.
  void replace(int p, int by) {
    if (p == by) return;
    const auto observers = w_.observers_of(p);
    w_.mark_bad(p);
    for (const auto& o : observers) {
      if (o.second.slot < 0) continue;
      if (w_.observers_of(by).count(o.first) != 0) {
        w_.clear_slot(o.first, o.second.slot);
      } else if (w_.set_slot(o.first, o.second.slot, by) == status::ok) {
        w_.set_observation(o.first, by, o.second);
      }
    }
  }
  // KeyFrame::SetBadFlag: the slots stay as they are.
  void cull(int k) {
    for (const int p : w_.points_of(k))
      if (p != none) w_.erase_observation(k, p);
    w_.remove_keyframe(k);
  }
  void wrong(int k, int p, int slot) {
    const bool known = kf(k).known;
    const auto expect = [&](status s, status expected) {
      EXPECT_EQ(s, known ? expected : status::unknown_keyframe) << red::name_of(s);
    };
    switch (below(9)) {
      case 0:
        expect(w_.set_observation(k, p, {slot, World::view::levels}), status::level_out_of_range);
        break;
      case 1:
        expect(w_.set_observation(k, p, {slot, -1}), status::level_out_of_range);
        break;
      case 2:
        expect(w_.set_observation(k, p, {-2, 0}), status::slot_out_of_range);
        break;
      case 3:
        expect(w_.set_observation(k, p, {slots_, 0}), status::slot_out_of_range);
        break;
      case 4:
        expect(w_.set_slot(k, slots_, p), status::slot_out_of_range);
        break;
      case 5:
        expect(w_.clear_slot(k, -1), status::slot_out_of_range);
        break;
      case 6:
        EXPECT_EQ(w_.set_slot(k, slot, none), status::no_point);
        break;
      case 7:
        EXPECT_EQ(w_.mark_bad(none), status::no_point);
        break;
      default:
        EXPECT_EQ(w_.erase_observation(k, none), status::no_point);
        break;
    }
  }
  // The constructor of a keyframe copies slots; nobody is told before it is added.
  void before_it_is_known(int k, int p, int slot) {
    if (!kf(k).known) kf(k).points[World::at(slot)] = p;
  }

  World& w_;
  std::mt19937 random_;
  const int slots_;
};

}  // namespace redundancy_test
