// expect-error: slamgc: only objects with a deferred reclaimer can be retired
#include <slamgc/deferred.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {};
#else
struct frame : slamgc::rc_object<frame> {};
#endif

bool cull(frame* p) { return slamgc::retire(p); }
