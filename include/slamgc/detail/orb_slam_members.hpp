/// @file
/// The counted members of ORB-SLAM3's and ORB-SLAM2's classes: under which lock they are, and what becomes of each when its target
/// is retired. docs/orb-slam3.md has the reasons.
#pragma once

#include <cstddef>
#include <mutex>
#include <type_traits>
#include <utility>

#include "../dispositions.hpp"
#include "../fwd.hpp"
#include "described.hpp"
#include "edge_member.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Whether edges can be described of a member.
template <class Member, class = void>
struct is_counted : std::false_type {};
template <class T, class Env>
struct is_counted<rc_slot<T, Env>> : std::true_type {};
template <class T, class Env>
struct is_counted<atomic_rc<T, Env>> : std::true_type {};
template <class Container>
struct is_counted<Container,
                  std::void_t<decltype(detail::reference_in(std::declval<const Container&>()))>>
    : std::true_type {};

/// A friend of ORB-SLAM's classes. A member that is not counted (yet) is not described.
class orb_slam_members {
 public:
  // What an index of redundancy reads.
  template <class KeyFrame>
  static auto& slots(KeyFrame& kf) {
    return kf.mvpMapPoints;
  }
  template <class MapPoint>
  static auto& observations(MapPoint& mp) {
    return mp.mObservations;
  }
  template <class MapPoint>
  static bool bad_flag(const MapPoint& mp) {
    return mp.mbBad;
  }
  template <class T>
  static std::mutex& features_mutex(T& object) {
    return object.mMutexFeatures;
  }

  template <class Visitor, class KeyFrame>
  static void keyframe(Visitor& v, KeyFrame& kf) {
    {
      const lock features(kf.mMutexFeatures);
      if constexpr (has<KeyFrame>(in_index)) {
        using hooks = typename std::decay_t<decltype(kf.mRedundancy)>::hooks;
        if constexpr (std::is_same<Visitor, severing_visitor>::value) hooks::remove_keyframe(&kf);
        std::size_t next = 0;
        const auto tell = [&](auto& bad) { next = hooks::drop_slot(kf, bad, next); };
        member(v, "mvpMapPoints", kf.mvpMapPoints, on_retire::announce(tell, on_retire::null));
      } else {
        member(v, "mvpMapPoints", kf.mvpMapPoints, on_retire::null);
      }
    }
    {
      const lock connections(kf.mMutexConnections);
      member(v, "mConnectedKeyFrameWeights", kf.mConnectedKeyFrameWeights, on_retire::erase);
      member(v, "mvpOrderedConnectedKeyFrames", kf.mvpOrderedConnectedKeyFrames,
             on_retire::erase_with(kf.mvOrderedWeights));
      if (kf.mbBad)  // its pose is relative to this one
        member(v, "mpParent", kf.mpParent);
      else
        member(v, "mpParent", kf.mpParent,
               on_retire::bypass([&kf](KeyFrame& bad) { return parent_instead_of(bad, kf); }));
      member(v, "mspChildrens", kf.mspChildrens, on_retire::erase);
      member(v, "mspLoopEdges", kf.mspLoopEdges, on_retire::erase);
      optional(
          v, "mspMergeEdges", kf,
          [](auto& k) -> decltype((k.mspMergeEdges)) { return k.mspMergeEdges; }, on_retire::erase);
    }
    optional(
        v, "mPrevKF", kf, [](auto& k) -> decltype((k.mPrevKF)) { return k.mPrevKF; },
        on_retire::bypass([](auto& bad) -> KeyFrame* { return bad.mPrevKF; }));
    optional(
        v, "mNextKF", kf, [](auto& k) -> decltype((k.mNextKF)) { return k.mNextKF; },
        on_retire::bypass([](auto& bad) -> KeyFrame* { return bad.mNextKF; }));
    in_map(v, kf);
  }

  template <class Visitor, class MapPoint>
  static void map_point(Visitor& v, MapPoint& mp) {
    {
      const lock features(mp.mMutexFeatures);
      if constexpr (has<MapPoint>(in_index)) {
        using hooks = typename std::decay_t<decltype(mp.mRedundancy)>::hooks;
        const auto tell = [&mp](auto& bad) { hooks::erase_observation(&bad, &mp); };
        member(v, "mObservations", mp.mObservations, on_retire::announce(tell, on_retire::erase));
      } else {
        member(v, "mObservations", mp.mObservations, on_retire::erase);  // before one of them
      }
      // Used without a test while the point is good: it stays until there is another one.
      if (mp.mObservations.empty())
        member(v, "mpRefKF", mp.mpRefKF);
      else
        member(v, "mpRefKF", mp.mpRefKF, on_retire::bypass([&mp](auto& bad) {
                 auto* first = &bad;
                 first = mp.mObservations.begin()->first;
                 return first;
               }));
      member(v, "mpReplaced", mp.mpReplaced);  // tracking follows it in the next frame
    }
    in_map(v, mp);
  }

