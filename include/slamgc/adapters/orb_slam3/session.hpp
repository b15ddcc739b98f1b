/// @file
/// From the start of an ORB-SLAM3 system to its end. See ../orb_slam3.hpp.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "../../background_reclaimer.hpp"
#include "../../detail/orb_slam_system.hpp"
#include "../../domain.hpp"
#include "../../mutator.hpp"
#include "threads.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace orb_slam3 {

/// Reclaims what ORB-SLAM3 marks: a member of `System`.
///
/// ```
/// mSlamgc.start(*this);                              // in System's constructor
/// const slamgc::orb_slam3::frame here(mSlamgc);      // first line of each TrackX
/// mSlamgc.stop();                                    // in Shutdown()
/// System::~System() { mSlamgc.end(*this); }
/// ```
class session {
 public:
  /// What purges start from, for a program that has other parts than ORB-SLAM3's System. @p tracker is what a frame's thread
  /// owns; @p parts are those that several threads change, under their locks. Does not compile while a member of theirs, or of
  /// keyframes, points and maps, is a raw pointer, unless own() empties it. Throws std::bad_alloc.
  template <class Tracking, class... Parts>
  void add(Tracking& tracker, Parts&... parts) {
    (..., access::check<Parts>());
    own(tracker);
    (..., put(default_domain(), parts));
  }
  /// For a program that runs another part on tracking's thread. Members that are filled anew before they are used need not be
  /// counted: the end of each `frame` empties them. Throws std::bad_alloc.
  template <class Part>
  void own(Part& part) {
    access::check_own_thread<Part>();
    put(tracking_, part);
    forget_.push_back([&part] { access::forget(part); });
  }
  /// add() with what @p system consists of, and start(): the last line of its constructor.
  template <class System>
  void start(System& system) {
    whole_system::with_shared_parts(system, [this](auto&... parts) { this->add(parts...); });
    start();
  }
  /// Begins to reclaim, on a thread of its own. Without it a program calls `slamgc::default_domain().collect()` itself.
  /// Throws what starting a thread throws.
  void start() { reclaimer_ = std::make_unique<background_reclaimer>(default_domain()); }
  /// No longer reclaims; so what walks through the map without its locks, as SaveAtlas does, may do so. In Shutdown(); by any thread, and
  /// more than once.
  void stop() {
    const std::lock_guard<std::mutex> lock(stopping_);
    reclaimer_.reset();
  }
  /// Reclaims what was marked before and what nobody uses any more; what the tracker keeps, too. Between two frames, by whoever tracks. Returns
  /// waited::refused on a thread with a `thread` or a `frame`. While other threads go on marking, it waits for a moment at which nothing
  /// is left to be reclaimed, up to @p timeout.
  waited drain(std::chrono::nanoseconds timeout = std::chrono::nanoseconds::max()) {
    // What the tracker lets go of may be all that kept other things that it keeps.
    constexpr int rounds = 4;
    const auto begin = std::chrono::steady_clock::now();
    waited result = default_domain().drain(timeout);
    for (int i = 0; i != rounds && result == waited::done; ++i) {
      { const mutator::online_scope here(tracking_); }
      const std::chrono::nanoseconds gone = std::chrono::steady_clock::now() - begin;
      result = default_domain().drain(timeout - std::min(timeout, gone));
    }
    return result;
  }
  /// Ends @p system, in its destructor: asks its threads to finish, with Shutdown() and Viewer::RequestFinish(), joins those that
  /// can be joined, and ends the parts. Threads that do not finish are waited for without an end. Not on one of these threads: none can join
  /// itself. May be called again. Returns what end(parts...) does.
  template <class System>
  waited end(System& system) {
    whole_system::join_threads(system);
    return whole_system::with_all_parts(
        system, [this](auto&... parts) { return this->end_parts(parts...); });
  }
  /// Ends: a global bundle adjustment that still runs is asked to stop, and waited for, if adjusting() began it; each part forgets what
  /// it refers to, maps are cleared, and what they held is reclaimed. No other thread uses the system any more, and no frame
  /// is open. For a program that has other parts than ORB-SLAM3's System: at least two. Returns waited::done if nothing is left that can be
  /// reclaimed: what the program pins stays, see stats().
  template <class First, class Second, class... Parts>
  waited end(First& first, Second& second, Parts&... parts) {
    return end_parts(first, second, parts...);
  }

 private:
  friend class frame;
  using whole_system = access::whole_system;

  template <class... Parts>
  waited end_parts(Parts&... parts) {
    stop();
    (..., whole_system::stop_adjustment(parts));
    detail::orb_slam_adjustments::all().wait();
    roots_.clear();
    forget_.clear();
    {
      const thread here("System");
      (..., whole_system::clear(parts));
    }
    return default_domain().drain();
  }

  template <class Of, class Part>
  void put(Of& of, Part& part) {
    roots_.push_back(std::make_shared<detail::orb_slam_root<Part>>(of, access::name<Part>(), part));
  }

  mutator tracking_{"Tracking", {false, true, true}};
  std::vector<std::shared_ptr<void>> roots_;   // orb_slam_roots
  std::vector<std::function<void()>> forget_;  // what their raw members refer to
  int frames_ = 0;                             // nested ones: of one thread at a time
  std::unique_ptr<background_reclaimer> reclaimer_;
  std::mutex stopping_;
};

/// One call of `System::TrackX`: the calling thread may use the map while this exists. Whichever thread calls, but one at a time.
/// One read-modify-write, and one for each type of which objects were marked in the frame.
class frame {
 public:
  /// Goes online.
  explicit frame(session& of) : session_(of), online_(of.tracking_) { ++of.frames_; }
  /// Empties what the tracker need not count, and goes offline, unless it is within another frame.
  ~frame() {
    if (--session_.frames_ != 0) return;
    for (const auto& forget : session_.forget_) forget();
  }
  frame(const frame&) = delete;
  frame& operator=(const frame&) = delete;

 private:
  session& session_;
  mutator::online_scope online_;
};

}  // namespace orb_slam3
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
