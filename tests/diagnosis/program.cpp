// Writes the reports on a small map that check.py reads: JSON on the first lines, then DOT.
#include <iostream>
#include <slamgc/diagnosis/audit.hpp>
#include <slamgc/diagnosis/graphviz.hpp>
#include <slamgc/diagnosis/retention_report.hpp>
#include <slamgc/slamgc.hpp>

namespace program {

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  explicit KeyFrame(unsigned long id) : mnId(id) {}
  unsigned long report_id() const { return mnId; }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mpParent", mpParent);
  }
  const unsigned long mnId;
  slamgc::rc_slot<KeyFrame> mpParent;
  slamgc::rc_slot<KeyFrame> forgotten;
};
struct Map {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("a \"quoted\\ name\"\n\tof two lines", mspKeyFrames);
  }
  slamgc::registry<slamgc::rc_set<KeyFrame>> mspKeyFrames;
};

}  // namespace program

int main() {
  using program::KeyFrame;
  slamgc::domain domain;
  {
    slamgc::mutator me(domain, "local \"mapping\"");
    program::Map map;
    const slamgc::root root(domain, "M\xc3\xa4p", map);
    KeyFrame* const parent = new KeyFrame(811);
    KeyFrame* const child = new KeyFrame(812);
    map.mspKeyFrames.insert(parent);
    child->mpParent = parent;
    parent->mpParent = child;
    parent->forgotten = child;
    slamgc::retire(child);
    (void)domain.collect();  // opens a grace period that waits for this thread
    std::cout << slamgc::retention_report(domain, child).json() << '\n'
              << slamgc::retention_report::of_type<KeyFrame>(domain).json() << '\n'
              << slamgc::audit(domain).json() << '\n';
    slamgc::write_dot(std::cout, slamgc::capture(domain));
    parent->forgotten = nullptr;
    map.mspKeyFrames.clear();
  }
  return domain.drain() == slamgc::waited::done ? 0 : 1;
}