  template <class Visitor, class Map>
  static void map(Visitor& v, Map& m) {
    const lock all(m.mMutexMap);
    member(v, "mspKeyFrames", m.mspKeyFrames, on_retire::erase);
    member(v, "mspMapPoints", m.mspMapPoints, on_retire::erase);
    member(v, "mvpReferenceMapPoints", m.mvpReferenceMapPoints, on_retire::erase);
    // mvpKeyFrameOrigins has no lock in ORB-SLAM3: clear() empties it, and the map's end. The others are used without a test, by an
    // adjustment that goes on after a reset, too; the next keyframe takes their place.
    optional(v, "mpKFinitial", m,
             [](auto& i) -> decltype((i.mpKFinitial)) { return i.mpKFinitial; });
    optional(v, "mpKFlowerID", m,
             [](auto& i) -> decltype((i.mpKFlowerID)) { return i.mpKFlowerID; });
  }

  /// Of a part of the system that refers to keyframes or points. Which part it is is seen from what it has.
  template <class Visitor, class Part>
  static void part(Visitor& v, Part& p) {
    constexpr kind is = kind_of<Part>();
    if constexpr (is == kind::tracking) tracking(v, p);
    if constexpr (is == kind::local_mapping) local_mapping(v, p);
    if constexpr (is == kind::loop_closing) loop_closing(v, p);
    if constexpr (is == kind::atlas) atlas(v, p);
    if constexpr (is == kind::only_map) map(v, p);
    if constexpr (is == kind::drawer) drawer(v, p);
    if constexpr (is == kind::system) system(v, p);
  }
  /// Of a part, for reports.
  template <class Part>
  static const char* name() {
    constexpr const char* names[] = {"Tracking", "LocalMapping", "LoopClosing", "Atlas",
                                     "Map",      "FrameDrawer",  "System"};
    return names[static_cast<int>(kind_of<Part>())];
  }
  /// Does not compile while a member of the part, or of an object to which that leads, is not counted.
  template <class Part>
  static void check() {
    (void)&check_part<completeness, Part>;
  }
  /// The same, of a part whose thread calls forget().
  template <class Part>
  static void check_own_thread() {
    (void)&check_part<completeness_but_scratch, Part>;
  }
  /// Empties what is not counted since only the part's thread uses it, between two of its quiescent states.
  template <class Part>
  static void forget(Part& p) {
    forgetting all;
    part(all, p);
  }
  /// What a session does with a system as a whole: orb_slam_system.hpp.
  struct whole_system;

 private:
  using lock = std::lock_guard<std::mutex>;
  /// What adapters/orb_slam_redundancy.hpp keeps in an object, and which is told what is dropped.
  static constexpr auto in_index = [](auto& o) -> decltype((o.mRedundancy)) {
    return o.mRedundancy;
  };

  static constexpr auto an_atlas = [](auto& o) -> decltype((o.mpAtlas)) { return o.mpAtlas; };

  // ---- members

  /// Wants all members of all objects to be counted.
  struct completeness {
    template <class Member, class Disposition = on_retire::hold_edge>
    void edge(const char*, Member& m, const Disposition& = {}) {
      edge_member<Member>::each(m, [](auto* p) {
        using object = std::remove_const_t<std::remove_pointer_t<decltype(p)>>;
        (void)&check_object<object>;
      });
    }
  };
  struct completeness_but_scratch : completeness {};
  template <class Completeness, class Part>
  static void check_part(Completeness& v, Part& p) {
    part(v, p);
  }
  struct forgetting {
    template <class Member, class Disposition = on_retire::hold_edge>
    void edge(const char*, Member&, const Disposition& = {}) {}
  };
  template <class T>
  static void empty(T*& p) {
    p = nullptr;
  }
  template <class Container>
  static void empty(Container& c) {
    c.clear();
  }
  template <class T>
  static void check_object(completeness& v, T& object) {
    object.edges(v);
  }

