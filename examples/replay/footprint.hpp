// What a keyframe and a point of ORB-SLAM3 own besides references: as many bytes, in as many blocks.
//
// Measured on ORB-SLAM3 v1.0: sizeof(KeyFrame) 4640 bytes, with all that it owns 308 to 354 kB for 1,000 to 1,200 features;
// sizeof(MapPoint) 672 bytes, with all that it owns 1.17 to 1.40 kB.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

namespace replay {

using descriptor = std::array<std::uint64_t, 4>;  // 256 bits, as ORB

inline unsigned distance(const descriptor& a, const descriptor& b) {
  int n = 0;
  for (std::size_t i = 0; i != a.size(); ++i) n += __builtin_popcountll(a[i] ^ b[i]);
  return static_cast<unsigned>(n);
}

// The same for the same numbers, on every run.
inline std::uint64_t mixed(std::uint64_t a, std::uint64_t b) {
  std::uint64_t x = a * 0x9e3779b97f4a7c15ULL + b + 0x7f4a7c15ULL;
  x ^= x >> 31;
  x *= 0xbf58476d1ce4e5b9ULL;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

struct keypoint {  // cv::KeyPoint
  float x, y, size, angle, response;
  int octave, class_id;
};

constexpr std::size_t grid_columns = 64, grid_rows = 48, words_of_vocabulary = 10000;

struct keyframe_footprint {
  keyframe_footprint(std::uint64_t id, std::size_t features);

  std::vector<keypoint> mvKeys, mvKeysUn, mvKeysRight;
  std::vector<float> mvuRight, mvDepth;
  std::vector<descriptor> mDescriptors;
  std::map<unsigned, double> mBowVec;
  std::map<unsigned, std::vector<unsigned>> mFeatVec;
  std::vector<std::vector<std::vector<std::size_t>>> mGrid;
  std::array<unsigned char, 3952> poses_calibration_and_preintegration{};
};

struct point_footprint {
  using block = std::array<unsigned char, 112>;
  point_footprint() : mDescriptor(new block{}), mDescriptorHeader(new block{}) {}  // cv::Mat
  std::array<float, 3> mWorldPos{}, mNormalVector{};
  descriptor best{};
  std::unique_ptr<block> mDescriptor, mDescriptorHeader;
  std::array<unsigned char, 416> counters_and_tracking_variables{};
};

}  // namespace replay
