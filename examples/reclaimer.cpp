// The reclaimer: what happens when a count falls to zero. This one hands the objects to a recycler
// instead of destroying them.
#include <cstdio>
#include <slamgc/intrusive_rc.hpp>
#include <vector>

struct Frame;

struct recycle {
  template <class T>
  static void release(T* object) noexcept {
    if (slamgc::uncount_reference(object).count() == 1) pool().push_back(object);
  }
  template <class T>
  static void* first_link() noexcept {
    return nullptr;
  }
  // Nothing is destroyed while a container changes, so there is nothing to hold back.
  template <class T>
  struct scope {
    scope() noexcept {}
  };
  static std::vector<Frame*>& pool() {
    static std::vector<Frame*> frames;
    return frames;
  }
};

struct Frame : slamgc::rc_object<Frame, slamgc::fetch_add_counter, recycle> {
  int id = 0;
};

int main() {
  recycle::pool().reserve(100);
  Frame* first = nullptr;
  {
    const auto frame = slamgc::make_rc<Frame>();
    first = frame.get();
  }
  {
    const slamgc::intrusive_rc<Frame> again(recycle::pool().back());
    recycle::pool().pop_back();
    std::printf("recycled: %s\n", again == first ? "yes" : "no");
  }
  for (Frame* frame : recycle::pool()) delete frame;
}
