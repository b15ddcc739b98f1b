/// @file
/// slamgc in ORB-SLAM3: what is known of its classes, so that a change of some hundred lines is enough. docs/orb-slam3.md is the guide.
///
/// ORB-SLAM3's members become counted ones, under the names that they have; locals, parameters and return types stay raw pointers.
/// Three base classes make keyframes, points and maps objects; `access`, a friend of ORB-SLAM3's classes, knows what
/// becomes of each member when its target is retired; a `thread` in each Run() and a `frame` in each TrackX() say when the thread
/// holds no pointer; a `session` reclaims in the background.
///
/// Nothing of ORB-SLAM3 is included here, and its classes are template parameters: a fork with other types compiles, too. Members
/// that a system does not have (ORB-SLAM2 has fewer) are left out; a member that it has and that is not counted yet is left
/// out as well, until session::add() and `thread` refuse to compile.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "../anchor.hpp"
#include "../background_reclaimer.hpp"
#include "../containers/rc_list.hpp"
#include "../containers/rc_map.hpp"
#include "../containers/rc_set.hpp"
#include "../containers/rc_vector.hpp"
#include "../deferred.hpp"
#include "../detail/orb_slam_members.hpp"
#include "../domain.hpp"
#include "../mutator.hpp"
#include "../pin.hpp"
#include "../rc_object.hpp"
#include "../rc_slot.hpp"
#include "../registry.hpp"
#include "../root.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// A part of the system as a root.
template <class Part>
struct orb_slam_root {
  template <class Of>
  orb_slam_root(Of& of, const char* name, Part& p) : part{p}, place(of, name, part) {}
  orb_slam_part<Part> part;
  root place;
};

/// The global bundle adjustments that were asked for and have not ended.
class orb_slam_adjustments {
 public:
  /// Those of the process. Never destroyed: an adjustment nobody waits for may end after main().
  static orb_slam_adjustments& all() {
    static auto& instance = *new orb_slam_adjustments;
    return instance;
  }
  /// One more, until the last copy of what this returns is gone.
  std::shared_ptr<void> begin() {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::shared_ptr<void> one(this, [](orb_slam_adjustments* all) { all->end(); });
    ++running_;
    return one;
  }
  /// Waits until there is none.
  void wait() {
    std::unique_lock<std::mutex> lock(mutex_);
    none_.wait(lock, [this] { return running_ == 0; });
  }

 private:
  void end() {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (--running_ == 0) none_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable none_;
  std::size_t running_ = 0;
};

}  // namespace detail
namespace orb_slam3 {

/// What may read the members of ORB-SLAM3's classes: `friend slamgc::orb_slam3::access;` in each class that the guide names.
using access = detail::orb_slam_members;

/// What a reclaimed keyframe leaves for the trajectory.
template <class KeyFrame, class Pose>
struct pose_record {
  bool bad = false;                           ///< Whether it was culled; else its map was cleared.
  Pose mTcp{};                                ///< Of a bad one: to its parent.
  Pose Tcw{};                                 ///< Where it was.
  anchor<KeyFrame, pose_record> parent = {};  ///< Its parent, or what that has left.
};

/// Base class of `KeyFrame`. @p Pose is what its GetPose() returns by value: `Sophus::SE3f`.
///
/// ```
/// class KeyFrame : public slamgc::orb_slam3::keyframe_base<KeyFrame, Sophus::SE3f> {
///   friend slamgc::orb_slam3::access;
/// ```
template <class KeyFrame, class Pose>
class keyframe_base : public rc_object<KeyFrame, fetch_add_counter, reclaim_retired>,
                      public enable_anchor<KeyFrame, pose_record<KeyFrame, Pose>> {
 public:
  /// Describes its members, under its locks.
  template <class Visitor>
  void edges(Visitor& v) {
    access::keyframe(v, static_cast<KeyFrame&>(*this));
  }
  /// What it leaves. Takes its locks.
  pose_record<KeyFrame, Pose> record() {
    auto& me = static_cast<KeyFrame&>(*this);
    return {me.isBad(), me.mTcp, me.GetPose(),
            anchor<KeyFrame, pose_record<KeyFrame, Pose>>(me.GetParent())};
  }
  /// Reports call it by its mnId.
  std::uint64_t report_id() const { return static_cast<const KeyFrame&>(*this).mnId; }
};

/// Base class of `MapPoint`.
template <class MapPoint>
class map_point_base : public rc_object<MapPoint, fetch_add_counter, reclaim_retired> {
 public:
  /// Describes its members, under its locks.
  template <class Visitor>
  void edges(Visitor& v) {
    access::map_point(v, static_cast<MapPoint&>(*this));
  }
  /// Reports call it by its mnId.
  std::uint64_t report_id() const { return static_cast<const MapPoint&>(*this).mnId; }
};

/// Base class of `Map`.
template <class Map>
class map_base : public rc_object<Map, fetch_add_counter, reclaim_retired> {
 public:
  /// Describes its members, under its lock.
  template <class Visitor>
  void edges(Visitor& v) {
    access::map(v, static_cast<Map&>(*this));
  }
};

/// An element of `Tracking::mlpReferences`: a keyframe, or what it has left.
///
/// ```
/// std::list<slamgc::orb_slam3::trajectory_reference<KeyFrame, Sophus::SE3f>> mlpReferences;
/// ```
///
/// Thread-safety: that of anchor. walk() and Trw() on a thread that has a `thread` or a `frame`.
template <class KeyFrame, class Pose>
class trajectory_reference {
 public:
  /// Of a keyframe, or none.
  trajectory_reference(KeyFrame* pKF = nullptr) : anchor_(pKF) {}
  /// Of what a slot refers to.
  trajectory_reference(const rc_slot<KeyFrame>& pKF) : anchor_(pKF) {}

