// expect-error: slamgc: weak handles need a deferred reclaimer
#include <slamgc/weak_rc.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
using reclaimer = slamgc::reclaim_deferred;
#else
using reclaimer = slamgc::reclaim_at_zero;
#endif

struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, reclaimer>,
               slamgc::enable_weak_rc<frame> {};

frame* make() { return new frame; }
