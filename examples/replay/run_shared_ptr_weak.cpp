#include "run.hpp"
#include "scheme_shared.hpp"

namespace replay {
run_result run_shared_ptr_weak(const run_request& r) { return run<shared_ptr_weak_scheme>(r); }
}  // namespace replay
