#include "Optimizer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "Frame.h"
#include "KeyFrame.h"
#include "Map.h"
#include "MapPoint.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;

namespace {

constexpr double kInlier = 0.15;  // metres between where a feature is seen and where its point is

std::size_t LeftIndex(const std::tuple<int, int>& indexes) {
  return static_cast<std::size_t>(std::get<0>(indexes));
}

// The way from the identity to a transformation, up to a fraction between 0 and 1.
Pose Part(const Pose& of, double fraction) {
  Pose part(Eigen::Quaterniond::Identity().slerp(fraction, Eigen::Quaterniond(of.linear())));
  part.translation() = fraction * of.translation();
  return part;
}

// Places in a camera, and where they are in the world; returns the Tcw that fits best.
class Fit {
 public:
  void Add(const Vector3d& camera, const Vector3d& world) {
    ++n_;
    camera_ += camera;
    world_ += world;
    products_ += camera * world.transpose();
  }
  int Count() const { return n_; }
  Pose Tcw() const {
    const Eigen::Matrix3d centred = products_ - camera_ * world_.transpose() / n_;
    const double yaw = std::atan2(centred(1, 0) - centred(0, 1), centred(0, 0) + centred(1, 1));
    Pose pose(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()));
    pose.translation() = (camera_ - pose.linear() * world_) / n_;
    return pose;
  }

 private:
  int n_ = 0;
  Vector3d camera_ = Vector3d::Zero(), world_ = Vector3d::Zero();  // sums
  Eigen::Matrix3d products_ = Eigen::Matrix3d::Zero();             // sum of camera times world
};

}  // namespace

int Optimizer::PoseOptimization(Frame* pFrame) {
  lock_guard<mutex> lock(MapPoint::mGlobalMutex);
  int inliers = 0;
  for (int round = 0; round != 3; ++round) {
    Fit fit;
    for (std::size_t i = 0; i != pFrame->mvpMapPoints.size(); ++i)
      if (MapPoint* const pMP = pFrame->mvpMapPoints[i])
        if (!pFrame->mvbOutlier[i] && pFrame->mvDepth[i] > 0)
          fit.Add(pFrame->InCamera(i), pMP->GetWorldPos());
    if (fit.Count() < 5) return 0;
    pFrame->SetPose(fit.Tcw());
    inliers = 0;
    for (std::size_t i = 0; i != pFrame->mvpMapPoints.size(); ++i) {
      MapPoint* const pMP = pFrame->mvpMapPoints[i];
      if (pMP == nullptr || pFrame->mvDepth[i] <= 0) continue;
      const Vector3d error = pFrame->mTcw * pMP->GetWorldPos() - pFrame->InCamera(i);
      pFrame->mvbOutlier[i] = error.norm() > (round == 0 ? 4 : 1) * kInlier;
      if (!pFrame->mvbOutlier[i]) ++inliers;
    }
  }
  return inliers;
}

