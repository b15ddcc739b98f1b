// expect-error: slamgc: this container cannot do that: null is for rc_vector and rc_value_map
#include <slamgc/slamgc.hpp>

struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {};
struct map {
  template <class Visitor>
  void edges(Visitor& v) {
#ifdef SLAMGC_POSITIVE_CONTROL
    v.edge("frames", frames, slamgc::on_retire::erase);
#else
    v.edge("frames", frames, slamgc::on_retire::null);
#endif
  }
  slamgc::rc_set<frame> frames;
};

slamgc::root describe(slamgc::domain& of, map& m) { return {of, "map", m}; }
