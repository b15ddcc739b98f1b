// expect-error: no match|no viable|cannot convert
#include <slamgc/intrusive_rc.hpp>

struct frame : slamgc::rc_object<frame> {
  virtual ~frame() = default;
};
struct keyframe : frame {};

void narrow(slamgc::intrusive_rc<keyframe>& k, const slamgc::intrusive_rc<frame>& f) {
#ifdef SLAMGC_POSITIVE_CONTROL
  k = slamgc::static_pointer_cast<keyframe>(f);
#else
  k = f;
#endif
}
