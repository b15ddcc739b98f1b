// What is measured while a session is replayed: births and deaths, memory, and times, without locks.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace replay {

// Whose doing something is.
enum class role { main, tracking, mapping, looping, adjustment, viewer, reclaimer };
constexpr std::size_t roles = 7;
const char* name_of(role r);

enum class kind { keyframe, point };

std::int64_t nanoseconds_now();      // steady
std::int64_t cpu_nanoseconds_now();  // of this thread

// Numbers of which there may be any number, in memory that does not grow: when it is full, every second one goes.
class thinned {
 public:
  thinned() { kept_.reserve(most); }
  void add(double value) {
    sum_ += value;
    if (value > max_) max_ = value;
    if (count_++ % stride_ != 0) return;
    if (kept_.size() == most) {
      for (std::size_t i = 0; i != most / 2; ++i) kept_[i] = kept_[2 * i];
      kept_.resize(most / 2);
      stride_ *= 2;
    }
    kept_.push_back(static_cast<float>(value));
  }
  std::uint64_t count() const { return count_; }
  double mean() const { return count_ == 0 ? 0 : sum_ / static_cast<double>(count_); }
  double max() const { return max_; }
  const std::vector<float>& kept() const { return kept_; }

 private:
  static constexpr std::size_t most = std::size_t{1} << 15;
  std::vector<float> kept_;
  std::uint64_t count_ = 0, stride_ = 1;
  double sum_ = 0, max_ = 0;
};

// What one thread did; nobody else touches it until the thread has ended.
struct alignas(128) role_ledger {
  std::uint64_t made[2] = {}, destroyed[2] = {}, destroyed_marked[2] = {};
  thinned death_delay;       // ms from marking to destruction
  thinned wall, cpu;         // ms of each iteration, without what it waited for
  double longest_pause = 0;  // ms: reclamation in one piece
  double reclaiming = 0;     // ms, all of it
  std::uint64_t work = 0;    // what the work computed, so that it is not optimised away
};

// Of the replay that runs.
class ledger {
 public:
  static ledger& now();
  role_ledger& of(role r) { return of_[static_cast<std::size_t>(r)]; }
  const role_ledger& of(role r) const { return of_[static_cast<std::size_t>(r)]; }
  role_ledger& mine();
  void clear() {
    for (auto& one : of_) one = {};
    marked[0] = marked[1] = freed[0] = freed[1] = 0;
  }
  template <class Number>
  std::uint64_t sum(Number number) const {
    std::uint64_t n = 0;
    for (const auto& one : of_) n += number(one);
    return n;
  }

  // For the progress, while threads run: by kind.
  std::atomic<std::uint64_t> marked[2] = {}, freed[2] = {};

 private:
  std::array<role_ledger, roles> of_;
};

// The calling thread plays this part from now on.
class playing {
 public:
  explicit playing(role r);
  ~playing();
  playing(const playing&) = delete;
  playing& operator=(const playing&) = delete;

 private:
  const role before_;
};
role current_role();
// What the calling thread is at, for the explanation of a crash.
void at_iteration(long number);
long current_iteration();

// What was marked before a lap began does not count as freed in it: its map was reset.
void begin_lap();
std::int64_t lap_began();

// Bytes that operator new has handed out and not got back (counted_heap.cpp); resident memory of the process.
std::int64_t live_bytes();
void count_bytes(std::int64_t more);  // of another allocator, to be counted with them
std::int64_t resident_bytes();
std::int64_t peak_resident_bytes();

// An object that was deleted is in use: says so and ends the process, unless somebody else is to be told.
using fault_handler = void (*)(const char* what);
void on_fault(fault_handler handler);
void fault(const char* what);
// Or nothing is really deleted by schemes that cannot do it safely (bury() instead), and such uses are only counted: to see how far a
// scheme would have come.
void count_faults(bool yes);
bool counting_faults();
std::uint64_t counted_faults();

// Base class of what is born and dies: knows whether it is alive, and enters it into the ledger.
template <kind Kind>
class mortal {
 public:
  // Whoever uses an object says so. Costs a load and a comparison under every scheme.
  void used() const {
    if (alive_ != magic)
      fault(Kind == kind::keyframe ? "a keyframe is used after it was deleted"
                                   : "a map point is used after it was deleted");
  }
  void marked() {
    ledger::now().marked[index].fetch_add(1, std::memory_order_relaxed);
    marked_at_ = nanoseconds_now();
  }

 protected:
  mortal() { ++ledger::now().mine().made[index]; }
  ~mortal() {
    if (alive_ == magic) die();
  }
  // It counts as destroyed from now on.
  void die() {
    alive_ = 0;
    role_ledger& mine = ledger::now().mine();
    ++mine.destroyed[index];
    if (marked_at_ == 0 || marked_at_ < lap_began()) return;
    ++mine.destroyed_marked[index];
    ledger::now().freed[index].fetch_add(1, std::memory_order_relaxed);
    mine.death_delay.add(static_cast<double>(nanoseconds_now() - marked_at_) / 1e6);
  }
  mortal(const mortal&) = delete;
  mortal& operator=(const mortal&) = delete;

 private:
  static constexpr std::size_t index = static_cast<std::size_t>(Kind);
  static constexpr std::uint64_t magic = 0x6c6976696e67ULL;
  volatile std::uint64_t alive_ =
      magic;  // volatile: it is read after it was freed, and written before
  std::int64_t marked_at_ = 0;
};

}  // namespace replay
