// A program that uses everything and builds with -fno-exceptions -fno-rtti. It prints what failed and
// returns how many checks that were.
#include <slamgc/background_reclaimer.hpp>
#include <slamgc/mutex_counter.hpp>
#include <slamgc/slamgc.hpp>

#include <cstdio>
#include <thread>
#include <unordered_set>
#include <utility>
#include <vector>

namespace {

int failures = 0;
void check(bool ok, const char* what, int line) {
  if (ok) return;
  std::printf("line %d: %s\n", line, what);
  ++failures;
}
#define CHECK(condition) check((condition), #condition, __LINE__)

template <class Policy>
struct object : slamgc::rc_object<object<Policy>, Policy> {
  object() { ++live; }
  object(const object&) = delete;
  object& operator=(const object&) = delete;
  virtual ~object() { --live; }

  slamgc::rc_slot<object> slot;
  slamgc::rc_vector<object> vector;
  slamgc::rc_list<object> list;
  slamgc::rc_set<object> set;
  slamgc::rc_map<object, int> map;
  slamgc::rc_value_map<int, object> value_map;
  slamgc::rc_unordered_set<object> unordered_set;
  slamgc::rc_unordered_map<object, int> unordered_map;

  static inline int live = 0;
};
template <class Policy>
struct derived : object<Policy> {};

template <class Policy>
void pointers() {
  using node = object<Policy>;
  slamgc::intrusive_rc<node> p = slamgc::make_rc<derived<Policy>>();
  auto d = slamgc::static_pointer_cast<derived<Policy>>(p);
  slamgc::intrusive_rc<const node> constant = d;
  CHECK(p->use_count() == 3);
  CHECK(p == d && constant == p && p != nullptr && !(p < d));
  std::unordered_set<slamgc::intrusive_rc<node>> hashed;
  hashed.insert(p);
  CHECK(hashed.count(p) == 1);
  hashed.clear();
  constant.reset();
  d = nullptr;
  node* const raw = p.detach();
  p = slamgc::intrusive_rc<node>::adopt(raw);
  CHECK(p->use_count() == 1);
  p.reset();
  CHECK(node::live == 0);
}

template <class Policy>
void members() {
  using node = object<Policy>;
  auto a = slamgc::make_rc<node>();
  const auto b = slamgc::make_rc<node>();
  node* const raw = b.get();
  a->slot = b;
  a->vector.push_back(raw);
  a->vector[0] = raw;
  a->list.push_back(raw);
  a->set.insert(raw);
  a->map[raw] = 1;
  a->value_map[1] = raw;
  a->unordered_set.insert(raw);
  a->unordered_map[raw] = 1;
  CHECK(b->use_count() == 9);
  {
    const slamgc::scoped_count scope(a->vector.raw());
    CHECK(b->use_count() == 10);
    a->vector.clear();
  }
  a->vector.edit()->assign(3, raw);
  CHECK(b->use_count() == 11);
  slamgc::rc_slot<node> other;
  other.swap(a->slot);
  CHECK(a->slot == nullptr && other == raw);
  a->list.erase(a->list.begin());
  a->set.erase(raw);
  std::thread([&] { a.reset(); }).join();
  CHECK(b->use_count() == 2);
  other.reset();
  CHECK(b->use_count() == 1 && node::live == 1);
}

template <class Policy, class Reclaimer>
struct waiting : slamgc::rc_object<waiting<Policy, Reclaimer>, Policy, Reclaimer> {
  waiting() { ++live; }
  waiting(const waiting&) = delete;
  waiting& operator=(const waiting&) = delete;
  virtual ~waiting() { --live; }

  slamgc::rc_slot<waiting> slot;

  static inline int live = 0;
};

template <class Policy, class Reclaimer>
void deferred() {
  using node = waiting<Policy, Reclaimer>;
  slamgc::domain domain;
  slamgc::mutator mutator(domain, "test");
  auto p = slamgc::make_rc<node>();
  p->slot = new node;
  node* const second = p->slot;
  slamgc::atomic_rc<node> shared(p);
  const slamgc::borrow<node> borrowed(p.get());
  CHECK(shared.load() == p);
  CHECK(borrowed->use_count() == 2);
  node* expected = p.get();
  CHECK(shared.compare_exchange_strong(expected, nullptr));
  CHECK(slamgc::retire(p.get()) && !slamgc::retire(p.get()) && slamgc::retire(second));
  p.reset();
  CHECK(domain.collect().result == slamgc::collected::outcome::waiting && node::live == 2);
  CHECK(domain.synchronize() == slamgc::waited::refused);
  mutator.quiescent();
  CHECK(domain.collect(slamgc::budget{1}).reclaimed == 1);
  {
    const slamgc::mutator::offline_scope offline(mutator);
    CHECK(domain.drain() == slamgc::waited::done && node::live == 0);
  }
  CHECK(domain.stats().total(&slamgc::type_stats::reclaimed) == 2);
  slamgc::retire(new node);
  std::thread([&] {
    const slamgc::mutator short_lived(domain, "short");
    slamgc::retire(new node);
  }).join();
  {
    const slamgc::mutator::offline_scope offline(mutator);
    slamgc::background_reclaimer reclaimer(domain);
    CHECK(reclaimer.stop() == slamgc::waited::done);
  }
  CHECK(node::live == 0);
}

template <class Policy>
void scanned() {
  using node = waiting<Policy, slamgc::reclaim_by_scan>;
  slamgc::retire_set<node> dead;
  auto p = slamgc::make_rc<node>();
  CHECK(dead.insert(p.get()) && dead.scan() == 0);
  p.reset();
  CHECK(dead.scan() == 1 && dead.empty() && node::live == 0);
}

template <class Policy>
void all() {
  deferred<Policy, slamgc::reclaim_deferred>();
  deferred<Policy, slamgc::reclaim_retired>();
  scanned<Policy>();
  pointers<Policy>();
  members<Policy>();
  CHECK(object<Policy>::live == 0);
}

}  // namespace

int main() {
  all<slamgc::fetch_add_counter>();
  all<slamgc::cas_counter>();
  all<slamgc::mutex_counter>();
  all<slamgc::unsync_counter>();
  return failures;
}
