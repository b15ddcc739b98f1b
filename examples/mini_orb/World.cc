#include "World.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mini_orb {
namespace {

// A hash by multiplication and shifts, one after the other.
std::uint64_t Mix(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}
// Between 0 and 1.
double Uniform(std::uint64_t key) { return static_cast<double>(Mix(key) >> 11) * 0x1p-53; }
// Between -a and a.
double Noise(std::uint64_t key, double a) { return a * (2 * Uniform(key) - 1); }

constexpr double kRadius = 10;  // of the track, metres
constexpr double kSight = 8;    // metres

}  // namespace

World::World(std::uint64_t seed, int features)
    : mSeed(Mix(seed)), mnFeatures(static_cast<std::size_t>(features)) {
  for (std::size_t i = 0; i != 12 * mnFeatures; ++i) {
    const std::uint64_t key = mSeed + 16 * i;
    const double side = Uniform(key) < 0.5 ? -1 : 1;
    const double radius = kRadius + side * (1.5 + 3.5 * Uniform(key + 1));
    const double angle = 2 * std::acos(-1.0) * Uniform(key + 2);
    Landmark mark;
    mark.position = {radius * std::cos(angle), radius * std::sin(angle), Noise(key + 3, 1.5)};
    for (std::size_t byte = 0; byte != mark.descriptor.size(); ++byte)
      mark.descriptor[byte] =
          static_cast<std::uint8_t>(Mix(key + 4 + byte / 8) >> (8 * (byte % 8)));
    mark.depth = Uniform(key + 8) < 0.9;
    mvLandmarks.push_back(mark);
  }
}

Pose World::TruePose(double angle) {
  const double turn = std::acos(-1.0) / 2;
  Pose Twc(Eigen::AngleAxisd(angle + turn, Vector3d::UnitZ()));
  Twc.translation() = Vector3d(kRadius * std::cos(angle), kRadius * std::sin(angle), 0);
  return Twc.inverse();
}

Image World::Look(double angle, std::uint64_t number) const {
  Image image = Dark(number);
  const Pose Tcw = TruePose(angle);
  std::vector<std::pair<double, std::size_t>> seen;
  for (std::size_t i = 0; i != mvLandmarks.size(); ++i) {
    double u, v;
    const Vector3d p = Tcw * mvLandmarks[i].position;
    if (p.x() > 0.5 && p.x() < kSight && Camera::Project(p, u, v)) seen.emplace_back(p.x(), i);
  }
  std::sort(seen.begin(), seen.end());
  if (seen.size() > mnFeatures) seen.resize(mnFeatures);
  for (const auto& [depth, i] : seen) {
    const std::uint64_t key = Mix(mSeed + Mix(number) + i);
    Feature feature;
    feature.descriptor = mvLandmarks[i].descriptor;
    // The first bytes make its word: they are seen without noise.
    for (std::uint64_t flip = 0; flip != 4; ++flip) {
      const std::uint64_t bit = 32 + Mix(key + 8 + flip) % 224;
      feature.descriptor[bit / 8] =
          static_cast<std::uint8_t>(feature.descriptor[bit / 8] ^ (1u << (bit % 8)));
    }
    const Vector3d p = Tcw * mvLandmarks[i].position +
                       Vector3d(Noise(key, 0.01), Noise(key + 1, 0.01), Noise(key + 2, 0.01));
    if (!Camera::Project(p, feature.u, feature.v)) continue;
    if (mvLandmarks[i].depth) feature.depth = p.x();
    // A thing that is near is large.
    const double level = std::log(kSight / p.x()) / std::log(1.2) / 2 + Noise(key + 3, 0.3);
    feature.octave = std::min(Camera::levels - 1, std::max(0, static_cast<int>(level)));
    image.features.push_back(feature);
  }
  return image;
}

Image World::Dark(std::uint64_t number) {
  Image image;
  image.time = 0.05 * static_cast<double>(number);
  return image;
}

}  // namespace mini_orb
