// expect-error: slamgc: objects of a retire_set need the reclaimer reclaim_by_scan
#include <slamgc/deferred.hpp>
#include <slamgc/retire_set.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
using reclaimer = slamgc::reclaim_by_scan;
#else
using reclaimer = slamgc::reclaim_retired;
#endif
struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, reclaimer> {};

bool cull(slamgc::retire_set<frame>& set, frame* p) { return set.insert(p); }
