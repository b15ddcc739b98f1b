// expect-error: slamgc: the class that derives from rc_object must also derive publicly, and once, from
#include <slamgc/weak_rc.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
               slamgc::enable_weak_rc<frame> {};
#else
struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};
#endif

slamgc::weak_rc<frame> refer(frame* p) { return slamgc::weak_rc<frame>(p); }
