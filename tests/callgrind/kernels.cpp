// What tests/callgrind/check.py counts the instructions of: each kernel once with a standard
// container of raw pointers and once with slamgc's, on the same objects in the same order, with two
// numbers of elements; and operations that count references, alone.
#include <valgrind/callgrind.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <list>
#include <map>
#include <memory>
#include <new>
#include <set>
#include <slamgc/deferred.hpp>
#include <slamgc/mutator.hpp>
#include <slamgc/slamgc.hpp>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

static_assert(SLAMGC_DEBUG == 0,
              "without the checks: that they cost nothing when off is a promise");

// Memory from one block, the same number of instructions each time. What does not fit is an error.
namespace {
alignas(64) unsigned char arena[std::size_t{1} << 25];
std::size_t arena_used = 0;
}  // namespace

void* operator new(std::size_t size) {
  void* const p = arena + arena_used;
  arena_used += (size + 63) / 64 * 64;
  if (arena_used > sizeof arena) std::abort();
  return p;
}
void operator delete(void*) noexcept {}
void operator delete(void*, std::size_t) noexcept {}

namespace {

template <class Policy>
struct basic_object : slamgc::rc_object<basic_object<Policy>, Policy> {
  std::uint64_t value = 1;
};
using object = basic_object<slamgc::fetch_add_counter>;

struct raw_holder {
  object* member = nullptr;
};
struct counted_holder {
  slamgc::rc_slot<object> member;
};
struct raw_node : raw_holder {
  raw_node* next = nullptr;
};
struct counted_node : slamgc::rc_object<counted_node> {
  slamgc::rc_slot<counted_node> next;
};

// The same with objects that a collector reclaims, read by a mutator.
struct deferred_object
    : slamgc::rc_object<deferred_object, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
  std::uint64_t value = 1;
  slamgc::rc_slot<deferred_object> next;
};
struct deferred_holder {
  slamgc::rc_slot<deferred_object> member;
};
struct raw_deferred_holder {
  deferred_object* member = nullptr;
};

std::uint64_t value_of(const object* p) { return p->value; }
template <class T>
std::uint64_t value_of(const std::pair<object* const, T>& element) {
  return element.first->value;
}
template <class T>
std::uint64_t value_of(const std::pair<const T, object*>& element) {
  return element.second->value;
}

// Kernels. None is inlined, and all are called through one signature, so that nothing around them
// depends on the container.
using kernel = std::uint64_t (*)(void*);

#define KERNEL(name) \
  template <class C> \
  [[gnu::noinline]] std::uint64_t name(void* argument)

[[gnu::noinline]] std::uint64_t nothing(void*) { return 0; }

KERNEL(iterate) {
  std::uint64_t sum = 0;
  for (const auto& element : *static_cast<const C*>(argument)) sum += value_of(element);
  return sum;
}
KERNEL(iterate_not_const) {
  std::uint64_t sum = 0;
  auto& c = *static_cast<C*>(argument);
  for (auto i = c.begin(); i != c.end(); ++i) sum += value_of(*i);
  return sum;
}
KERNEL(iterate_backwards) {
  std::uint64_t sum = 0;
  const auto& c = *static_cast<const C*>(argument);
  for (auto i = c.rbegin(); i != c.rend(); ++i) sum += value_of(*i);
  return sum;
}
KERNEL(index) {
  std::uint64_t sum = 0;
  const auto& c = *static_cast<const C*>(argument);
  for (std::size_t i = 0; i != c.size(); ++i) sum += c[i]->value;
  return sum;
}
KERNEL(index_not_const) {
  std::uint64_t sum = 0;
  auto& c = *static_cast<C*>(argument);
  for (std::size_t i = 0; i != c.size(); ++i) sum += c[i]->value;
  return sum;
}
// The loop that fills SLAM systems.
KERNEL(index_skip_null) {
  std::uint64_t sum = 0;
  auto& c = *static_cast<C*>(argument);
  for (std::size_t i = 0; i != c.size(); ++i) {
    object* const p = c[i];
    if (!p) continue;
    sum += p->value;
  }
  return sum;
}
KERNEL(index_test_null) {
  std::uint64_t sum = 0;
  auto& c = *static_cast<C*>(argument);
  for (std::size_t i = 0; i != c.size(); ++i)
    if (!c[i]) ++sum;
  return sum;
}
KERNEL(index_compare) {
  std::uint64_t i = 0;
  auto& c = *static_cast<C*>(argument);
  object* const last = c.back();
  while (c[i] != last) ++i;
  return i;
}
KERNEL(linear_find) {
  const auto& c = *static_cast<const C*>(argument);
  return static_cast<std::uint64_t>(std::find(c.begin(), c.end(), c.back()) != c.end());
}
KERNEL(copy_out) {
  const auto& c = *static_cast<const C*>(argument);
  const std::vector<object*> copy(c.begin(), c.end());
  return copy.size();
}
KERNEL(copy_out_by_conversion) {
  const std::vector<object*> copy = *static_cast<const C*>(argument);
  return copy.size();
}
KERNEL(assign_to_plain) {
  static std::vector<object*> copy;
  copy = *static_cast<const C*>(argument);
  return copy.size();
}

