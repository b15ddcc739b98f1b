// expect-error: slamgc: this container cannot do that: .* bypass
#include <slamgc/slamgc.hpp>

struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  slamgc::rc_slot<frame> next;
};
struct map {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("frames", frames, slamgc::on_retire::bypass([](frame& f) { return f.next.get(); }));
  }
#ifdef SLAMGC_POSITIVE_CONTROL
  slamgc::rc_vector<frame> frames;
#else
  slamgc::rc_set<frame> frames;
#endif
};

slamgc::root describe(slamgc::domain& of, map& m) { return {of, "map", m}; }
