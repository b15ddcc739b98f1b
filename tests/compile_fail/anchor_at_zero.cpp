// expect-error: slamgc: anchors need a deferred reclaimer
#include <slamgc/anchor.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
using reclaimer = slamgc::reclaim_retired;
#else
using reclaimer = slamgc::reclaim_at_zero;
#endif

struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, reclaimer>,
               slamgc::enable_anchor<frame, int> {
  int record() { return 1; }
};

frame* make() { return new frame; }
