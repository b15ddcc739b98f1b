// Counter policies: one per class, as part of its type. The last one is the program's own.
#include <cstdio>
#include <slamgc/intrusive_rc.hpp>
#include <slamgc/mutex_counter.hpp>

// A policy that also counts how often counts change. It inherits what it does not change.
struct counting_policy : slamgc::fetch_add_counter {
  static std::uint64_t add(storage& s, std::uint64_t delta) noexcept {
    ++changes;
    return slamgc::fetch_add_counter::add(s, delta);
  }
  static std::uint64_t subtract(storage& s, std::uint64_t delta) noexcept {
    ++changes;
    return slamgc::fetch_add_counter::subtract(s, delta);
  }
  static inline int changes = 0;  // this program has one thread
};

struct Fast : slamgc::rc_object<Fast> {};                              // fetch_add_counter
struct Loop : slamgc::rc_object<Loop, slamgc::cas_counter> {};         // as in the thesis, 4.4
struct Locked : slamgc::rc_object<Locked, slamgc::mutex_counter> {};   // as in the thesis, 4.3
struct Single : slamgc::rc_object<Single, slamgc::unsync_counter> {};  // one thread only
struct Observed : slamgc::rc_object<Observed, counting_policy> {};

int main() {
  std::printf("bytes of header: %zu %zu %zu %zu\n", sizeof(Fast), sizeof(Loop), sizeof(Locked),
              sizeof(Single));
  {
    const auto first = slamgc::make_rc<Observed>();
    const auto second = first;
    std::printf("count %u, version %u\n", first->use_count(), first->state().version());
  }
  std::printf("changes: %d\n", counting_policy::changes);
}
