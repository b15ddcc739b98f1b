// A robot drives through the same rooms for hours. Its map is written once, as ORB-SLAM's is, and
// compiled twice: with raw pointers, and with the same members counted by slamgc.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <set>
#include <slamgc/slamgc.hpp>
#include <vector>

namespace {

struct nothing {};

// How the members of the map hold their pointers: raw...
struct raw_members {
  template <class T>
  using object = nothing;
  template <class T>
  using pointer = T*;
  template <class T>
  using vector = std::vector<T*>;
  template <class T>
  using set = std::set<T*>;
  template <class T>
  using map = std::map<T*, int>;
  template <class T>
  using guard = T*;
};
// ... or counted.
struct counted_members {
  template <class T>
  using object = slamgc::rc_object<T>;
  template <class T>
  using pointer = slamgc::rc_slot<T>;
  template <class T>
  using vector = slamgc::rc_vector<T>;
  template <class T>
  using set = slamgc::rc_set<T>;
  template <class T>
  using map = slamgc::rc_map<T, int>;
  template <class T>
  using guard = slamgc::intrusive_rc<T>;
};

struct usage {
  long keyframes = 0;
  long points = 0;
  double megabytes = 0;
};

// The map, and what ORB-SLAM does to it when it culls: unlink the object and call it bad.
template <class Members>
struct slam {
  struct MapPoint;

  struct KeyFrame : Members::template object<KeyFrame> {
    typename Members::template vector<MapPoint> mvpMapPoints;
    typename Members::template map<KeyFrame> mConnectedKeyFrameWeights;
    typename Members::template pointer<KeyFrame> mpParent{nullptr};
    typename Members::template set<KeyFrame> mspChildrens;
    std::vector<unsigned char> descriptors = std::vector<unsigned char>(1000 * 32);
    bool mbBad = false;

    KeyFrame() { change(+1); }
    ~KeyFrame() { change(-1); }
    void change(int n) {
      alive().keyframes += n;
      alive().megabytes += n * static_cast<double>(sizeof(KeyFrame) + descriptors.size()) / 1e6;
    }
    void SetBadFlag() {
      for (auto& connection : mConnectedKeyFrameWeights)
        connection.first->mConnectedKeyFrameWeights.erase(this);
      mConnectedKeyFrameWeights.clear();
      for (MapPoint* pMP : mvpMapPoints) pMP->mObservations.erase(this);
      mvpMapPoints.clear();
      for (KeyFrame* child : mspChildrens) {
        child->mpParent = mpParent;
        if (mpParent) mpParent->mspChildrens.insert(child);
      }
      mspChildrens.clear();
      if (mpParent) mpParent->mspChildrens.erase(this);
      mbBad = true;
    }
  };

  struct MapPoint : Members::template object<MapPoint> {
    typename Members::template map<KeyFrame> mObservations;
    double position[3] = {0, 0, 0};
    unsigned char descriptor[32] = {};

    MapPoint() { change(+1); }
    ~MapPoint() { change(-1); }
    void change(int n) {
      alive().points += n;
      alive().megabytes += n * static_cast<double>(sizeof(MapPoint)) / 1e6;
    }
  };

  static usage& alive() {
    static usage u;
    return u;
  }

  typename Members::template set<KeyFrame> mspKeyFrames;
  typename Members::template set<MapPoint> mspMapPoints;
  typename Members::template pointer<KeyFrame> mpLastKeyFrame{nullptr};

  // A keyframe that sees `seen` points of the one before and as many new ones.
  void insert_keyframe(std::size_t seen) {
    KeyFrame* pKF = new KeyFrame;
    mspKeyFrames.insert(pKF);
    KeyFrame* pLast = mpLastKeyFrame;
    for (std::size_t i = 0; i < 2 * seen; ++i) {
      MapPoint* pMP = nullptr;
      if (i < seen && pLast && i + seen < pLast->mvpMapPoints.size())
        pMP = pLast->mvpMapPoints[i + seen];
      if (!pMP) {
        pMP = new MapPoint;
        mspMapPoints.insert(pMP);
      }
      pKF->mvpMapPoints.push_back(pMP);
      pMP->mObservations[pKF] = static_cast<int>(i);
    }
    if (pLast) {
      pKF->mConnectedKeyFrameWeights[pLast] = static_cast<int>(seen);
      pLast->mConnectedKeyFrameWeights[pKF] = static_cast<int>(seen);
      pKF->mpParent = pLast;
      pLast->mspChildrens.insert(pKF);
    }
    mpLastKeyFrame = pKF;
    recent_.push_back(pKF);
  }

