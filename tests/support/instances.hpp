// Test objects that are counted: how many of a type are alive.
#pragma once

#include <atomic>

namespace support {

// Base class: counts the objects of type T that exist. Knows nothing of slamgc, so tests of both
// flavours may share it.
template <class T>
class instances {
 public:
  [[nodiscard]] static int live() noexcept { return live_.load(); }

 protected:
  instances() noexcept { ++live_; }
  instances(const instances&) noexcept { ++live_; }
  instances& operator=(const instances&) noexcept = default;
  ~instances() { --live_; }

 private:
  static inline std::atomic<int> live_{0};
};

}  // namespace support
