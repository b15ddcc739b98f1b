/// @file
/// Model of every counter policy: what is done under one reference happens before the destruction that
/// another one sets off.
#pragma once

#include "../support/relacy_env.hpp"

template <class Policy>
struct counted_object : slamgc::rc_object<counted_object<Policy>, Policy> {
  static constexpr int threads = 3;
  plain<int> part[threads];

  ~counted_object() {
    for (int i = 0; i != threads; ++i) {
      require(part[i].get() == i + 1, "a thread's work is there");
      part[i].set(-1);
    }
  }
};

/// Each thread copies its reference, gives the first up, writes its part, and gives the second up.
template <class Policy>
struct copy_and_destroy : model_base<copy_and_destroy<Policy>, 3> {
  static constexpr unsigned context_bound = std::is_same<Policy, relacy_cas_counter>::value ? 2 : 3;
  using object = counted_object<Policy>;
  slamgc::intrusive_rc<object> references[object::threads];

  void before() {
    slamgc::intrusive_rc<object> made = slamgc::make_rc<object>();
    for (auto& reference : references) reference = made;
  }
  void thread(unsigned i) {
    slamgc::intrusive_rc<object> mine(references[i]);
    references[i].reset();
    mine->part[i].set(static_cast<int>(i) + 1);
  }
};
