#include "harness.hpp"

#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <mutex>
#include <random>
#include <thread>

namespace bench {
namespace {

struct options {
  unsigned rounds = 31;
  double window = 1e-3;  ///< Seconds of CPU time per thread.
  bool smoke = false;    ///< A few iterations, no measurement: for tests.
  unsigned threads = most_threads;
  const char* only = "";
};

double now(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// The processors that this process may use.
std::vector<int> processors() {
  cpu_set_t set;
  std::vector<int> result;
  if (sched_getaffinity(0, sizeof set, &set) == 0)
    for (int i = 0; i != CPU_SETSIZE; ++i)
      if (CPU_ISSET(i, &set)) result.push_back(i);
  if (result.empty()) result.push_back(0);
  return result;
}

/// What one thread measured in one window.
struct sample {
  double begin = 0, end = 0, cpu = 0;
  bool preempted = false;
};

struct window {
  double cpu = 0, wall = 0;  ///< Seconds, mean of the threads.
  double overlap = 1;        ///< How much of it all threads measured at the same time.
  bool preempted = false;
};

/// Threads that wait for work.
class pool {
 public:
  explicit pool(unsigned threads) : processors_(processors()), samples_(threads) {
    for (unsigned i = 0; i != threads; ++i) threads_.emplace_back([this, i] { serve(i); });
  }
  ~pool() {
    post(nullptr, 0, 0, 0);
    for (std::thread& t : threads_) t.join();
  }
  pool(const pool&) = delete;
  pool& operator=(const pool&) = delete;

  std::size_t processor_count() const { return processors_.size(); }

  window measure(const contender& c, std::uint64_t n, unsigned threads, unsigned round) {
    post(&c, n, threads, round);
    std::unique_lock<std::mutex> lock(mutex_);
    done_.wait(lock, [this] { return running_ == 0; });
    window w;
    double first_begin = samples_[0].begin, last_begin = first_begin;
    double first_end = samples_[0].end, last_end = first_end;
    for (unsigned i = 0; i != threads; ++i) {
      const sample& s = samples_[i];
      first_begin = std::min(first_begin, s.begin);
      last_begin = std::max(last_begin, s.begin);
      first_end = std::min(first_end, s.end);
      last_end = std::max(last_end, s.end);
      w.cpu += s.cpu / threads;
      w.wall += (s.end - s.begin) / threads;
      w.preempted = w.preempted || s.preempted;
    }
    w.overlap = (first_end - last_begin) / (last_end - first_begin);
    return w;
  }

 private:
  void post(const contender* c, std::uint64_t n, unsigned threads, unsigned round) {
    const std::lock_guard<std::mutex> lock(mutex_);
    work_ = c;
    iterations_ = n;
    round_ = round;
    running_ = threads;
    active_ = threads;
    waiting_.store(threads);
    ++ticket_;
    posted_.notify_all();
  }

  void serve(unsigned thread) {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<std::size_t>(processors_[thread % processors_.size()]), &set);
    pthread_setaffinity_np(pthread_self(), sizeof set, &set);
    for (std::uint64_t seen = 0;;) {
      const contender* c = nullptr;
      std::uint64_t n = 0;
      unsigned round = 0;
      {
        std::unique_lock<std::mutex> lock(mutex_);
        posted_.wait(lock, [&] { return ticket_ != seen; });
        seen = ticket_;
        if (work_ == nullptr) return;
        if (thread >= active_) continue;
        c = work_;
        n = iterations_;
        round = round_;
      }
      if (c->prepare) c->prepare(thread, n);
      // Begin together. A thread that waits must not keep others from getting here.
      waiting_.fetch_sub(1);
      while (waiting_.load() != 0)
        if (active_ > processors_.size()) sched_yield();
      sample s;
      const long before = preemptions();
      s.begin = now(CLOCK_MONOTONIC);
      const double cpu = now(CLOCK_THREAD_CPUTIME_ID);
      c->run(thread, n, round);
      s.cpu = now(CLOCK_THREAD_CPUTIME_ID) - cpu;
      s.end = now(CLOCK_MONOTONIC);
      s.preempted = preemptions() != before;
      if (c->finish) c->finish(thread);
      const std::lock_guard<std::mutex> lock(mutex_);
      samples_[thread] = s;
      if (--running_ == 0) done_.notify_all();
    }
  }

  static long preemptions() {
    rusage usage{};
    getrusage(RUSAGE_THREAD, &usage);
    return usage.ru_nivcsw;
  }

  const std::vector<int> processors_;
  std::mutex mutex_;
  std::condition_variable posted_, done_;
  const contender* work_ = nullptr;
  std::uint64_t iterations_ = 0, ticket_ = 0;
  unsigned active_ = 0, running_ = 0, round_ = 0;
  std::atomic<unsigned> waiting_{0};
  std::vector<sample> samples_;
  std::vector<std::thread> threads_;
};

options parse(int argc, char** argv) {
  options o;
  for (int i = 1; i < argc; ++i) {
    const char* const value = std::strchr(argv[i], '=');
    const auto is = [&](const char* name) {
      return std::strncmp(argv[i], name, std::strlen(name)) == 0;
    };
    if (is("--smoke"))
      o.smoke = true;
    else if (value != nullptr && is("--rounds="))
      o.rounds = static_cast<unsigned>(std::strtoul(value + 1, nullptr, 10));
    else if (value != nullptr && is("--threads="))
      o.threads = static_cast<unsigned>(std::strtoul(value + 1, nullptr, 10));
    else if (value != nullptr && is("--only="))
      o.only = value + 1;
    else {
      std::fprintf(stderr,
                   "usage: %s [--smoke] [--rounds=N] [--threads=N (at most)] [--only=OPERATION]\n",
                   argv[0]);
      std::exit(2);
    }
  }
  return o;
}

class session {
 public:
  session(const options& o, unsigned threads) : options_(o), pool_(threads) {}

