// expect-error: slamgc: the type must derive publicly, and once, from slamgc::rc_object
#include <slamgc/intrusive_rc.hpp>

struct frame : slamgc::rc_object<frame> {
  virtual ~frame() = default;
};
struct landmark : slamgc::rc_object<landmark> {
  virtual ~landmark() = default;
};
struct both : frame, landmark {};

#ifdef SLAMGC_POSITIVE_CONTROL
slamgc::intrusive_rc<frame> p(new both);
#else
slamgc::intrusive_rc<both> p(new both);
#endif
