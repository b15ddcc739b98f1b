#include "Frame.h"

#include <algorithm>

#include "KeyFrame.h"
#include "MapPoint.h"

namespace mini_orb {

Racy<unsigned long> Frame::nNextId;

Features::Features(const Image& image)
    : mTimeStamp(image.time),
      N(static_cast<int>(image.features.size())),
      mGrid(kGridCols, std::vector<std::vector<std::size_t>>(kGridRows)) {
  for (const Feature& feature : image.features) {
    KeyPoint key;
    key.x = static_cast<float>(feature.u);
    key.y = static_cast<float>(feature.v);
    key.octave = feature.octave;
    const std::size_t i = mvKeys.size();
    mvKeys.push_back(key);
    mvDepth.push_back(static_cast<float>(feature.depth));
    mvuRight.push_back(feature.depth > 0 ? key.x - 40 / mvDepth.back() : -1);
    mDescriptors.push_back(feature.descriptor);
    const unsigned word = feature.descriptor[0] + 256u * feature.descriptor[1];
    mBowVec[word] += 1;
    mFeatVec[word % 1024].push_back(static_cast<unsigned>(i));
    const auto column = std::min(kGridCols - 1, static_cast<std::size_t>(key.x / 10));
    const auto row = std::min(kGridRows - 1, static_cast<std::size_t>(key.y / 10));
    mGrid[column][row].push_back(i);
  }
  mvKeysUn = mvKeys;
}

std::vector<std::size_t> Features::GetFeaturesInArea(double x, double y, double r) const {
  std::vector<std::size_t> found;
  const auto cell = [](double at, std::size_t cells) {
    return static_cast<std::size_t>(std::min(std::max(at / 10, 0.0), double(cells - 1)));
  };
  if (mGrid.empty()) return found;
  for (std::size_t c = cell(x - r, kGridCols); c <= cell(x + r, kGridCols); ++c)
    for (std::size_t l = cell(y - r, kGridRows); l <= cell(y + r, kGridRows); ++l)
      for (const std::size_t i : mGrid[c][l])
        if (std::abs(mvKeysUn[i].x - x) < r && std::abs(mvKeysUn[i].y - y) < r) found.push_back(i);
  return found;
}

Vector3d Features::InCamera(std::size_t i) const {
  return Camera::Unproject(mvKeysUn[i].x, mvKeysUn[i].y, mvDepth[i]);
}

Vector3d Features::Ray(std::size_t i) const {
  return Camera::Unproject(mvKeysUn[i].x, mvKeysUn[i].y, 1);
}

int Features::Distance(const Descriptor& a, const Descriptor& b) {
  int bits = 0;
  for (std::size_t i = 0; i != a.size(); ++i)
    bits += __builtin_popcount(static_cast<unsigned>(a[i] ^ b[i]));
  return bits;
}

Frame::Frame(const Image& image)
    : Features(image),
      mnId(nNextId++),
      mvpMapPoints(static_cast<std::size_t>(N), nullptr),
      mvbOutlier(static_cast<std::size_t>(N), false) {}

void Frame::SetPose(const Pose& Tcw) { mTcw = Tcw; }

Vector3d Frame::UnprojectStereo(std::size_t i) const { return mTcw.inverse() * InCamera(i); }

}  // namespace mini_orb
