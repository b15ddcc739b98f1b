#pragma once

#include <mutex>
#include <set>
#include <vector>

#include "Common.h"
#include "Map.h"

namespace mini_orb {

class Atlas {
 public:
  Atlas();

  void CreateNewMap();
  void ChangeMap(Map* pMap);
  void AddMap(Map* pMap);
  Map* GetCurrentMap();
  std::vector<Map*> GetAllMaps();
  std::size_t CountMaps();

  // Forgets all maps.
  void clearAtlas();
  // For a map that was merged into another one.
  void SetMapBad(Map* pMap);
  void RemoveBadMaps();

 private:
  std::set<Map*, ById> mspMaps, mspBadMaps;
  Map* mpCurrentMap = nullptr;
  std::mutex mMutexAtlas;
};

}  // namespace mini_orb
