// What retiring costs while a reader that does not become quiescent holds 20,000 objects.
#include <slamgc/deferred.hpp>
#include <slamgc/mutator.hpp>

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "contenders.hpp"

namespace {

using namespace bench;

constexpr std::size_t held = 20000;
constexpr unsigned batch = 1024;

struct object : slamgc::rc_object<object, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
  std::uint64_t payload[4];
};

/// A thread that is a mutator: offline, or online without ever being quiescent.
class reader {
 public:
  explicit reader(slamgc::domain& d)
      : thread_([this, &d] {
          slamgc::mutator me(d, "reader", {false, false});
          std::unique_lock<std::mutex> lock(mutex_);
          while (!over_) {
            {
              std::optional<slamgc::mutator::online_scope> online;
              if (stall_) online.emplace(me);
              const bool before = now_ = stall_;
              changed_.notify_all();
              changed_.wait(lock, [&] { return over_ || stall_ != before; });
            }
          }
        }) {}
  ~reader() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      over_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  reader(const reader&) = delete;
  reader& operator=(const reader&) = delete;

  /// Returns when the thread is so.
  void stall(bool yes) {
    std::unique_lock<std::mutex> lock(mutex_);
    stall_ = yes;
    changed_.notify_all();
    changed_.wait(lock, [&] { return now_ == yes; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stall_ = false, now_ = false, over_ = false;
  std::thread thread_;  // last: it uses the others
};

struct state {
  slamgc::domain domain;
  reader other{domain};
  std::optional<slamgc::mutator> mutator;
  std::vector<object*> objects;
};

contender retiring(const char* name, bool stalled, bool collecting) {
  const auto s = std::make_shared<state>();
  contender c{name, [=](unsigned, std::uint64_t n, unsigned) {
                object* const* p = s->objects.data();
                for (; n != 0; --n) {
                  for (unsigned i = 0; i != batch; ++i) slamgc::retire(*p++);
                  s->mutator->quiescent();
                  if (collecting) s->domain.collect();
                }
              }};
  c.prepare = [=](unsigned, std::uint64_t n) {
    s->other.stall(stalled);
    s->mutator.emplace(s->domain, "worker");
    if (stalled) {
      for (std::size_t i = 0; i != held; ++i) slamgc::retire(new object);
      s->mutator->quiescent();
      s->domain.collect();
    }
    s->objects.clear();
    for (std::uint64_t i = 0; i != n * batch; ++i) s->objects.push_back(new object);
  };
  c.finish = [=](unsigned) {
    s->other.stall(false);
    s->mutator.reset();
    (void)s->domain.drain();
  };
  // The objects shall fit into a second-level cache.
  c.most = 16;
  return c;
}

}  // namespace

int main(int argc, char** argv) {
  return run(argc, argv,
             {{"retire",
               "a stalled reader",
               {retiring("none held", false, false), retiring("20000 held", true, false),
                retiring("20000 held, and collect() after each 1024", true, true)},
               batch,
               {1}}});
}
