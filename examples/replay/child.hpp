// One scheme in a process of its own: the memory of one does not touch the next, and one that crashes is explained.
#pragma once

#include <functional>
#include <string>

#include "result.hpp"

namespace replay {

// What can be seen of a running child.
struct child_progress {
  long frames = 0;
  double seconds = 0;
  std::int64_t live_bytes = 0;
  std::uint64_t marked[2] = {}, freed[2] = {};
};

// Runs it, and calls @p show some times a second. Does not throw because of anything that happens in the child. One that makes no progress for
// @p patience seconds is ended.
run_result run_in_child(const scheme_entry& scheme, const run_request& request, double patience,
                        const std::function<void(const child_progress&)>& show);

}  // namespace replay
