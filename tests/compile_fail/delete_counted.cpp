// expect-error: delete
#include <slamgc/intrusive_rc.hpp>

struct keyframe : slamgc::rc_object<keyframe> {};

template <>
inline constexpr bool slamgc::implicit_to_raw<keyframe> = true;

void end(slamgc::intrusive_rc<keyframe>& p) {
#ifdef SLAMGC_POSITIVE_CONTROL
  p = nullptr;
#else
  delete p;
#endif
}
