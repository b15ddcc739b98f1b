// The counter policies that every test of counting runs on.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <cstdint>
#include <slamgc/counter.hpp>
#include <slamgc/mutex_counter.hpp>
#include <string>
#include <thread>
#include <type_traits>

namespace support {

// A policy of the user's own: everything that counter.hpp asks for, and nothing from it but the
// environment.
struct spin_counter {
  using env = slamgc::std_env;
  struct storage {
    mutable std::atomic<bool> locked{false};
    std::uint64_t word = 0;
  };

  [[nodiscard]] static std::uint64_t load(const storage& s) noexcept {
    const guard lock(s);
    return s.word;
  }
  static std::uint64_t add(storage& s, std::uint64_t delta) noexcept {
    const guard lock(s);
    const std::uint64_t before = s.word;
    s.word += delta;
    return before;
  }
  static std::uint64_t subtract(storage& s, std::uint64_t delta) noexcept {
    return add(s, std::uint64_t{0} - delta);
  }
  static bool compare_exchange(storage& s, std::uint64_t& expected,
                               std::uint64_t desired) noexcept {
    const guard lock(s);
    const bool equal = s.word == expected;
    (equal ? s.word : expected) = equal ? desired : s.word;
    return equal;
  }

 private:
  class guard {
   public:
    explicit guard(const storage& s) noexcept : storage_(s) {
      while (storage_.locked.exchange(true, std::memory_order_acquire)) std::this_thread::yield();
    }
    ~guard() { storage_.locked.store(false, std::memory_order_release); }
    guard(const guard&) = delete;
    guard& operator=(const guard&) = delete;

   private:
    const storage& storage_;
  };
};

using thread_safe_policies = ::testing::Types<slamgc::fetch_add_counter, slamgc::cas_counter,
                                              slamgc::mutex_counter, spin_counter>;
using all_policies = ::testing::Types<slamgc::fetch_add_counter, slamgc::cas_counter,
                                      slamgc::mutex_counter, slamgc::unsync_counter, spin_counter>;

// How a test's name shows its policy.
struct policy_names {
  template <class Policy>
  static std::string GetName(int) {
    if (std::is_same<Policy, slamgc::fetch_add_counter>::value) return "fetch_add_counter";
    if (std::is_same<Policy, slamgc::cas_counter>::value) return "cas_counter";
    if (std::is_same<Policy, slamgc::mutex_counter>::value) return "mutex_counter";
    if (std::is_same<Policy, slamgc::unsync_counter>::value) return "unsync_counter";
    return "spin_counter";
  }
};

// Sets the state word of a storage to anything.
template <class Policy>
void set_word(typename Policy::storage& s, std::uint64_t word) noexcept {
  std::uint64_t found = Policy::load(s);
  while (!Policy::compare_exchange(s, found, word)) {
  }
}

}  // namespace support
