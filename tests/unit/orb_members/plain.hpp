/// @file
/// How ORB-SLAM3 declares its members.
#pragma once

#include <list>
#include <map>
#include <memory>
#include <set>
#include <vector>

namespace {

template <class T>
struct object {};
template <class T>
using pointer_to = T*;
template <class T>
using vector_of = std::vector<T*>;
template <class T>
using list_of = std::list<T*>;
template <class T>
using set_of = std::set<T*>;
template <class T, class Mapped>
using map_of = std::map<T*, Mapped>;
template <class T>
using owner_of = std::unique_ptr<T>;

template <class M>
const M& as_plain(const M& member) {
  return member;
}

// What stands for the few lines that have to change (code_changed.inc).
template <class C>
C& edit(C& container) {
  return container;
}
template <class T>
void replace(std::list<T*>&, typename std::list<T*>::iterator at, T* p) {
  *at = p;
}

}  // namespace
