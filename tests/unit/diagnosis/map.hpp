// A map like ORB-SLAM3's, small enough that each report on it can be written down.
#pragma once

#include <cstdint>
#include <mutex>
#include <slamgc/slamgc.hpp>
#include <string>

namespace diagnosis_map {

template <class T>
using object = slamgc::rc_object<T, slamgc::fetch_add_counter, slamgc::reclaim_retired>;

struct MapPoint;

struct KeyFrame : object<KeyFrame> {
  explicit KeyFrame(unsigned long id) : mnId(id) {}
  unsigned long report_id() const { return mnId; }
  template <class Visitor>
  void edges(Visitor& v) {
    const std::lock_guard<std::mutex> lock(mutex);
    v.edge("mvpMapPoints", mvpMapPoints, slamgc::on_retire::null);
    v.edge("mpParent", mpParent);
    v.edge("mspChildrens", mspChildrens, slamgc::on_retire::erase);
  }
  const unsigned long mnId;
  std::mutex mutex;
  slamgc::rc_vector<MapPoint> mvpMapPoints;
  slamgc::rc_slot<KeyFrame> mpParent;
  slamgc::rc_set<KeyFrame> mspChildrens;
};

// Has no number.
struct MapPoint : object<MapPoint> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mObservations", mObservations);
    v.edge("mpRefKF", mpRefKF);
  }
  slamgc::rc_map<KeyFrame, int> mObservations;
  slamgc::rc_slot<KeyFrame> mpRefKF;
};

struct Map {
  explicit Map(slamgc::domain& d) : root(d, "Map", *this) {}
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mspKeyFrames", mspKeyFrames);
    v.edge("mspMapPoints", mspMapPoints);
  }
  slamgc::registry<slamgc::rc_set<KeyFrame>> mspKeyFrames;
  slamgc::rc_set<MapPoint> mspMapPoints;
  slamgc::root root;
};

struct Tracking {
  explicit Tracking(slamgc::mutator& m) : root(m, "Tracking", *this) {}
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mpReferenceKF", mpReferenceKF);
  }
  slamgc::rc_slot<KeyFrame> mpReferenceKF;
  slamgc::root root;
};

// A domain with this thread as its mutator.
struct world {
  slamgc::domain domain;
  slamgc::mutator me{domain, "mapping"};

  KeyFrame* key_frame(unsigned long id) { return new KeyFrame(id); }
  // As many rounds as anything here takes.
  void settle() {
    for (int i = 0; i != 12; ++i) {
      me.quiescent();
      domain.collect();
    }
  }
  // Retires all that was made; what nobody holds in another way is reclaimed.
  template <class... Registries>
  void clear(Registries&... all) {
    slamgc::drop_map(all...);
    settle();
  }
  std::uint64_t live() const { return domain.stats().total(&slamgc::type_stats::live); }
};

inline std::string address(const void* p) {
  std::uintptr_t n = reinterpret_cast<std::uintptr_t>(p);
  std::string digits;
  for (; n != 0; n /= 16) digits.insert(digits.begin(), "0123456789abcdef"[n % 16]);
  return "0x" + digits;
}

}  // namespace diagnosis_map
