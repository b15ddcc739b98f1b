// A whole program in a scheme: the map, the threads' members, and what tests want to know of them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "threads.hpp"

namespace orb_slam3 {

// Calls f(p) for each reference in a member, whatever the scheme.
template <class Member, class F, class = void>
struct each_reference {
  static void call(Member& member, F f) {
    if (auto* const p = to_pointer(member)) f(p);
  }
  template <class T, class Env>
  static T* to_pointer(slamgc::rc_slot<T, Env>& p) {
    return p;
  }
  template <class T>
  static T* to_pointer(shared_pointer<T>& p) {
    return p;
  }
  template <class T>
  static T* to_pointer(T* p) {
    return p;
  }
};
template <class Member, class F>
struct each_reference<Member, F, std::void_t<decltype(std::declval<Member&>().begin())>> {
  static void call(Member& member, F f) {
    for (const auto& e : member)
      if (auto* const p = to_pointer(e)) f(p);
  }
  template <class T>
  static T* to_pointer(T* p) {
    return p;
  }
  template <class T>
  static T* to_pointer(const shared_pointer<T>& p) {
    return p;
  }
  template <class Key, class Mapped>
  static auto* to_pointer(const std::pair<const Key, Mapped>& e) {
    return to_pointer(e.first);
  }
};

// A visitor of edges: calls f(name, p) for each reference.
template <class F>
struct with_names {
  F f;
  template <class Member, class Disposition = on::hold_edge>
  void edge(const char* name, Member& member, const Disposition& = {}) {
    const auto call = [&](const auto* p) { f(name, p); };
    each_reference<Member, decltype(call)>::call(member, call);
  }
};
// A visitor of edges: clears them.
struct clearing {
  template <class Member, class Disposition = on::hold_edge>
  void edge(const char*, Member& member, const Disposition& = {}) {
    clear(member, 0);
  }
  template <class Member>
  static auto clear(Member& member, int) -> decltype(member.clear()) {
    member.clear();
  }
  template <class Member>
  static void clear(Member& member, long) {
    member = nullptr;
  }
};

template <class S>
class World {
 public:
  using KF = KeyFrame<S>;
  using Point = MapPoint<S>;

  struct parts {
    KeyFrameDatabase<S> database;
    Atlas<S> atlas;
    LocalMapping<S> mapping;
    LoopClosing<S> closing;
    Tracking<S> tracking;
    Outputs<S> outputs;
    GlobalBundleAdjustment<S> adjustment;
  };

  World() {
    found.clear();
    program_.emplace();
    program_->atlas.CreateNewMap();
    threads.root_of_atlas(program_->atlas);
    threads.root_of_atlas(program_->database);
    threads.root_of_mapping("LocalMapping", program_->mapping);
    threads.root_of_mapping("LoopClosing", program_->closing);
    threads.root_of_tracking("Tracking", program_->tracking);
    threads.root_of_tracking("Outputs", program_->outputs);
  }
  // What is left is freed, so that the leak does not outlive the test.
  ~World() {
    const std::size_t leaked = end();
    if (S::adapted) {
      EXPECT_EQ(leaked, 0u);
      EXPECT_EQ(found.all(), 0);
    }
    if constexpr (std::is_same<S, plain>::value) {
      for (KF* const kf : listed<KF>::all()) delete kf;
      for (Point* const p : listed<Point>::all()) delete p;
      for (Map<S>* const map : listed<Map<S>>::all()) delete map;
    } else if constexpr (std::is_same<S, shared>::value) {
      free_shared();
    }
    EXPECT_EQ(keyframes() + points() + maps(), 0u);
  }
  // The program ends. Returns how many objects it leaks.
  std::size_t end() {
    threads.end_roots();
    program_.reset();
    threads.settle();
    return keyframes() + points() + maps();
  }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  parts* operator->() { return &*program_; }
  Map<S>* map() { return program_->atlas.GetCurrentMap(); }

  // ---- making a map

  // A keyframe of the current map, with room for points; the next id.
  auto keyframe(std::size_t slots = 64) { return keyframe_of(std::vector<Point*>(slots, nullptr)); }
  auto keyframe_of(const std::vector<Point*>& slots) {
    const auto kf = S::template make<KF>(next_keyframe_, slots, words_of(next_keyframe_), map(),
                                         &program_->database);
    ++next_keyframe_;
    map()->AddKeyFrame(kf);
    return kf;
  }
  auto point(KF* reference) {
    const auto p = S::template make<Point>(next_point_++, reference, map());
    map()->AddMapPoint(p);
    return p;
  }
  // The keyframe sees the point, in its next slot.
  void see(KF* kf, Point* p) {
    const std::vector<Point*> slots = kf->GetMapPointMatches();
    const auto i =
        static_cast<std::size_t>(std::find(slots.begin(), slots.end(), nullptr) - slots.begin());
    p->AddObservation(kf, i);
    kf->AddMapPoint(p, i);
  }
  // So many new points that all of these see.
  void share(const std::vector<KF*>& keyframes, int points) {
    for (int i = 0; i != points; ++i) {
      const auto p = point(keyframes.front());
      for (KF* const kf : keyframes) see(kf, p);
    }
  }
  // A keyframe on its way through the threads: tracking makes it of the current frame, mapping and loop closing process it.
  long new_keyframe(bool processed = true) {
    const long id = next_keyframe_++;
    threads.on_tracking([&] {
      const auto kf =
          program_->tracking.CreateNewKeyFrame(id, words_of(id), map(), &program_->database);
      program_->mapping.InsertKeyFrame(kf);
    });
    if (processed) process();
    return id;
  }
  void process() {
    while (program_->mapping.CheckNewKeyFrames()) {
      program_->mapping.ProcessNewKeyFrame(program_->atlas);
      program_->closing.InsertKeyFrame(program_->mapping.mpCurrentKeyFrame);
      program_->closing.NewDetectCommonRegions(program_->database);
    }
  }
  // Tracking processes a frame that sees these.
  void frame(const std::vector<Point*>& matches) {
    threads.on_tracking([&] { program_->tracking.Track(matches); });
  }