void Optimizer::LocalBundleAdjustment(KeyFrame* pKF, const Racy<bool>* pbStopFlag, Map* pMap) {
  std::vector<KeyFrame*> localKFs{pKF};
  for (KeyFrame* pNeighbour : pKF->GetVectorCovisibleKeyFrames())
    if (!pNeighbour->isBad() && pNeighbour->GetMap() == pMap) localKFs.push_back(pNeighbour);
  std::set<MapPoint*, ById> localMPs;
  for (KeyFrame* pLocal : localKFs)
    for (MapPoint* pMP : pLocal->GetMapPointMatches())
      if (pMP != nullptr && !pMP->isBad()) localMPs.insert(pMP);

  // Each edge of the problem: who sees what, and where. Poses of those that are not local are fixed.
  struct Edge {
    MapPoint* pMP;
    KeyFrame* pKF;
    Vector3d camera;
  };
  KeyFrameAndPose poses;
  std::map<MapPoint*, Vector3d, ById> places;
  std::vector<Edge> edges;
  for (MapPoint* pMP : localMPs) {
    places[pMP] = pMP->GetWorldPos();
    for (const auto& [pObserver, indexes] : pMP->GetObservations()) {
      if (pObserver->isBad() || pObserver->GetMap() != pMap) continue;
      const std::size_t i = LeftIndex(indexes);
      if (pObserver->mvDepth[i] <= 0) continue;
      edges.push_back({pMP, pObserver, pObserver->InCamera(i)});
      poses.emplace(pObserver, pObserver->GetPose());
    }
  }
  for (int iteration = 0; iteration != 4; ++iteration) {
    if (*pbStopFlag) break;
    std::map<MapPoint*, std::pair<int, Vector3d>, ById> sums;
    for (const Edge& edge : edges) {
      auto& [n, sum] = sums.try_emplace(edge.pMP, 0, Vector3d::Zero()).first->second;
      sum += poses[edge.pKF].inverse() * edge.camera;
      ++n;
    }
    for (const auto& [pMP, sum] : sums) places[pMP] = sum.second / sum.first;
    std::map<KeyFrame*, Fit, ById> fits;
    for (const Edge& edge : edges) fits[edge.pKF].Add(edge.camera, places[edge.pMP]);
    for (KeyFrame* pLocal : localKFs)
      if (pLocal->mnId != pMap->GetInitKFid() && fits[pLocal].Count() >= 5)
        poses[pLocal] = fits[pLocal].Tcw();
  }
  if (*pbStopFlag) return;

  lock_guard<mutex> lock(pMap->mMutexMapUpdate);
  for (const Edge& edge : edges)
    if ((poses[edge.pKF] * places[edge.pMP] - edge.camera).norm() > 2 * kInlier) {
      edge.pKF->EraseMapPointMatch(LeftIndex(edge.pMP->GetIndexInKeyFrame(edge.pKF)));
      edge.pMP->EraseObservation(edge.pKF);
    }
  for (KeyFrame* pLocal : localKFs)
    if (poses.count(pLocal) != 0) pLocal->SetPose(poses[pLocal]);
  for (const auto& [pMP, place] : places) {
    pMP->SetWorldPos(place);
    pMP->UpdateNormalAndDepth();
  }
}

void Optimizer::GlobalBundleAdjustemnt(Map* pMap, int nIterations, const Racy<bool>* pbStopFlag,
                                       unsigned long nLoopKF) {
  const std::vector<KeyFrame*> vpKFs = pMap->GetAllKeyFrames();
  const std::vector<MapPoint*> vpMP = pMap->GetAllMapPoints();
  // From here on the problem has numbers for keyframes and points.
  struct Edge {
    std::size_t point, keyframe;
    Vector3d camera;
  };
  std::map<KeyFrame*, std::size_t, ById> number;
  std::vector<Pose> poses;
  for (KeyFrame* pKF : vpKFs) {
    number.emplace(pKF, poses.size());
    poses.push_back(pKF->GetPose());
  }
  std::vector<Edge> edges;
  std::vector<Vector3d> places;
  for (MapPoint* pMP : vpMP) {
    for (const auto& [pKF, indexes] : pMP->GetObservations()) {
      const std::size_t i = LeftIndex(indexes);
      const auto it = number.find(pKF);
      if (it != number.end() && pKF->mvDepth[i] > 0)
        edges.push_back({places.size(), it->second, pKF->InCamera(i)});
    }
    places.push_back(pMP->GetWorldPos());
  }
  const auto initial = number.find(pMap->GetOriginKF());
  const std::size_t fixed = initial != number.end() ? initial->second : 0;

  const auto optimize = [&] {
    for (int iteration = 0; iteration != nIterations && !*pbStopFlag; ++iteration) {
      std::vector<Vector3d> sums(places.size(), Vector3d::Zero());
      std::vector<int> counts(places.size(), 0);
      for (const Edge& edge : edges) {
        sums[edge.point] += poses[edge.keyframe].inverse() * edge.camera;
        ++counts[edge.point];
      }
      for (std::size_t i = 0; i != places.size(); ++i)
        if (counts[i] != 0) places[i] = sums[i] / counts[i];
      std::vector<Fit> fits(poses.size());
      for (const Edge& edge : edges) fits[edge.keyframe].Add(edge.camera, places[edge.point]);
      for (std::size_t k = 0; k != poses.size(); ++k)
        if (k != fixed && fits[k].Count() >= 5) poses[k] = fits[k].Tcw();
    }
  };
  optimize();

  lock_guard<mutex> lock(pMap->mMutexMapUpdate);
  if (*pbStopFlag) return;
  for (std::size_t k = 0; k != poses.size(); ++k) {
    vpKFs[k]->mTcwGBA = poses[k];
    vpKFs[k]->mnBAGlobalForKF = nLoopKF;
  }
  for (std::size_t i = 0; i != places.size(); ++i) {
    vpMP[i]->mPosGBA = places[i];
    vpMP[i]->mnBAGlobalForKF = nLoopKF;
  }
}

