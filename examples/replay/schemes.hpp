// How objects are owned, under one set of names: a *scheme* is a struct of these. The model of the map is written once, and
// takes one of them as its parameter.
//
//   object<T>                 base class
//   pointer, vector, list,    members that refer to others
//   set, registry
//   frame_vector              members that are filled anew in each frame; end_frame() when it is over
//   chosen_map, chosen_vector, the three members that the thesis counts: mConnectedKeyFrameWeights,
//   observations              mvpOrderedConnectedKeyFrames, mObservations
//   up_pointer                MapPoint::mpRefKF
//   reference<T, Record>      an entry of mlpReferences
//   local<T>                  what a function works on; local_of() makes one from an element, raw() and plain() give the pointer
//   handle<T>                 whoever makes an object owns it by this until the session is done with it
//   allocator<T>              of containers outside of objects that hold locals, handles or references
//   owner                     base class of what is no object, is made by new, and has such containers or members
//   program                   retire(), collect() at the end of culling, finish() when no thread runs
//   thread                    what a thread has while it runs: begin() and end() of each iteration, offline() for waits within one
#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <set>
#include <type_traits>
#include <utility>
#include <vector>

#include "ledger.hpp"

namespace replay {

// What all schemes have in common but those that look through memory.
struct ordinary_memory {
  template <class T>
  using allocator = std::allocator<T>;
  struct owner {};
};

// What all schemes without mutators and roots have in common.
struct no_threads : ordinary_memory {
  template <class Program>
  struct thread_without_duty {
    thread_without_duty(Program&, const char*, role) {}
    void begin() {}
    void end() {}
    template <class F>
    void offline(F f) {
      f();
    }
    template <class Described>
    struct root {
      root(thread_without_duty&, const char*, Described&) {}
    };
  };
};

// Plain pointers, as in ORB-SLAM3. `Deletes`: what is retired is deleted at once.
template <bool Deletes>
struct raw_pointers : no_threads {
  template <class T>
  struct object {};
  template <class T, class Record>
  struct leaves_record {};
  template <class T>
  using pointer = T*;
  template <class T>
  using up_pointer = T*;
  template <class T>
  using vector = std::vector<T*>;
  template <class T>
  using frame_vector = vector<T>;
  template <class Vector>
  static void end_frame(Vector&) {}
  template <class T>
  using chosen_vector = std::vector<T*>;
  template <class T>
  using list = std::list<T*>;
  template <class T>
  using set = std::set<T*>;
  template <class T, class Mapped>
  using chosen_map = std::map<T*, Mapped>;
  template <class T>
  using observations = std::map<T*, std::size_t>;
  template <class Container>
  using registry = Container;
  template <class T, class Record>
  using reference = T*;
  template <class T>
  using local = T*;
  template <class T>
  using handle = T*;

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
  static T* plain(T* p) {
    return p;
  }
  template <class T>
  static void assign(std::vector<T*>& to, const std::vector<T*>& from) {
    to = from;
  }
  template <class T, class Record>
  static T* reference_to(T* p) {
    return p;
  }
  template <class T>
  static long id_of(T* reference) {
    return reference->mnId;
  }
  template <class T>
  static T* hold(T* p) {
    return p;
  }
  // What is not deleted stays known by its address.
  template <class T>
  static void release(T*& p) {
    if constexpr (Deletes) p = nullptr;
  }
  template <class T>
  static void drop_all(std::vector<T*>& handles) {
    handles.clear();
  }

  struct program {
    explicit program(bool /*background*/) {}
    template <class T, class... Args>
    T* make(Args&&... args) {
      return new T(std::forward<Args>(args)...);
    }
    template <class T>
    void retire([[maybe_unused]] T* p) {
      if constexpr (Deletes) {
        if (counting_faults())
          p->bury();
        else
          delete p;
      }
    }
    void collect() {}
    void finish() {}
    template <class Described>
    struct root {
      root(program&, const char*, Described&) {}
    };
  };
  using thread = no_threads::thread_without_duty<program>;
};

struct leak : raw_pointers<false> {
  static constexpr const char* name = "leak";
  static constexpr bool keeps_all = true;
};
struct direct_delete : raw_pointers<true> {
  static constexpr const char* name = "direct_delete";
  static constexpr bool keeps_all = false;
};

}  // namespace replay
