// A simulated world: landmarks on both sides of a round track, and what a camera with depth sees of them. Each run with the
// same seed sees the same.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "Common.h"

namespace mini_orb {

using Descriptor = std::array<std::uint8_t, 32>;

struct Feature {
  double u = 0, v = 0;  // pixels
  double depth = -1;    // metres; negative: not measured
  int octave = 0;       // scale level
  Descriptor descriptor{};
};

// What the camera delivers.
struct Image {
  double time = 0;  // seconds
  std::vector<Feature> features;
};

struct Camera {
  static constexpr double f = 320, cx = 320, cy = 240, width = 640, height = 480;  // pixels
  static constexpr int levels = 8;

  // Forward is x, left is y, up is z.
  static bool Project(const Vector3d& p, double& u, double& v) {
    if (p.x() < 0.1) return false;
    u = cx - f * p.y() / p.x();
    v = cy - f * p.z() / p.x();
    return u >= 0 && u < width && v >= 0 && v < height;
  }
  static Vector3d Unproject(double u, double v, double depth) {
    return Vector3d(depth, (cx - u) / f * depth, (cy - v) / f * depth);
  }
};

class World {
 public:
  // features: how many a frame has at most.
  World(std::uint64_t seed, int features);

  // The camera drives round the track, this far in each frame (radians).
  static constexpr double kStep = 0.04;
  static constexpr int kLap = 157;  // frames
  static Pose TruePose(double angle);

  // What is seen at an angle of the track. number: of the frame, for its noise.
  Image Look(double angle, std::uint64_t number) const;
  // The camera is covered.
  static Image Dark(std::uint64_t number);

 private:
  struct Landmark {
    Vector3d position;
    Descriptor descriptor;
    bool depth;  // whether its depth can be measured
  };

  const std::uint64_t mSeed;
  const std::size_t mnFeatures;
  std::vector<Landmark> mvLandmarks;
};

}  // namespace mini_orb