void Optimizer::OptimizeEssentialGraph(Map* pMap, KeyFrame* pLoopKF, KeyFrame* pCurKF,
                                       const KeyFrameAndPose& NonCorrected,
                                       const KeyFrameAndPose& Corrected,
                                       const std::set<MapPoint*, ById>& CorrectedPoints) {
  const Pose correction =
      Corrected.at(pCurKF).inverse() * NonCorrected.at(pCurKF);  // of the world there
  lock_guard<mutex> lock(pMap->mMutexMapUpdate);
  const double length = static_cast<double>(pCurKF->mnId) - static_cast<double>(pLoopKF->mnId);
  std::map<KeyFrame*, Pose, ById> moved;
  for (KeyFrame* pKF : pMap->GetAllKeyFrames()) {
    if (Corrected.count(pKF) != 0 || pKF->mnId <= pLoopKF->mnId || length <= 0) continue;
    const double way = static_cast<double>(pKF->mnId) - static_cast<double>(pLoopKF->mnId);
    const Pose part = Part(correction, std::min(1.0, way / length));
    moved[pKF] = part;
    pKF->SetPose(pKF->GetPose() * part.inverse());
  }
  for (MapPoint* pMP : pMap->GetAllMapPoints()) {
    KeyFrame* const pRefKF = pMP->GetReferenceKeyFrame();
    const auto it = moved.find(pRefKF);
    if (pRefKF == nullptr || it == moved.end() || CorrectedPoints.count(pMP) != 0) continue;
    pMP->SetWorldPos(it->second * pMP->GetWorldPos());
    pMP->UpdateNormalAndDepth();
  }
  pMap->InformNewBigChange();
}

bool Optimizer::OptimizePose(KeyFrame* pKF1, std::vector<MapPoint*>& vpMatches, std::size_t nMin,
                             Pose& Tcw) {
  std::vector<bool> inlier(vpMatches.size(), true);
  std::size_t inliers = 0;
  for (int round = 0; round != 3; ++round) {
    Fit fit;
    for (std::size_t i = 0; i != vpMatches.size(); ++i)
      if (vpMatches[i] != nullptr && inlier[i] && pKF1->mvDepth[i] > 0)
        fit.Add(pKF1->InCamera(i), vpMatches[i]->GetWorldPos());
    if (fit.Count() < 5) return false;
    Tcw = fit.Tcw();
    inliers = 0;
    for (std::size_t i = 0; i != vpMatches.size(); ++i) {
      if (vpMatches[i] == nullptr || pKF1->mvDepth[i] <= 0) continue;
      inlier[i] = (Tcw * vpMatches[i]->GetWorldPos() - pKF1->InCamera(i)).norm() < 2 * kInlier;
      if (inlier[i]) ++inliers;
    }
  }
  for (std::size_t i = 0; i != vpMatches.size(); ++i)
    if (!inlier[i] || (vpMatches[i] != nullptr && pKF1->mvDepth[i] <= 0)) vpMatches[i] = nullptr;
  return inliers >= nMin;
}

}  // namespace mini_orb
