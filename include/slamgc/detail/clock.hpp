/// @file
/// Time, apart from env.hpp because `<chrono>` and `<thread>` are large.
#pragma once

#include <chrono>
#include <thread>

#include "../fwd.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// The time of an environment: real, unless it specialises this.
template <class Env>
struct clock_of {
  using time_point = std::chrono::steady_clock::time_point;

  static time_point now() noexcept { return std::chrono::steady_clock::now(); }

  /// Lets other threads run for about @p time; zero is a yield.
  static void pause(std::chrono::nanoseconds time) noexcept {
    if (time.count() == 0)
      std::this_thread::yield();
    else
      std::this_thread::sleep_for(time);
  }
};

}  // namespace SLAMGC_SHARED
}  // namespace slamgc
