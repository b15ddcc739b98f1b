// What the threads do besides changing the map: per frame and keyframe the reading that ORB-SLAM3 does, over real pointers.
// Features and descriptors are made up; which keyframe and point is read, how often, and under which lock, is not.
#pragma once

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <vector>

#include "world.hpp"

namespace replay {

// Not inlined: the functions whose instructions scripts/count_replay counts.

constexpr std::size_t most_local_keyframes = 80, best_neighbours = 10, candidates_per_point = 8;

// Tracking: from the frame's matches to its local map, and new matches there.
template <class S>
class tracking_work {
  using Frame = KeyFrame<S>;
  using Point = MapPoint<S>;

 public:
  tracking_work() : features_(1000) {
    for (std::size_t i = 0; i != features_.size(); ++i)
      for (std::size_t j = 0; j != 4; ++j) features_[i][j] = mixed(i, j);
  }

  void begin() { current_.clear(), given_ = false; }
  // The points that were matched in the recorded frame.
  void matched(world<S>& w, const int* ids, int n) {
    given_ = true;
    for (int i = 0; i != n; ++i)
      if (Point* const p = w.point(ids[i])) current_.push_back(S::template local_of<Point>(p));
  }
  __attribute__((noinline)) void end(world<S>& w, long frame, Frame* reference) {
    check_replaced(w);
    if (!given_ && reference != nullptr)  // as TrackReferenceKeyFrame
      for (auto& p : reference->GetMapPointMatches())
        if (S::raw(p) != nullptr && !S::raw(p)->isBad()) current_.push_back(p);
    update_local_keyframes();
    update_local_points(frame);
    search_local_points();
    optimize_pose();
    need_new_keyframe(reference);
    w.map.SetReferenceMapPoints(local_points_);
    S::assign(w.tracker.mvpLocalKeyFrames, local_keyframes_);
    S::assign(w.tracker.mvpLocalMapPoints, local_points_);
    S::end_frame(w.tracker.mvpLocalKeyFrames);
    S::end_frame(w.tracker.mvpLocalMapPoints);
    S::assign(w.tracker.mLastFrame_mvpMapPoints, current_);
    w.tracker.mpReferenceKF = reference;
    current_.clear();
    local_keyframes_.clear();
    local_points_.clear();
  }

 private:
  void check_replaced(world<S>& w) {
    for (const auto& element : w.tracker.mLastFrame_mvpMapPoints) {
      const auto p = S::template local_of<Point>(element);
      if (S::raw(p) != nullptr && S::raw(S::raw(p)->GetReplaced()) != nullptr) ++mine().work;
    }
  }
  void update_local_keyframes() {
    std::unordered_map<Frame*, int> votes;
    locals<S, Frame> seen;
    for (const auto& p : current_) {
      if (S::raw(p)->isBad()) continue;
      for (auto& of : S::raw(p)->GetObservations())
        if (votes[S::raw(of.first)]++ == 0) seen.push_back(std::move(of.first));
    }
    const auto add = [&](local<S, Frame> kf) {
      if (S::raw(kf) == nullptr || S::raw(kf)->isBad()) return;
      int& vote = votes[S::raw(kf)];
      if (vote < 0) return;
      vote = -1;
      local_keyframes_.push_back(std::move(kf));
    };
    for (auto& kf : seen) add(std::move(kf));
    for (std::size_t i = 0;
         i != local_keyframes_.size() && local_keyframes_.size() < most_local_keyframes; ++i) {
      Frame* const kf = S::raw(local_keyframes_[i]);
      for (auto& neighbour : kf->GetBestCovisibilityKeyFrames(best_neighbours))
        add(std::move(neighbour));
      for (auto& child : kf->GetChilds()) add(std::move(child));
      add(kf->GetParent());
    }
  }
  void update_local_points(long frame) {
    for (const auto& kf : local_keyframes_)
      for (auto& p : S::raw(kf)->GetMapPointMatches()) {
        if (S::raw(p) == nullptr || S::raw(p)->mnTrackReferenceForFrame == frame) continue;
        S::raw(p)->mnTrackReferenceForFrame = frame;
        if (!S::raw(p)->isBad()) local_points_.push_back(std::move(p));
      }
  }
  void search_local_points() {
    unsigned best = 256;
    for (const auto& p : local_points_) {
      const auto at = S::raw(p)->GetWorldPos();
      const descriptor d = S::raw(p)->GetDescriptor();
      const std::size_t first = static_cast<std::size_t>(d[0] + static_cast<std::uint64_t>(at[0])) %
                                (features_.size() - candidates_per_point);
      for (std::size_t i = 0; i != candidates_per_point; ++i)
        best = std::min(best, distance(d, features_[first + i]));
    }
    mine().work += best;
  }
  void optimize_pose() {
    float error = 0;
    for (int iteration = 0; iteration != 40; ++iteration)
      for (const auto& p : current_) {
        const auto& at = S::raw(p)->own.mNormalVector;
        error += std::sqrt(at[0] * at[0] + at[1] * at[1] + 1.F) / (at[2] + 1.F);
      }
    mine().work += static_cast<std::uint64_t>(error);
  }
  void need_new_keyframe(Frame* reference) {
    if (reference == nullptr) return;
    for (const auto& p : reference->GetMapPointMatches())
      if (S::raw(p) != nullptr && !S::raw(p)->isBad())
        mine().work += S::raw(p)->Observations() >= 3;
  }
  static role_ledger& mine() { return ledger::now().mine(); }

