// A map in the manner of ORB-SLAM, with a redundancy index over it: which calls to hook in, and what to say there.
//
// Index<view> is one of slamgc::redundancy's, and State its states; no_index has none, to see what the map alone costs.
#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <slamgc/redundancy.hpp>
#include <unordered_map>
#include <utility>
#include <vector>

#include "recorded_session.hpp"

// What each index keeps in a keyframe and in a point.
struct no_state {};
struct recompute_states {
  template <class K, class P>
  using keyframe = slamgc::redundancy::keyframe_counts<>;
  template <class K, class P>
  using point = no_state;
};
struct level_histogram_states {
  template <class K, class P>
  using keyframe = slamgc::redundancy::keyframe_counts<>;
  template <class K, class P>
  using point = slamgc::redundancy::point_levels<K>;
};
struct connection_sets_states {
  template <class K, class P>
  using keyframe = slamgc::redundancy::keyframe_connections<K>;
  template <class K, class P>
  using point = slamgc::redundancy::point_connections<K>;
};
struct published_states {
  template <class K, class P>
  using keyframe = slamgc::redundancy::keyframe_published<K, P>;
  template <class K, class P>
  using point = no_state;
};
struct no_states {
  template <class K, class P>
  using keyframe = no_state;
  template <class K, class P>
  using point = no_state;
};

template <class States>
struct orb {
  struct MapPoint;
  struct KeyPoint {  // as cv::KeyPoint
    float x, y, size, angle, response;
    int octave, class_id;
  };
  struct KeyFrame {
    int mnId = 0;
    bool mbBad = false;
    std::mutex mMutexFeatures;
    std::vector<MapPoint*> mvpMapPoints;
    std::vector<KeyPoint> mvKeysUn;
    typename States::template keyframe<KeyFrame*, MapPoint*> redundancy;  // new
  };
  struct MapPoint {
    int mnId = 0;
    bool mbBad = false;
    std::mutex mMutexFeatures;
    std::map<KeyFrame*, std::pair<int, int>> mObservations;
    typename States::template point<KeyFrame*, MapPoint*> redundancy;  // new
  };

  // What the index may ask.
  struct view {
    using keyframe = KeyFrame*;
    using point = MapPoint*;
    using observation = slamgc::redundancy::observation;
    static constexpr int levels = 8;

    auto& keyframe_state(KeyFrame* pKF) const { return pKF->redundancy; }
    auto& point_state(MapPoint* pMP) const { return pMP->redundancy; }
    auto lock_slots(KeyFrame* pKF) const {
      return std::lock_guard<std::mutex>(pKF->mMutexFeatures);
    }
    auto lock_observations(MapPoint* pMP) const {
      return std::lock_guard<std::mutex>(pMP->mMutexFeatures);
    }
    bool is_null(MapPoint* pMP) const { return pMP == nullptr; }
    bool bad(MapPoint* pMP) const { return pMP->mbBad; }
    bool find(MapPoint* pMP, KeyFrame* pKF, observation& o) const {
      const auto it = pMP->mObservations.find(pKF);
      if (it == pMP->mObservations.end()) return false;
      o = {it->second.first, level(pKF, it->second.first)};
      return true;
    }
    template <class F>
    void observers(MapPoint* pMP, F f) const {
      for (const auto& o : pMP->mObservations)
        if (!f(o.first, observation{o.second.first, level(o.first, o.second.first)})) return;
    }
    int slots(KeyFrame* pKF) const { return static_cast<int>(pKF->mvpMapPoints.size()); }
    int level(KeyFrame* pKF, int slot) const { return pKF->mvKeysUn[at(slot)].octave; }
    bool eligible(KeyFrame*, int) const {
      return true;
    }  // with depth: eligible_by_depth(mvDepth[slot], mThDepth)
    MapPoint* slot(KeyFrame* pKF, int slot) const { return pKF->mvpMapPoints[at(slot)]; }
  };

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
};

// Index that does nothing.
template <class View>
struct no_index {
  using status = slamgc::redundancy::status;
  explicit no_index(const View&, const slamgc::redundancy::rule&) {}
  template <class... A>
  status add_keyframe(const A&...) {
    return status::ok;
  }
  template <class... A>
  status remove_keyframe(const A&...) {
    return status::ok;
  }
  template <class... A>
  status set_observation(const A&...) {
    return status::ok;
  }
  template <class... A>
  status erase_observation(const A&...) {
    return status::ok;
  }
  template <class... A>
  status mark_bad(const A&...) {
    return status::ok;
  }
  template <class... A>
  status set_slot(const A&...) {
    return status::ok;
  }
  template <class... A>
  status clear_slot(const A&...) {
    return status::ok;
  }
};

// The map, and the functions of ORB-SLAM that change it; each has one line more.
template <class States, template <class> class Index>
class orb_map {
 public:
  using KeyFrame = typename orb<States>::KeyFrame;
  using MapPoint = typename orb<States>::MapPoint;
  using view = typename orb<States>::view;

  orb_map(const recorded_session& session, const slamgc::redundancy::rule& rule)
      : index(view{}, rule),
        session_(session),
        keyframes_(session.levels.size()),
        points_(at(session.points)) {}

  Index<view> index;