  // Keeps the newest `window` keyframes, and the points that at least one of them sees.
  void cull(std::size_t window) {
    while (recent_.size() > window) {
      typename Members::template guard<KeyFrame> pKF(recent_.front());  // ours until we are done
      recent_.erase(recent_.begin());
      const std::vector<MapPoint*> points = pKF->mvpMapPoints;
      std::vector<MapPoint*> unseen;
      for (MapPoint* pMP : points)
        if (pMP->mObservations.size() == 1) unseen.push_back(pMP);
      for (MapPoint* pMP : unseen) mspMapPoints.erase(pMP);
      pKF->SetBadFlag();
      mspKeyFrames.erase(&*pKF);
      ++marked.keyframes;
      marked.points += static_cast<long>(unseen.size());
    }
  }

  // What tracking does with the map in every frame: read.
  double read() const {
    double sum = 0;
    for (KeyFrame* pKF : mspKeyFrames)
      for (MapPoint* pMP : pKF->mvpMapPoints)
        sum += pMP->position[0] + static_cast<double>(pMP->mObservations.size());
    return sum;
  }

  usage marked;

 private:
  typename Members::template vector<KeyFrame> recent_;
};

template <class Members>
double milliseconds_to_read(const slam<Members>& map) {
  double best = 1e9;
  double sink = 0;
  for (int i = 0; i < 50; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    sink += map.read();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - begin;
    if (took.count() < best) best = took.count();
  }
  return sink < 0 ? 0 : best;
}

}  // namespace

int main(int argc, char** argv) {
  const int minutes = argc > 1 ? std::atoi(argv[1]) : 60;
  if (argc > 2 || minutes < 10) {
    std::fprintf(stderr, "usage: %s [MINUTES]\n  MINUTES: length of the drive, 10 or more (60)\n",
                 argv[0]);
    return 2;
  }
  std::printf(
      "A robot drives for %d minutes and inserts a keyframe every other second.\n"
      "It keeps a map of 200 keyframes; the rest is culled.\n\n",
      minutes);
  std::printf(
      "         | raw pointers, as ORB-SLAM3    | the same members counted by slamgc\n"
      " minute  | keyframes   points    memory  | keyframes   points    memory\n"
      "---------+-------------------------------+-----------------------------------\n");

  // The raw map is never freed: that is what it shows.
  auto* raw = new slam<raw_members>;
  auto counted = std::make_unique<slam<counted_members>>();
  for (int minute = 1; minute <= minutes; ++minute) {
    for (int i = 0; i < 30; ++i) {
      raw->insert_keyframe(100);
      raw->cull(200);
      counted->insert_keyframe(100);
      counted->cull(200);
    }
    if (minute % (minutes / 10) == 0) {
      const usage& a = slam<raw_members>::alive();
      const usage& b = slam<counted_members>::alive();
      std::printf("   %4d  | %9ld %8ld %6.1f MB  | %9ld %8ld %6.1f MB\n", minute, a.keyframes,
                  a.points, a.megabytes, b.keyframes, b.points, b.megabytes);
      std::fflush(stdout);
    }
  }

  const usage& raw_alive = slam<raw_members>::alive();
  const usage& alive = slam<counted_members>::alive();
  const long keyframes_made = 30L * minutes;
  const long keyframes_kept = static_cast<long>(counted->mspKeyFrames.size());
  const long points_kept = static_cast<long>(counted->mspMapPoints.size());
  const long points_made = points_kept + counted->marked.points;
  std::printf("\nmarked bad: %ld keyframes and %ld points\n", counted->marked.keyframes,
              counted->marked.points);
  std::printf("freed:      raw %ld and %ld; counted %ld and %ld\n",
              keyframes_made - raw_alive.keyframes, points_made - raw_alive.points,
              keyframes_made - alive.keyframes, points_made - alive.points);
  std::printf("reading the whole map: raw %.3f ms, counted %.3f ms\n", milliseconds_to_read(*raw),
              milliseconds_to_read(*counted));

  const bool exact = alive.keyframes == keyframes_kept && alive.points == points_kept;
  std::printf("%s\n", exact ? "What is alive is exactly what the map holds."
                            : "Something is alive that the map does not hold.");
  return exact ? EXIT_SUCCESS : EXIT_FAILURE;
}
