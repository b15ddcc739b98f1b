#include "run.hpp"
#include "scheme_retire_set.hpp"

namespace replay {
run_result run_mutex_all(const run_request& r) { return run<mutex_all>(r); }
}  // namespace replay
