// The counted pointers that are compared: slamgc's policies, the counters that one would write by
// hand, boost::intrusive_ptr and std::shared_ptr.
#pragma once

#include <algorithm>
#include <atomic>
#include <boost/smart_ptr/intrusive_ptr.hpp>
#include <boost/smart_ptr/intrusive_ref_counter.hpp>
#include <cstdint>
#include <memory>
#include <mutex>
#include <random>
#include <slamgc/mutex_counter.hpp>
#include <slamgc/slamgc.hpp>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "harness.hpp"

namespace bench {

// Counters as one writes them without a library.

struct hand_fetch_add {
  std::atomic<std::uint64_t> count{0};
  void add() { count.fetch_add(1, std::memory_order_relaxed); }
  bool subtract_is_last() { return count.fetch_sub(1, std::memory_order_acq_rel) == 1; }
};

struct hand_cas {
  std::atomic<std::uint64_t> count{0};
  void add() {
    std::uint64_t found = count.load(std::memory_order_relaxed);
    while (!count.compare_exchange_weak(found, found + 1, std::memory_order_relaxed)) {
    }
  }
  bool subtract_is_last() {
    std::uint64_t found = count.load(std::memory_order_relaxed);
    while (!count.compare_exchange_weak(found, found - 1, std::memory_order_acq_rel,
                                        std::memory_order_relaxed)) {
    }
    return found == 1;
  }
};

/// As slamgc's cas_counter: with a version, a change that was undone meanwhile is a change, too.
struct hand_cas_versioned {
  static constexpr std::uint64_t version_unit = std::uint64_t{1} << 32;
  std::atomic<std::uint64_t> count{0};
  void add() {
    std::uint64_t found = count.load(std::memory_order_relaxed);
    while (
        !count.compare_exchange_weak(found, found + version_unit + 1, std::memory_order_relaxed)) {
    }
  }
  bool subtract_is_last() {
    std::uint64_t found = count.load(std::memory_order_relaxed);
    while (!count.compare_exchange_weak(found, found - 1, std::memory_order_acq_rel,
                                        std::memory_order_relaxed)) {
    }
    return static_cast<std::uint32_t>(found) == 1;
  }
};

struct hand_mutex {
  std::mutex mutex;
  std::uint64_t count = 0;
  void add() {
    const std::lock_guard<std::mutex> lock(mutex);
    ++count;
  }
  bool subtract_is_last() {
    const std::lock_guard<std::mutex> lock(mutex);
    return --count == 0;
  }
};

struct hand_plain {
  std::uint64_t count = 0;
  void add() { ++count; }
  bool subtract_is_last() { return --count == 0; }
};

/// The pointer that goes with them.
template <class T>
class hand_ptr {
 public:
  hand_ptr() = default;
  explicit hand_ptr(T* p) : p_(p) {
    if (p_ != nullptr) p_->counter.add();
  }
  hand_ptr(const hand_ptr& other) : hand_ptr(other.p_) {}
  hand_ptr(hand_ptr&& other) noexcept : p_(std::exchange(other.p_, nullptr)) {}
  hand_ptr& operator=(hand_ptr other) noexcept {
    std::swap(p_, other.p_);
    return *this;
  }
  ~hand_ptr() {
    if (p_ != nullptr && p_->counter.subtract_is_last()) delete p_;
  }
  T* get() const { return p_; }

 private:
  T* p_ = nullptr;
};

/// A member that several threads may assign, as rc_slot.
template <class T>
class hand_atomic_slot {
 public:
  hand_atomic_slot() = default;
  hand_atomic_slot(const hand_atomic_slot&) = delete;
  hand_atomic_slot& operator=(const hand_atomic_slot&) = delete;
  hand_atomic_slot& operator=(const hand_ptr<T>& p) {
    T* const next = p.get();
    if (next != nullptr) next->counter.add();
    release(p_.exchange(next, std::memory_order_acq_rel));
    return *this;
  }
  ~hand_atomic_slot() { release(p_.load(std::memory_order_relaxed)); }

 private:
  static void release(T* p) {
    if (p != nullptr && p->counter.subtract_is_last()) delete p;
  }
  std::atomic<T*> p_{nullptr};
};

/// As hand_atomic_slot; libstdc++ takes a mutex of a pool of 16.
template <class T>
class shared_atomic_slot {
 public:
  shared_atomic_slot& operator=(const std::shared_ptr<T>& p) {
    std::atomic_store(&p_, p);
    return *this;
  }

