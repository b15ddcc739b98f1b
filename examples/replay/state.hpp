// What a map is in the end, by content: to compare schemes with each other and with what the recorded system had in memory.
#pragma once

#include <array>
#include <map>
#include <string>
#include <vector>

#include "world.hpp"

namespace replay {

// By letter, as in the final dumps of recorded sessions: k kf bad, p mp bad, R mp by, T kf parent, N kf previous next, C kf other weight,
// s kf index mp, O kf mp index, H kf child, G kf other, Q kf in the database, K and P in the map, r frames' references in order.
struct map_state {
  using entry = std::array<int, 3>;
  std::map<char, std::vector<entry>> kinds;

  void add(char letter, int a, int b = -1, int c = -1) { kinds[letter].push_back({a, b, c}); }
  void sort();
};

// Throws bad_trace, also if it has ids that the session has not.
map_state read_final_state(const std::string& path, const session& of);

// What of it does not concern objects that the session marks. Links in time step over them (letter n).
map_state live_part(const map_state& all, const session& of);

// One line for each kind that differs; empty: equal.
std::vector<std::string> differences(const map_state& a, const map_state& b);

template <class S>
map_state state_of(world<S>& w) {
  map_state s;
  for (const auto& handle : w.keyframes) {
    KeyFrame<S>* const kf = S::raw(handle);
    if (kf == nullptr) continue;
    const int id = static_cast<int>(kf->mnId);
    const auto id_of = [](auto* p) {
      if (p == nullptr) return -1;
      p->used();
      return static_cast<int>(p->mnId);
    };
    s.add('k', id, kf->mbBad);
    if (S::plain(kf->mpParent) != nullptr) s.add('T', id, id_of(S::plain(kf->mpParent)));
    const int previous = id_of(S::plain(kf->mPrevKF)), next = id_of(S::plain(kf->mNextKF));
    if (previous >= 0 || next >= 0) s.add('N', id, previous, next);
    if (!kf->mbBad) {
      auto* before = S::plain(kf->mPrevKF);
      auto* after = S::plain(kf->mNextKF);
      while (before != nullptr && before->mbBad) before = S::plain(before->mPrevKF);
      while (after != nullptr && after->mbBad) after = S::plain(after->mNextKF);
      s.add('n', id, id_of(before), id_of(after));
    }
    for (const auto& entry : kf->mConnectedKeyFrameWeights)
      s.add('C', id, id_of(S::plain(entry.first)), entry.second);
    int slot = -1;
    for (const auto& element : kf->mvpMapPoints)
      if (++slot, S::plain(element) != nullptr) s.add('s', id, slot, id_of(S::plain(element)));
    for (const auto& child : kf->mspChildrens) s.add('H', id, id_of(S::plain(child)));
    for (const auto& other : kf->mspLoopEdges) s.add('G', id, id_of(S::plain(other)));
    if (w.database.contains(kf)) s.add('Q', id);
  }
  for (const auto& handle : w.points) {
    MapPoint<S>* const p = S::raw(handle);
    if (p == nullptr) continue;
    const int id = static_cast<int>(p->mnId);
    s.add('p', id, p->mbBad);
    if (auto* const by = S::plain(p->mpReplaced)) s.add('R', id, static_cast<int>(by->mnId));
    for (const auto& seen : p->mObservations)
      if (auto* const kf = S::plain(seen.first))
        s.add('O', static_cast<int>(kf->mnId), id, static_cast<int>(seen.second));
  }
  for (const auto& kf : w.map.mspKeyFrames) s.add('K', static_cast<int>(S::plain(kf)->mnId));
  for (const auto& p : w.map.mspMapPoints) s.add('P', static_cast<int>(S::plain(p)->mnId));
  int frame = 0;
  for (const auto& reference : w.tracker.mlpReferences)
    s.add('r', frame++, static_cast<int>(S::id_of(reference)));
  s.sort();
  return s;
}

}  // namespace replay
