// expect-error: slamgc: the type must derive publicly|inaccessible|private
#include <slamgc/intrusive_rc.hpp>

#ifdef SLAMGC_POSITIVE_CONTROL
class keyframe : public slamgc::rc_object<keyframe> {};
#else
class keyframe : slamgc::rc_object<keyframe> {};
#endif

slamgc::intrusive_rc<keyframe> p(new keyframe);
