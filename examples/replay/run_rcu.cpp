#include "run.hpp"
#include "scheme_rcu.hpp"

namespace replay {
run_result run_rcu(const run_request& r) { return run<rcu>(r); }
}  // namespace replay