std::vector<object*> keys;
KERNEL(find_each) {
  std::uint64_t found = 0;
  auto& c = *static_cast<C*>(argument);
  for (object* key : keys) found += c.find(key) != c.end();
  return found;
}
KERNEL(count_each) {
  std::uint64_t found = 0;
  const auto& c = *static_cast<const C*>(argument);
  for (object* key : keys) found += c.count(key);
  return found;
}
KERNEL(at_each_key) {
  std::uint64_t sum = 0;
  auto& c = *static_cast<C*>(argument);
  for (object* key : keys) sum += c.at(key);
  return sum;
}
KERNEL(at_each_number) {
  std::uint64_t sum = 0;
  auto& c = *static_cast<C*>(argument);
  const std::size_t n = keys.size();
  for (std::size_t i = 0; i != n; ++i) sum += c.at(i)->value;
  return sum;
}

KERNEL(read_members) {
  std::uint64_t sum = 0;
  for (const auto& holder : *static_cast<const C*>(argument)) sum += holder.member->value;
  return sum;
}
KERNEL(test_members) {
  std::uint64_t sum = 0;
  for (const auto& holder : *static_cast<const C*>(argument))
    if (!holder.member) ++sum;
  return sum;
}
KERNEL(walk_chain) {
  std::uint64_t length = 0;
  for (const C* p = static_cast<const C*>(argument); p; p = p->next) ++length;
  return length;
}

// Operations that count.
std::size_t elements;

KERNEL(copy_and_destroy) {
  auto& p = *static_cast<C*>(argument);
  for (std::size_t i = 0; i != elements; ++i) {
    const C copy(p);
    asm volatile("" : : "r"(copy.get()) : "memory");
  }
  return 0;
}
KERNEL(move_there_and_back) {
  auto& p = *static_cast<C*>(argument);
  for (std::size_t i = 0; i != elements; ++i) {
    C there(std::move(p));
    asm volatile("" : : "r"(&there) : "memory");
    p = std::move(there);
  }
  return 0;
}
KERNEL(assign_slot) {
  auto& slot = *static_cast<C*>(argument);
  for (object* p : keys) slot = p;
  return 0;
}
KERNEL(assign_elements) {
  auto& c = *static_cast<C*>(argument);
  for (std::size_t i = 0; i != c.size(); ++i) c[i] = keys[i];
  return 0;
}
KERNEL(rebuild) {
  *static_cast<C*>(argument) = keys;
  return 0;
}
std::vector<object*> other_keys;
KERNEL(rebuild_with_others) {
  std::swap(keys, other_keys);
  *static_cast<C*>(argument) = keys;
  return 0;
}
KERNEL(be_quiescent) {
  auto& mutator = *static_cast<C*>(argument);
  for (std::size_t i = 0; i != elements; ++i) {
    mutator.quiescent();
    asm volatile("" : : "r"(&mutator) : "memory");
  }
  return 0;
}
// Of a type whose memory costs nothing.
struct pooled_object
    : slamgc::rc_object<pooled_object, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {
  static void* operator new(std::size_t) {
    void* const p = free;
    free = *static_cast<void**>(p);
    return p;
  }
  static void operator delete(void* p) noexcept {
    *static_cast<void**>(p) = free;
    free = p;
  }
  static void grow(std::size_t n) {
    static std::vector<std::unique_ptr<unsigned char[]>> memory;
    for (std::size_t i = 0; i != n; ++i) {
      memory.emplace_back(new unsigned char[64]);
      operator delete(memory.back().get());
    }
  }
  static inline void* free = nullptr;
};
KERNEL(retire_and_reclaim) {
  auto& domain = *static_cast<C*>(argument);
  for (std::size_t i = 0; i != elements; ++i) slamgc::retire(new pooled_object);
  return domain.collect().reclaimed;
}
KERNEL(collect_nothing) {
  auto& domain = *static_cast<C*>(argument);
  std::uint64_t reclaimed = 0;
  for (std::size_t i = 0; i != elements; ++i) reclaimed += domain.collect().reclaimed;
  return reclaimed;
}
KERNEL(push_and_pop) {
  auto& c = *static_cast<C*>(argument);
  for (object* p : keys) {
    c.push_back(p);
    c.pop_back();
  }
  return 0;
}

