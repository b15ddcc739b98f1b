// expect-error: read-only|const
#include <slamgc/containers/rc_vector.hpp>
#include <slamgc/rc_object.hpp>

struct keyframe : slamgc::rc_object<keyframe> {};

void forget(slamgc::rc_vector<keyframe>& v) {
#ifdef SLAMGC_POSITIVE_CONTROL
  v[0] = nullptr;
#else
  *v.begin() = nullptr;
#endif
}
