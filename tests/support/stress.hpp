// What the stress tests share: rounds, threads that begin together, policies that stall at random.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <cstdlib>
#include <mutex>
#include <slamgc/counter.hpp>
#include <slamgc/mutex_counter.hpp>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "support/policies.hpp"
#include "support/yield_env.hpp"

namespace support {

// How often a test repeats: SLAMGC_STRESS_ROUNDS, or 1000.
inline int rounds() {
  const char* const wish = std::getenv("SLAMGC_STRESS_ROUNDS");
  const int n = wish != nullptr ? std::atoi(wish) : 0;
  return n > 0 ? n : 1000;
}

// Where threads wait for each other, as often as they like. It yields: there may be one processor.
class barrier {
 public:
  explicit barrier(int threads) : threads_(threads) {}
  void wait() {
    const unsigned phase = phase_.load(std::memory_order_acquire);
    if (arrived_.fetch_add(1, std::memory_order_acq_rel) + 1 == threads_) {
      arrived_.store(0, std::memory_order_relaxed);
      phase_.store(phase + 1, std::memory_order_release);
    } else {
      while (phase_.load(std::memory_order_acquire) == phase) std::this_thread::yield();
    }
  }

 private:
  const int threads_;
  std::atomic<int> arrived_{0};
  std::atomic<unsigned> phase_{0};
};

// Runs f(0) .. f(n - 1) in threads of their own that begin together.
template <class F>
void in_threads(int n, F f) {
  yield_env::seed();  // printed once
  barrier begin(n);
  std::vector<std::thread> threads;
  for (int i = 0; i != n; ++i)
    threads.emplace_back([&, i] {
      yield_env::number_thread(static_cast<std::uint64_t>(i));
      begin.wait();
      f(i);
    });
  for (std::thread& t : threads) t.join();
}

using yielding_fetch_add = slamgc::basic_fetch_add_counter<yield_env>;
using yielding_cas = slamgc::basic_cas_counter<yield_env>;
using yielding_mutex = slamgc::basic_mutex_counter<yield_env, std::mutex>;

// Each policy as it ships, and with stalls between its steps.
using stress_policies =
    ::testing::Types<slamgc::fetch_add_counter, slamgc::cas_counter, slamgc::mutex_counter,
                     spin_counter, yielding_fetch_add, yielding_cas, yielding_mutex>;

struct stress_policy_names {
  template <class Policy>
  static std::string GetName(int i) {
    if (std::is_same<Policy, yielding_fetch_add>::value) return "yielding_fetch_add";
    if (std::is_same<Policy, yielding_cas>::value) return "yielding_cas";
    if (std::is_same<Policy, yielding_mutex>::value) return "yielding_mutex";
    return policy_names::GetName<Policy>(i);
  }
};

}  // namespace support
