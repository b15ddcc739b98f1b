// What the thesis published: "Automatic Memory Management in ORB SLAM-3", chapter 4, means over the eleven sequences of EuRoC.
#pragma once

#include <vector>

namespace replay {

struct thesis_row {
  const char* scheme;  // the one here that it is about
  const char* name;
  const char* source;       // where it is published
  const char* outcome;      // in words; empty: see the numbers
  int marked[2], freed[2];  // keyframes, points; -1: not published
  double percent[2];
  double raw_marked_mb[2], raw_freed_mb[2];  // count times sizeof
  double seconds, mapping_ms, tracking_ms;   // means
  int processed[2];
};

constexpr int thesis_bytes[2] = {4720,
                                 752};  // of one keyframe, one point: sizeof alone (tables 1, 2)

inline const std::vector<thesis_row>& thesis_rows() {
  static const std::vector<thesis_row> rows = {
      {"leak",
       "vanilla ORB-SLAM3",
       "tables 3 to 6",
       "nothing is freed",
       {-1, -1},
       {0, 0},
       {0, 0},
       {-1, -1},
       {0, 0},
       125,
       228,
       19.88,
       {406, 15170}},
      {"direct_delete",
       "1st attempt",
       "section 4.1",
       "segmentation fault",
       {-1, -1},
       {-1, -1},
       {-1, -1},
       {-1, -1},
       {-1, -1},
       -1,
       -1,
       -1,
       {-1, -1}},
      {"shared_ptr",
       "2nd attempt",
       "section 4.2",
       "nothing is freed: cycles",
       {-1, -1},
       {0, 0},
       {0, 0},
       {-1, -1},
       {0, 0},
       -1,
       -1,
       -1,
       {-1, -1}},
      {"mutex_subset",
       "3rd attempt",
       "tables 1 to 6",
       "",
       {94, 13183},
       {65, 12833},
       {69, 97},
       {0.44, 9.91},
       {0.30, 9.65},
       125,
       255,
       21.15,
       {376, 13189}},
      {"cas_subset",
       "4th attempt",
       "tables 7 to 12",
       "",
       {98, 13305},
       {70, 12939},
       {71, 97},
       {0.46, 10.00},
       {0.33, 9.73},
       125,
       247,
       20.68,
       {383, 13305}},
  };
  return rows;
}

}  // namespace replay
