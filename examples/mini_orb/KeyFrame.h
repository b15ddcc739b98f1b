#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <set>
#include <vector>

#include "Common.h"
#include "Frame.h"
#include "MapPoint.h"

namespace mini_orb {

class KeyFrameDatabase;
class Map;
class MapPoint;

class KeyFrame : public Features, public Instances<KeyFrame> {
 public:
  KeyFrame(const Frame& F, Map* pMap, KeyFrameDatabase* pKFDB);

  void SetPose(const Pose& Tcw);
  Pose GetPose();
  Pose GetPoseInverse();
  Vector3d GetCameraCenter();

  void AddConnection(KeyFrame* pKF, int weight);
  void EraseConnection(KeyFrame* pKF);
  void UpdateConnections(bool upParent = true);
  void UpdateBestCovisibles();
  std::set<KeyFrame*, ById> GetConnectedKeyFrames();
  std::vector<KeyFrame*> GetVectorCovisibleKeyFrames();
  std::vector<KeyFrame*> GetBestCovisibilityKeyFrames(std::size_t n);
  int GetWeight(KeyFrame* pKF);

  void AddChild(KeyFrame* pKF);
  void EraseChild(KeyFrame* pKF);
  void ChangeParent(KeyFrame* pKF);
  std::set<KeyFrame*, ById> GetChilds();
  KeyFrame* GetParent();

  void AddLoopEdge(KeyFrame* pKF);
  std::set<KeyFrame*, ById> GetLoopEdges();
  void AddMergeEdge(KeyFrame* pKF);

  void AddMapPoint(MapPoint* pMP, std::size_t idx);
  void EraseMapPointMatch(std::size_t idx);
  void ReplaceMapPointMatch(std::size_t idx, MapPoint* pMP);
  std::set<MapPoint*, ById> GetMapPoints();
  std::vector<MapPoint*> GetMapPointMatches();
  MapPoint* GetMapPoint(std::size_t idx);
  int TrackedMapPoints(int minObs);
  Vector3d UnprojectStereo(std::size_t i);

  void SetNotErase();
  void SetErase();
  void SetBadFlag();
  bool isBad() const { return mbBad; }

  Map* GetMap();
  void UpdateMap(Map* pMap);

  static Racy<unsigned long> nNextId;
  const unsigned long mnId;
  const unsigned long mnFrameId;
  Racy<unsigned long> mnTrackReferenceForFrame = 0, mnFuseTargetForKF = 0;
  Racy<unsigned long> mnBAGlobalForKF = 0;
  Pose mTcwGBA, mTcwBefGBA;  // of the global BA that comes next
  Racy<KeyFrame*> mPrevKF, mNextKF;
  Pose mTcp;  // to the parent, once it is bad

 private:
  friend class System;

  Pose mTcw;
  std::vector<MapPoint*> mvpMapPoints;
  std::map<KeyFrame*, int, ById> mConnectedKeyFrameWeights;
  std::vector<KeyFrame*> mvpOrderedConnectedKeyFrames;
  std::vector<int> mvOrderedWeights;
  bool mbFirstConnection = true;
  KeyFrame* mpParent = nullptr;
  std::set<KeyFrame*, ById> mspChildrens;
  std::set<KeyFrame*, ById> mspLoopEdges;
  std::set<KeyFrame*, ById> mspMergeEdges;
  Racy<bool> mbNotErase = false, mbToBeErased = false, mbBad = false;
  Map* mpMap;
  KeyFrameDatabase* const mpKeyFrameDB;
  std::mutex mMutexPose, mMutexConnections, mMutexFeatures, mMutexMap;
};

}  // namespace mini_orb
