#include "Atlas.h"

#include "KeyFrame.h"
#include "MapPoint.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;

Atlas::Atlas() { CreateNewMap(); }

void Atlas::CreateNewMap() {
  lock_guard<mutex> lock(mMutexAtlas);
  mpCurrentMap = new Map(KeyFrame::nNextId);
  mspMaps.insert(mpCurrentMap);
}

void Atlas::ChangeMap(Map* pMap) {
  lock_guard<mutex> lock(mMutexAtlas);
  mpCurrentMap = pMap;
}

void Atlas::AddMap(Map* pMap) {
  lock_guard<mutex> lock(mMutexAtlas);
  mspMaps.insert(pMap);
}

Map* Atlas::GetCurrentMap() {
  lock_guard<mutex> lock(mMutexAtlas);
  return mpCurrentMap;
}

std::vector<Map*> Atlas::GetAllMaps() {
  lock_guard<mutex> lock(mMutexAtlas);
  return std::vector<Map*>(mspMaps.begin(), mspMaps.end());
}

std::size_t Atlas::CountMaps() {
  lock_guard<mutex> lock(mMutexAtlas);
  return mspMaps.size();
}

void Atlas::clearAtlas() {
  lock_guard<mutex> lock(mMutexAtlas);
  mspMaps.clear();
  mpCurrentMap = nullptr;
}

void Atlas::SetMapBad(Map* pMap) {
  lock_guard<mutex> lock(mMutexAtlas);
  mspMaps.erase(pMap);
  pMap->SetBad();
  mspBadMaps.insert(pMap);
}

void Atlas::RemoveBadMaps() {
  lock_guard<mutex> lock(mMutexAtlas);
  mspBadMaps.clear();
}

}  // namespace mini_orb
