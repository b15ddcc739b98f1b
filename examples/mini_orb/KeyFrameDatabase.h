#pragma once

#include <list>
#include <mutex>
#include <vector>

#include "Common.h"
#include "Frame.h"
#include "KeyFrame.h"
#include "Map.h"

namespace mini_orb {

class Frame;
class KeyFrame;
class Map;

class KeyFrameDatabase {
 public:
  KeyFrameDatabase();

  void add(KeyFrame* pKF);
  void erase(KeyFrame* pKF);
  void clear();
  void clearMap(Map* pMap);

  // The best places that may be where pKF is, in its map and in others.
  void DetectNBestCandidates(KeyFrame* pKF, std::vector<KeyFrame*>& vpLoopCand,
                             std::vector<KeyFrame*>& vpMergeCand, std::size_t nNumCandidates);
  std::vector<KeyFrame*> DetectRelocalizationCandidates(const Frame& F, Map* pMap);

 private:
  template <class FeaturesOf>
  std::vector<KeyFrame*> Similar(const FeaturesOf& of, double minScore);

  std::vector<std::list<KeyFrame*>> mvInvertedFile;  // by word
  std::mutex mMutex;
};

}  // namespace mini_orb
