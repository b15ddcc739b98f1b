// expect-error: slamgc: what can be announced is null, erase and erase_with
#include <slamgc/slamgc.hpp>

struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  slamgc::rc_slot<frame> next;
};
struct map {
  template <class Visitor>
  void edges(Visitor& v) {
#ifdef SLAMGC_POSITIVE_CONTROL
    const auto how = slamgc::on_retire::null;
#else
    const auto how = slamgc::on_retire::bypass([](frame& f) { return f.next.get(); });
#endif
    v.edge("first", first, slamgc::on_retire::announce([](frame&) {}, how));
  }
  slamgc::rc_slot<frame> first;
};

slamgc::root describe(slamgc::domain& of, map& m) { return {of, "map", m}; }
