// expect-error: slamgc: the type must derive publicly, and once, from slamgc::rc_object
#include <slamgc/intrusive_rc.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
struct keyframe : slamgc::rc_object<keyframe> {};
#else
struct keyframe {};
#endif

slamgc::intrusive_rc<keyframe> p(new keyframe);
