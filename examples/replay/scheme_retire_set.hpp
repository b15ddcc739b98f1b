// The thesis's schemes: references are counted, what is marked goes into a set, and at the end of culling those with a count of
// zero are deleted. Locals are counted while a function uses them, under the lock of what they were read from.
//
// `All`: every member is counted. Else the thesis's three: mConnectedKeyFrameWeights, mvpOrderedConnectedKeyFrames, mObservations.
#pragma once

#include <mutex>
#include <slamgc/mutex_counter.hpp>
#include <slamgc/slamgc.hpp>

#include "schemes.hpp"

namespace replay {

template <class S>
class KeyFrame;
template <class S>
class MapPoint;

template <class S, class Policy, bool All>
struct retire_sets : no_threads {
  static constexpr bool keeps_all = false;

  template <class T>
  using object = slamgc::rc_object<T, Policy, slamgc::reclaim_by_scan>;
  template <class T, class Record>
  struct leaves_record {};
  template <class T>
  using pointer = std::conditional_t<All, slamgc::rc_slot<T>, T*>;
  template <class T>
  using up_pointer = pointer<T>;
  template <class T>
  using vector = std::conditional_t<All, slamgc::rc_vector<T>, std::vector<T*>>;
  template <class T>
  using frame_vector = vector<T>;
  template <class Vector>
  static void end_frame(Vector&) {}
  template <class T>
  using chosen_vector = slamgc::rc_vector<T>;
  template <class T>
  using list = std::conditional_t<All, slamgc::rc_list<T>, std::list<T*>>;
  template <class T>
  using set = std::conditional_t<All, slamgc::rc_set<T>, std::set<T*>>;
  template <class T, class Mapped>
  using chosen_map = slamgc::rc_map<T, Mapped>;
  template <class T>
  using observations = slamgc::rc_map<T, std::size_t>;
  template <class Container>
  using registry = Container;
  template <class T>
  using local = slamgc::intrusive_rc<T>;
  template <class T>
  using handle = std::conditional_t<All, slamgc::intrusive_rc<T>, T*>;
  template <class T, class Record>
  using reference = handle<T>;

  template <class T>
  static local<T> local_of(T* p) {
    if (p != nullptr) p->used();
    return local<T>(p);
  }
  template <class T>
  static T* raw(const local<T>& p) {
    return p.get();
  }
  template <class T>
  static T* raw(T* p) {
    return p;
  }
  template <class T>
  static T* plain(T* p) {
    return p;
  }
  template <class T>
  static T* plain(const slamgc::rc_slot<T>& p) {
    return p.get();
  }
  template <class Vector, class T>
  static void assign(Vector& to, const std::vector<local<T>>& from) {
    std::vector<T*> content;
    content.reserve(from.size());
    for (const auto& p : from) content.push_back(p.get());
    to = std::move(content);
  }
  template <class T, class Record>
  static handle<T> reference_to(T* p) {
    return handle<T>(p);
  }
  template <class Reference>
  static long id_of(const Reference& reference) {
    raw(reference)->used();
    return raw(reference)->mnId;
  }
  template <class T>
  static local<T> hold(const local<T>& p) {
    return p;
  }
  template <class T>
  static void release(local<T>& p) {
    p.reset();
  }
  // Nobody can say whether it still exists.
  template <class T>
  static void release(T*& p) {
    p = nullptr;
  }
  template <class T>
  static void drop_all(std::vector<T>& handles) {
    handles.clear();
  }

  class program {
   public:
    explicit program(bool /*background*/) {}
    template <class T, class... Args>
    handle<T> make(Args&&... args) {
      return handle<T>(new T(std::forward<Args>(args)...));
    }
    template <class T>
    void retire(T* p) {
      if (counting_faults())
        buried_of<T>().insert(p);
      else
        (void)set_of<T>().insert(p);
    }
    void collect() { (void)scan(); }
    void finish() {
      while (scan() != 0) {
      }
    }
    template <class Described>
    struct root {
      root(program&, const char*, Described&) {}
    };

   private:
    // What a retire_set does, without deleting.
    template <class T>
    class burying_set {
     public:
      void insert(T* p) {
        const std::lock_guard<std::mutex> l(mutex_);
        waiting_.insert(p);
      }
      std::size_t scan() {
        const std::lock_guard<std::mutex> l(mutex_);
        std::size_t n = 0;
        for (auto i = waiting_.begin(); i != waiting_.end();) {
          T* const p = *i;
          if (p->use_count() != 0) {
            ++i;
            continue;
          }
          i = waiting_.erase(i);
          p->bury();
          ++n;
        }
        return n;
      }

     private:
      std::mutex mutex_;
      std::set<T*> waiting_;
    };

    static std::size_t scan() {
      if (counting_faults())
        return buried_of<MapPoint<S>>().scan() + buried_of<KeyFrame<S>>().scan();
      return set_of<MapPoint<S>>().scan() + set_of<KeyFrame<S>>().scan();
    }
    template <class T>
    static burying_set<T>& buried_of() {
      static burying_set<T>& set = *new burying_set<T>;
      return set;
    }
    // Never destroyed: what is left in it is still counted.
    template <class T>
    static slamgc::retire_set<T>& set_of() {
      static slamgc::retire_set<T>& set = *new slamgc::retire_set<T>;
      return set;
    }
  };
  using thread = no_threads::thread_without_duty<program>;
};

struct mutex_subset : retire_sets<mutex_subset, slamgc::mutex_counter, false> {
  static constexpr const char* name = "mutex_subset";
};
struct cas_subset : retire_sets<cas_subset, slamgc::cas_counter, false> {
  static constexpr const char* name = "cas_subset";
};
struct mutex_all : retire_sets<mutex_all, slamgc::mutex_counter, true> {
  static constexpr const char* name = "mutex_all";
};
struct cas_all : retire_sets<cas_all, slamgc::cas_counter, true> {
  static constexpr const char* name = "cas_all";
};
struct fetch_add_all : retire_sets<fetch_add_all, slamgc::fetch_add_counter, true> {
  static constexpr const char* name = "fetch_add_all";
};

}  // namespace replay
