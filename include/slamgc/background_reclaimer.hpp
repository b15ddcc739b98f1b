/// @file
/// A thread that collects.
#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include "domain.hpp"
#include "fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// How a background_reclaimer works.
struct reclaimer_options {
  /// Between two slices. After one that used its budget up: as long as that took, so that a large backlog takes
  /// half of a processor and no more.
  std::chrono::nanoseconds pause = std::chrono::milliseconds(5);
  budget slice{static_cast<std::size_t>(-1), std::chrono::milliseconds(2), 15};  ///< Of one slice.
  std::function<void()> on_start;  ///< Called first on the new thread: sets its priority, say.
  std::function<void(const domain_stats&)> on_stats;  ///< Called on the thread now and then.
  std::chrono::nanoseconds stats_period =
      std::chrono::seconds(1);  ///< How often on_stats is called.
};

/// A thread of its own that collects a domain in slices, until stop() or its destruction.
///
/// Thread-safety: stop() and wake() by any thread. The functions in its options run on its thread, one at a time, and
/// must not throw; neither they nor destructors on that thread may destroy the reclaimer.
class background_reclaimer {
 public:
  /// Starts the thread. The domain must outlive it. Throws what starting a thread throws.
  explicit background_reclaimer(domain& of, reclaimer_options options = {})
      : domain_(of), options_(std::move(options)), thread_([this] { run(); }) {}
  /// Stops without draining.
  ~background_reclaimer() { end(); }
  background_reclaimer(const background_reclaimer&) = delete;
  background_reclaimer& operator=(const background_reclaimer&) = delete;

  /// Collects now instead of after the pause.
  void wake() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      woken_ = true;
    }
    change_.notify_one();
  }
  /// Ends the thread, then drains the domain on the calling one. Refused where drain() is, and the thread has ended
  /// then; and on the thread itself, which goes on.
  [[nodiscard]] waited stop(std::chrono::nanoseconds timeout = std::chrono::nanoseconds::max()) {
    if (std::this_thread::get_id() == thread_.get_id()) return waited::refused;
    end();
    return domain_.drain(timeout);
  }

 private:
  void end() {
    const std::lock_guard<std::mutex> one_at_a_time(ending_mutex_);
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ending_ = true;
    }
    change_.notify_one();
    if (thread_.joinable()) thread_.join();
  }
  void run() {
    if (options_.on_start) options_.on_start();
    auto told = std::chrono::steady_clock::now();
    std::unique_lock<std::mutex> lock(mutex_);
    while (!ending_) {
      lock.unlock();
      const auto begin = std::chrono::steady_clock::now();
      const collected did = domain_.collect(options_.slice);
      const auto end = std::chrono::steady_clock::now();
      if (options_.on_stats && end - told >= options_.stats_period) {
        told = end;
        tell();
      }
      // A longer one would overflow the clock of wait_for.
      auto pause = std::min<std::chrono::nanoseconds>(options_.pause, std::chrono::hours(24));
      if (did.result == collected::outcome::partial) pause = end - begin;
      lock.lock();
      change_.wait_for(lock, pause, [this] { return ending_ || woken_; });
      woken_ = false;
    }
  }

  /// Not when there is no memory for it.
  void tell() {
#if defined(__cpp_exceptions)
    try {
      options_.on_stats(domain_.stats());
    } catch (const std::bad_alloc&) {
    }
#else
    options_.on_stats(domain_.stats());
#endif
  }

  domain& domain_;
  const reclaimer_options options_;
  std::mutex ending_mutex_;
  std::mutex mutex_;
  std::condition_variable change_;
  bool ending_ = false;
  bool woken_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