  std::vector<descriptor> features_;
  locals<S, Point> current_, local_points_;
  locals<S, Frame> local_keyframes_;
  bool given_ = false;
};

// Local mapping: which of the neighbours are redundant, and the window of a bundle adjustment.
template <class S>
__attribute__((noinline)) void mapping_work(KeyFrame<S>* current) {
  std::uint64_t redundant = 0;
  const auto neighbours = current->GetBestCovisibilityKeyFrames(100);
  for (const auto& neighbour : neighbours) {
    KeyFrame<S>* const kf = S::raw(neighbour);
    if (kf->isBad()) continue;
    const auto points = kf->GetMapPointMatches();
    std::size_t seen = 0, better = 0;
    for (std::size_t i = 0; i != points.size(); ++i) {
      MapPoint<S>* const p = S::raw(points[i]);
      if (p == nullptr || p->isBad()) continue;
      ++seen;
      if (p->Observations() <= 3) continue;
      int others = 0;
      for (const auto& of : p->GetObservations()) {
        KeyFrame<S>* const other = S::raw(of.first);
        if (other != kf && other->mvOctaves[of.second] <= kf->mvOctaves[i] + 1 && ++others > 3)
          break;
      }
      better += others > 3;
    }
    redundant += 10 * better > 9 * seen;
  }

  std::vector<std::array<float, 3>> window;
  for (std::size_t n = 0; n != std::min<std::size_t>(neighbours.size(), 20); ++n)
    for (const auto& p : S::raw(neighbours[n])->GetMapPointMatches())
      if (S::raw(p) != nullptr && !S::raw(p)->isBad())
        for (std::size_t i = S::raw(p)->Observations(); i != 0; --i)
          window.push_back(S::raw(p)->GetWorldPos());
  float error = 0;
  for (int iteration = 0; iteration != 5; ++iteration)
    for (const auto& at : window)
      error += std::sqrt(at[0] * at[0] + at[1] * at[1] + 1.F) / (at[2] + 1.F);
  ledger::now().mine().work += redundant + static_cast<std::uint64_t>(error);
}

// What a global adjustment works on, kept while it works.
template <class S>
class adjustment_work {
 public:
  void begin(world<S>& w) {
    for (const auto& kf : w.map.GetAllKeyFrames()) keyframes_.push_back(S::hold(kf));
    for (const auto& p : w.map.GetAllMapPoints()) points_.push_back(S::hold(p));
  }
  void compute() {
    float sum = 0;
    for (int iteration = 0; iteration != 10; ++iteration)
      for (const auto& p : points_) sum += S::raw(p)->GetWorldPos()[0] + 1.F;
    ledger::now().mine().work += static_cast<std::uint64_t>(sum);
  }
  void end() {
    keyframes_.clear();
    points_.clear();
  }

 private:
  template <class T>
  using held = owning_vector<S, decltype(S::hold(std::declval<const local<S, T>&>()))>;
  held<KeyFrame<S>> keyframes_;
  held<MapPoint<S>> points_;
};

// The viewer: all keyframes with their tree, and the points of tracking's local map.
template <class S>
void viewer_work(world<S>& w) {
  std::uint64_t drawn = 0;
  for (const auto& kf : w.map.GetAllKeyFrames()) {
    drawn += S::raw(kf)->Connections();
    drawn += S::raw(S::raw(kf)->GetParent()) != nullptr;
  }
  for (const auto& p : w.map.GetReferenceMapPoints()) drawn += !S::raw(p)->isBad();
  ledger::now().mine().work += drawn;
}

}  // namespace replay
