/// @file
/// Objects, faults and checks for the tests of counted containers. All of it is local to the file
/// that includes it, so that files with different flavours and checks can be linked together.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <map>
#include <new>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <slamgc/slamgc.hpp>

namespace {

/// A counted object that can be found while it lives, and whose destructor can do something.
struct node : slamgc::rc_object<node> {
  explicit node(int number = 0) : id(number) { living().insert(this); }
  ~node() {
    living().erase(this);
    if (at_end) at_end();
  }
  node(const node&) = delete;
  node& operator=(const node&) = delete;

  static std::set<node*>& living() {
    static std::set<node*> objects;
    return objects;
  }

  int id;
  std::function<void()> at_end;
};

using node_ptr = slamgc::intrusive_rc<node>;

/// @p n objects with the numbers 0, 1, ..., each of which is kept.
inline std::vector<node_ptr> make_nodes(int n) {
  std::vector<node_ptr> nodes;
  for (int i = 0; i != n; ++i) nodes.push_back(slamgc::make_rc<node>(i));
  return nodes;
}

// The counted pointer of an element, and an element with a given counted pointer.

inline node* pointer_in(node* element) { return element; }
template <class Mapped>
node* pointer_in(const std::pair<node* const, Mapped>& element) {
  return element.first;
}
template <class Key>
node* pointer_in(const std::pair<const Key, node*>& element) {
  return element.second;
}

inline void make_element(node*& element, node* p, int) { element = p; }
inline void make_element(std::pair<node*, int>& element, node* p, int other) {
  element = {p, other};
}
inline void make_element(std::pair<int, node*>& element, node* p, int other) {
  element = {other, p};
}

template <class Value>
struct assignable {
  using type = Value;
};
template <class First, class Second>
struct assignable<std::pair<const First, Second>> {
  using type = std::pair<First, Second>;
};

/// The element of container C for the pointer @p p; @p other is the rest of it, if it has any.
template <class C>
typename assignable<typename C::value_type>::type element(node* p, int other) {
  typename assignable<typename C::value_type>::type made{};
  make_element(made, p, other);
  return made;
}
template <class C>
typename assignable<typename C::value_type>::type element(const node_ptr& p) {
  return element<C>(p.get(), p->id);
}

template <class C>
std::vector<node*> pointers_in(const C& container) {
  std::vector<node*> found;
  for (const auto& e : container) found.push_back(pointer_in(e));
  return found;
}

/// The key of an element.
template <class Value>
const Value& key_in(const Value& value) {
  return value;
}
template <class Key, class Mapped>
const Key& key_in(const std::pair<Key, Mapped>& value) {
  return value.first;
}

using tally = std::map<const node*, std::uint32_t>;

template <class C>
void add_references(tally& references, const C& container) {
  for (const auto& e : container) ++references[pointer_in(e)];
}

/// Whether every living object's count is its number of references in @p containers, plus @p owners.
template <class... C>
testing::AssertionResult counts_are_exact(std::uint32_t owners, const C&... containers) {
  tally references;
  (add_references(references, containers), ...);
  for (const node* p : node::living())
    if (p->use_count() != owners + references[p])
      return testing::AssertionFailure()
             << "object " << p->id << " has a count of " << p->use_count() << " but "
             << owners + references[p] << " references";
  return testing::AssertionSuccess();
}

/// A place where a test lets something go wrong: the n-th time that the program gets there.
struct fault : std::bad_alloc {
  static void arm(int n) { left() = n; }
  static void disarm() { left() = -1; }
  static void point() {
    if (left() < 0) return;
    if (left()-- == 0) throw fault();
  }
  static int& left() {
    static int passes = -1;
    return passes;
  }
};

template <class T>
struct faulty_allocator {
  using value_type = T;
  faulty_allocator() = default;
  template <class U>
  faulty_allocator(const faulty_allocator<U>&) noexcept {}
  T* allocate(std::size_t n) {
    fault::point();
    return static_cast<T*>(::operator new(n * sizeof(T)));
  }
  void deallocate(T* p, std::size_t) noexcept { ::operator delete(p); }
  friend bool operator==(faulty_allocator, faulty_allocator) noexcept { return true; }
  friend bool operator!=(faulty_allocator, faulty_allocator) noexcept { return false; }
};
struct faulty_less {
  bool operator()(const node* a, const node* b) const { return (fault::point(), a->id < b->id); }
  bool operator()(int a, int b) const { return (fault::point(), a < b); }
};
struct faulty_equal {
  bool operator()(const node* a, const node* b) const { return (fault::point(), a == b); }
};
struct faulty_hash {
  std::size_t operator()(const node* p) const {
    return (fault::point(), static_cast<std::size_t>(p->id));
  }
};

/// A single-pass iterator that can throw wherever it is used.
template <class Iterator>
struct faulty_input {
  using iterator_category = std::input_iterator_tag;
  using value_type = typename std::iterator_traits<Iterator>::value_type;
  using difference_type = std::ptrdiff_t;
  using pointer = const value_type*;
  using reference = const value_type&;

  Iterator at;

  reference operator*() const { return (fault::point(), *at); }
  faulty_input& operator++() {
    fault::point();
    ++at;
    return *this;
  }
  faulty_input operator++(int) {
    faulty_input before(*this);
    ++*this;
    return before;
  }
  friend bool operator==(const faulty_input& a, const faulty_input& b) { return a.at == b.at; }
  friend bool operator!=(const faulty_input& a, const faulty_input& b) { return a.at != b.at; }
};
template <class Iterator>
faulty_input<Iterator> faulty(Iterator at) {
  return {at};
}

/// The containers of the library, with pointers, numbers and nothing else in them.
using all_containers =
    testing::Types<slamgc::rc_vector<node>, slamgc::rc_list<node>, slamgc::rc_set<node>,
                   slamgc::rc_map<node, int>, slamgc::rc_unordered_set<node>,
                   slamgc::rc_unordered_map<node, int>, slamgc::rc_value_map<int, node>>;
using keyed_containers =
    testing::Types<slamgc::rc_set<node>, slamgc::rc_map<node, int>, slamgc::rc_unordered_set<node>,
                   slamgc::rc_unordered_map<node, int>, slamgc::rc_value_map<int, node>>;
using sequences = testing::Types<slamgc::rc_vector<node>, slamgc::rc_list<node>>;

/// Names the container in the name of a test: EveryContainer/rc_set.EraseUncountsOnce.
struct container_name {
  template <class C>
  static std::string GetName(int) {
    return of(static_cast<const C*>(nullptr));
  }

 private:
  static const char* of(const slamgc::rc_vector<node>*) { return "rc_vector"; }
  static const char* of(const slamgc::rc_list<node>*) { return "rc_list"; }
  static const char* of(const slamgc::rc_set<node>*) { return "rc_set"; }
  static const char* of(const slamgc::rc_map<node, int>*) { return "rc_map"; }
  static const char* of(const slamgc::rc_unordered_set<node>*) { return "rc_unordered_set"; }
  static const char* of(const slamgc::rc_unordered_map<node, int>*) { return "rc_unordered_map"; }
  static const char* of(const slamgc::rc_value_map<int, node>*) { return "rc_value_map"; }
};

/// A container with an element for each of @p nodes.
template <class C>
C filled(const std::vector<node_ptr>& nodes) {
  C container;
  for (const node_ptr& p : nodes) container.insert(container.end(), element<C>(p));
  return container;
}

}  // namespace
