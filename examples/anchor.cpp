// anchor: a trajectory whose frames refer to keyframes that are culled, and to their parents, culled too. The poses are
// multiplied hop by hop as if nothing had been freed, with the same result bit by bit.
#include <array>
#include <cstdio>
#include <slamgc/slamgc.hpp>
#include <vector>

// A rotation in the plane and a translation; a program has Sophus::SE3f here.
struct Pose {
  double c = 1, s = 0, x = 0, y = 0;

  Pose operator*(const Pose& b) const {
    return {c * b.c - s * b.s, s * b.c + c * b.s, c * b.x - s * b.y + x, s * b.x + c * b.y + y};
  }
  bool operator==(const Pose& b) const { return c == b.c && s == b.s && x == b.x && y == b.y; }
};

struct KeyFrame;
struct PoseRecord;
using Anchor = slamgc::anchor<KeyFrame, PoseRecord>;

// What is left of a culled keyframe: a hundred bytes in place of 400 kB.
struct PoseRecord {
  Pose Tcp;       // to the parent
  Anchor parent;  // alive or a record, too
};

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
                  slamgc::enable_anchor<KeyFrame, PoseRecord> {
  KeyFrame(const Pose& to_parent, KeyFrame* parent) : mTcp(to_parent), mpParent(parent) { ++made; }
  ~KeyFrame() { --made; }

  // Called by the collector, when nobody can see the keyframe any more.
  PoseRecord record() { return {mTcp, Anchor(mpParent)}; }

  Pose mTcp;
  slamgc::rc_slot<KeyFrame> mpParent;
  std::array<char, 300000> features{};
  static inline int made = 0;
};

struct Frame {
  Pose Tcr;          // to its reference keyframe
  Anchor reference;  // mlpReferences
};

// SaveTrajectory: from the frame to its keyframe, and from parent to parent.
Pose absolute(const Frame& frame) {
  Pose pose = frame.Tcr;
  for (Anchor at = frame.reference; at;)
    at = at.read(
        [&](KeyFrame& alive) {
          pose = pose * alive.mTcp;
          return Anchor(alive.mpParent);
        },
        [&](const PoseRecord& culled) {
          pose = pose * culled.Tcp;
          return culled.parent;
        });
  return pose;
}

int main() {
  slamgc::domain system;
  slamgc::mutator mapping(system, "mapping");
  slamgc::rc_vector<KeyFrame> map;
  std::vector<Frame> trajectory;
  for (std::size_t i = 0; i != 200; ++i) {
    const double a = 0.01 * static_cast<double>(i);
    // Every tenth keyframe follows the last tenth one; those between form a chain.
    KeyFrame* const pParent = i == 0 ? nullptr : map[i % 10 == 0 ? i - 10 : i - 1].get();
    KeyFrame* const pKF = new KeyFrame({1 - a * a / 2, a, 0.1 + a, -0.3 * a}, pParent);
    map.push_back(pKF);
    trajectory.push_back({Pose{1, 0, a, 1 / (a + 3)}, Anchor(pKF)});
  }
  std::vector<Pose> leaking;  // what a program that frees nothing would save
  for (const Frame& frame : trajectory) leaking.push_back(absolute(frame));

  const auto collect_and_compare = [&](int expected) {
    {
      const slamgc::mutator::offline_scope offline(mapping);
      if (system.drain() != slamgc::waited::done) return false;
    }
    std::printf("%d keyframes are left\n", KeyFrame::made);
    for (std::size_t i = 0; i != trajectory.size(); ++i)
      if (!(absolute(trajectory[i]) == leaking[i])) return false;
    return KeyFrame::made == expected;
  };
  for (std::size_t i = 0; i != map.size(); ++i) {
    if (i % 10 == 0) continue;
    slamgc::retire(map[i].get());  // culled, and so is its parent, in most cases
    map[i] = nullptr;
  }
  if (!collect_and_compare(20)) return 1;
  for (KeyFrame* pKF : map)  // the end of the map
    if (pKF != nullptr) slamgc::retire(pKF);
  map.clear();
  if (!collect_and_compare(0)) return 1;
  std::puts("the trajectory is the same, bit by bit");
  return 0;
}
