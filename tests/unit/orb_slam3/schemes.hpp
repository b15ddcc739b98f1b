// Three ways to own the objects of a map, under one set of names: a *scheme* is a struct of these.
//
// - plain: raw pointers, as in ORB-SLAM3. Nothing is ever freed. What a program that frees would do is shown without undefined
//   behaviour: destroy() only marks the object, and whoever uses a marked one is counted.
// - shared: the same members as std::shared_ptr, as in the forks that were ported to it.
// - counted: the same members counted by slamgc.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <slamgc/slamgc.hpp>
#include <thread>
#include <utility>
#include <vector>

namespace orb_slam3 {

// What a program does that it must not, seen where it does it.
struct faults {
  std::atomic<int> freed_used{0};     // an object that was freed
  std::atomic<int> null_used{0};      // through a pointer that is null, or without its object
  std::atomic<int> read_past_end{0};  // an element of a container without elements
  int all() const { return freed_used + null_used + read_past_end; }
  void clear() { freed_used = null_used = read_past_end = 0; }
};
inline faults found;

// Base class: knows the objects of type T that exist.
template <class T>
class listed {
 public:
  static std::vector<T*> all() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return {all_.begin(), all_.end()};
  }
  listed(const listed&) = delete;
  listed& operator=(const listed&) = delete;

 protected:
  listed() {
    const std::lock_guard<std::mutex> lock(mutex_);
    all_.insert(static_cast<T*>(this));
  }
  ~listed() {
    const std::lock_guard<std::mutex> lock(mutex_);
    all_.erase(static_cast<T*>(this));
  }

 private:
  static inline std::mutex mutex_;
  static inline std::set<T*> all_;
};

// A thread that does what it is told, one thing after the other.
class actor {
 public:
  actor() : thread_([this] { work(); }) {}
  ~actor() {
    hand_over(nullptr);
    thread_.join();
  }
  actor(const actor&) = delete;
  actor& operator=(const actor&) = delete;

  // Returns when it is done.
  void run(const std::function<void()>& f) { hand_over(&f); }

