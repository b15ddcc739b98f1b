#include "run.hpp"
#include "scheme_retire_set.hpp"

namespace replay {
run_result run_fetch_add_all(const run_request& r) { return run<fetch_add_all>(r); }
}  // namespace replay
