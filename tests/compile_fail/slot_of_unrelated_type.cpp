// expect-error: no match|no viable|cannot convert
#include <slamgc/rc_slot.hpp>

struct keyframe : slamgc::rc_object<keyframe> {};
struct map_point : slamgc::rc_object<map_point> {};

void connect(slamgc::rc_slot<keyframe>& slot, const slamgc::intrusive_rc<map_point>& p,
             const slamgc::intrusive_rc<keyframe>& k) {
#ifdef SLAMGC_POSITIVE_CONTROL
  (void)p;
  slot = k;
#else
  (void)k;
  slot = p;
#endif
}
