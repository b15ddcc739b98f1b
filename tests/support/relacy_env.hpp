/// @file
/// An environment on top of relacy, a checker of the C++ memory model, for the models in tests/model.
///
/// The headers under test are those of the library, unchanged: relacy runs a model's threads as
/// fibers, switches between them before each atomic operation, and lets loads see old values as far
/// as the memory orders permit. What relacy needs in turn:
/// - each standard header before relacy's, whose macros (new, delete, assert, memory_order_...) must
///   be gone afterwards;
/// - `-fno-sized-deallocation`, since it replaces the plain operator delete only;
/// - no `thread_local`: all threads are fibers of one;
/// - destructors that read and then poison every datum: to relacy, free() is no write, and a missing
///   order before a destruction would go unnoticed.
///
/// The models use the unchecked flavour. The checked one loads the state word more often than
/// programs do, with acquire, which could hide a missing order.
#pragma once

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <numeric>
#include <optional>
#include <queue>
#include <set>
#include <sstream>
#include <stack>
#include <stdexcept>
#include <string>
#include <thread>
#include <type_traits>
#include <typeindex>
#include <typeinfo>
#include <unordered_map>
#include <unordered_set>
#include <utility>
#include <vector>

#pragma push_macro("assert")
#pragma push_macro("errno")
#include <relacy/relacy.hpp>
#undef assert
#undef errno
#undef new
#undef delete
#undef malloc
#undef calloc
#undef realloc
#undef free
#undef memory_order_relaxed
#undef memory_order_consume
#undef memory_order_acquire
#undef memory_order_release
#undef memory_order_acq_rel
#undef memory_order_seq_cst
#undef VAR
#undef VAR_T
#undef $
#pragma pop_macro("assert")
#pragma pop_macro("errno")

#undef SLAMGC_DEBUG
#define SLAMGC_DEBUG 0
#include "slamgc/anchor.hpp"
#include "slamgc/atomic_rc.hpp"
#include "slamgc/deferred.hpp"
#include "slamgc/intrusive_rc.hpp"
#include "slamgc/mutator.hpp"
#include "slamgc/mutex_counter.hpp"
#include "slamgc/rc_slot.hpp"
#include "slamgc/registry.hpp"
#include "slamgc/retire_set.hpp"
#include "slamgc/root.hpp"
#include "slamgc/weak_rc.hpp"

/// Where an operation stands in the source, for relacy's report: the place of the call.
#define RELACY_HERE \
  rl::debug_info { __builtin_FUNCTION(), __builtin_FILE(), static_cast<unsigned>(__builtin_LINE()) }

struct relacy_env {
  template <class T>
  class atomic {
    /// relacy cannot print pointers to const.
    using stored =
        std::conditional_t<std::is_pointer<T>::value,
                           std::add_pointer_t<std::remove_const_t<std::remove_pointer_t<T>>>, T>;

   public:
    constexpr atomic(T value) noexcept : value_(stored(value)) {}

    T load(std::memory_order order, rl::debug_info here = RELACY_HERE) const noexcept {
      return value_.load(relacy_order(order), here);
    }
    void store(T value, std::memory_order order, rl::debug_info here = RELACY_HERE) noexcept {
      value_.store(stored(value), relacy_order(order), here);
    }
    T exchange(T value, std::memory_order order, rl::debug_info here = RELACY_HERE) noexcept {
      return value_.exchange(value, relacy_order(order), here);
    }
    T fetch_add(T delta, std::memory_order order, rl::debug_info here = RELACY_HERE) noexcept {
      return value_.fetch_add(delta, relacy_order(order), here);
    }
    T fetch_sub(T delta, std::memory_order order, rl::debug_info here = RELACY_HERE) noexcept {
      return value_.fetch_sub(delta, relacy_order(order), here);
    }
    bool compare_exchange_weak(T& expected, T desired, std::memory_order success,
                               std::memory_order failure,
                               rl::debug_info here = RELACY_HERE) noexcept {
      return alone ? compare_exchange<false>(expected, desired, success, failure, here)
                   : compare_exchange<true>(expected, desired, success, failure, here);
    }
    bool compare_exchange_strong(T& expected, T desired, std::memory_order success,
                                 std::memory_order failure,
                                 rl::debug_info here = RELACY_HERE) noexcept {
      return compare_exchange<false>(expected, desired, success, failure, here);
    }

