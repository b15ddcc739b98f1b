// expect-error: slamgc: the counter policy needs the types `env` and `storage`
#include <slamgc/intrusive_rc.hpp>

struct policy : slamgc::cas_counter {
#ifndef SLAMGC_POSITIVE_CONTROL
 private:
  using slamgc::cas_counter::storage;
#endif
};

struct keyframe : slamgc::rc_object<keyframe, policy> {};

keyframe object;
