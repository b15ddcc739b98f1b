// What all classes use: a small pose type, numbers that threads share without a lock, and counts of what is alive.
#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>

namespace mini_orb {

struct Vec3 {
  double x = 0, y = 0, z = 0;

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  double Dot(const Vec3& b) const { return x * b.x + y * b.y + z * b.z; }
  double Norm() const { return std::sqrt(Dot(*this)); }
};

// A rigid transformation of a robot on a floor: a rotation about the vertical axis and a translation.
struct Pose {
  double yaw = 0;
  Vec3 t;

  Vec3 operator*(const Vec3& p) const {
    const double c = std::cos(yaw), s = std::sin(yaw);
    return Vec3{c * p.x - s * p.y, s * p.x + c * p.y, p.z} + t;
  }
  Pose operator*(const Pose& b) const { return {yaw + b.yaw, *this * b.t}; }
  Pose Inverse() const {
    const Pose turn{-yaw, {}};
    return {-yaw, -1.0 * (turn * t)};
  }
  // The way from the identity to this transformation, up to a fraction between 0 and 1.
  Pose Part(double fraction) const {
    return {fraction * std::remainder(yaw, 2 * std::acos(-1.0)), fraction * t};
  }
};

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

// Orders the sets and maps: an order by address would make each run different.
struct ById {
  template <class T>
  bool operator()(const T* a, const T* b) const {
    return a->mnSerial < b->mnSerial;
  }
};

// Whether what is culled is freed: the tests ask.
inline constexpr bool kReclaims = false;

}  // namespace mini_orb
