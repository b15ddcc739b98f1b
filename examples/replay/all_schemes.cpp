#include "result.hpp"

namespace replay {

run_result run_leak(const run_request&);
run_result run_direct_delete(const run_request&);
run_result run_shared_ptr(const run_request&);
run_result run_shared_ptr_weak(const run_request&);
run_result run_mutex_subset(const run_request&);
run_result run_cas_subset(const run_request&);
run_result run_mutex_all(const run_request&);
run_result run_cas_all(const run_request&);
run_result run_fetch_add_all(const run_request&);
run_result run_deferred(const run_request&);
#if defined(REPLAY_WITH_RCU)
run_result run_rcu(const run_request&);
#endif
#if defined(REPLAY_WITH_BOEHM)
run_result run_boehm(const run_request&);
#endif

const std::vector<scheme_entry>& all_schemes() {
  static const std::vector<scheme_entry> all = [] {
    std::vector<scheme_entry> of = {
        {"leak", "plain pointers, nothing is freed: ORB-SLAM3 today", false, run_leak},
        {"direct_delete",
         "plain pointers, delete as soon as something is marked (thesis, 1st attempt)", true,
         run_direct_delete},
        {"shared_ptr", "std::shared_ptr for every reference and local (2nd attempt)", false,
         run_shared_ptr},
        {"shared_ptr_weak", "the same, std::weak_ptr from points to keyframes", false,
         run_shared_ptr_weak},
        {"mutex_subset", "counter with a mutex, three members counted, retire set (3rd attempt)",
         true, run_mutex_subset},
        {"cas_subset", "compare and swap, three members counted, retire set (4th attempt)", true,
         run_cas_subset},
        {"mutex_all", "as mutex_subset, every member counted", false, run_mutex_all},
        {"cas_all", "as cas_subset, every member counted", false, run_cas_all},
        {"fetch_add_all", "fetch_add, every member counted, retire set", false, run_fetch_add_all},
        {"deferred",
         "slamgc: every member counted, plain locals, quiescent states, purges, trial deletion",
         false, run_deferred},
    };
#if defined(REPLAY_WITH_RCU)
    of.push_back({"rcu", "plain pointers, delete after a grace period: liburcu, for comparison",
                  true, run_rcu});
#endif
#if defined(REPLAY_WITH_BOEHM)
    of.push_back({"boehm",
                  "plain pointers, nobody deletes; a conservative collector: libgc, for comparison",
                  false, run_boehm});
#endif
    return of;
  }();
  return all;
}

}  // namespace replay