/// The counter that one would write by hand.
struct hand_written {
  std::atomic<std::uint64_t> count{0};
};
class hand_written_pointer {
 public:
  explicit hand_written_pointer(hand_written* p) : p_(p) { add(); }
  hand_written_pointer(const hand_written_pointer& other) : p_(other.p_) { add(); }
  hand_written_pointer& operator=(const hand_written_pointer&) = delete;
  ~hand_written_pointer() {
    if (p_ && p_->count.fetch_sub(1, std::memory_order_acq_rel) == 1) delete p_;
  }
  hand_written* get() const { return p_; }

 private:
  void add() {
    if (p_) p_->count.fetch_add(1, std::memory_order_relaxed);
  }
  hand_written* p_;
};

std::uint64_t result;  // so that no kernel is optimised away

/// Runs it twice and counts the second time: the first one binds symbols.
[[gnu::noinline]] void measure(const std::string& name, kernel f, void* argument) {
  const std::string label = name + " " + std::to_string(elements);
  result += f(argument);
  CALLGRIND_TOGGLE_COLLECT;
  result += f(argument);
  CALLGRIND_TOGGLE_COLLECT;
  CALLGRIND_DUMP_STATS_AT(label.c_str());
}

/// The pair that is compared: with the standard container and with slamgc's.
void compare(const std::string& name, kernel std_kernel, void* std_argument, kernel slamgc_kernel,
             void* slamgc_argument) {
  measure("std " + name, std_kernel, std_argument);
  measure("slamgc " + name, slamgc_kernel, slamgc_argument);
}

#define COMPARE(name, f, std_container, slamgc_container)                              \
  compare(name, f<std::remove_reference_t<decltype(std_container)>>, &(std_container), \
          f<std::remove_reference_t<decltype(slamgc_container)>>, &(slamgc_container))

