#include "run.hpp"
#include "scheme_retire_set.hpp"

namespace replay {
run_result run_cas_all(const run_request& r) { return run<cas_all>(r); }
}  // namespace replay
