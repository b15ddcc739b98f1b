#include "run.hpp"
#include "scheme_shared.hpp"

namespace replay {
run_result run_shared_ptr(const run_request& r) { return run<shared_ptr_scheme>(r); }
}  // namespace replay
