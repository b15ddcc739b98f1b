#pragma once

#include <mutex>
#include <set>
#include <vector>

#include "Common.h"
#include "KeyFrame.h"
#include "MapPoint.h"

namespace mini_orb {

class KeyFrame;
class MapPoint;

class Map : public Instances<Map> {
 public:
  explicit Map(unsigned long initKFid);

  void AddKeyFrame(KeyFrame* pKF);
  void AddMapPoint(MapPoint* pMP);
  void EraseKeyFrame(KeyFrame* pKF);
  void EraseMapPoint(MapPoint* pMP);
  void SetReferenceMapPoints(const std::vector<MapPoint*>& vpMPs);

  std::vector<KeyFrame*> GetAllKeyFrames();
  std::vector<MapPoint*> GetAllMapPoints();
  std::vector<MapPoint*> GetReferenceMapPoints();
  std::size_t KeyFramesInMap();
  std::size_t MapPointsInMap();
  unsigned long GetInitKFid() const { return mnInitKFid; }
  KeyFrame* GetOriginKF();
  void AddKeyFrameOrigin(KeyFrame* pKF);
  std::vector<KeyFrame*> GetKeyFrameOrigins();
  unsigned long GetMaxKFid() const { return mnMaxKFid; }
  bool IsBad() const { return mbBad; }
  void SetBad() { mbBad = true; }
  void InformNewBigChange() { mnBigChangeIdx += 1; }
  int GetLastBigChangeIdx() const { return mnBigChangeIdx; }

  // Forgets all keyframes and points.
  void clear();

  static Racy<unsigned long> nNextId;
  const unsigned long mnId;
  std::mutex mMutexMapUpdate;

 private:
  friend class System;

  std::set<KeyFrame*, ById> mspKeyFrames;
  std::set<MapPoint*, ById> mspMapPoints;
  std::vector<KeyFrame*> mvpKeyFrameOrigins;
  std::vector<MapPoint*> mvpReferenceMapPoints;
  KeyFrame* mpKFinitial = nullptr;
  KeyFrame* mpKFlowerID = nullptr;
  std::vector<KeyFrame*> mvpBackupKeyFrames;
  std::vector<MapPoint*> mvpBackupMapPoints;
  Racy<unsigned long> mnInitKFid;
  Racy<unsigned long> mnMaxKFid;
  Racy<int> mnBigChangeIdx = 0;
  Racy<bool> mbBad = false;
  std::mutex mMutexMap;
};

}  // namespace mini_orb
