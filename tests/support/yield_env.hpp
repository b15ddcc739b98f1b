/// @file
/// An environment for stress tests: std_env, with a random yield or stall before each atomic operation.
///
/// On a machine with few processors two threads seldom meet in the middle of an operation; here they
/// do, every few operations. The seed is printed, and `SLAMGC_SEED=<number>` sets it. A thread's
/// sequence of yields and stalls depends on the seed and its number alone; what the operating system
/// makes of them does not repeat.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <thread>

#include "slamgc/env.hpp"

struct yield_env {
  /// The seed of this run.
  static std::uint64_t seed() {
    static const std::uint64_t value = choose_seed();
    return value;
  }

  /// Gives the calling thread a number, and starts its sequence anew. Without it a thread is numbered
  /// when it first gets here.
  static void number_thread(std::uint64_t number) {
    random_state() = scramble(seed() + number * 0x9e3779b97f4a7c15U) | 1;
  }

  /// Mostly nothing, often a yield, now and then a stall that is long enough for the other threads to
  /// do a whole operation.
  static void disturb() {
    const std::uint64_t r = random() >> 32;
    if (r % 128 == 0)
      std::this_thread::sleep_for(std::chrono::microseconds(r / 128 % 64));
    else if (r % 8 == 0)
      std::this_thread::yield();
  }

  template <class T>
  class atomic {
   public:
    constexpr atomic(T value) noexcept : value_(value) {}
    T load(std::memory_order order) const noexcept {
      disturb();
      return value_.load(order);
    }
    void store(T value, std::memory_order order) noexcept {
      disturb();
      value_.store(value, order);
    }
    T exchange(T value, std::memory_order order) noexcept {
      disturb();
      return value_.exchange(value, order);
    }
    T fetch_add(T delta, std::memory_order order) noexcept {
      disturb();
      return value_.fetch_add(delta, order);
    }
    T fetch_sub(T delta, std::memory_order order) noexcept {
      disturb();
      return value_.fetch_sub(delta, order);
    }
    bool compare_exchange_weak(T& expected, T desired, std::memory_order success,
                               std::memory_order failure) noexcept {
      disturb();
      return value_.compare_exchange_weak(expected, desired, success, failure);
    }
    bool compare_exchange_strong(T& expected, T desired, std::memory_order success,
                                 std::memory_order failure) noexcept {
      disturb();
      return value_.compare_exchange_strong(expected, desired, success, failure);
    }

   private:
    std::atomic<T> value_;
  };

  static constexpr std::size_t mutator_doors = 3;

  template <class Record>
  static Record& thread_record() noexcept {
    return slamgc::std_env::thread_record<Record>();
  }
  template <class T>
  static T* load(T* const& element) noexcept {
    disturb();
    return slamgc::std_env::load(element);
  }
  template <class T>
  static T* exchange(T*& element, T* desired) noexcept {
    disturb();
    return slamgc::std_env::exchange(element, desired);
  }
  template <class T>
  static bool compare_exchange(T*& element, T* expected, T* desired) noexcept {
    disturb();
    return slamgc::std_env::compare_exchange(element, expected, desired);
  }

 private:
  static std::uint64_t choose_seed() {
    const char* const wish = std::getenv("SLAMGC_SEED");
    const std::uint64_t value =
        wish != nullptr ? std::strtoull(wish, nullptr, 0)
                        : static_cast<std::uint64_t>(
                              std::chrono::steady_clock::now().time_since_epoch().count());
    std::fprintf(stderr, "yield_env: SLAMGC_SEED=%llu\n", static_cast<unsigned long long>(value));
    return value;
  }
  static std::uint64_t scramble(std::uint64_t x) {  // splitmix64
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31);
  }
  static std::uint64_t& random_state() {
    static thread_local std::uint64_t state = 0;
    return state;
  }
  static std::uint64_t random() {  // xorshift64*
    std::uint64_t& state = random_state();
    if (state == 0) {
      static std::atomic<std::uint64_t> threads{0};
      number_thread(threads.fetch_add(1, std::memory_order_relaxed));
    }
    state ^= state >> 12;
    state ^= state << 25;
    state ^= state >> 27;
    return state * 0x2545f4914f6cdd1dU;
  }
};
