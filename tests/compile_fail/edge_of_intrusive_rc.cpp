// expect-error: slamgc: an edge is an rc_slot, an atomic_rc or a counted container
#include <slamgc/slamgc.hpp>

struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
#ifdef SLAMGC_POSITIVE_CONTROL
  slamgc::rc_slot<frame> parent;
#else
  slamgc::intrusive_rc<frame> parent;
#endif
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("parent", parent);
  }
};

frame* make() { return new frame; }
