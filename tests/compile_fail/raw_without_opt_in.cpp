// expect-error: cannot convert|no viable conversion
#include <slamgc/intrusive_rc.hpp>

struct keyframe : slamgc::rc_object<keyframe> {};

#ifdef SLAMGC_POSITIVE_CONTROL
template <>
inline constexpr bool slamgc::implicit_to_raw<keyframe> = true;
#endif

keyframe* raw(const slamgc::intrusive_rc<keyframe>& p) { return p; }