  // ---- looking at it

  // The object with this id, if it exists and was not freed.
  KF* kf(long id) { return find<KF>(id); }
  Point* mp(long id) { return find<Point>(id); }
  std::size_t keyframes() { return exist<KF>(); }
  std::size_t points() { return exist<Point>(); }
  std::size_t maps() { return exist<Map<S>>(); }
  // Objects that the program called bad, and that exist.
  std::size_t bad() { return bad_of<KF>() + bad_of<Point>(); }

  // Who refers to an object: "KeyFrame 1.mpParent", "Tracking.mpReferenceKF", ..., sorted.
  std::vector<std::string> holders(const void* object) {
    std::vector<std::string> all;
    each_edge([&](const std::string& holder, const char* edge, const auto* p) {
      if (static_cast<const void*>(p) == object) all.push_back(holder + "." + edge);
    });
    std::sort(all.begin(), all.end());
    return all;
  }
  // References to objects that were freed.
  std::size_t dangling() {
    std::size_t n = 0;
    if constexpr (std::is_same<S, plain>::value)
      each_edge([&](const std::string&, const char*, const auto* p) { n += p->freed; });
    return n;
  }
  // What a program does that frees what it calls bad: only the plain scheme has to ask for it.
  void free_bad() {
    if constexpr (std::is_same<S, plain>::value) {
      free_bad_of<KF>();
      free_bad_of<Point>();
    }
  }

  typename S::threads threads;

 private:
  template <class T>
  static bool exists(T* p) {
    if constexpr (std::is_same<S, plain>::value)
      return !p->freed;
    else
      return p != nullptr;
  }
  template <class T>
  static std::vector<T*> existing() {
    std::vector<T*> all = listed<T>::all();
    all.erase(std::remove_if(all.begin(), all.end(), [](T* p) { return !exists(p); }), all.end());
    return all;
  }
  template <class T>
  static std::size_t exist() {
    return existing<T>().size();
  }
  template <class T>
  static T* find(long id) {
    for (T* const p : existing<T>())
      if (p->mnId == id) return p;
    return nullptr;
  }
  template <class T>
  static std::size_t bad_of() {
    std::size_t n = 0;
    for (T* const p : existing<T>()) n += p->isBad();
    return n;
  }
  template <class T>
  static void free_bad_of() {
    for (T* const p : existing<T>())
      if (p->isBad()) S::destroy(p);
  }
  template <class F>
  void each_edge(F f) {
    const auto visit = [&](const std::string& holder, auto& described) {
      const auto with_holder = [&](const char* edge, const auto* p) { f(holder, edge, p); };
      with_names<decltype(with_holder)> v{with_holder};
      described.edges(v);
    };
    for (KF* const kf : existing<KF>()) visit("KeyFrame " + std::to_string(kf->mnId), *kf);
    for (Point* const p : existing<Point>()) visit("MapPoint " + std::to_string(p->mnId), *p);
    for (Map<S>* const m : existing<Map<S>>()) visit("Map " + std::to_string(m->mnId), *m);
    if (!program_) return;
    visit("KeyFrameDatabase", program_->database);
    visit("Atlas", program_->atlas);
    visit("LocalMapping", program_->mapping);
    visit("LoopClosing", program_->closing);
    visit("Tracking", program_->tracking);
    visit("Outputs", program_->outputs);
    visit("GlobalBundleAdjustment", program_->adjustment);
  }
  // Breaks every cycle by hand.
  void free_shared() {
    std::vector<typename S::template local<KF>> keyframes;
    std::vector<typename S::template local<Point>> points;
    std::vector<typename S::template local<Map<S>>> maps;
    for (KF* const kf : listed<KF>::all()) keyframes.emplace_back(kf);
    for (Point* const p : listed<Point>::all()) points.emplace_back(p);
    for (Map<S>* const m : listed<Map<S>>::all()) maps.emplace_back(m);
    clearing v;
    for (KF* const kf : keyframes) kf->edges(v);
    for (Point* const p : points) p->edges(v);
    for (Map<S>* const m : maps) m->edges(v);
  }
  static std::vector<std::size_t> words_of(long keyframe) {
    const auto n = static_cast<std::size_t>(keyframe);
    return {n % KeyFrameDatabase<S>::words, (n + 1) % KeyFrameDatabase<S>::words};
  }

  std::optional<parts> program_;
  long next_keyframe_ = 0;
  long next_point_ = 0;
};

using holders = std::vector<std::string>;

}  // namespace orb_slam3
