// expect-error: slamgc: a root needs `template <class V> void edges
#include <slamgc/slamgc.hpp>

struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {};
struct map {
#ifdef SLAMGC_POSITIVE_CONTROL
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("frames", frames);
  }
#endif
  slamgc::rc_set<frame> frames;
};

slamgc::root describe(slamgc::domain& of, map& m) { return {of, "map", m}; }
