// expect-error: slamgc: what can become of a slot is hold, null or bypass
#include <slamgc/slamgc.hpp>

struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {};
struct tracker {
  template <class Visitor>
  void edges(Visitor& v) {
#ifdef SLAMGC_POSITIVE_CONTROL
    v.edge("last", last, slamgc::on_retire::null);
#else
    v.edge("last", last, slamgc::on_retire::erase);
#endif
  }
  slamgc::rc_slot<frame> last;
};

slamgc::root describe(slamgc::mutator& of, tracker& t) { return {of, "tracker", t}; }
