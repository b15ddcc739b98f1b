// expect-error: deleted (function|operator)
// The scope of `*v.edit()` ends before the loop begins: what it writes would not be counted.
#include <slamgc/slamgc.hpp>

struct node : slamgc::rc_object<node> {};

void clear(slamgc::rc_vector<node>& v) {
#ifdef SLAMGC_POSITIVE_CONTROL
  const auto scope = v.edit();
  for (node*& p : *scope) p = nullptr;
#else
  for (node*& p : *v.edit()) p = nullptr;
#endif
}
