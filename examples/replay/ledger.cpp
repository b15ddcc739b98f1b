#include "ledger.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <ctime>

namespace replay {
namespace {

thread_local role role_now = role::main;
thread_local long iteration_now = -1;
fault_handler handler = nullptr;
bool counting = false;
std::atomic<std::int64_t> lap_began_at{0};
std::atomic<std::uint64_t> counted{0};

std::int64_t of_clock(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return std::int64_t{t.tv_sec} * 1000000000 + t.tv_nsec;
}

}  // namespace

const char* name_of(role r) {
  static const char* const names[roles] = {"main",         "tracking",          "local mapping",
                                           "loop closing", "global adjustment", "viewer",
                                           "reclaimer"};
  return names[static_cast<std::size_t>(r)];
}

std::int64_t nanoseconds_now() { return of_clock(CLOCK_MONOTONIC); }
std::int64_t cpu_nanoseconds_now() { return of_clock(CLOCK_THREAD_CPUTIME_ID); }

ledger& ledger::now() {
  static ledger the_ledger;
  return the_ledger;
}
role_ledger& ledger::mine() { return of(role_now); }

playing::playing(role r) : before_(role_now) { role_now = r; }
playing::~playing() { role_now = before_; }
role current_role() { return role_now; }
void at_iteration(long number) { iteration_now = number; }
long current_iteration() { return iteration_now; }

void begin_lap() { lap_began_at.store(nanoseconds_now(), std::memory_order_relaxed); }
std::int64_t lap_began() { return lap_began_at.load(std::memory_order_relaxed); }

std::int64_t resident_bytes() {
  std::FILE* const file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr) return 0;
  long all = 0, resident = 0;
  const int n = std::fscanf(file, "%ld %ld", &all, &resident);
  std::fclose(file);
  return n == 2 ? std::int64_t{resident} * sysconf(_SC_PAGESIZE) : 0;
}
std::int64_t peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

void on_fault(fault_handler h) { handler = h; }
void fault(const char* what) {
  if (counting) {
    counted.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  if (handler != nullptr) handler(what);
  std::fprintf(stderr, "%s: %s, iteration %ld\n", what, name_of(role_now), iteration_now);
  std::abort();
}
void count_faults(bool yes) {
  counting = yes;
  counted = 0;
}
bool counting_faults() { return counting; }
std::uint64_t counted_faults() { return counted; }

}  // namespace replay
