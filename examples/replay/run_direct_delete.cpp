#include "run.hpp"
#include "schemes.hpp"

namespace replay {
run_result run_direct_delete(const run_request& r) { return run<direct_delete>(r); }
}  // namespace replay
