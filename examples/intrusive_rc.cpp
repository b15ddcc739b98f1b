// intrusive_rc: the counted pointer for locals, parameters and roots.
#include <cstdio>
#include <slamgc/intrusive_rc.hpp>
#include <unordered_set>

struct Frame : slamgc::rc_object<Frame> {
  explicit Frame(int number) : id(number) {}
  int id;
};
// Existing functions take `Frame*`: this type opts in to converting without being asked.
template <>
inline constexpr bool slamgc::implicit_to_raw<Frame> = true;

void show(Frame* frame) { std::printf("frame %d, count %u\n", frame->id, frame->use_count()); }

int main() {
  slamgc::intrusive_rc<Frame> first = slamgc::make_rc<Frame>(1);
  show(first);  // count 1
  {
    const slamgc::intrusive_rc<Frame> again = first;
    show(again);  // count 2
  }
  slamgc::intrusive_rc<Frame> moved = std::move(first);  // no count changes
  show(moved);                                           // count 1

  // Comparing and hashing go by address, with raw pointers too.
  std::unordered_set<slamgc::intrusive_rc<Frame>> frames{moved};
  Frame* raw = moved.get();
  std::printf("known: %s\n", frames.count(raw) != 0 && moved == raw ? "yes" : "no");

  // Through a C interface: give the reference away, take it back.
  Frame* given = moved.detach();
  moved = slamgc::intrusive_rc<Frame>::adopt(given);
  show(moved);  // count 2: one here, one in the set
}
