/// @file
/// What a domain does, for the Tracy profiler (https://github.com/wolfpld/tracy): zones, plots, and grace periods as frames.
///
/// For programs that use Tracy. Without `TRACY_ENABLE` it does nothing, as all of Tracy.
#pragma once

#if !__has_include(<tracy/TracyC.h>)
#error "slamgc: slamgc/integrations/tracy.hpp needs Tracy's headers: <tracy/TracyC.h> was not found"
#endif
#include <tracy/TracyC.h>

#include <cstdint>
#include <cstring>
#include <map>
#include <string>

#include "../diagnosis/hooks.hpp"

namespace slamgc {

/// Shows one domain in Tracy: `domain.install(&hooks)`. Tracy keeps the names of plots: it has to live as long as the program.
class tracy_hooks final : public collector_hooks {
 public:
  tracy_hooks() = default;
  tracy_hooks(const tracy_hooks&) = delete;
  tracy_hooks& operator=(const tracy_hooks&) = delete;

#if defined(TRACY_ENABLE)
  /// Begins a zone.
  void slice_begins(time_point) noexcept override {
    TracyCZoneN(zone, "slamgc collect", 1);
    zone_ = zone;
  }
  /// Ends a frame of its own.
  void grace_period_closed(std::uint64_t, time_point) noexcept override {
    if (open_) TracyCFrameMarkEnd(grace_period_name);
    open_ = false;
  }
  /// Begins a frame of its own.
  void grace_period_opened(std::uint64_t, time_point) noexcept override {
    TracyCFrameMarkStart(grace_period_name);
    open_ = true;
  }
  /// Plots them. Ends the program if there is no memory, as Tracy does.
  void objects(const type_stats& now, std::uint64_t) noexcept override {
    plot_names& names = plots_[now.type];
    if (names.live.empty())
      names = {std::string("live ") + now.type, std::string("backlog ") + now.type};
    TracyCPlotI(names.live.c_str(), static_cast<std::int64_t>(now.live));
    TracyCPlotI(names.backlog.c_str(), static_cast<std::int64_t>(now.backlog));
  }
  /// Ends the zone, whose value is the number of objects reclaimed, and whose text is whom the domain waits for.
  void slice_ended(const slice_stats& s) noexcept override {
    TracyCZoneValue(zone_, s.did.reclaimed);
    if (s.delayed.oldest != nullptr)
      TracyCZoneText(zone_, s.delayed.oldest, std::strlen(s.delayed.oldest));
    TracyCZoneEnd(zone_);
  }

 private:
  static constexpr const char* grace_period_name = "slamgc grace period";
  struct plot_names {
    std::string live;
    std::string backlog;
  };

  TracyCZoneCtx zone_{};
  bool open_ = false;
  std::map<const char*, plot_names> plots_;  // by address: a type has one
#endif
};

}  // namespace slamgc
