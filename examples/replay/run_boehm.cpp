#include "run.hpp"
#include "scheme_boehm.hpp"

namespace replay {
run_result run_boehm(const run_request& r) { return run<boehm>(r); }
}  // namespace replay
