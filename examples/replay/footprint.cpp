#include "footprint.hpp"

namespace replay {

keyframe_footprint::keyframe_footprint(std::uint64_t id, std::size_t features)
    : mvKeys(features),
      mvKeysRight(features),
      mvuRight(features, -1.F),
      mvDepth(features, -1.F),
      mDescriptors(features) {
  mGrid.assign(grid_columns, std::vector<std::vector<std::size_t>>(grid_rows));
  for (std::size_t i = 0; i != features; ++i) {
    const std::uint64_t r = mixed(id, i);
    mvKeys[i] = {static_cast<float>(r % 752),
                 static_cast<float>((r >> 16) % 480),
                 31,
                 0,
                 20,
                 static_cast<int>((r >> 40) % 8),
                 -1};
    for (std::size_t j = 0; j != 4; ++j) mDescriptors[i][j] = mixed(r, j);
    mGrid[(r % 752) * grid_columns / 752][((r >> 16) % 480) * grid_rows / 480].push_back(i);
    const unsigned word = static_cast<unsigned>((r >> 24) % words_of_vocabulary);
    mBowVec[word] += 1.0 / static_cast<double>(features);
    mFeatVec[word % 100].push_back(static_cast<unsigned>(i));
  }
  mvKeysUn = mvKeys;
}

}  // namespace replay
