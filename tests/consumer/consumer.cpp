// A program of somebody else's, the same for every way to get at slamgc. It also has to build
// without exceptions and run-time type information.
#ifdef SLAMGC_CONSUMER_SINGLE_INCLUDE
#include "slamgc.hpp"
#else
#include <slamgc/slamgc.hpp>
#endif

#include <cstdio>
#include <thread>

namespace {

int live = 0;

class keyframe : public slamgc::rc_object<keyframe> {
 public:
  keyframe() { ++live; }
  ~keyframe() { --live; }
  keyframe(const keyframe&) = delete;
  keyframe& operator=(const keyframe&) = delete;

  slamgc::rc_slot<keyframe> parent;
  slamgc::rc_vector<keyframe> neighbours;
};

}  // namespace

int main() {
  auto root = slamgc::make_rc<keyframe>();
  std::thread([&root] {
    auto child = slamgc::make_rc<keyframe>();
    child->parent = root;
    child->neighbours.push_back(root.get());
    root->neighbours.push_back(child.get());
  }).join();
  const bool counted = live == 2 && root->use_count() == 3;
  root->neighbours.clear();
  const bool released = live == 1 && root->use_count() == 1;
  root.reset();
  std::printf("slamgc %d.%d.%d: %s\n", SLAMGC_VERSION_MAJOR, SLAMGC_VERSION_MINOR,
              SLAMGC_VERSION_PATCH, counted && released && live == 0 ? "ok" : "failed");
  return counted && released && live == 0 ? 0 : 1;
}
