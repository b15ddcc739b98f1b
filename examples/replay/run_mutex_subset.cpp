#include "run.hpp"
#include "scheme_retire_set.hpp"

namespace replay {
run_result run_mutex_subset(const run_request& r) { return run<mutex_subset>(r); }
}  // namespace replay
