// The Boehm-Demers-Weiser collector, for comparison (libgc): plain pointers, nobody deletes; what no thread, no root and no
// reachable object refers to is found by stopping all threads and marking from their stacks.
//
// In the collector's memory: the objects, their containers, and the containers of what functions work on. Not there: what an object
// owns that has no references (features, descriptors). An object's destructor gives it back; it runs as a finalizer.
#pragma once

#define GC_THREADS
#define GC_NO_THREAD_REDIRECTS
#include <gc/gc.h>

#include <algorithm>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <new>
#include <thread>

#include "schemes.hpp"

namespace replay {

// The collector's memory, counted as operator new counts.
struct collected_heap {
  static void* counted(void* p) {
    if (p == nullptr) throw std::bad_alloc();
    count_bytes(static_cast<std::int64_t>(GC_size(p)));
    return p;
  }
  static void* scanned(std::size_t bytes) { return counted(GC_malloc(bytes)); }
  // Scanned, and never collected.
  static void* root(std::size_t bytes) { return counted(GC_malloc_uncollectable(bytes)); }
  static void give_back(void* p) {
    count_bytes(-static_cast<std::int64_t>(GC_size(p)));
    GC_free(p);
  }
};

template <class T>
struct collected_allocator {
  using value_type = T;
  collected_allocator() = default;
  template <class U>
  collected_allocator(const collected_allocator<U>&) {}
  T* allocate(std::size_t n) { return static_cast<T*>(collected_heap::scanned(n * sizeof(T))); }
  void deallocate(T* p, std::size_t) { collected_heap::give_back(p); }
  // A vector that was cleared has its capacity still, and the collector looks through all of it.
  template <class U>
  void destroy(U* p) {
    p->~U();
    std::memset(static_cast<void*>(p), 0, sizeof(U));
  }
  template <class U>
  bool operator==(const collected_allocator<U>&) const {
    return true;
  }
  template <class U>
  bool operator!=(const collected_allocator<U>&) const {
    return false;
  }
};

struct boehm : raw_pointers<true> {
  static constexpr const char* name = "boehm";
  static constexpr bool keeps_all = false;

  template <class T>
  using allocator = collected_allocator<T>;
  template <class T>
  struct object {
    static void* operator new(std::size_t bytes) { return collected_heap::scanned(bytes); }
    static void operator delete(void* p) { collected_heap::give_back(p); }
  };
  struct owner {
    static void* operator new(std::size_t bytes) { return collected_heap::root(bytes); }
    static void operator delete(void* p) { collected_heap::give_back(p); }
  };
  template <class T>
  using vector = std::vector<T*, allocator<T*>>;
  template <class T>
  using frame_vector = vector<T>;
  template <class T>
  using chosen_vector = vector<T>;
  template <class T>
  using list = std::list<T*, allocator<T*>>;
  template <class T>
  using set = std::set<T*, std::less<T*>, allocator<T*>>;
  template <class T, class Mapped>
  using chosen_map = std::map<T*, Mapped, std::less<T*>, allocator<std::pair<T* const, Mapped>>>;
  template <class T>
  using observations = chosen_map<T, std::size_t>;

  template <class T>
  static void assign(vector<T>& to, const vector<T>& from) {
    to = from;
  }
  template <class T>
  static void drop_all(vector<T>& handles) {
    handles.clear();
  }

  class program {
   public:
    explicit program(bool background) {
      start_libgc();
      before_ = live_bytes();
      if (background) reclaimer_ = std::thread([this] { reclaim(); });
    }
    ~program() {
      if (!reclaimer_.joinable()) return;
      wake(&program::ended_);
      reclaimer_.join();
    }
    program(const program&) = delete;
    program& operator=(const program&) = delete;

    template <class T, class... Args>
    T* make(Args&&... args) {
      T* const p = new T(std::forward<Args>(args)...);
      // In no order: cycles have none.
      GC_register_finalizer_no_order(
          p, [](void* object, void*) { delete static_cast<T*>(object); }, nullptr, nullptr,
          nullptr);
      return p;
    }
    template <class T>
    void retire(T*) {}
    void collect() {
      if (reclaimer_.joinable())
        wake(&program::wanted_);
      else
        collect_if_due();
    }
    void finish() {
      const std::lock_guard<std::mutex> l(finalizing_);
      do {
        GC_gcollect();
      } while (GC_invoke_finalizers() != 0);
    }
    template <class Described>
    struct root {
      root(program&, const char*, Described&) {}
    };

   private:
    static void start_libgc() {
      static const bool started = [] {
        GC_set_warn_proc(GC_ignore_warn_proc);
        GC_set_finalize_on_demand(1);  // not on the thread that happens to allocate
        GC_INIT();
        GC_allow_register_threads();
        GC_set_on_collection_event(note_pause);
        return true;
      }();
      (void)started;
    }
    // Called by the thread that collects, while others are stopped.
    static void note_pause(GC_EventType event) {
      static std::int64_t since = 0;
      if (event == GC_EVENT_PRE_STOP_WORLD) since = nanoseconds_now();
      if (event != GC_EVENT_POST_START_WORLD || current_role() == role::main) return;
      double& longest = ledger::now().mine().longest_pause;
      longest = std::max(longest, static_cast<double>(nanoseconds_now() - since) / 1e6);
    }

    // libgc collects when its own heap has grown by about a third. It does not see what objects own outside of it: so the same
    // rule once more, for all bytes.
    void collect_if_due() {
      const std::lock_guard<std::mutex> l(finalizing_);
      const bool due = live_bytes() - before_ > due_;
      if (due) GC_gcollect();
      GC_invoke_finalizers();  // those of libgc's own collections, too
      if (due) due_ = std::max(least_due, (live_bytes() - before_) * 4 / 3);
    }
    void reclaim() {
      const playing as(role::reclaimer);
      std::unique_lock<std::mutex> l(mutex_);
      for (;;) {
        changed_.wait(l, [this] { return wanted_ || ended_; });
        if (ended_) return;
        wanted_ = false;
        l.unlock();
        {
          const registration
              registered;  // not while it waits: what is left on its stack is not looked at
          collect_if_due();
        }
        l.lock();
      }
    }
    void wake(bool program::*why) {
      {
        const std::lock_guard<std::mutex> l(mutex_);
        this->*why = true;
      }
      changed_.notify_one();
    }

    static constexpr std::int64_t least_due = 1000000;
    std::int64_t before_ = 0, due_ = least_due;
    std::mutex finalizing_, mutex_;
    std::condition_variable changed_;
    bool wanted_ = false, ended_ = false;
    std::thread reclaimer_;
  };

 private:
  // The collector stops this thread, and looks through its stack.
  class registration {
   public:
    registration() {
      GC_stack_base base{};
      if (GC_get_stack_base(&base) != GC_SUCCESS) fault("libgc does not find a thread's stack");
      is_new_ = GC_register_my_thread(&base) == GC_SUCCESS;
    }
    ~registration() {
      if (is_new_) GC_unregister_my_thread();
    }
    registration(const registration&) = delete;
    registration& operator=(const registration&) = delete;

   private:
    bool is_new_ = false;
  };

 public:
  class thread : public no_threads::thread_without_duty<program> {
   public:
    using no_threads::thread_without_duty<program>::thread_without_duty;

   private:
    registration registered_;
  };
};

}  // namespace replay