  void run(const group& g, unsigned threads) {
    struct entry {
      const contender* c;
      std::uint64_t n;
    };
    std::vector<entry> entries;
    for (const contender& c : g.contenders)
      if (threads == 1 || !c.one_thread_only) entries.push_back({&c, calibrate(c, threads)});
    if (options_.smoke) return;
    const bool parallel = threads <= pool_.processor_count();
    // With more threads than processors the scheduler is part of what is measured: longer windows.
    const unsigned rounds = parallel ? options_.rounds : std::max(3u, options_.rounds / 3);
    for (unsigned round = 0; round != rounds; ++round) {
      std::shuffle(entries.begin(), entries.end(), random_);
      for (const entry& e : entries) {
        window w;
        bool valid = false;
        for (unsigned attempt = 0; attempt != 10 * threads && !valid; ++attempt) {
          w = pool_.measure(*e.c, e.n, threads, round);
          valid = !parallel || (w.overlap >= 0.8 && !w.preempted);
        }
        // Alone, preemption costs little: the thread's own time is measured.
        valid = valid || threads == 1;
        const double ns = 1e9 / (static_cast<double>(e.n) * static_cast<double>(g.operations));
        std::printf(
            "{\"operation\": \"%s\", \"shape\": \"%s\", \"threads\": %u, \"contender\": \"%s\", "
            "\"round\": %u, \"cpu_ns\": %.4f, \"wall_ns\": %.4f, \"overlap\": %.3f, \"valid\": "
            "%s}\n",
            g.operation.c_str(), g.shape.c_str(), threads, e.c->name.c_str(), round, w.cpu * ns,
            w.wall * ns, w.overlap, valid ? "true" : "false");
      }
    }
    std::fflush(stdout);
  }

 private:
  /// How often it has to be done to fill a window.
  std::uint64_t calibrate(const contender& c, unsigned threads) {
    if (options_.smoke) {
      pool_.measure(c, 2, threads, 0);
      return 0;
    }
    const double window =
        threads <= pool_.processor_count() ? options_.window : 4 * options_.window;
    for (std::uint64_t n = 1;; n *= 2) {
      if (n >= c.most) return c.most;
      double best = pool_.measure(c, n, threads, 0).cpu;
      for (int i = 0; i != 2; ++i) best = std::min(best, pool_.measure(c, n, threads, 0).cpu);
      if (best > window / 8)
        return std::min(c.most,
                        std::max<std::uint64_t>(
                            1, static_cast<std::uint64_t>(window / best * static_cast<double>(n))));
    }
  }

  options options_;
  pool pool_;
  std::mt19937 random_{1};
};

}  // namespace

int run(int argc, char** argv, const std::vector<group>& groups) {
  const options o = parse(argc, argv);
  const std::vector<unsigned> all{1, 2, 4, max_threads};
  // The others wait all the time: as few as there may be.
  unsigned threads_of_all = max_threads;
  for (const group& g : groups)
    for (unsigned threads : g.threads) threads_of_all = std::max(threads_of_all, threads);
  session s(o, threads_of_all);
  for (const group& g : groups) {
    if (g.operation.find(o.only) == std::string::npos) continue;
    for (unsigned threads : g.threads.empty() ? all : g.threads)
      if (threads <= o.threads) s.run(g, threads);
  }
  return 0;
}

}  // namespace bench