void measure_all(std::size_t n) {
  elements = n;
  keys.clear();
  other_keys.clear();
  for (std::size_t i = 0; i != n; ++i) keys.push_back(new object);
  for (std::size_t i = 0; i != n; ++i) other_keys.push_back(new object);
  // Someone keeps them all.
  static std::vector<slamgc::intrusive_rc<object>> roots;
  roots.insert(roots.end(), keys.begin(), keys.end());
  roots.insert(roots.end(), other_keys.begin(), other_keys.end());
  // In some order, the same in each container of a pair.
  std::uint64_t random = 1;
  for (std::size_t i = n; i > 1; --i) {
    random = random * 6364136223846793005u + 1442695040888963407u;
    std::swap(keys[i - 1], keys[(random >> 33) % i]);
  }

  measure("nothing", nothing, nullptr);

  {
    std::vector<object*> a(keys);
    slamgc::rc_vector<object> b(keys);
    COMPARE("vector: iterate", iterate, a, b);
    COMPARE("vector: iterate, not const", iterate_not_const, a, b);
    COMPARE("vector: iterate backwards", iterate_backwards, a, b);
    COMPARE("vector: v[i]->, const", index, a, b);
    COMPARE("vector: v[i]->, not const", index_not_const, a, b);
    COMPARE("vector: p = v[i]; if (!p) continue; p->", index_skip_null, a, b);
    COMPARE("vector: if (!v[i])", index_test_null, a, b);
    COMPARE("vector: v[i] != p", index_compare, a, b);
    COMPARE("vector: std::find", linear_find, a, b);
    COMPARE("vector: copy out, range", copy_out, a, b);
    COMPARE("vector: copy out, conversion", copy_out_by_conversion, a, b);
    COMPARE("vector: assign to plain", assign_to_plain, a, b);
  }
  {
    std::list<object*> a(keys.begin(), keys.end());
    slamgc::rc_list<object> b(keys.begin(), keys.end());
    COMPARE("list: iterate", iterate, a, b);
    COMPARE("list: iterate, not const", iterate_not_const, a, b);
    COMPARE("list: std::find", linear_find, a, b);
    COMPARE("list: copy out", copy_out, a, b);
  }
  {
    std::set<object*> a(keys.begin(), keys.end());
    slamgc::rc_set<object> b(keys.begin(), keys.end());
    COMPARE("set: iterate", iterate, a, b);
    COMPARE("set: iterate, not const", iterate_not_const, a, b);
    COMPARE("set: find", find_each, a, b);
    COMPARE("set: count", count_each, a, b);
    COMPARE("set: copy out", copy_out, a, b);
  }
  {
    std::map<object*, std::size_t> a;
    slamgc::rc_map<object, std::size_t> b;
    for (std::size_t i = 0; i != n; ++i) a[keys[i]] = b[keys[i]] = i;
    COMPARE("map: iterate", iterate, a, b);
    COMPARE("map: iterate, not const", iterate_not_const, a, b);
    COMPARE("map: find", find_each, a, b);
    COMPARE("map: count", count_each, a, b);
    COMPARE("map: at", at_each_key, a, b);
  }
  {
    std::map<std::size_t, object*> a;
    slamgc::rc_value_map<std::size_t, object> b;
    for (std::size_t i = 0; i != n; ++i) a[i] = b[i] = keys[i];
    COMPARE("value map: iterate", iterate, a, b);
    COMPARE("value map: at", at_each_number, a, b);
  }
  {
    std::unordered_set<object*> a(keys.begin(), keys.end());
    slamgc::rc_unordered_set<object> b(keys.begin(), keys.end());
    COMPARE("unordered set: iterate", iterate, a, b);
    COMPARE("unordered set: find", find_each, a, b);
  }
  {
    std::unordered_map<object*, std::size_t> a;
    slamgc::rc_unordered_map<object, std::size_t> b;
    for (std::size_t i = 0; i != n; ++i) a[keys[i]] = b[keys[i]] = i;
    COMPARE("unordered map: iterate", iterate, a, b);
    COMPARE("unordered map: find", find_each, a, b);
  }
  {
    std::vector<raw_holder> a(n);
    std::vector<counted_holder> b(n);
    for (std::size_t i = 0; i != n; ++i) b[i].member = a[i].member = keys[i];
    COMPARE("slot: read members", read_members, a, b);
    COMPARE("slot: if (!member)", test_members, a, b);
  }
  {
    std::vector<raw_node> a(n);
    for (std::size_t i = 0; i + 1 != n; ++i) a[i].next = &a[i + 1];
    const slamgc::intrusive_rc<counted_node> b(new counted_node);
    for (std::size_t i = 1; i != n; ++i) {
      auto* const first = new counted_node;
      first->next = b->next;
      b->next = first;
    }
    compare("slot: walk a chain", walk_chain<raw_node>, a.data(), walk_chain<counted_node>,
            b.get());
  }
  {
    slamgc::domain domain;
    slamgc::mutator mutator(domain, "main");
    std::vector<raw_deferred_holder> a(n);
    std::vector<deferred_holder> b(n);
    std::vector<raw_node> raw(n);
    for (std::size_t i = 0; i != n; ++i) {
      b[i].member = a[i].member = new deferred_object;
      if (i != 0) b[i - 1].member->next = a[i].member;
      if (i != 0) raw[i - 1].next = &raw[i];
    }
    COMPARE("slot: read members, deferred", read_members, a, b);
    compare("slot: walk a chain, deferred", walk_chain<raw_node>, raw.data(),
            walk_chain<deferred_object>, a[0].member);
    measure("count quiescent(), nothing to do", be_quiescent<decltype(mutator)>, &mutator);
    pooled_object::grow(n);
    const slamgc::mutator::offline_scope offline(mutator);
    measure("count retire and reclaim", retire_and_reclaim<decltype(domain)>, &domain);
    measure("count collect(), nothing to do", collect_nothing<decltype(domain)>, &domain);
  }

  {
    slamgc::intrusive_rc<object> p(keys[0]);
    slamgc::intrusive_rc<basic_object<slamgc::cas_counter>> q(
        new basic_object<slamgc::cas_counter>);
    slamgc::intrusive_rc<basic_object<slamgc::unsync_counter>> r(
        new basic_object<slamgc::unsync_counter>);
    hand_written_pointer s(new hand_written);
    measure("count copy+destroy: by hand", copy_and_destroy<decltype(s)>, &s);
    measure("count copy+destroy: fetch_add", copy_and_destroy<decltype(p)>, &p);
    measure("count copy+destroy: cas", copy_and_destroy<decltype(q)>, &q);
    measure("count copy+destroy: unsync", copy_and_destroy<decltype(r)>, &r);
    measure("count move there and back", move_there_and_back<decltype(p)>, &p);
  }
  {
    slamgc::rc_slot<object> slot;
    slamgc::rc_vector<object> v(keys);
    v.reserve(n + 1);
    measure("count slot = p", assign_slot<decltype(slot)>, &slot);
    measure("count v[i] = p", assign_elements<decltype(v)>, &v);
    measure("count vector: push_back, pop_back", push_and_pop<decltype(v)>, &v);
    measure("count vector = vector, unchanged", rebuild<decltype(v)>, &v);
    measure("count vector = vector, all changed", rebuild_with_others<decltype(v)>, &v);
  }
}

}  // namespace

int main() {
  if (!RUNNING_ON_VALGRIND) {
    std::fputs("to be run by tests/callgrind/check.py\n", stderr);
    return 2;
  }
  measure_all(1000);
  measure_all(2000);
  return result == 0;
}
