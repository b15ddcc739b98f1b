// expect-error: slamgc: the type must be complete where references to it are added or removed
#include <slamgc/rc_slot.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
struct keyframe : slamgc::rc_object<keyframe> {};
#else
struct keyframe;
#endif

void connect(slamgc::rc_slot<keyframe>& slot, keyframe* parent) { slot = parent; }
