// expect-error: slamgc: references to a class derived from the one that derives from rc_object
#include <slamgc/intrusive_rc.hpp>

struct frame : slamgc::rc_object<frame> {
#ifdef SLAMGC_POSITIVE_CONTROL
  virtual ~frame() = default;
#endif
};
struct keyframe : frame {};

slamgc::intrusive_rc<keyframe> p(new keyframe);
