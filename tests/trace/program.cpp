// Writes a trace with everything that can be in one, and with names that JSON has to escape. check.py reads it.
#include <cstdio>
#include <slamgc/integrations/trace_json.hpp>
#include <slamgc/slamgc.hpp>
#include <thread>

namespace {

template <class T>
using base = slamgc::rc_object<T, slamgc::fetch_add_counter, slamgc::reclaim_deferred>;
template <char>
struct quoted : base<quoted<'"'>> {};
struct node : base<node> {};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  slamgc::trace_json trace(argv[1]);
  slamgc::domain map;
  map.install(&trace);
  trace.name_thread("main \"thread\"\n\\");
  slamgc::mutator m(map, "tracking\t\"\\\x01");
  for (int i = 0; i != 10; ++i) {
    const slamgc::trace_json::span frame(trace, "frame");
    slamgc::retire(new node);
    slamgc::retire(new quoted<'"'>);
    (void)map.collect();  // waits
    m.quiescent();
    (void)map.collect();
  }
  std::thread([&trace] {
    trace.name_thread("other");
    const slamgc::trace_json::span span(trace, "a \"span\"");
  }).join();
  {
    const slamgc::mutator::offline_scope offline(m);
    if (map.drain() != slamgc::waited::done) return 1;
  }
  map.install(nullptr);
  return trace.good() ? 0 : 1;
}
