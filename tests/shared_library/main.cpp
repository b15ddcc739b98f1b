// Two libraries and a program, all with hidden symbols: one default domain, one list of mutators per
// thread, and each object reclaimed once, whoever made and dropped it.
#include <cstdint>
#include <cstdio>
#include <thread>

#include "library.hpp"

namespace {

int failures = 0;
void check(bool ok, const char* what, int line) {
  if (ok) return;
  std::fprintf(stderr, "line %d: %s\n", line, what);
  ++failures;
}
#define CHECK(condition) check((condition), #condition, __LINE__)

struct library {
  const char* name;
  node* (*make)(int&);
  void (*drop)(node*);
  bool (*retire)(node*);
  bool (*is_online)();
  std::uint64_t (*live)();
  std::uint64_t (*collect)();
  void (*keep)(node*);
};
#define LIBRARY(name)                                                                              \
  {                                                                                                \
#name, name##_make, name##_drop, name##_retire, name##_is_online, name##_live, name##_collect, \
        name##_keep                                                                                \
  }
const library libraries[] = {LIBRARY(first), LIBRARY(second), LIBRARY(other_flavour)};

void thread_is_known_everywhere() {
  for (const library& l : libraries) CHECK(!l.is_online());
  slamgc::mutator m("main");
  for (const library& l : libraries) CHECK(l.is_online());
  {
    const slamgc::mutator::offline_scope offline(m);
    for (const library& l : libraries) CHECK(!l.is_online());
  }
  bool elsewhere = true;
  std::thread([&] { elsewhere = libraries[0].is_online(); }).join();
  CHECK(!elsewhere);
}

void reclaimed_once(const library& maker, const library& dropper, const library& collector) {
  int destroyed = 0;
  slamgc::mutator m("main");
  node* const p = maker.make(destroyed);
  node* const q = maker.make(destroyed);
  for (const library& l : libraries) CHECK(l.live() == 2);
  CHECK(dropper.retire(q));
  CHECK(!maker.retire(q));
  dropper.drop(p);
  maker.drop(q);
  CHECK(collector.collect() == 0);
  CHECK(p->use_count() == 0 && destroyed == 0);  // borrowed by a mutator that the collector sees
  m.quiescent();
  CHECK(collector.collect() == 2);
  CHECK(maker.collect() == 0 && dropper.collect() == 0);
  CHECK(destroyed == 2);
  for (const library& l : libraries) CHECK(l.live() == 0);
}

until_the_end kept;
int destroyed_at_the_end = 0;

}  // namespace

int main() {
  thread_is_known_everywhere();
  for (const library& maker : libraries)
    for (const library& dropper : libraries)
      for (const library& collector : libraries) reclaimed_once(maker, dropper, collector);

  for (const library& l : libraries) l.keep(new node(destroyed_at_the_end));
  kept.slot = new node(destroyed_at_the_end);
  return failures;
}