  void AddKeyFrame(KeyFrame* pKF) {  // at the end of KeyFrame's constructor
    const std::lock_guard<std::mutex> lock(pKF->mMutexFeatures);
    must(index.add_keyframe(pKF));
  }
  void SetBadFlag(KeyFrame* pKF) {
    const std::lock_guard<std::mutex> lock(pKF->mMutexFeatures);
    must(index.remove_keyframe(pKF));
    pKF->mbBad = true;
  }
  void AddObservation(MapPoint* pMP, KeyFrame* pKF, int idx) {
    const std::lock_guard<std::mutex> lock(pMP->mMutexFeatures);
    must(index.set_observation(
        pKF, pMP, slamgc::redundancy::observation{idx, pKF->mvKeysUn[at(idx)].octave}));
    pMP->mObservations[pKF] = {idx, -1};
  }
  void EraseObservation(MapPoint* pMP, KeyFrame* pKF) {
    const std::lock_guard<std::mutex> lock(pMP->mMutexFeatures);
    const auto it = pMP->mObservations.find(pKF);
    if (it == pMP->mObservations.end()) return;
    must(index.erase_observation(pKF, pMP));
    pMP->mObservations.erase(it);
  }
  void SetBadFlag(MapPoint* pMP) {  // and Replace(): the slots follow
    const std::lock_guard<std::mutex> lock(pMP->mMutexFeatures);
    must(index.mark_bad(pMP));
    pMP->mbBad = true;
    pMP->mObservations.clear();
  }
  void AddMapPoint(KeyFrame* pKF, MapPoint* pMP, int idx) {  // and ReplaceMapPointMatch()
    const std::lock_guard<std::mutex> lock(pKF->mMutexFeatures);
    must(index.set_slot(pKF, idx, pMP));
    pKF->mvpMapPoints[at(idx)] = pMP;
  }
  void EraseMapPointMatch(KeyFrame* pKF, int idx) {
    const std::lock_guard<std::mutex> lock(pKF->mMutexFeatures);
    if (pKF->mvpMapPoints[at(idx)] == nullptr) return;
    must(index.clear_slot(pKF, idx));
    pKF->mvpMapPoints[at(idx)] = nullptr;
  }

  // One event of a recorded session, other than a pass.
  void replay(const recorded_event& e) {
    switch (e.what) {
      case recorded_event::new_keyframe:
        construct(e.keyframe);
        break;
      case recorded_event::remove_keyframe:
        SetBadFlag(keyframe(e.keyframe));
        break;
      case recorded_event::observe:
        AddObservation(point(e.point), keyframe(e.keyframe), e.slot);
        break;
      case recorded_event::unobserve:
        EraseObservation(point(e.point), keyframe(e.keyframe));
        break;
      case recorded_event::mark_bad:
        SetBadFlag(point(e.point));
        break;
      case recorded_event::set_slot:
        AddMapPoint(keyframe(e.keyframe), point(e.point), e.slot);
        break;
      case recorded_event::clear_slot:
        EraseMapPointMatch(keyframe(e.keyframe), e.slot);
        break;
      case recorded_event::pass:
        break;
    }
  }

  KeyFrame* keyframe(int id) { return keyframes_[at(id)].get(); }
  MapPoint* point(int id) {
    auto& p = points_[at(id)];
    if (p == nullptr) {
      p = std::make_unique<MapPoint>();
      p->mnId = id;
    }
    return p.get();
  }

  // Gives back what the index keeps besides the objects; it must not be used any more.
  void forget_index() {
    for (auto& k : keyframes_)
      if (k != nullptr) renew(k->redundancy);
    for (auto& p : points_)
      if (p != nullptr) renew(p->redundancy);
  }

  // The keyframes that share points with this one, best first; ORB-SLAM3 looks at 100.
  std::vector<KeyFrame*> GetBestCovisibilityKeyFrames(KeyFrame* pKF, std::size_t most = 100) const {
    std::unordered_map<KeyFrame*, int> weights;
    for (const MapPoint* pMP : pKF->mvpMapPoints) {
      if (pMP == nullptr || pMP->mbBad) continue;
      for (const auto& o : pMP->mObservations)
        if (o.first != pKF && !o.first->mbBad) ++weights[o.first];
    }
    std::vector<std::pair<KeyFrame*, int>> sorted(weights.begin(), weights.end());
    std::sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second > b.second : a.first->mnId < b.first->mnId;
    });
    std::vector<KeyFrame*> best;
    for (const auto& s : sorted)
      if (best.size() < most) best.push_back(s.first);
    return best;
  }

 private:
  template <class T>
  static void renew(T& t) {
    t.~T();
    new (&t) T;
  }
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  static void must(slamgc::redundancy::status s) {
    if (s == slamgc::redundancy::status::ok) return;
    std::fprintf(stderr, "redundancy: %s\n", slamgc::redundancy::name_of(s));
    std::abort();
  }
  void construct(int id) {
    auto& k = keyframes_[at(id)];
    if (k != nullptr) return;
    k = std::make_unique<KeyFrame>();
    k->mnId = id;
    k->mvpMapPoints.resize(session_.levels[at(id)].size());
    for (const int level : session_.levels[at(id)])
      k->mvKeysUn.push_back({0, 0, 0, 0, 0, level, -1});
    AddKeyFrame(k.get());
  }

  const recorded_session& session_;
  std::vector<std::unique_ptr<KeyFrame>> keyframes_;
  std::vector<std::unique_ptr<MapPoint>> points_;
};
