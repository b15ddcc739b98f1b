// What the program and its libraries share. Compiled with -fvisibility=hidden everywhere: nothing is
// exported but the functions below, and what slamgc itself says.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <slamgc/slamgc.hpp>

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
  explicit node(int& counter) : destroyed(&counter) {}
  ~node() { ++*destroyed; }
  int* destroyed;
  slamgc::rc_slot<node> next;
};

// For static objects: drops its reference when they are destroyed, and has the object reclaimed.
struct until_the_end {
  ~until_the_end() {
    if (slot == nullptr) return;
    const int* const destroyed = slot->destroyed;
    const int before = *destroyed;
    slot.reset();
    if (slamgc::default_domain().collect().reclaimed != 1 || *destroyed != before + 1)
      std::_Exit(1);
  }
  slamgc::rc_slot<node> slot;
};

#define EXPORTED extern "C" __attribute__((visibility("default")))

// Each library has these, with its name in front.
#define DECLARE_LIBRARY(name)                                          \
  EXPORTED node* name##_make(int& destroyed); /* with one reference */ \
  EXPORTED void name##_drop(node* p);         /* takes a reference */  \
  EXPORTED bool name##_retire(node* p);                                \
  EXPORTED bool name##_is_online();        /* the calling thread */    \
  EXPORTED std::uint64_t name##_live();    /* in the default domain */ \
  EXPORTED std::uint64_t name##_collect(); /* objects reclaimed */     \
  EXPORTED void name##_keep(node* p);      /* until static destruction */

DECLARE_LIBRARY(first)
DECLARE_LIBRARY(second)
DECLARE_LIBRARY(other_flavour)
