/// @file
/// The same members, counted.
#pragma once

#include <slamgc/slamgc.hpp>

namespace {

template <class T>
using object = slamgc::rc_object<T>;
template <class T>
using pointer_to = slamgc::rc_slot<T>;
template <class T>
using vector_of = slamgc::rc_vector<T>;
template <class T>
using list_of = slamgc::rc_list<T>;
template <class T>
using set_of = slamgc::rc_set<T>;
template <class T, class Mapped>
using map_of = slamgc::rc_map<T, Mapped>;
template <class T>
using owner_of = slamgc::intrusive_rc<T>;

template <class C>
const typename C::std_type& as_plain(const C& container) {
  return container;
}
template <class T>
T* as_plain(const slamgc::rc_slot<T>& slot) {
  return slot;
}

// What stands for the few lines that have to change (code_changed.inc).
template <class C>
auto edit(C& container) {
  return container.edit();
}
template <class T>
void replace(slamgc::rc_list<T>& list, typename slamgc::rc_list<T>::iterator at, T* p) {
  list.replace(at, p);
}

}  // namespace
