#include "run.hpp"
#include "schemes.hpp"

namespace replay {
run_result run_leak(const run_request& r) { return run<leak>(r); }
}  // namespace replay
