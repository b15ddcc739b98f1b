// expect-error: write rc_slot<KeyFrame>, not rc_slot<KeyFrame\*>
#include <slamgc/rc_slot.hpp>

struct keyframe : slamgc::rc_object<keyframe> {};

#ifdef SLAMGC_POSITIVE_CONTROL
slamgc::rc_slot<keyframe> parent;
#else
slamgc::rc_slot<keyframe*> parent;
#endif
