#include "ORBmatcher.h"

#include <set>

#include "Frame.h"
#include "KeyFrame.h"
#include "MapPoint.h"

namespace mini_orb {
namespace {

// The feature near the projection of a place that looks most like a descriptor, and for which free(i) holds; or -1.
template <class Free>
int Nearest(const Features& in, const Pose& Tcw, const Vector3d& place,
            const Descriptor& descriptor, double th, Free free) {
  double u, v;
  if (!Camera::Project(Tcw * place, u, v)) return -1;
  int best = -1, bestDistance = ORBmatcher::TH_LOW + 1;
  for (const std::size_t i : in.GetFeaturesInArea(u, v, th)) {
    if (!free(i)) continue;
    const int distance = Features::Distance(in.mDescriptors[i], descriptor);
    if (distance < bestDistance) best = static_cast<int>(i), bestDistance = distance;
  }
  return best;
}

// Calls found(i, j) for features with common words that look alike.
template <class Found>
void EachAlike(const Features& a, const Features& b, Found found) {
  for (const auto& [node, of_a] : a.mFeatVec) {
    const auto it = b.mFeatVec.find(node);
    if (it == b.mFeatVec.end()) continue;
    for (const unsigned i : of_a)
      for (const unsigned j : it->second)
        if (Features::Distance(a.mDescriptors[i], b.mDescriptors[j]) <= ORBmatcher::TH_LOW)
          found(i, j);
  }
}

}  // namespace

int ORBmatcher::SearchByProjection(Frame& F, const std::vector<MapPoint*>& vpMapPoints, double th) {
  int n = 0;
  for (MapPoint* pMP : vpMapPoints) {
    if (pMP->mnLastFrameSeen == F.mnId || pMP->isBad()) continue;
    const int i = Nearest(F, F.mTcw, pMP->GetWorldPos(), pMP->GetDescriptor(), th,
                          [&](std::size_t at) { return F.mvpMapPoints[at] == nullptr; });
    double u, v;
    if (Camera::Project(F.mTcw * pMP->GetWorldPos(), u, v)) pMP->IncreaseVisible();
    if (i < 0) continue;
    F.mvpMapPoints[static_cast<std::size_t>(i)] = pMP;
    ++n;
  }
  return n;
}

int ORBmatcher::SearchByProjection(Frame& CurrentFrame, const Frame& LastFrame, double th) {
  int n = 0;
  for (std::size_t j = 0; j != LastFrame.mvpMapPoints.size(); ++j) {
    MapPoint* const pMP = LastFrame.mvpMapPoints[j];
    if (pMP == nullptr || LastFrame.mvbOutlier[j]) continue;
    const int i =
        Nearest(CurrentFrame, CurrentFrame.mTcw, pMP->GetWorldPos(), pMP->GetDescriptor(), th,
                [&](std::size_t at) { return CurrentFrame.mvpMapPoints[at] == nullptr; });
    if (i < 0) continue;
    CurrentFrame.mvpMapPoints[static_cast<std::size_t>(i)] = pMP;
    ++n;
  }
  return n;
}

int ORBmatcher::SearchByBoW(KeyFrame* pKF, const Frame& F, std::vector<MapPoint*>& vpMatches) {
  int n = 0;
  const std::vector<MapPoint*> points = pKF->GetMapPointMatches();
  vpMatches.assign(F.mDescriptors.size(), nullptr);
  EachAlike(*pKF, F, [&](std::size_t i, std::size_t j) {
    if (points[i] == nullptr || points[i]->isBad() || vpMatches[j] != nullptr) return;
    vpMatches[j] = points[i];
    ++n;
  });
  return n;
}

int ORBmatcher::SearchByBoW(KeyFrame* pKF1, KeyFrame* pKF2, std::vector<MapPoint*>& vpMatches12) {
  int n = 0;
  const std::vector<MapPoint*> points = pKF2->GetMapPointMatches();
  vpMatches12.assign(pKF1->mDescriptors.size(), nullptr);
  EachAlike(*pKF1, *pKF2, [&](std::size_t i, std::size_t j) {
    if (points[j] == nullptr || points[j]->isBad() || vpMatches12[i] != nullptr) return;
    vpMatches12[i] = points[j];
    ++n;
  });
  return n;
}

int ORBmatcher::SearchForTriangulation(KeyFrame* pKF1, KeyFrame* pKF2,
                                       std::vector<std::pair<std::size_t, std::size_t>>& vMatched) {
  vMatched.clear();
  std::set<std::size_t> taken;
  EachAlike(*pKF1, *pKF2, [&](std::size_t i, std::size_t j) {
    if (pKF1->GetMapPoint(i) != nullptr || pKF2->GetMapPoint(j) != nullptr) return;
    if (!taken.insert(i).second) return;
    vMatched.emplace_back(i, j);
  });
  return static_cast<int>(vMatched.size());
}

int ORBmatcher::Fuse(KeyFrame* pKF, const std::vector<MapPoint*>& vpMapPoints, double th,
                     std::vector<MapPoint*>* pvpReplace) {
  int n = 0;
  for (std::size_t k = 0; k != vpMapPoints.size(); ++k) {
    MapPoint* const pMP = vpMapPoints[k];
    if (pMP == nullptr || pMP->isBad() || pMP->IsInKeyFrame(pKF)) continue;
    const int found = Nearest(*pKF, pKF->GetPose(), pMP->GetWorldPos(), pMP->GetDescriptor(), th,
                              [](std::size_t) { return true; });
    if (found < 0) continue;
    const auto i = static_cast<std::size_t>(found);
    MapPoint* const pMPinKF = pKF->GetMapPoint(i);
    if (pMPinKF == nullptr) {
      pMP->AddObservation(pKF, found);
      pKF->AddMapPoint(pMP, i);
    } else if (!pMPinKF->isBad()) {
      if (pvpReplace != nullptr)
        (*pvpReplace)[k] = pMPinKF;
      else if (pMPinKF->Observations() > pMP->Observations())
        pMP->Replace(pMPinKF);
      else
        pMPinKF->Replace(pMP);
    }
    ++n;
  }
  return n;
}

}  // namespace mini_orb
