/// @file
/// Threads that use an ORB-SLAM3 map: those with a loop, and those of a global bundle adjustment. See ../orb_slam3.hpp.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

#include "../../mutator.hpp"
#include "../../pin.hpp"
#include "../../root.hpp"
#include "objects.hpp"

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

}  // namespace orb_slam3
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
