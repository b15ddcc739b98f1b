// expect-error: slamgc: what a registry holds needs a deferred reclaimer
#include <slamgc/slamgc.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {};
#else
struct frame : slamgc::rc_object<frame> {};
#endif

void clear(slamgc::registry<slamgc::rc_set<frame>>& frames) { frames.clear(); }
