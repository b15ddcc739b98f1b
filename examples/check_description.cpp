// Diagnosis: a test that fails when somebody adds a counted member and forgets it in edges().
#undef SLAMGC_DEBUG
#define SLAMGC_DEBUG 1  // or on the compiler's command line, for all files of the test

#include <cstdio>
#include <slamgc/diagnosis/check_description.hpp>
#include <slamgc/slamgc.hpp>

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  explicit KeyFrame(unsigned long id) : mnId(id) {}
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mpParent", mpParent);
    v.edge("mspChildrens", mspChildrens, slamgc::on_retire::erase);
  }
  const unsigned long mnId;
  slamgc::rc_slot<KeyFrame> mpParent;
  slamgc::rc_set<KeyFrame> mspChildrens;
  slamgc::rc_set<KeyFrame> mspLoopEdges;  // new
};

int main() {
  const auto check = slamgc::check_description<KeyFrame>([] { return new KeyFrame(1); });
  std::printf("%s", check.words().c_str());
  return check.missing.size() == 1 ? 0 : 1;  // a program's own test returns check.ok()
}