 private:
  void hand_over(const std::function<void()>* f) {
    std::unique_lock<std::mutex> lock(mutex_);
    task_ = f;
    has_task_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !has_task_; });
  }
  void work() {
    std::unique_lock<std::mutex> lock(mutex_);
    for (bool more = true; more;) {
      changed_.wait(lock, [this] { return has_task_; });
      more = task_ != nullptr;
      if (more) (*task_)();
      has_task_ = false;
      changed_.notify_all();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  const std::function<void()>* task_ = nullptr;
  bool has_task_ = false;
  std::thread thread_;
};

// The threads of a program whose memory does not depend on them.
struct one_thread {
  template <class Described>
  void root_of_atlas(Described&) {}
  template <class Described>
  void root_of_mapping(const char*, Described&) {}
  template <class Described>
  void root_of_tracking(const char*, Described&) {}
  void on_tracking(const std::function<void()>& f) { f(); }
  void collect() {}
  void settle() {}
  void end_roots() {}
};

struct plain {
  static constexpr bool adapted = false;
  template <class T>
  struct object {
    void used() const { found.freed_used += freed; }
    bool freed = false;
  };
  template <class T>
  using pointer = T*;
  template <class T>
  using local = T*;
  template <class T>
  using vector = std::vector<T*>;
  template <class T>
  using list = std::list<T*>;
  template <class T>
  using set = std::set<T*>;
  template <class T, class Mapped>
  using map = std::map<T*, Mapped>;
  template <class Container>
  using registry = Container;
  template <class T>
  using snapshot = std::vector<T*>;
  template <class T, class Record>
  struct leaves_record {};
  template <class T, class Record>
  using reference = T*;
  using threads = one_thread;

  template <class T, class... Args>
  static T* make(Args&&... args) {
    return new T(std::forward<Args>(args)...);
  }
  // The program calls it bad.
  template <class T>
  static void retire(T*) {}
  // The program deletes it.
  template <class T>
  static void destroy(T* p) {
    p->freed = true;
  }
};

template <class T>
class shared_pointer {
 public:
  shared_pointer() = default;
  shared_pointer(T* p) : p_(p != nullptr ? p->shared_from_this() : nullptr) {}
  explicit shared_pointer(std::shared_ptr<T> p) : p_(std::move(p)) {}
  operator T*() const { return p_.get(); }
  T* operator->() const { return p_.get(); }

 private:
  std::shared_ptr<T> p_;
};

struct shared {
  static constexpr bool adapted = false;
  template <class T>
  struct object : std::enable_shared_from_this<T> {
    void used() const {}
  };
  template <class T>
  using pointer = shared_pointer<T>;
  template <class T>
  using local = shared_pointer<T>;
  template <class T>
  using vector = std::vector<shared_pointer<T>>;
  template <class T>
  using list = std::list<shared_pointer<T>>;
  template <class T>
  using set = std::set<shared_pointer<T>, std::less<T*>>;
  template <class T, class Mapped>
  using map = std::map<shared_pointer<T>, Mapped, std::less<T*>>;
  template <class Container>
  using registry = Container;
  template <class T>
  using snapshot = std::vector<shared_pointer<T>>;
  template <class T, class Record>
  struct leaves_record {};
  template <class T, class Record>
  using reference = shared_pointer<T>;
  using threads = one_thread;

  template <class T, class... Args>
  static shared_pointer<T> make(Args&&... args) {
    return shared_pointer<T>(std::make_shared<T>(std::forward<Args>(args)...));
  }
  template <class T>
  static void retire(T*) {}
  template <class T>
  static void destroy(T*) {}
};

// Local mapping and loop closing run on the thread of the test, tracking on one of its own.
class registered_threads {
 public:
  registered_threads() {
    tracking_.run([this] {
      tracker_ = std::make_unique<slamgc::mutator>(
          domain_, "Tracking", slamgc::mutator_options{true, /*never_reclaim=*/true});
    });
  }
  ~registered_threads() {
    end_roots();
    tracking_.run([this] { tracker_.reset(); });
  }

  template <class Described>
  void root_of_atlas(Described& described) {
    roots_.push_back(std::make_unique<slamgc::root>(domain_, "Atlas", described));
  }
  template <class Described>
  void root_of_mapping(const char* name, Described& described) {
    roots_.push_back(std::make_unique<slamgc::root>(mapper_, name, described));
  }
  template <class Described>
  void root_of_tracking(const char* name, Described& described) {
    tracking_.run([&] {
      roots_of_tracking_.push_back(std::make_unique<slamgc::root>(*tracker_, name, described));
    });
  }
  void end_roots() {
    roots_.clear();
    tracking_.run([this] { roots_of_tracking_.clear(); });
  }

  // Tracking does something in its interval: between two quiescent states.
  void on_tracking(const std::function<void()>& f) { tracking_.run(f); }
  // Tracking has finished with its frame.
  void end_of_frame() {
    tracking_.run([this] { tracker_->quiescent(); });
  }
  // Mapping reclaims as far as tracking permits.
  void collect() {
    for (int i = 0; i != 12; ++i) {
      domain_.collect();
      mapper_.quiescent();
    }
  }
  // All threads pass quiescent states until nothing changes any more.
  void settle() {
    for (int i = 0; i != 3; ++i) {
      end_of_frame();
      tracking_.run(
          [this] { pause_ = std::make_unique<slamgc::mutator::offline_scope>(*tracker_); });
      {
        const slamgc::mutator::offline_scope offline(mapper_);
        drained_ = domain_.drain() == slamgc::waited::done;
      }
      tracking_.run([this] { pause_.reset(); });
    }
  }
  bool drained() const { return drained_; }
  slamgc::domain& domain() { return domain_; }
  slamgc::mutator& mapper() { return mapper_; }

 private:
  slamgc::domain domain_;
  slamgc::mutator mapper_{domain_, "LocalMapping and LoopClosing"};
  actor tracking_;
  std::unique_ptr<slamgc::mutator> tracker_;
  std::unique_ptr<slamgc::mutator::offline_scope> pause_;
  std::vector<std::unique_ptr<slamgc::root>> roots_;
  std::vector<std::unique_ptr<slamgc::root>> roots_of_tracking_;
  bool drained_ = false;
};

struct counted {
  // Whether the program has the few lines that docs/orb-slam3-cases.md asks for.
  static constexpr bool adapted = true;
  template <class T>
  struct object : slamgc::rc_object<T, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
    void used() const {}
  };
  template <class T>
  using pointer = slamgc::rc_slot<T>;
  template <class T>
  using local = T*;
  template <class T>
  using vector = slamgc::rc_vector<T>;
  template <class T>
  using list = slamgc::rc_list<T>;
  template <class T>
  using set = slamgc::rc_set<T>;
  template <class T, class Mapped>
  using map = slamgc::rc_map<T, Mapped>;
  template <class Container>
  using registry = slamgc::registry<Container>;
  template <class T>
  using snapshot = slamgc::pin_set<T>;
  template <class T, class Record>
  using leaves_record = slamgc::enable_anchor<T, Record>;
  template <class T, class Record>
  using reference = slamgc::anchor<T, Record>;
  using threads = registered_threads;

  template <class T, class... Args>
  static T* make(Args&&... args) {
    return new T(std::forward<Args>(args)...);
  }
  template <class T>
  static void retire(T* p) {
    slamgc::retire(p);
  }
  template <class T>
  static void destroy(T* p) {
    slamgc::retire(p);
  }
};

}  // namespace orb_slam3