  /// Whether there is a keyframe, or was one.
  [[nodiscard]] explicit operator bool() const noexcept { return static_cast<bool>(anchor_); }

  /// From here to the first keyframe that is not bad, through the parents, as ORB-SLAM3's loop
  /// `while (pKF->isBad()) { Trw = Trw * pKF->mTcp; pKF = pKF->GetParent(); }` does, multiplication by multiplication. Null if
  /// there is none, or if its map was cleared and it is gone. O(culled keyframes on the way).
  KeyFrame* walk(Pose& Trw) const {
    return walk([&Trw](const Pose& mTcp) { Trw = Trw * mTcp; }).keyframe;
  }
  /// The same, of which the pose is of no interest.
  [[nodiscard]] KeyFrame* walk() const {
    return walk([](const Pose&) {}).keyframe;
  }
  /// `Trw` after that loop and `Trw = Trw * pKF->GetPose()`; where the keyframe was, if it is gone. @p identity is what the
  /// loop begins with.
  [[nodiscard]] Pose Trw(Pose identity = Pose()) const {
    const end last = walk([&identity](const Pose& mTcp) { identity = identity * mTcp; });
    return last.Tcw ? Pose(identity * *last.Tcw) : identity;
  }

 private:
  using record = pose_record<KeyFrame, Pose>;
  using link = anchor<KeyFrame, record>;
  struct end {
    KeyFrame* keyframe = nullptr;
    std::optional<Pose> Tcw{};
  };

  template <class F>
  end walk(F passes) const {
    link at = anchor_;
    end last;
    while (at) {
      at = at.read(
          [&](KeyFrame& kf) {
            link parent;
            if (kf.isBad()) parent = link(kf.GetParent());
            if (parent)
              passes(kf.mTcp);
            else
              last = {kf.isBad() ? nullptr : &kf, kf.GetPose()};
            return parent;
          },
          [&](const record& r) {
            link parent;
            if (r.bad) parent = r.parent;
            if (parent)
              passes(r.mTcp);
            else
              last.Tcw = r.Tcw;
            return parent;
          });
    }
    return last;
  }

