// Diagnosis: why is a retired keyframe still alive? And do the descriptions say what the counts say?
#include <cstdio>
#include <slamgc/diagnosis/audit.hpp>
#include <slamgc/diagnosis/retention_report.hpp>
#include <slamgc/slamgc.hpp>

struct KeyFrame : slamgc::rc_object<KeyFrame, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  explicit KeyFrame(unsigned long id) : mnId(id) {}
  unsigned long report_id() const { return mnId; }  // what reports call it
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mpParent", mpParent);
    // v.edge("mNextKF", mNextKF);  forgotten
  }
  const unsigned long mnId;
  slamgc::rc_slot<KeyFrame> mpParent;
  slamgc::rc_slot<KeyFrame> mNextKF;
};

struct Map {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mspKeyFrames", mspKeyFrames, slamgc::on_retire::erase);
  }
  slamgc::rc_set<KeyFrame> mspKeyFrames;
  slamgc::root root{"Map", *this};
};

int main() {
  slamgc::domain& domain = slamgc::default_domain();
  Map map;
  {
    slamgc::mutator me("mapping");
    auto* const culled = new KeyFrame(812);
    auto* const child = new KeyFrame(813);
    auto* const before = new KeyFrame(811);
    child->mpParent = culled;
    before->mNextKF = culled;
    for (auto* kf : {culled, child, before}) map.mspKeyFrames.insert(kf);
    slamgc::retire(culled);
  }
  (void)domain.drain();  // takes it out of the map; but two others refer to it

  const auto report = slamgc::retention_report::of_type<KeyFrame>(domain);
  std::printf("%s\n", report.words().c_str());
  std::printf("%s\n\n", report.json().c_str());
  std::printf("%s", slamgc::audit(domain).words().c_str());

  // The reader of that sees what is missing in edges(). Here the program ends.
  for (auto* kf : map.mspKeyFrames) kf->mNextKF = kf->mpParent = nullptr;
  for (auto* kf : map.mspKeyFrames) slamgc::retire(kf);
  (void)domain.drain();
}
