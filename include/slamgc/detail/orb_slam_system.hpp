/// @file
/// The parts of an ORB-SLAM system, and the end of its threads and of what they refer to.
#pragma once

#include <mutex>
#include <thread>
#include <type_traits>

#include "../fwd.hpp"
#include "described.hpp"
#include "orb_slam_members.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// As a nested class a friend of ORB-SLAM's classes, too.
struct orb_slam_members::whole_system {
  /// Calls @p f with the parts of a system that purges start from, its tracker first.
  template <class System, class F>
  static auto with_shared_parts(System& s, F f) {
    if constexpr (has<System>(an_atlas))
      return f(*s.mpTracker, s, *s.mpAtlas, *s.mpFrameDrawer);
    else
      return f(*s.mpTracker, s, *s.mpMap);  // ORB-SLAM2
  }
  /// Calls @p f with all parts of a system.
  template <class System, class F>
  static auto with_all_parts(System& s, F f) {
    return with_shared_parts(
        s, [&](auto&... shared) { return f(shared..., *s.mpLocalMapper, *s.mpLoopCloser); });
  }
  /// Asks a system's threads to finish, and waits for them. May be called again.
  template <class System>
  static void join_threads(System& s) {
    const auto is_shut_down = [](auto& o) -> decltype(o.isShutDown()) { return o.isShutDown(); };
    if constexpr (has<System>(is_shut_down)) {
      if (!is_shut_down(s)) s.Shutdown();
    } else {
      s.Shutdown();  // ORB-SLAM2's may be called again
    }
    (void)is_shut_down;
    join(s.mptLocalMapping);
    join(s.mptLoopClosing);
    if (s.mpViewer != nullptr) {
      s.mpViewer->RequestFinish();
      join(s.mptViewer);
    }
  }
  /// Asks a global bundle adjustment to stop, if the part runs one, and has a lock for that.
  template <class Part>
  static void stop_adjustment(Part& p) {
    const auto mutex = [](auto& l) -> decltype((void)l.mbStopGBA, (l.mMutexGBA)) {
      return l.mMutexGBA;
    };
    if constexpr (std::is_invocable<decltype(mutex), Part&>::value) {
      const std::lock_guard<std::mutex> adjustment(mutex(p));
      p.mbStopGBA = true;
    }
    (void)mutex, (void)p;
  }
  /// The part forgets what it refers to, and its maps end.
  template <class Part>
  static void clear(Part& p) {
    constexpr kind is = kind_of<Part>();
    if constexpr (is == kind::atlas) {
      p.clearAtlas();
      p.RemoveBadMaps();
    }
    if constexpr (is == kind::only_map) p.clear();
    if constexpr (is == kind::tracking) p.mlpReferences.clear();
    if constexpr (is == kind::local_mapping) p.mlpRecentAddedMapPoints.clear();
    severing_visitor drop;
    orb_slam_members::part(drop, p);
  }

 private:
  static void join(std::thread& t) {
    if (t.joinable()) t.join();
  }
  static void join(std::thread* t) {
    if (t != nullptr) join(*t);
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
