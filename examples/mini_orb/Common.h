// What all classes use: the types of Eigen, numbers that threads share without a lock, and counts of what is alive.
#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <vector>

namespace mini_orb {

using Eigen::Vector3d;
// Of ORB-SLAM3's Sophus::SE3f the part that is used here.
using Pose = Eigen::Isometry3d;

// A member that ORB-SLAM3 writes and reads on several threads without a lock (README.md lists them): an atomic with the order
// that a plain member has on x86.
template <class T>
class Racy {
 public:
  Racy(T value = T()) : value_(value) {}
  Racy(const Racy& other) : value_(other.Get()) {}
  Racy& operator=(const Racy& other) { return *this = other.Get(); }
  Racy& operator=(T value) {
    value_.store(value, std::memory_order_release);
    return *this;
  }
  T Get() const { return value_.load(std::memory_order_acquire); }
  operator T() const { return Get(); }
  T operator->() const { return Get(); }
  T operator++(int) { return value_.fetch_add(1, std::memory_order_relaxed); }
  Racy& operator+=(T more) {
    value_.fetch_add(more, std::memory_order_acq_rel);
    return *this;
  }

 private:
  std::atomic<T> value_;
};

// Base class that counts how many T there are. mnSerial tells in which order they were made; never used twice, as mnId is
// after a reset.
template <class T>
class Instances {
 public:
  static long Alive() { return alive_.load(); }
  static long Made() { return made_.load(); }
  // How many ended on threads that had called ForbidHere().
  static long EndedWhereForbidden() { return ended_where_forbidden_.load(); }
  static void ForbidHere() { forbidden_here_ = true; }
  const long mnSerial = made_++;

 protected:
  Instances() { ++alive_; }
  Instances(const Instances&) : Instances() {}
  Instances& operator=(const Instances&) { return *this; }
  ~Instances() {
    --alive_;
    if (forbidden_here_) ++ended_where_forbidden_;
  }

 private:
  static inline std::atomic<long> alive_{0};
  static inline std::atomic<long> made_{0};
  static inline std::atomic<long> ended_where_forbidden_{0};
  static inline thread_local bool forbidden_here_ = false;
};

// What a thread takes each time that it does something, in microseconds.
struct Times {
  std::vector<double> elapsed_us, processor_us;
};

// Adds the microseconds of its life, and those of its thread's processor time, to two lists.
class Stopwatch {
 public:
  explicit Stopwatch(Times& to) : to_(to) {}
  ~Stopwatch() {
    to_.processor_us.push_back(Processor() - processor_);
    to_.elapsed_us.push_back(
        std::chrono::duration<double, std::micro>(Clock::now() - begin_).count());
  }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  using Clock = std::chrono::steady_clock;
  static double Processor() {
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
  }

  Times& to_;
  const Clock::time_point begin_ = Clock::now();
  const double processor_ = Processor();
};

// Orders the sets and maps: an order by address would make each run different.
struct ById {
  template <class T>
  bool operator()(const T* a, const T* b) const {
    return a->mnSerial < b->mnSerial;
  }
};

}  // namespace mini_orb
