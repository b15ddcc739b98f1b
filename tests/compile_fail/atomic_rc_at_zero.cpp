// expect-error: slamgc: what an atomic_rc refers to needs a deferred reclaimer
#include <slamgc/atomic_rc.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};
#else
struct frame : slamgc::rc_object<frame> {};
#endif

slamgc::intrusive_rc<frame> load(slamgc::atomic_rc<frame>& p) { return p.load(); }
