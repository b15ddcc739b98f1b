// expect-error: slamgc: this container cannot do that: .* erase_with for sequences
#include <slamgc/slamgc.hpp>
#include <vector>

struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {};
struct map {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("frames", frames, slamgc::on_retire::erase_with(weights));
  }
#ifdef SLAMGC_POSITIVE_CONTROL
  slamgc::rc_vector<frame> frames;
#else
  slamgc::rc_map<frame, int> frames;
#endif
  std::vector<int> weights;
};

slamgc::root describe(slamgc::domain& of, map& m) { return {of, "map", m}; }