   private:
    static rl::memory_order relacy_order(std::memory_order order) noexcept {
      switch (order) {
        case std::memory_order_relaxed:
          return rl::mo_relaxed;
        case std::memory_order_consume:
          return rl::mo_consume;
        case std::memory_order_acquire:
          return rl::mo_acquire;
        case std::memory_order_release:
          return rl::mo_release;
        case std::memory_order_acq_rel:
          return rl::mo_acq_rel;
        default:
          return rl::mo_seq_cst;
      }
    }
    /// relacy knows no failure order that is stronger than the success order, C++17 does. An acquire
    /// fence behind the failure makes up for it.
    template <bool Weak>
    bool compare_exchange(T& expected, T desired, std::memory_order success,
                          std::memory_order failure, const rl::debug_info& here) noexcept {
      const bool stronger =
          failure == std::memory_order_acquire &&
          (success == std::memory_order_relaxed || success == std::memory_order_release);
      const bool done =
          value_.compare_exchange(rl::bool_t<Weak>(), expected, desired, relacy_order(success),
                                  stronger ? rl::mo_relaxed : relacy_order(failure), here);
      if (!done && stronger) rl::atomic_thread_fence(rl::mo_acquire, here);
      return done;
    }

    rl::atomic<stored> value_;
  };

  /// The record of the simulated thread, zero at the beginning of each simulated execution.
  template <class Record>
  static Record& thread_record() noexcept {
    struct entry {
      unsigned execution;
      Record record;
    };
    static entry entries[16];
    entry& mine = entries[rl::thread_index()];
    if (mine.execution != execution()) mine = {execution(), Record{}};
    return mine.record;
  }
  /// The number of the simulated execution; model_base counts it up.
  static unsigned& execution() noexcept {
    static unsigned number = 0;
    return number;
  }

  /// No simulated thread has begun, or all have ended: a spurious failure would only double the search.
  static inline bool alone = true;

  /// So few that in models with three threads two share a door.
  static constexpr std::size_t mutator_doors = 1;

  // Elements of containers are plain pointers, in which relacy sees no order: a model keeps a container
  // under a mutex. Without it, relacy reports races that are none; it cannot miss one.
  template <class T>
  static T* load(T* const& element) noexcept {
    return element;
  }
  template <class T>
  static T* exchange(T*& element, T* desired) noexcept {
    return std::exchange(element, desired);
  }
  template <class T>
  static bool compare_exchange(T*& element, T* expected, T* desired) noexcept {
    if (element != expected) return false;
    element = desired;
    return true;
  }
};

/// Time stands still: an execution must not depend on it.
template <>
struct slamgc::runtime::clock_of<relacy_env> {
  using time_point = std::chrono::steady_clock::time_point;
  static time_point now() noexcept { return {}; }
  static void pause(std::chrono::nanoseconds) noexcept { rl::yield(1, RELACY_HERE); }
};

/// For basic_mutex_counter.
class relacy_mutex {
 public:
  void lock(rl::debug_info here = RELACY_HERE) { mutex_.lock(here); }
  void unlock(rl::debug_info here = RELACY_HERE) { mutex_.unlock(here); }

 private:
  rl::mutex mutex_;
};

using relacy_fetch_add_counter = slamgc::basic_fetch_add_counter<relacy_env>;
using relacy_cas_counter = slamgc::basic_cas_counter<relacy_env>;
using relacy_mutex_counter = slamgc::basic_mutex_counter<relacy_env, relacy_mutex>;

