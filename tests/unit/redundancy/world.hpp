// A small map with numbered keyframes and points, the indices over it, and the rule as ORB-SLAM3's documentation of
// facts states it (oracle), written without the library.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <map>
#include <mutex>
#include <slamgc/redundancy.hpp>
#include <utility>
#include <vector>

namespace redundancy_test {

namespace red = slamgc::redundancy;

inline constexpr int none = -1;

template <int Levels, class Env>
struct world {
  struct keyframe_data {
    std::mutex mutex;
    std::vector<int> points;  // by slot
    std::vector<int> levels;
    std::vector<char> eligible;
    bool known = false, removed = false;
    red::keyframe_counts<Env> recomputed, histogram;
    red::keyframe_connections<int, Env> sets;
    red::keyframe_published<int, int, Env> published;
  };
  struct point_data {
    std::mutex mutex;
    std::map<int, red::observation> observers;
    bool bad = false;
    red::point_levels<int, Levels> histogram;
    red::point_connections<int> sets;
  };

  // What the indices see, each with states of its own.
  struct view {
    using keyframe = int;
    using point = int;
    static constexpr int levels = Levels;
    world* w;

    auto lock_slots(int k) const { return std::unique_lock<std::mutex>(w->keyframes[at(k)].mutex); }
    auto lock_observations(int p) const {
      return std::unique_lock<std::mutex>(w->points[at(p)].mutex);
    }
    bool is_null(int p) const { return p == none; }
    bool bad(int p) const { return w->points[at(p)].bad; }
    bool find(int p, int k, red::observation& o) const {
      const auto it = w->points[at(p)].observers.find(k);
      if (it == w->points[at(p)].observers.end()) return false;
      o = it->second;
      return true;
    }
    template <class F>
    void observers(int p, F f) const {
      for (const auto& o : w->points[at(p)].observers)
        if (!f(o.first, o.second)) return;
    }
    int slots(int k) const { return static_cast<int>(w->keyframes[at(k)].points.size()); }
    int level(int k, int slot) const { return w->keyframes[at(k)].levels[at(slot)]; }
    bool eligible(int k, int slot) const { return w->keyframes[at(k)].eligible[at(slot)] != 0; }
    int slot(int k, int slot) const { return w->keyframes[at(k)].points[at(slot)]; }
  };
  struct recompute_view : view {
    auto& keyframe_state(int k) const { return this->w->keyframes[at(k)].recomputed; }
  };
  struct histogram_view : view {
    auto& keyframe_state(int k) const { return this->w->keyframes[at(k)].histogram; }
    auto& point_state(int p) const { return this->w->points[at(p)].histogram; }
  };
  struct sets_view : view {
    auto& keyframe_state(int k) const { return this->w->keyframes[at(k)].sets; }
    auto& point_state(int p) const { return this->w->points[at(p)].sets; }
  };
  struct published_view : view {
    auto& keyframe_state(int k) const { return this->w->keyframes[at(k)].published; }
  };

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  world(int keyframe_count, int point_count, const red::rule& r)
      : keyframes(at(keyframe_count)),
        points(at(point_count)),
        recompute(recompute_view{{this}}, r),
        histogram(histogram_view{{this}}, r),
        sets(sets_view{{this}}, r),
        published(published_view{{this}}, r),
        rule(r) {}

  std::vector<keyframe_data> keyframes;
  std::vector<point_data> points;
  red::recompute<recompute_view, Env> recompute;
  red::level_histogram<histogram_view, Env> histogram;
  red::connection_sets<sets_view, Env> sets;
  red::connection_sets_as_published<published_view, Env> published;
  red::rule rule;

  // Announces to each index; they agree about errors.
  template <class F>
  red::status tell(F f) {
    const red::status s = f(histogram);
    const red::status by_sets = f(sets), by_recompute = f(recompute), by_published = f(published);
    EXPECT_EQ(s, by_sets) << red::name_of(s) << ", " << red::name_of(by_sets);
    EXPECT_EQ(s, by_recompute) << red::name_of(s) << ", " << red::name_of(by_recompute);
    EXPECT_EQ(s, by_published) << red::name_of(s) << ", " << red::name_of(by_published);
    return s;
  }

