#include "run.hpp"
#include "scheme_deferred.hpp"

namespace replay {
run_result run_deferred(const run_request& r) { return run<deferred>(r); }
}  // namespace replay