/// Plain data: relacy reports each pair of accesses that race, and each read before the first write.
template <class T>
class plain {
 public:
  T get(rl::debug_info here = RELACY_HERE) const { return value_(here).load(); }
  void set(T value, rl::debug_info here = RELACY_HERE) { value_(here).store(value); }

 private:
  rl::var<T> value_;
};

/// The simulated execution fails if @p condition does not hold.
inline void require(bool condition, const char* what, rl::debug_info here = RELACY_HERE) {
  if (!condition) rl::ctx().fail_test(what, rl::test_result_user_assert_failed, here);
}

/// A model of a protocol: `before()` makes the objects, `thread(i)` runs in each simulated thread, `after()`
/// looks at what is left. There is one object of the model per simulated execution.
struct model {
  virtual ~model() = default;
  virtual void before() {}
  virtual void thread(unsigned i) = 0;
  virtual void after() {}
};

/// Base of all models: what a model may choose differently.
template <class Model, rl::thread_id_t Threads>
struct model_base : model {
  static constexpr rl::thread_id_t threads = Threads;
  static constexpr unsigned context_bound = 2;          ///< Preemptions in the exhaustive search.
  static constexpr unsigned random_executions = 20000;  ///< Executions in the random search.
  static constexpr unsigned cases = 1;                  ///< Each is searched.
  static inline unsigned current_case = 0;              ///< The one that is searched now.
};

/// What relacy instantiates: one type for all models, since each makes the compiler work for seconds.
template <rl::thread_id_t Threads>
struct any_model : rl::test_suite<any_model<Threads>, Threads> {
  static inline model* (*make)(void* at) = nullptr;

  any_model() : model_((++relacy_env::execution(), relacy_env::alone = true, make(place_))) {}
  ~any_model() { model_->~model(); }
  void before() {
    model_->before();
    relacy_env::alone = false;
  }
  void thread(unsigned i) { model_->thread(i); }
  void after() {
    relacy_env::alone = true;
    model_->after();
  }

 private:
  alignas(16) char place_[1024];  // no allocation: each deallocation doubles the search
  model* model_;
};

/// Prints the execution that fails, if one does.
template <class Suite, class Scheduler>
bool search(const char* name, const char* how, rl::test_params params) {
  rl::ostringstream output;  // does not allocate from the simulated heap
  std::ostream nowhere(nullptr);
  params.output_stream = &output;
  params.progress_stream = &nowhere;
  rl::ostringstream state;
  const bool passed =
      rl::run_test<Suite, Scheduler>(params, state, false) == rl::test_result_success;
  std::cout << name << ", " << how << ": " << (passed ? "passed " : "FAILED after ")
            << params.stop_iteration << " executions" << std::endl;
  if (!passed) {
    params.initial_state = state.str();
    params.collect_history = true;
    rl::run_test<Suite, Scheduler>(params, state, true);
    std::cout << output.str().c_str();
  }
  return passed;
}

template <class Model>
bool check_case() {
  using suite = any_model<Model::threads>;
  static_assert(sizeof(Model) <= 1024, "fits into any_model");
  suite::make = [](void* at) -> model* { return ::new (at) Model; };
  const std::string name =
      std::string(typeid(Model).name()) + ", case " + std::to_string(Model::current_case);
  rl::test_params params;
  params.context_bound = Model::context_bound;
  params.iteration_count = Model::random_executions;
  params.search_type = rl::fair_context_bound_scheduler_type;
  if (!search<suite, rl::context_bound_scheduler<Model::threads>>(name.c_str(), "bounded", params))
    return false;
  params.search_type = rl::random_scheduler_type;
  return search<suite, rl::random_scheduler<Model::threads>>(name.c_str(), "random", params);
}

template <class Model>
bool check_model() {
  for (unsigned i = 0; i != Model::cases; ++i) {
    Model::current_case = i;
    if (!check_case<Model>()) return false;
  }
  return true;
}

/// Searches each model exhaustively up to its context bound, then at random, until an error is found. For
/// main(): 0 if there is none.
template <class... Models>
int check_models() {
  return (check_model<Models>() && ...) ? 0 : 1;
}
