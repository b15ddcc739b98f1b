// rc_slot: the counted pointer for members, which several threads may assign.
#include <atomic>
#include <cstdio>
#include <slamgc/rc_slot.hpp>
#include <thread>

struct KeyFrame : slamgc::rc_object<KeyFrame> {
  explicit KeyFrame(int number) : id(number) { ++alive; }
  ~KeyFrame() { --alive; }
  int id;
  slamgc::rc_slot<KeyFrame> parent;  // was: KeyFrame* parent = nullptr;
  static std::atomic<int> alive;
};
std::atomic<int> KeyFrame::alive{0};

int main() {
  {
    const auto root = slamgc::make_rc<KeyFrame>(0);
    const auto child = slamgc::make_rc<KeyFrame>(1);
    child->parent = root.get();
    std::printf("the parent of %d is %d\n", child->id, child->parent->id);

    // Two threads give the child other parents at once: each old one is released exactly once.
    auto reparent = [&child] {
      for (int i = 0; i < 1000; ++i) child->parent = new KeyFrame(i);
    };
    std::thread mapping(reparent);
    std::thread closing(reparent);
    mapping.join();
    closing.join();
    std::printf("alive: %d (root, child, the last parent)\n", KeyFrame::alive.load());
  }
  std::printf("alive: %d\n", KeyFrame::alive.load());
}