 private:
  std::shared_ptr<T> p_;
};

// Kinds: what belongs together. A cache line per object, so that only what is shared is contended.

template <class Policy>
struct slamgc_kind {
  struct alignas(64) object : slamgc::rc_object<object, Policy> {
    std::uint64_t payload = 0;
  };
  using pointer = slamgc::intrusive_rc<object>;
  using slot = slamgc::rc_slot<object>;
  using vector = slamgc::rc_vector<object>;
  using source = std::vector<object*>;  // what programs assign to an rc_vector
  static pointer make() { return pointer(new object); }
};

template <class Counter>
struct hand_kind {
  struct alignas(64) object {
    Counter counter;
    std::uint64_t payload = 0;
  };
  using pointer = hand_ptr<object>;
  using slot = pointer;
  using vector = std::vector<pointer>;
  using source = vector;
  static pointer make() { return pointer(new object); }
};
template <class Counter>
struct hand_atomic_kind : hand_kind<Counter> {
  using slot = hand_atomic_slot<typename hand_kind<Counter>::object>;
};

struct boost_kind {
  struct alignas(64) object : boost::intrusive_ref_counter<object, boost::thread_safe_counter> {
    std::uint64_t payload = 0;
  };
  using pointer = boost::intrusive_ptr<object>;
  using slot = pointer;
  using vector = std::vector<pointer>;
  using source = vector;
  static pointer make() { return pointer(new object); }
};

struct shared_kind {
  struct alignas(64) object {
    std::uint64_t payload = 0;
  };
  using pointer = std::shared_ptr<object>;
  using slot = pointer;
  using vector = std::vector<pointer>;
  using source = vector;
  static pointer make() { return std::make_shared<object>(); }
};
struct shared_atomic_kind : shared_kind {
  using slot = shared_atomic_slot<shared_kind::object>;
};

/// The floor: nothing is counted.
struct raw_kind {
  struct alignas(64) object {
    std::uint64_t payload = 0;
  };
  using pointer = std::shared_ptr<object>;
  using vector = std::vector<object*>;
  using source = vector;
  static pointer make() { return std::make_shared<object>(); }
};

using slamgc_fetch_add = slamgc_kind<slamgc::fetch_add_counter>;
using slamgc_cas = slamgc_kind<slamgc::cas_counter>;
using slamgc_mutex = slamgc_kind<slamgc::mutex_counter>;
using slamgc_unsync = slamgc_kind<slamgc::unsync_counter>;

/// All kinds, each made into a contender by Make<Kind>()(name).
template <template <class> class Make>
std::vector<contender> all_kinds() {
  std::vector<contender> all{
      Make<slamgc_fetch_add>()("slamgc fetch_add"),
      Make<hand_kind<hand_fetch_add>>()("hand fetch_add"),
      Make<boost_kind>()("boost::intrusive_ptr"),
      Make<shared_kind>()("std::shared_ptr"),
      Make<slamgc_cas>()("slamgc cas"),
      Make<hand_kind<hand_cas>>()("hand cas"),
      Make<hand_kind<hand_cas_versioned>>()("hand cas, versioned"),
      Make<slamgc_mutex>()("slamgc mutex"),
      Make<hand_kind<hand_mutex>>()("hand mutex"),
      Make<slamgc_unsync>()("slamgc unsync"),
      Make<hand_kind<hand_plain>>()("hand plain"),
  };
  for (contender& c : all) c.one_thread_only = c.name == "slamgc unsync" || c.name == "hand plain";
  return all;
}

/// How many objects "spread objects" are. They fit into a second-level cache.
constexpr std::size_t spread_objects = 4096;

/// @p n new objects in random order; always the same order.
template <class Kind>
std::vector<typename Kind::pointer> make_objects(std::size_t n) {
  std::vector<typename Kind::pointer> result;
  result.reserve(n);
  for (std::size_t i = 0; i != n; ++i) result.push_back(Kind::make());
  std::shuffle(result.begin(), result.end(), std::mt19937(1));
  return result;
}

/// What is assigned to a container to make it refer to these objects.
template <class Kind>
typename Kind::source source_of(const std::vector<typename Kind::pointer>& pointers) {
  typename Kind::source result;
  for (const auto& p : pointers) {
    if constexpr (std::is_pointer<typename Kind::source::value_type>::value)
      result.push_back(p.get());
    else
      result.push_back(p);
  }
  return result;
}

/// Which object is the first of @p Objects in this round.
template <std::size_t Objects>
std::size_t first_object(unsigned round) {
  return Objects == 1 ? round % object_choices : 0;
}
/// Where a thread begins; all go through all objects, in the same order.
template <std::size_t Objects>
std::size_t first_place(unsigned thread) {
  return thread * Objects / max_threads;
}

/// Something for each thread, with cache lines of its own.
template <class T>
struct per_thread {
  struct alignas(128) padded {
    T value;
  };
  padded all[most_threads];
  T& operator[](unsigned thread) { return all[thread].value; }
};

}  // namespace bench
