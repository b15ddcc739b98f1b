// slamgc as it is meant: members are counted, locals are plain pointers, culled objects wait until no thread can see them, stale
// references are purged, cycles are found.
#pragma once

#include <memory>
#include <optional>
#include <slamgc/background_reclaimer.hpp>
#include <slamgc/slamgc.hpp>

#include "schemes.hpp"

namespace replay {

struct deferred : ordinary_memory {
  static constexpr const char* name = "deferred";
  static constexpr bool keeps_all = false;

  template <class T>
  using object = slamgc::rc_object<T, slamgc::fetch_add_counter, slamgc::reclaim_retired>;
  template <class T, class Record>
  using leaves_record = slamgc::enable_anchor<T, Record>;
  template <class T>
  using pointer = slamgc::rc_slot<T>;
  template <class T>
  using up_pointer = slamgc::rc_slot<T>;
  template <class T>
  using vector = slamgc::rc_vector<T>;
  template <class T>
  using frame_vector =
      std::vector<T*>;  // as in docs/orb-slam3.md: not counted, and empty when the frame is over
  template <class T>
  static void end_frame(std::vector<T*>& v) {
    v.clear();
  }
  template <class T>
  using chosen_vector = slamgc::rc_vector<T>;
  template <class T>
  using list = slamgc::rc_list<T>;
  template <class T>
  using set = slamgc::rc_set<T>;
  template <class T, class Mapped>
  using chosen_map = slamgc::rc_map<T, Mapped>;
  template <class T>
  using observations = slamgc::rc_map<T, std::size_t>;
  template <class Container>
  using registry = slamgc::registry<Container>;
  template <class T, class Record>
  using reference = slamgc::anchor<T, Record>;
  template <class T>
  using local = T*;
  template <class T>
  using handle = slamgc::intrusive_rc<T>;

  template <class T>
  static T* local_of(T* p) {
    if (p != nullptr) p->used();
    return p;
  }
  template <class T>
  static T* raw(T* p) {
    return p;
  }
  template <class T>
  static T* raw(const handle<T>& p) {
    return p.get();
  }
  template <class T>
  static T* plain(T* p) {
    return p;
  }
  template <class T>
  static T* plain(const slamgc::rc_slot<T>& p) {
    return p.get();
  }
  template <class T>
  static void assign(slamgc::rc_vector<T>& to, const std::vector<T*>& from) {
    to = from;
  }
  template <class T>
  static void assign(std::vector<T*>& to, const std::vector<T*>& from) {
    to = from;
  }
  template <class T, class Record>
  static slamgc::anchor<T, Record> reference_to(T* p) {
    return slamgc::anchor<T, Record>(p);
  }
  template <class T, class Record>
  static long id_of(const slamgc::anchor<T, Record>& reference) {
    return reference.read([](T& object) { return object.mnId; },
                          [](const Record& record) { return record.id; });
  }
  template <class T>
  static handle<T> hold(T* p) {
    return handle<T>(p);
  }
  template <class T>
  static void release(handle<T>& p) {
    p.reset();
  }
  template <class T>
  static void drop_all(std::vector<handle<T>>& handles) {
    handles.clear();
  }

  class program {
   public:
    // Without a thread of its own the reclaimer is local mapping, at the end of culling.
    explicit program(bool background) {
      if (!background) return;
      slamgc::reclaimer_options how;
      how.on_start = [this] { part_ = std::make_unique<playing>(role::reclaimer); };
      reclaimer_ = std::make_unique<slamgc::background_reclaimer>(domain, how);
    }
    template <class T, class... Args>
    handle<T> make(Args&&... args) {
      return handle<T>(new T(std::forward<Args>(args)...));
    }
    template <class T>
    void retire(T* p) {
      slamgc::retire(p);
    }
    void collect() {
      if (reclaimer_ == nullptr) (void)domain.collect({slice});
    }
    void finish() { (void)domain.drain(); }
    static constexpr std::size_t slice = 5000;  // objects to look at in one piece

    slamgc::domain domain;
    template <class Described>
    struct root {
      root(program& p, const char* label, Described& d) : root_(p.domain, label, d) {}
      slamgc::root root_;
    };

   private:
    std::unique_ptr<playing> part_;
    std::unique_ptr<slamgc::background_reclaimer> reclaimer_;
  };

  class thread {
   public:
    thread(program& p, const char* label, role r)
        : mutator_(p.domain, label,
                   slamgc::mutator_options{false, /*never_reclaim=*/r == role::tracking}) {}
    // Between two iterations the thread holds no pointer, and delays nobody.
    void begin() { online_.emplace(mutator_); }
    void end() { online_.reset(); }
    template <class F>
    void offline(F f) {
      const slamgc::mutator::offline_scope scope(mutator_);
      f();
    }
    template <class Described>
    struct root {
      root(thread& t, const char* label, Described& d) : root_(t.mutator_, label, d) {}
      slamgc::root root_;
    };

   private:
    slamgc::mutator mutator_;
    std::optional<slamgc::mutator::online_scope> online_;
  };
};

}  // namespace replay
