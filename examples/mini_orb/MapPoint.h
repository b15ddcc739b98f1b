#pragma once

#include <map>
#include <mutex>
#include <tuple>

#include "Common.h"
#include "Frame.h"
#include "KeyFrame.h"
#include "Map.h"
#include "World.h"

namespace mini_orb {

class KeyFrame;
class Map;

class MapPoint : public Instances<MapPoint> {
 public:
  MapPoint(const Vector3d& Pos, KeyFrame* pRefKF, Map* pMap);
  // Of a frame, in localisation mode: it is in no keyframe.
  MapPoint(const Vector3d& Pos, Map* pMap, const Frame& frame, std::size_t i);

  void SetWorldPos(const Vector3d& Pos);
  Vector3d GetWorldPos();
  Descriptor GetDescriptor();
  KeyFrame* GetReferenceKeyFrame();

  std::map<KeyFrame*, std::tuple<int, int>, ById> GetObservations();
  int Observations();
  void AddObservation(KeyFrame* pKF, int idx);
  void EraseObservation(KeyFrame* pKF);
  std::tuple<int, int> GetIndexInKeyFrame(KeyFrame* pKF);
  bool IsInKeyFrame(KeyFrame* pKF);

  void SetBadFlag();
  bool isBad() const { return mbBad; }
  void Replace(MapPoint* pMP);
  MapPoint* GetReplaced();

  void IncreaseVisible(int n = 1) { mnVisible += n; }
  void IncreaseFound(int n = 1) { mnFound += n; }
  float GetFoundRatio() const {
    return static_cast<float>(mnFound) / static_cast<float>(mnVisible);
  }

  // The descriptor that is nearest to the others.
  void ComputeDistinctiveDescriptors();
  void UpdateNormalAndDepth();

  Map* GetMap();
  void UpdateMap(Map* pMap);

  static Racy<unsigned long> nNextId;
  unsigned long mnId;
  long mnFirstKFid = 0;
  Racy<int> nObs = 0;
  Racy<unsigned long> mnTrackReferenceForFrame = 0, mnLastFrameSeen = 0;
  Racy<unsigned long> mnFuseCandidateForKF = 0;
  Racy<unsigned long> mnBAGlobalForKF = 0;
  Vector3d mPosGBA;

  static std::mutex mGlobalMutex;

 private:
  friend class System;

  Vector3d mWorldPos, mNormalVector;
  float mfMinDistance = 0, mfMaxDistance = 0;
  Descriptor mDescriptor{};
  std::map<KeyFrame*, std::tuple<int, int>, ById> mObservations;
  KeyFrame* mpRefKF = nullptr;
  MapPoint* mpReplaced = nullptr;
  Map* mpMap;
  Racy<int> mnVisible = 1, mnFound = 1;
  Racy<bool> mbBad = false;
  std::mutex mMutexPos, mMutexFeatures, mMutexMap;
};

}  // namespace mini_orb