  link anchor_;
};

/// Registers the calling thread while it exists: the first line of `LocalMapping::Run`, `LoopClosing::Run`, `Viewer::Run`, and of
/// what a user's thread calls while the system runs, such as `System::SaveTrajectoryTUM`. (`System::TrackX` has a frame.)
///
/// What the thread reads from the map stays valid until its next usleep() or quiescent(), or the end of this. It reclaims nothing.
/// Thread-safety: for the thread that makes it.
class thread {
 public:
  /// @p name stays valid, as a string literal does. Throws std::bad_alloc.
  explicit thread(const char* name) : mutator_(name, {true, true, false}) {}
  /// With the members of @p part, `*this` in Run(), that no lock guards: this thread drops stale references from them, and
  /// empties those that need not be counted, since it alone uses them, whenever it holds no pointer.
  template <class Part>
  thread(const char* name, Part& part) : thread(name) {
    access::check_own_thread<Part>();
    part_ = std::make_shared<detail::orb_slam_root<Part>>(mutator_, name, part);
    forget_ = [&part] { access::forget(part); };
  }
  thread(const thread&) = delete;
  thread& operator=(const thread&) = delete;

  /// The thread holds no pointer now.
  void quiescent() {
    if (forget_) forget_();
    mutator_.quiescent();
  }
  /// Sleeps so many microseconds. The thread holds no pointer meanwhile.
  void usleep(unsigned microseconds) {
    if (forget_) forget_();
    const mutator::offline_scope offline(mutator_);
    std::this_thread::sleep_for(std::chrono::microseconds(microseconds));
  }

 private:
  friend class adjustment;

  mutator mutator_;
  std::function<void()> forget_;  // what the part's raw members refer to
  std::shared_ptr<void> part_;    // an orb_slam_root; ends first
};

/// The thread of a global bundle adjustment, which may take minutes. See adjusting().
class adjustment {
 public:
  /// Registers the calling thread. Throws std::bad_alloc.
  adjustment() : thread_("GlobalBA"), outer_(std::exchange(of_this_thread(), this)) {}
  ~adjustment() { of_this_thread() = outer_; }
  adjustment(const adjustment&) = delete;
  adjustment& operator=(const adjustment&) = delete;

  /// Runs @p f. On a thread with an adjustment, and no `thread` or `frame`, nobody waits for it, and what is in the vectors @p pinned
  /// stays alive; @p f, and its caller afterwards, use nothing else of the map that was read before. On other threads it just
  /// runs @p f, so that tracking may call `Optimizer::BundleAdjustment`, too. O(what is pinned).
  ///
  /// ```
  /// slamgc::orb_slam3::adjustment::optimize([&] { optimizer.optimize(nIterations); }, vpKFs, vpMP);
  /// ```
  template <class F, class... Objects>
  static void optimize(F&& f, const std::vector<Objects*>&... pinned) {
    adjustment* const me = of_this_thread();
    if (me == nullptr) return std::forward<F>(f)();
    const std::tuple<pin_set<Objects>...> pins(pinned...);
    const mutator::offline_scope offline(me->thread_.mutator_);
    std::forward<F>(f)();
  }

 private:
  static adjustment*& of_this_thread() noexcept {
    thread_local adjustment* innermost = nullptr;
    return innermost;
  }

  thread thread_;
  adjustment* const outer_;
};

/// What a thread for a global bundle adjustment of @p pMap runs: `f(args...)`, registered, and with the map pinned from now on.
///
/// ```
/// mpThreadGBA = new thread(slamgc::orb_slam3::adjusting(
///     pLoopMap, &LoopClosing::RunGlobalBundleAdjustment, this, pLoopMap, mpCurrentKF->mnId));
/// ```
template <class Map, class F, class... Args>
[[nodiscard]] auto adjusting(Map* pMap, F f, Args... args) {
  return [running = detail::orb_slam_adjustments::all().begin(), pinned = pin<Map>(pMap), f,
          args...]() mutable {
    {
      const adjustment me;
      std::invoke(f, args...);
      pinned.reset();
    }
    running.reset();
  };
}

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
    access::with_shared_parts(system, [this](auto&... parts) { this->add(parts...); });
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
  /// itself. Returns what end(parts...) does.
  template <class System>
  waited end(System& system) {
    access::join_threads(system);
    return access::with_all_parts(system,
                                  [this](auto&... parts) { return this->end_parts(parts...); });
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

  template <class... Parts>
  waited end_parts(Parts&... parts) {
    stop();
    (..., access::stop_adjustment(parts));
    detail::orb_slam_adjustments::all().wait();
    roots_.clear();
    forget_.clear();
    {
      const thread here("System");
      (..., access::clear(parts));
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
