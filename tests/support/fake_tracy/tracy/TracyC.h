// In place of Tracy's header of this name: what slamgc uses of it, written down instead of sent.
#pragma once

#ifndef TRACY_ENABLE

typedef const void* TracyCZoneCtx;
#define TracyCZoneN(context, name, active)
#define TracyCZoneEnd(context)
#define TracyCZoneText(context, text, size)
#define TracyCZoneValue(context, value)
#define TracyCFrameMarkStart(name)
#define TracyCFrameMarkEnd(name)
#define TracyCPlotI(name, value)

#else

#include <cstdint>
#include <string>
#include <vector>

namespace fake_tracy {

inline std::vector<std::string> calls;
inline std::vector<const char*> names;  // which Tracy would keep

struct context {
  int zone;
};
inline int zones = 0;

inline context begin(const char* name) {
  calls.push_back(std::string("zone begins: ") + name);
  return {++zones};
}
inline void call(context c, const std::string& what) {
  calls.push_back("zone " + std::to_string(c.zone) + what);
}
inline void named(const char* what, const char* name, const std::string& more = "") {
  names.push_back(name);
  calls.push_back(std::string(what) + name + more);
}

}  // namespace fake_tracy

typedef fake_tracy::context TracyCZoneCtx;
#define TracyCZoneN(context, name, active) TracyCZoneCtx context = fake_tracy::begin(name)
#define TracyCZoneEnd(context) fake_tracy::call(context, " ends")
#define TracyCZoneText(context, text, size) \
  fake_tracy::call(context, ": " + std::string(text, size))
#define TracyCZoneValue(context, value) fake_tracy::call(context, ": " + std::to_string(value))
#define TracyCFrameMarkStart(name) fake_tracy::named("frame starts: ", name)
#define TracyCFrameMarkEnd(name) fake_tracy::named("frame ends: ", name)
#define TracyCPlotI(name, value) fake_tracy::named("plot ", name, " = " + std::to_string(value))

#endif
