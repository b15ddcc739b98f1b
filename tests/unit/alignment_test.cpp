// Alignment and allocation stay what the object's own class makes of them.
#include <slamgc/intrusive_rc.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <new>

#include "support/instances.hpp"

#if __has_include(<Eigen/Core>)
#include <Eigen/Core>
#define SLAMGC_TEST_EIGEN 1
#elif __has_include(<eigen3/Eigen/Core>)
#include <eigen3/Eigen/Core>
#define SLAMGC_TEST_EIGEN 1
#endif

namespace {

using slamgc::make_rc;

bool is_aligned(const void* p, std::size_t alignment) {
  return reinterpret_cast<std::uintptr_t>(p) % alignment == 0;
}

struct over_aligned : slamgc::rc_object<over_aligned>, support::instances<over_aligned> {
  char before = 1;
  alignas(64) double pose[8] = {};
  char after = 2;
};
static_assert(alignof(over_aligned) == 64);

TEST(Alignment, AnOverAlignedMemberIsAligned) {
  for (int i = 0; i != 100; ++i) {
    const auto p = make_rc<over_aligned>();
    EXPECT_TRUE(is_aligned(p->pose, 64));
    EXPECT_TRUE(is_aligned(p.get(), 64));
  }
  EXPECT_EQ(over_aligned::live(), 0);
}

struct pooled : slamgc::rc_object<pooled> {
  static void* operator new(std::size_t size) {
    ++allocated;
    return ::operator new(size);
  }
  static void operator delete(void* p, std::size_t size) noexcept {
    ++freed;
    freed_size = size;
    ::operator delete(p);
  }
  static inline int allocated = 0;
  static inline int freed = 0;
  static inline std::size_t freed_size = 0;
  char payload[100] = {};
};

TEST(Allocation, TheOperatorsOfTheClassAreUsed) {
  const int allocated = pooled::allocated;
  const int freed = pooled::freed;
  auto p = make_rc<pooled>();
  EXPECT_EQ(pooled::allocated, allocated + 1);
  EXPECT_EQ(pooled::freed, freed);
  p.reset();
  EXPECT_EQ(pooled::freed, freed + 1);
  EXPECT_EQ(pooled::freed_size, sizeof(pooled));
}

struct pooled_base : slamgc::rc_object<pooled_base> {
  virtual ~pooled_base() = default;
};
struct pooled_derived : pooled_base {
  static void* operator new(std::size_t size) { return ::operator new(size); }
  static void operator delete(void* p, std::size_t size) noexcept {
    ++freed;
    EXPECT_EQ(size, sizeof(pooled_derived));
    ::operator delete(p);
  }
  static inline int freed = 0;
  long more = 0;
};

TEST(Allocation, TheOperatorsOfTheMostDerivedClassAreUsed) {
  const int freed = pooled_derived::freed;
  slamgc::intrusive_rc<pooled_base> p = make_rc<pooled_derived>();
  p.reset();
  EXPECT_EQ(pooled_derived::freed, freed + 1);
}

#ifdef SLAMGC_TEST_EIGEN

struct eigen_keyframe : slamgc::rc_object<eigen_keyframe>, support::instances<eigen_keyframe> {
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW

  char before = 1;
  Eigen::Matrix4f pose = Eigen::Matrix4f::Identity();
  Eigen::Vector4d translation = Eigen::Vector4d::Zero();
};

TEST(Alignment, FixedSizeEigenMembersAreAligned) {
  for (int i = 0; i != 100; ++i) {
    const auto p = make_rc<eigen_keyframe>();
    EXPECT_TRUE(is_aligned(p->pose.data(), alignof(Eigen::Matrix4f)));
    EXPECT_TRUE(is_aligned(p->translation.data(), alignof(Eigen::Vector4d)));
    p->pose = p->pose * p->pose;
    EXPECT_EQ(p->pose, Eigen::Matrix4f::Identity());
  }
  EXPECT_EQ(eigen_keyframe::live(), 0);
}

#endif

}  // namespace