  template <class Visitor, class Member, class Disposition = on_retire::hold_edge>
  static void member(Visitor& v, const char* name, Member& m, const Disposition& how = {}) {
    if constexpr (is_counted<Member>::value)
      v.edge(name, m, how);
    else
      static_assert(
          !std::is_base_of<completeness, Visitor>::value,
          "slamgc: a member of ORB-SLAM is not counted yet; the compiler says below which "
          "one, docs/orb-slam3.md what its type becomes");
    (void)v, (void)name, (void)m, (void)how;
  }
  /// A member that not each system has: @p in(of) does not compile in the others.
  template <class Visitor, class Of, class In, class Disposition = on_retire::hold_edge>
  static void optional(Visitor& v, const char* name, Of& of, const In& in,
                       const Disposition& how = {}) {
    if constexpr (std::is_invocable<In, Of&>::value) member(v, name, in(of), how);
    (void)v, (void)name, (void)of, (void)in, (void)how;
  }
  /// A member that the part's thread writes before it reads it, each time it comes along: if it is not counted, forget() empties it.
  template <class Visitor, class Of, class In, class Disposition>
  static void scratch(Visitor& v, const char* name, Of& of, const In& in, const Disposition& how) {
    if constexpr (std::is_invocable<In, Of&>::value) {
      using type = std::remove_reference_t<std::invoke_result_t<In, Of&>>;
      if constexpr (is_counted<type>::value || std::is_same<Visitor, completeness>::value)
        member(v, name, in(of), how);
      else if constexpr (std::is_same<Visitor, forgetting>::value)
        empty(in(of));
    }
    (void)v, (void)name, (void)of, (void)in, (void)how;
  }
  /// In ORB-SLAM2 there is one map, which nobody counts.
  template <class Visitor, class T>
  static void in_map(Visitor& v, T& object) {
    const auto mutex = [](auto& o) -> decltype((o.mMutexMap)) { return o.mMutexMap; };
    if constexpr (std::is_invocable<decltype(mutex), T&>::value) {
      const lock map(mutex(object));
      member(v, "mpMap", object.mpMap);  // used without a test
    }
    (void)mutex, (void)v, (void)object;
  }
  /// The parent of the bad parent of @p child, which becomes one of its children if nobody is at work on these: to wait for that
  /// could be a deadlock. Else it is nobody's child, as those of bad parents are in ORB-SLAM.
  template <class KeyFrame>
  static KeyFrame* parent_instead_of(KeyFrame& bad, KeyFrame& child) {
    KeyFrame* const next = bad.mpParent;
    if (next == nullptr || next == &child) return nullptr;
    const std::unique_lock<std::mutex> theirs(next->mMutexConnections, std::try_to_lock);
    if (theirs && !next->mbBad) next->mspChildrens.insert(&child);
    return next;
  }

  // ---- parts

  enum class kind { tracking, local_mapping, loop_closing, atlas, only_map, drawer, system };
  template <class Of, class In>
  static constexpr bool has(const In&) {
    return std::is_invocable<In, Of&>::value;
  }
  template <class P>
  static constexpr kind kind_of() {
    if constexpr (has<P>([](auto& p) -> decltype((p.mlpReferences)) { return p.mlpReferences; }))
      return kind::tracking;
    else if constexpr (has<P>([](auto& p) -> decltype((p.mlNewKeyFrames)) {
                         return p.mlNewKeyFrames;
                       }))
      return kind::local_mapping;
    else if constexpr (has<P>([](auto& p) -> decltype((p.mlpLoopKeyFrameQueue)) {
                         return p.mlpLoopKeyFrameQueue;
                       }))
      return kind::loop_closing;
    else if constexpr (has<P>([](auto& p) -> decltype((p.mspMaps)) { return p.mspMaps; }))
      return kind::atlas;
    else if constexpr (has<P>([](auto& p) -> decltype((p.mspKeyFrames)) { return p.mspKeyFrames; }))
      return kind::only_map;
    else if constexpr (has<P>([](auto& p) -> decltype((p.mvpLocalMap)) { return p.mvpLocalMap; }))
      return kind::drawer;
    else {
      constexpr bool is_system =
          has<P>([](auto& p) -> decltype((p.mTrackedMapPoints)) { return p.mTrackedMapPoints; });
      static_assert(is_system,
                    "slamgc: this is no part of ORB-SLAM that refers to keyframes or points, or "
                    "`friend slamgc::orb_slam3::access;` is missing in it");
      return kind::system;
    }
  }

