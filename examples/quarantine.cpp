// A use after reclaim, found: a thread keeps a pointer past its quiescent state and writes through it. The report says where the
// object was retired and where it was reclaimed. The quarantine is for the checked flavour.
#define SLAMGC_DEBUG 1
#include <cstdio>

// The program goes on in this example; the default report aborts.
#define SLAMGC_ASSERT(condition, found) ((condition) ? void() : report(found))
template <class Misuse>
void report(const Misuse& m) {
  std::printf("the program %s\n", m.what);
  print_places(m);  // on the standard error stream
}

#include <slamgc/diagnosis/quarantine.hpp>
#include <slamgc/slamgc.hpp>

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  double pose = 0;
};

int main() {
  slamgc::quarantine quarantine;  // first
  slamgc::domain map;
  slamgc::mutator me(map, "tracking");

  auto* const pKF = new KeyFrame;
  slamgc::retire(pKF);
  me.quiescent();
  {
    const slamgc::mutator::offline_scope offline(me);
    (void)map.collect();
    std::printf("held back: %zu\n", quarantine.held());
  }

  slamgc::retire(pKF);                              // found at once
  const slamgc::borrow<KeyFrame> again = pKF;       // found at once
  std::printf("found: %zu\n", quarantine.check());  // looks for writes: none yet
#if !defined(SLAMGC_HAS_ASAN)                       // AddressSanitizer would end the program here
  pKF->pose = 1;                                    // a plain write
  std::printf("found: %zu\n", quarantine.check());  // found when somebody looks
#endif
  (void)again;
}
