#include "System.h"

#include <unistd.h>

#include <algorithm>
#include <iomanip>
#include <istream>
#include <map>
#include <ostream>

#include "Atlas.h"
#include "KeyFrame.h"
#include "KeyFrameDatabase.h"
#include "LocalMapping.h"
#include "LoopClosing.h"
#include "MapPoint.h"
#include "Tracking.h"
#include "Viewer.h"

namespace mini_orb {

using std::lock_guard;
using std::mutex;

namespace {

// A place, and a pose as place and quaternion: with a blank before each number.
std::ostream& Write(std::ostream& out, const Vector3d& place) {
  return out << ' ' << place.x() << ' ' << place.y() << ' ' << place.z();
}
std::ostream& Write(std::ostream& out, const Pose& pose) {
  const Eigen::Quaterniond q(pose.linear());
  return Write(out, pose.translation())
         << ' ' << q.x() << ' ' << q.y() << ' ' << q.z() << ' ' << q.w();
}
std::istream& Read(std::istream& in, Vector3d& place) {
  return in >> place.x() >> place.y() >> place.z();
}
std::istream& Read(std::istream& in, Pose& pose) {
  Vector3d place;
  Eigen::Quaterniond q;
  Read(in, place) >> q.x() >> q.y() >> q.z() >> q.w();
  pose = q;
  pose.translation() = place;
  return in;
}

}  // namespace

System::System(bool bThreads) : mbThreads(bThreads) {
  KeyFrame::nNextId = 0;
  Frame::nNextId = 0;
  mpKeyFrameDatabase = new KeyFrameDatabase;
  mpAtlas = new Atlas;
  mpFrameDrawer = new FrameDrawer;
  mpTracker = new Tracking(this, mpFrameDrawer, mpAtlas, mpKeyFrameDatabase);
  mpLocalMapper = new LocalMapping(mpAtlas, bThreads);
  mpLoopCloser = new LoopClosing(mpAtlas, mpKeyFrameDatabase, bThreads);
  mpViewer = new Viewer(mpFrameDrawer, mpAtlas, bThreads);
  mpTracker->mpLocalMapper = mpLocalMapper;
  mpTracker->mpLoopClosing = mpLoopCloser;
  mpLocalMapper->mpTracker = mpTracker;
  mpLocalMapper->mpLoopCloser = mpLoopCloser;
  mpLoopCloser->mpTracker = mpTracker;
  mpLoopCloser->mpLocalMapper = mpLocalMapper;
  if (!bThreads) return;
  mptLocalMapping = std::thread(&LocalMapping::Run, mpLocalMapper);
  mptLoopClosing = std::thread(&LoopClosing::Run, mpLoopCloser);
  mptViewer = std::thread(&Viewer::Run, mpViewer);
}

// What they refer to stays, as in ORB-SLAM3.
System::~System() {
  Shutdown();
  delete mpViewer;
  delete mpLoopCloser;
  delete mpLocalMapper;
  delete mpTracker;
  delete mpFrameDrawer;
  delete mpKeyFrameDatabase;
  delete mpAtlas;
}

void System::TrackRGBD(const Image& image) {
  if (mbActivateLocalizationMode) {
    mpLocalMapper->RequestStop();
    while (!mpLocalMapper->isStopped()) {
      mpLocalMapper->RequestStop();  // loop closing may have released it meanwhile
      usleep(300);
    }
    mpTracker->InformOnlyTracking(true);
    mbActivateLocalizationMode = false;
  }
  if (mbDeactivateLocalizationMode) {
    mpTracker->InformOnlyTracking(false);
    mpLocalMapper->Release();
    mbDeactivateLocalizationMode = false;
  }
  if (mbReset || mbResetActiveMap) {
    if (mbThreads) mpViewer->RequestStop();
    while (mbThreads && !mpViewer->isStopped()) usleep(300);
    if (mbReset)
      mpTracker->Reset();
    else
      mpTracker->ResetActiveMap();
    mbReset = mbResetActiveMap = false;
    mpViewer->Release();
  }
  mpTracker->GrabImageRGBD(image);
  {
    lock_guard<mutex> lock(mMutexState);
    mTrackedMapPoints = mpTracker->mCurrentFrame.mvpMapPoints;
  }
  if (mbThreads) return;
  mpLocalMapper->RunOnce();
  mpLoopCloser->RunOnce();
  mpViewer->RunOnce();
}

void System::Shutdown() {
  if (mbShutDown) return;
  mbShutDown = true;
  mpViewer->RequestFinish();
  mpLoopCloser->RequestFinish();
  if (mbThreads) mptViewer.join();
  if (mbThreads) mptLoopClosing.join();  // it may wait for local mapping to stop
  mpLocalMapper->RequestFinish();
  if (mbThreads) mptLocalMapping.join();
  while (mpLoopCloser->isRunningGBA()) usleep(300);
}

void System::SaveTrajectory(std::ostream& out) {
  out << std::setprecision(17);
  auto pose = mpTracker->mlRelativeFramePoses.begin();
  auto time = mpTracker->mlFrameTimes.begin();
  auto lost = mpTracker->mlbLost.begin();
  for (const auto& reference : mpTracker->mlpReferences) {
    const Pose Tcr = *pose++;
    const double at = *time++;
    if (*lost++) continue;
    KeyFrame* pKF = reference;
    Pose Trw = Pose::Identity();
    while (pKF->isBad() && pKF->GetParent() != nullptr) {
      Trw = Trw * pKF->mTcp;
      pKF = pKF->GetParent();
    }
    Trw = Trw * pKF->GetPose();
    const Pose Twc = (Tcr * Trw).inverse();
    Write(out << at, Twc) << '\n';
  }
}

std::vector<MapPoint*> System::GetTrackedMapPoints() {
  lock_guard<mutex> lock(mMutexState);
  return mTrackedMapPoints;
}

System::Summary System::GetSummary() {
  Summary all;
  for (Map* pMap : mpAtlas->GetAllMaps()) {
    ++all.maps;
    all.keyframes += pMap->KeyFramesInMap();
    all.points += pMap->MapPointsInMap();
  }
  all.frames = mpTracker->mlpReferences.size();
  all.culled = mpLocalMapper->mnCulled;
  all.loops = mpLoopCloser->mnLoops;
  all.merges = mpLoopCloser->mnMerges;
  all.globalBAs = mpLoopCloser->mnGBAs;
  all.abortedGBAs = mpLoopCloser->mnAbortedGBAs;
  all.state = mpTracker->mState;
  return all;
}

void System::PrintMaps(std::ostream& out) {
  out << std::setprecision(17);
  for (Map* pMap : mpAtlas->GetAllMaps()) {
    out << "map " << pMap->mnId << '\n';
    for (KeyFrame* pKF : pMap->GetAllKeyFrames()) {
      const Pose Tcw = pKF->GetPose();
      KeyFrame* const pParent = pKF->GetParent();
      Write(out << "keyframe " << pKF->mnId, Tcw)
          << " parent " << (pParent != nullptr ? static_cast<long>(pParent->mnId) : -1) << " sees";
      for (KeyFrame* pCovisible : pKF->GetVectorCovisibleKeyFrames())
        if (!pCovisible->isBad())
          out << ' ' << pCovisible->mnId << ':' << pKF->GetWeight(pCovisible);
      out << " points";
      for (MapPoint* pMP : pKF->GetMapPointMatches())
        if (pMP != nullptr && !pMP->isBad()) out << ' ' << pMP->mnId;
      out << '\n';
    }
    for (MapPoint* pMP : pMap->GetAllMapPoints()) {
      const Vector3d Pos = pMP->GetWorldPos();
      Write(out << "point " << pMP->mnId, Pos) << " seen by";
      for (const auto& [pKF, indexes] : pMP->GetObservations())
        if (!pKF->isBad()) out << ' ' << pKF->mnId;
      out << '\n';
    }
  }
}

void System::SaveAtlas(std::ostream& out) {
  out << std::setprecision(17);
  const std::vector<Map*> vpMaps = mpAtlas->GetAllMaps();
  out << vpMaps.size() << '\n';
  for (Map* pMap : vpMaps) SaveMap(pMap, out);
}

// Numbers stand for pointers: the place in the file, from 1 on; 0 is null.
void System::SaveMap(Map* pMap, std::ostream& out) {
  pMap->mvpBackupKeyFrames = pMap->GetAllKeyFrames();
  pMap->mvpBackupMapPoints = pMap->GetAllMapPoints();
  std::map<const void*, std::size_t> number;
  for (KeyFrame* pKF : pMap->mvpBackupKeyFrames) number.emplace(pKF, number.size() + 1);
  for (MapPoint* pMP : pMap->mvpBackupMapPoints) number.emplace(pMP, number.size() + 1);
  const auto of = [&](const void* p) {
    const auto it = number.find(p);
    return it != number.end() ? it->second : 0;
  };
  const auto write_set = [&](const std::set<KeyFrame*, ById>& keyframes) {
    out << keyframes.size();
    for (KeyFrame* pKF : keyframes) out << ' ' << of(pKF);
    out << '\n';
  };
  // What is seen by keyframes of other maps, or by bad ones, is not saved.
  for (MapPoint* pMP : pMap->mvpBackupMapPoints)
    for (const auto& [pKF, indexes] : pMP->GetObservations())
      if (of(pKF) == 0) pMP->EraseObservation(pKF);

  out << pMap->mvpBackupKeyFrames.size() << ' ' << pMap->mvpBackupMapPoints.size() << '\n';
  for (KeyFrame* pKF : pMap->mvpBackupKeyFrames) {
    const Pose Tcw = pKF->GetPose();
    Write(out << pKF->mnId << ' ' << pKF->mTimeStamp, Tcw) << ' ' << pKF->N << '\n';
    for (std::size_t i = 0; i != pKF->mDescriptors.size(); ++i) {
      out << pKF->mvKeysUn[i].x << ' ' << pKF->mvKeysUn[i].y << ' ' << pKF->mvDepth[i] << ' '
          << pKF->mvKeysUn[i].octave;
      for (const std::uint8_t byte : pKF->mDescriptors[i]) out << ' ' << unsigned{byte};
      out << ' ' << of(pKF->GetMapPoint(i)) << '\n';
    }
    out << of(pKF->GetParent()) << ' ' << of(pKF->mPrevKF) << ' ' << of(pKF->mNextKF) << '\n';
    out << pKF->mConnectedKeyFrameWeights.size();
    for (const auto& [pConnected, weight] : pKF->mConnectedKeyFrameWeights)
      out << ' ' << of(pConnected) << ' ' << weight;
    out << '\n';
    write_set(pKF->mspChildrens);
    write_set(pKF->mspLoopEdges);
    write_set(pKF->mspMergeEdges);
  }
  for (MapPoint* pMP : pMap->mvpBackupMapPoints) {
    const Vector3d Pos = pMP->GetWorldPos();
    const auto observations = pMP->GetObservations();
    Write(out << pMP->mnId << ' ' << pMP->mnFirstKFid, Pos)
        << ' ' << of(pMP->GetReferenceKeyFrame()) << ' ' << pMP->mnVisible << ' ' << pMP->mnFound
        << ' ' << observations.size();
    for (const auto& [pKF, indexes] : observations)
      out << ' ' << of(pKF) << ' ' << std::get<0>(indexes);
    out << '\n';
  }
}

// The current map stays the current one: loop closing merges it with those of the file.
void System::LoadAtlas(std::istream& in) {
  std::size_t maps = 0;
  for (in >> maps; maps != 0; --maps) LoadMap(in);
}

void System::LoadMap(std::istream& in) {
  std::size_t nKFs = 0, nMPs = 0;
  in >> nKFs >> nMPs;
  if (!in || nKFs == 0) return;
  auto* const pMap = new Map(0);
  std::vector<KeyFrame*>& vpKFs = pMap->mvpBackupKeyFrames;
  std::vector<MapPoint*>& vpMPs = pMap->mvpBackupMapPoints;
  const auto keyframe = [&](std::size_t number) {
    return number == 0 || number > vpKFs.size() ? nullptr : vpKFs[number - 1];
  };
  // A keyframe refers to some that come after it.
  struct Links {
    std::vector<std::size_t> points, connected, childrens, loops, merges;
    std::size_t parent = 0, previous = 0, next = 0;
    std::vector<int> weights;
  };
  std::vector<Links> links(nKFs);
  const auto read_list = [&](std::vector<std::size_t>& numbers) {
    std::size_t n = 0;
    in >> n;
    numbers.resize(n);
    for (std::size_t& number : numbers) in >> number;
  };
  const unsigned long nextKF = KeyFrame::nNextId, nextMP = MapPoint::nNextId;
  unsigned long maxKF = nextKF, maxMP = nextMP;
  for (Links& link : links) {
    unsigned long id = 0;
    Image image;
    Pose Tcw;
    std::size_t n = 0;
    Read(in >> id >> image.time, Tcw) >> n;
    image.features.resize(n);
    link.points.resize(n);
    for (std::size_t i = 0; i != n; ++i) {
      Feature& feature = image.features[i];
      in >> feature.u >> feature.v >> feature.depth >> feature.octave;
      for (std::uint8_t& byte : feature.descriptor) {
        unsigned value = 0;
        in >> value;
        byte = static_cast<std::uint8_t>(value);
      }
      in >> link.points[i];
    }
    in >> link.parent >> link.previous >> link.next >> n;
    link.connected.resize(n);
    link.weights.resize(n);
    for (std::size_t i = 0; i != n; ++i) in >> link.connected[i] >> link.weights[i];
    read_list(link.childrens);
    read_list(link.loops);
    read_list(link.merges);
    Frame frame(image);
    frame.SetPose(Tcw);
    KeyFrame::nNextId = id;
    maxKF = std::max(maxKF, id + 1);
    vpKFs.push_back(new KeyFrame(frame, pMap, mpKeyFrameDatabase));
  }
  for (std::size_t i = 0; i != nMPs; ++i) {
    unsigned long id = 0;
    long first = 0;
    Vector3d Pos;
    std::size_t reference = 0, n = 0;
    int visible = 1, found = 1;
    Read(in >> id >> first, Pos) >> reference >> visible >> found >> n;
    MapPoint::nNextId = id;
    maxMP = std::max(maxMP, id + 1);
    KeyFrame* const pRefKF = keyframe(reference);
    auto* const pMP = new MapPoint(Pos, pRefKF != nullptr ? pRefKF : vpKFs.front(), pMap);
    pMP->mnFirstKFid = first;
    pMP->mnVisible = visible;
    pMP->mnFound = found;
    for (; n != 0; --n) {
      std::size_t observer = 0;
      int idx = 0;
      in >> observer >> idx;
      if (KeyFrame* const pKF = keyframe(observer)) pMP->AddObservation(pKF, idx);
    }
    vpMPs.push_back(pMP);
    pMap->AddMapPoint(pMP);
  }
  KeyFrame::nNextId = maxKF;
  MapPoint::nNextId = maxMP;
  for (std::size_t k = 0; k != nKFs; ++k) {
    KeyFrame* const pKF = vpKFs[k];
    const Links& link = links[k];
    for (std::size_t i = 0; i != link.points.size(); ++i)
      if (link.points[i] > nKFs && link.points[i] <= nKFs + nMPs)
        pKF->AddMapPoint(vpMPs[link.points[i] - nKFs - 1], i);
    for (std::size_t i = 0; i != link.connected.size(); ++i)
      if (KeyFrame* const p = keyframe(link.connected[i]))
        pKF->mConnectedKeyFrameWeights[p] = link.weights[i];
    pKF->mpParent = keyframe(link.parent);
    pKF->mPrevKF = keyframe(link.previous);
    pKF->mNextKF = keyframe(link.next);
    for (const std::size_t n : link.childrens)
      if (KeyFrame* const p = keyframe(n)) pKF->mspChildrens.insert(p);
    for (const std::size_t n : link.loops)
      if (KeyFrame* const p = keyframe(n)) pKF->AddLoopEdge(p);
    for (const std::size_t n : link.merges)
      if (KeyFrame* const p = keyframe(n)) pKF->mspMergeEdges.insert(p);
    pKF->mbFirstConnection = false;
    pKF->UpdateBestCovisibles();
    pMap->AddKeyFrame(pKF);
    mpKeyFrameDatabase->add(pKF);
  }
  pMap->AddKeyFrameOrigin(vpKFs.front());
  for (MapPoint* pMP : vpMPs) {
    pMP->ComputeDistinctiveDescriptors();
    pMP->UpdateNormalAndDepth();
  }
  mpAtlas->AddMap(pMap);
}

}  // namespace mini_orb