  // The events of a program: its locks, the announcement, the change.
  red::status add_keyframe(int k) {
    const std::lock_guard<std::mutex> lock(keyframes[at(k)].mutex);
    const red::status s = tell([&](auto& index) { return index.add_keyframe(k); });
    if (s == red::status::ok) keyframes[at(k)].known = true;
    return s;
  }
  red::status remove_keyframe(int k) {
    const std::lock_guard<std::mutex> lock(keyframes[at(k)].mutex);
    const red::status s = tell([&](auto& index) { return index.remove_keyframe(k); });
    if (s == red::status::ok) keyframes[at(k)].removed = true;
    return s;
  }
  red::status set_observation(int k, int p, red::observation o) {
    if (p == none) return tell([&](auto& index) { return index.set_observation(k, p, o); });
    const std::lock_guard<std::mutex> lock(points[at(p)].mutex);
    const red::status s = tell([&](auto& index) { return index.set_observation(k, p, o); });
    if (s == red::status::ok) points[at(p)].observers[k] = o;
    return s;
  }
  red::status erase_observation(int k, int p) {
    if (p == none) return tell([&](auto& index) { return index.erase_observation(k, p); });
    const std::lock_guard<std::mutex> lock(points[at(p)].mutex);
    const red::status s = tell([&](auto& index) { return index.erase_observation(k, p); });
    if (s == red::status::ok) points[at(p)].observers.erase(k);
    return s;
  }
  red::status mark_bad(int p) {
    if (p == none) return tell([&](auto& index) { return index.mark_bad(p); });
    const std::lock_guard<std::mutex> lock(points[at(p)].mutex);
    const red::status s = tell([&](auto& index) { return index.mark_bad(p); });
    if (!points[at(p)].bad) points[at(p)].observers.clear();
    points[at(p)].bad = true;
    return s;
  }
  red::status set_slot(int k, int slot, int p) {
    const std::lock_guard<std::mutex> lock(keyframes[at(k)].mutex);
    const red::status s = tell([&](auto& index) { return index.set_slot(k, slot, p); });
    if (s == red::status::ok) keyframes[at(k)].points[at(slot)] = p;
    return s;
  }
  red::status clear_slot(int k, int slot) {
    const std::lock_guard<std::mutex> lock(keyframes[at(k)].mutex);
    const red::status s = tell([&](auto& index) { return index.clear_slot(k, slot); });
    if (s == red::status::ok) keyframes[at(k)].points[at(slot)] = none;
    return s;
  }

  std::map<int, red::observation> observers_of(int p) {
    const std::lock_guard<std::mutex> lock(points[at(p)].mutex);
    return points[at(p)].observers;
  }
  std::vector<int> points_of(int k) {
    const std::lock_guard<std::mutex> lock(keyframes[at(k)].mutex);
    return keyframes[at(k)].points;
  }

  // The rule.
  red::verdict oracle(int k) const {
    const keyframe_data& kf = keyframes[at(k)];
    if (!kf.known) return {red::status::unknown_keyframe};
    if (kf.removed) return {red::status::removed_keyframe};
    red::verdict v;
    for (std::size_t i = 0; i != kf.points.size(); ++i) {
      if (kf.points[i] == none || points[at(kf.points[i])].bad || !kf.eligible[i]) continue;
      ++v.eligible_slots;
      int better = 0;
      for (const auto& o : points[at(kf.points[i])].observers)
        if (o.first != k && o.second.level <= kf.levels[i] + rule.slack) ++better;
      if (better >= rule.others) ++v.redundant_slots;
    }
    v.redundant = v.redundant_slots * rule.denominator > v.eligible_slots * rule.numerator;
    return v;
  }
  // Whether the exact indices give the oracle's answer about each keyframe.
  ::testing::AssertionResult agrees() const {
    for (int k = 0; k != static_cast<int>(keyframes.size()); ++k) {
      const red::verdict expected = oracle(k);
      const auto same = [&](const char* who, const red::verdict& v) {
        return v.result == expected.result && v.redundant == expected.redundant &&
                       v.eligible_slots == expected.eligible_slots &&
                       v.redundant_slots == expected.redundant_slots
                   ? ::testing::AssertionSuccess()
                   : ::testing::AssertionFailure()
                         << who << ", keyframe " << k << ": " << red::name_of(v.result) << ", "
                         << v.redundant_slots << " of " << v.eligible_slots << " instead of "
                         << red::name_of(expected.result) << ", " << expected.redundant_slots
                         << " of " << expected.eligible_slots;
      };
      if (const auto a = same("level_histogram", histogram.check(k)); !a) return a;
      if (const auto a = same("connection_sets", sets.check(k)); !a) return a;
      if (const auto a = same("recompute", recompute.check(k)); !a) return a;
    }
    return ::testing::AssertionSuccess();
  }
};

// Keyframes with slots of random levels, most of them eligible.
template <class World, class Random>
void make_keyframes(World& w, int slots, Random& random) {
  const auto levels = static_cast<unsigned>(World::view::levels);
  for (auto& k : w.keyframes) {
    for (int i = 0; i != slots; ++i) {
      k.points.push_back(none);
      k.levels.push_back(static_cast<int>(random() % levels));
      k.eligible.push_back(random() % 8 != 0);
    }
  }
}

}  // namespace redundancy_test
