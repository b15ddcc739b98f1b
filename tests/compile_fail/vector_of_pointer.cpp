// expect-error: name the object, not the pointer
#include <slamgc/containers/rc_vector.hpp>
#include <slamgc/rc_object.hpp>

struct keyframe : slamgc::rc_object<keyframe> {};

#ifdef SLAMGC_POSITIVE_CONTROL
slamgc::rc_vector<keyframe> neighbours;
#else
slamgc::rc_vector<keyframe*> neighbours;
#endif
