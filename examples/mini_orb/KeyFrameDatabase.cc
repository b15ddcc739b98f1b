#include "KeyFrameDatabase.h"

#include <algorithm>
#include <map>
#include <utility>

#include "Frame.h"
#include "KeyFrame.h"
#include "Map.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;

KeyFrameDatabase::KeyFrameDatabase() : mvInvertedFile(1u << 16) {}

void KeyFrameDatabase::add(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutex);
  for (const auto& [word, weight] : pKF->mBowVec) mvInvertedFile[word].push_back(pKF);
}

void KeyFrameDatabase::erase(KeyFrame* pKF) {
  lock_guard<mutex> lock(mMutex);
  for (const auto& [word, weight] : pKF->mBowVec) mvInvertedFile[word].remove(pKF);
}

void KeyFrameDatabase::clear() {
  lock_guard<mutex> lock(mMutex);
  for (auto& keyframes : mvInvertedFile) keyframes.clear();
}

void KeyFrameDatabase::clearMap(Map* pMap) {
  lock_guard<mutex> lock(mMutex);
  for (auto& keyframes : mvInvertedFile)
    keyframes.remove_if([&](KeyFrame* pKF) { return pKF->GetMap() == pMap; });
}

// Best first.
template <class FeaturesOf>
std::vector<KeyFrame*> KeyFrameDatabase::Similar(const FeaturesOf& of, double minScore) {
  std::map<KeyFrame*, int, ById> common;
  {
    lock_guard<mutex> lock(mMutex);
    for (const auto& [word, weight] : of.mBowVec)
      for (KeyFrame* pKF : mvInvertedFile[word]) ++common[pKF];
  }
  std::vector<std::pair<double, KeyFrame*>> scored;
  for (const auto& [pKF, words] : common) {
    const double score = words / static_cast<double>(std::max<std::size_t>(1, of.mBowVec.size()));
    if (score >= minScore && !pKF->isBad()) scored.emplace_back(score, pKF);
  }
  std::stable_sort(scored.begin(), scored.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<KeyFrame*> keyframes;
  for (const auto& [score, pKF] : scored) keyframes.push_back(pKF);
  return keyframes;
}

void KeyFrameDatabase::DetectNBestCandidates(KeyFrame* pKF, std::vector<KeyFrame*>& vpLoopCand,
                                             std::vector<KeyFrame*>& vpMergeCand,
                                             std::size_t nNumCandidates) {
  const auto connected = pKF->GetConnectedKeyFrames();
  for (KeyFrame* pCandidate : Similar(*pKF, 0.4)) {
    if (pCandidate == pKF || connected.count(pCandidate) != 0) continue;
    Map* const pMap = pCandidate->GetMap();
    if (pMap == nullptr || pMap->IsBad()) continue;
    auto& found = pMap == pKF->GetMap() ? vpLoopCand : vpMergeCand;
    if (found.size() < nNumCandidates) found.push_back(pCandidate);
  }
}

std::vector<KeyFrame*> KeyFrameDatabase::DetectRelocalizationCandidates(const Frame& F, Map* pMap) {
  std::vector<KeyFrame*> found;
  for (KeyFrame* pKF : Similar(F, 0.4))
    if (pKF->GetMap() == pMap && found.size() < 5) found.push_back(pKF);
  return found;
}

}  // namespace mini_orb