  /// What a frame refers to is used in the next one, bad or not.
  template <class Visitor, class Frame>
  static void frame(Visitor& v, Frame& f, const char* points, const char* reference,
                    const char* last) {
    member(v, points, f.mvpMapPoints);
    member(v, reference, f.mpReferenceKF);
    optional(v, last, f, [](auto& g) -> decltype((g.mpLastKeyFrame)) { return g.mpLastKeyFrame; });
  }
  /// A frame that is kept for its features.
  template <class Visitor, class Frame>
  static void kept_frame(Visitor& v, Frame& f, const char* points, const char* reference,
                         const char* last) {
    member(v, points, f.mvpMapPoints, on_retire::null);
    member(v, reference, f.mpReferenceKF, on_retire::null);
    optional(
        v, last, f, [](auto& g) -> decltype((g.mpLastKeyFrame)) { return g.mpLastKeyFrame; },
        on_retire::null);
  }

  template <class Visitor, class Tracking>
  static void tracking(Visitor& v, Tracking& t) {
    frame(v, t.mCurrentFrame, "mCurrentFrame.mvpMapPoints", "mCurrentFrame.mpReferenceKF",
          "mCurrentFrame.mpLastKeyFrame");
    frame(v, t.mLastFrame, "mLastFrame.mvpMapPoints", "mLastFrame.mpReferenceKF",
          "mLastFrame.mpLastKeyFrame");
    kept_frame(v, t.mInitialFrame, "mInitialFrame.mvpMapPoints", "mInitialFrame.mpReferenceKF",
               "mInitialFrame.mpLastKeyFrame");
    member(v, "mpReferenceKF", t.mpReferenceKF);
    member(v, "mpLastKeyFrame", t.mpLastKeyFrame);
    if constexpr (has<Tracking>(an_atlas)) {
      scratch(
          v, "mvpLocalKeyFrames", t,
          [](auto& o) -> decltype((o.mvpLocalKeyFrames)) { return o.mvpLocalKeyFrames; },
          on_retire::erase);
      scratch(
          v, "mvpLocalMapPoints", t,
          [](auto& o) -> decltype((o.mvpLocalMapPoints)) { return o.mvpLocalMapPoints; },
          on_retire::erase);
    } else {  // ORB-SLAM2 may go on with those of the last frame
      member(v, "mvpLocalKeyFrames", t.mvpLocalKeyFrames, on_retire::erase);
      member(v, "mvpLocalMapPoints", t.mvpLocalMapPoints, on_retire::erase);
    }
    member(v, "mlpTemporalPoints", t.mlpTemporalPoints);
  }
  template <class Visitor, class LocalMapping>
  static void local_mapping(Visitor& v, LocalMapping& l) {
    {
      const lock queue(l.mMutexNewKFs);
      member(v, "mlNewKeyFrames", l.mlNewKeyFrames);
    }
    member(v, "mpCurrentKeyFrame", l.mpCurrentKeyFrame, on_retire::null);
    // Loop closing adds to it, too, and ORB-SLAM3 has no lock for it: MapPointCulling() erases what is bad.
    const auto mutex = [](auto& o) -> decltype((o.mMutexRecent)) { return o.mMutexRecent; };
    if constexpr (std::is_invocable<decltype(mutex), LocalMapping&>::value) {
      const lock recent(mutex(l));
      member(v, "mlpRecentAddedMapPoints", l.mlpRecentAddedMapPoints, on_retire::erase);
    }
    (void)mutex;
  }
  template <class Visitor, class LoopClosing>
  static void loop_closing(Visitor& v, LoopClosing& l) {
    {
      const lock queue(l.mMutexLoopQueue);
      member(v, "mlpLoopKeyFrameQueue", l.mlpLoopKeyFrameQueue, on_retire::erase);
    }
    scratch(
        v, "mpCurrentKF", l, [](auto& c) -> decltype((c.mpCurrentKF)) { return c.mpCurrentKF; },
        on_retire::null);
    scratch(
        v, "mvpCurrentConnectedKFs", l,
        [](auto& c) -> decltype((c.mvpCurrentConnectedKFs)) { return c.mvpCurrentConnectedKFs; },
        on_retire::erase);
    scratch(
        v, "mpLastCurrentKF", l,
        [](auto& c) -> decltype((c.mpLastCurrentKF)) { return c.mpLastCurrentKF; },
        on_retire::null);
    optional(
        v, "mpLoopLastCurrentKF", l,
        [](auto& c) -> decltype((c.mpLoopLastCurrentKF)) { return c.mpLoopLastCurrentKF; },
        on_retire::null);
    optional(
        v, "mpLoopMatchedKF", l,
        [](auto& c) -> decltype((c.mpLoopMatchedKF)) { return c.mpLoopMatchedKF; },
        on_retire::null);
    optional(
        v, "mpMergeLastCurrentKF", l,
        [](auto& c) -> decltype((c.mpMergeLastCurrentKF)) { return c.mpMergeLastCurrentKF; },
        on_retire::null);
    optional(
        v, "mpMergeMatchedKF", l,
        [](auto& c) -> decltype((c.mpMergeMatchedKF)) { return c.mpMergeMatchedKF; },
        on_retire::null);
    scratch(
        v, "mvpLoopMPs", l, [](auto& c) -> decltype((c.mvpLoopMPs)) { return c.mvpLoopMPs; },
        on_retire::erase);
    scratch(
        v, "mvpLoopMatchedMPs", l,
        [](auto& c) -> decltype((c.mvpLoopMatchedMPs)) { return c.mvpLoopMatchedMPs; },
        on_retire::null);
    scratch(
        v, "mvpLoopMapPoints", l,
        [](auto& c) -> decltype((c.mvpLoopMapPoints)) { return c.mvpLoopMapPoints; },
        on_retire::erase);
    scratch(
        v, "mvpMergeMPs", l, [](auto& c) -> decltype((c.mvpMergeMPs)) { return c.mvpMergeMPs; },
        on_retire::erase);
    scratch(
        v, "mvpMergeMatchedMPs", l,
        [](auto& c) -> decltype((c.mvpMergeMatchedMPs)) { return c.mvpMergeMatchedMPs; },
        on_retire::null);
    scratch(
        v, "mvpMergeConnectedKFs", l,
        [](auto& c) -> decltype((c.mvpMergeConnectedKFs)) { return c.mvpMergeConnectedKFs; },
        on_retire::erase);
    // ORB-SLAM2
    scratch(
        v, "mpMatchedKF", l, [](auto& c) -> decltype((c.mpMatchedKF)) { return c.mpMatchedKF; },
        on_retire::null);
    scratch(
        v, "mvpEnoughConsistentCandidates", l,
        [](auto& c) -> decltype((c.mvpEnoughConsistentCandidates)) {
          return c.mvpEnoughConsistentCandidates;
        },
        on_retire::erase);
    scratch(
        v, "mvpCurrentMatchedPoints", l,
        [](auto& c) -> decltype((c.mvpCurrentMatchedPoints)) { return c.mvpCurrentMatchedPoints; },
        on_retire::null);
    // ORB-SLAM3 still has these groups, and does not use them.
    const auto groups = [](auto& c) -> decltype((c.mvConsistentGroups)) {
      return c.mvConsistentGroups;
    };
    const auto merges = [](auto& c) -> decltype((c.mpMergeMatchedKF)) {
      return c.mpMergeMatchedKF;
    };
    if constexpr (std::is_invocable<decltype(groups), LoopClosing&>::value &&
                  !std::is_invocable<decltype(merges), LoopClosing&>::value)
      for (auto& group : groups(l)) member(v, "mvConsistentGroups", group.first, on_retire::erase);
    (void)merges;
    (void)groups;
  }
  template <class Visitor, class Atlas>
  static void atlas(Visitor& v, Atlas& a) {
    const lock all(a.mMutexAtlas);
    member(v, "mspMaps", a.mspMaps, on_retire::erase);
    member(v, "mspBadMaps", a.mspBadMaps, on_retire::erase);
    member(v, "mpCurrentMap", a.mpCurrentMap);
  }
  template <class Visitor, class FrameDrawer>
  static void drawer(Visitor& v, FrameDrawer& d) {
    const lock all(d.mMutex);
    kept_frame(v, d.mCurrentFrame, "mCurrentFrame.mvpMapPoints", "mCurrentFrame.mpReferenceKF",
               "mCurrentFrame.mpLastKeyFrame");
    // Its vectors are never read through: they may stay raw.
    if constexpr (is_counted<decltype(d.mvpLocalMap)>::value)
      member(v, "mvpLocalMap", d.mvpLocalMap, on_retire::erase);
  }
  template <class Visitor, class System>
  static void system(Visitor& v, System& s) {
    const lock all(s.mMutexState);
    member(v, "mTrackedMapPoints",
           s.mTrackedMapPoints);  // the user has copies until the next frame
  }
};

/// A part of the system as something that a root can describe.
template <class Part>
struct orb_slam_part {
  Part& part;

  template <class Visitor>
  void edges(Visitor& v) {
    orb_slam_members::part(v, part);
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
