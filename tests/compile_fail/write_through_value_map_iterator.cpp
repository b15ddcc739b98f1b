// expect-error: read-only|const
#include <slamgc/containers/rc_value_map.hpp>
#include <slamgc/rc_object.hpp>

struct keyframe : slamgc::rc_object<keyframe> {};

void forget(slamgc::rc_value_map<long, keyframe>& m) {
#ifdef SLAMGC_POSITIVE_CONTROL
  m.at(1) = nullptr;
#else
  m.find(1)->second = nullptr;
#endif
}
