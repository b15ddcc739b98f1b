// Read-copy-update, for comparison (liburcu, QSBR): plain pointers; what is marked is deleted when each thread has ended its
// iteration. References that the map stores are not counted, and dangle where any are left.
#pragma once

#include <urcu-qsbr.h>

#include "schemes.hpp"

namespace replay {

struct rcu : raw_pointers<true> {
  static constexpr const char* name = "rcu";
  static constexpr bool keeps_all = false;

  class program {
   public:
    explicit program(bool /*background*/) {}
    template <class T, class... Args>
    T* make(Args&&... args) {
      return new T(std::forward<Args>(args)...);
    }
    template <class T>
    void retire(T* p) {
      auto* const waiting = new grave<T>{{}, p};
      urcu_qsbr_call_rcu(&waiting->head, [](rcu_head* head) {
        const playing as(role::reclaimer);  // a thread of liburcu's own
        auto* const over = reinterpret_cast<grave<T>*>(head);
        if (counting_faults())
          over->object->bury();
        else
          delete over->object;
        delete over;
      });
    }
    void collect() {}
    void finish() { urcu_qsbr_barrier(); }
    template <class Described>
    struct root {
      root(program&, const char*, Described&) {}
    };

   private:
    template <class T>
    struct grave {
      rcu_head head;  // first: it has the address of the whole
      T* object;
    };
  };

  // Several of one thread, where one thread plays all: it is quiescent when none is in an iteration.
  class thread {
   public:
    thread(program&, const char*, role) {
      if (here().alive++ != 0) return;
      urcu_qsbr_register_thread();
      urcu_qsbr_thread_offline();
    }
    ~thread() {
      if (--here().alive == 0) urcu_qsbr_unregister_thread();
    }
    thread(const thread&) = delete;
    thread& operator=(const thread&) = delete;
    void begin() {
      if (here().inside++ == 0) urcu_qsbr_thread_online();
    }
    void end() {
      if (--here().inside == 0) urcu_qsbr_thread_offline();
    }
    // Not offline: it keeps what it holds.
    template <class F>
    void offline(F f) {
      f();
    }
    template <class Described>
    struct root {
      root(thread&, const char*, Described&) {}
    };

   private:
    struct parts {
      int alive = 0, inside = 0;
    };
    static parts& here() {
      thread_local parts of_this_thread;
      return of_this_thread;
    }
  };
};

}  // namespace replay
