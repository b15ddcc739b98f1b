// Why is it still alive? Each answer, word by word.
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <slamgc/diagnosis/retention_report.hpp>
#include <slamgc/pin.hpp>
#include <slamgc/slamgc.hpp>
#include <string>
#include <thread>

#include "unit/diagnosis/map.hpp"

namespace {

using namespace diagnosis_map;
using slamgc::heap_graph;
using slamgc::retention_report;

const std::string hint =
    "a pin, an intrusive_rc, a member that edges() does not name, a root that nobody told the "
    "domain of\n";

// Without the times, which are not the same in each run.
std::string without_times(std::string words) {
  for (std::size_t at = 0; (at = words.find("stuck ", at)) != std::string::npos; ++at)
    words.replace(at + 6, words.find(" ago", at) - at - 6, "T");
  return words;
}

TEST(RetentionReport, NamesHoldersByTypeAndEdge) {
  world w;
  Map map(w.domain);
  KeyFrame* const parent = w.key_frame(811);
  KeyFrame* const kf = w.key_frame(812);
  MapPoint* const point = new MapPoint;
  map.mspKeyFrames.insert(parent);
  map.mspMapPoints.insert(point);
  point->mpRefKF = kf;
  parent->mspChildrens.insert(kf);

  EXPECT_EQ(retention_report(w.domain, kf).words(),
            "KeyFrame 812 (" + address(kf) + ") is not retired; 2 references are counted\n" +
                "  held by KeyFrame 811 .mspChildrens (erase)\n  held by MapPoint " +
                address(point) + " .mpRefKF (hold)\n" +
                "  root Map .mspKeyFrames > KeyFrame 811 .mspChildrens > KeyFrame 812\n");

  slamgc::retire(kf);
  slamgc::retire(point);
  map.mspMapPoints.clear();
  w.settle();  // the child is erased from its parent; the point goes, and the keyframe with it
  EXPECT_EQ(w.live(), 1u);
  w.clear(map.mspKeyFrames);
  EXPECT_EQ(w.live(), 0u);
}

TEST(RetentionReport, ARootThatHoldsARetiredKeyframe) {
  world w;
  KeyFrame* const kf = w.key_frame(812);
  {
    Tracking tracking(w.me);
    tracking.mpReferenceKF = kf;
    slamgc::retire(kf);
    w.settle();
    const retention_report report(w.domain, kf);
    EXPECT_EQ(without_times(report.words()), "KeyFrame 812 (" + address(kf) +
                                                 ") is retired; 1 reference is counted\n" +
                                                 "  held by root Tracking .mpReferenceKF (hold)\n" +
                                                 "  a collector has seen it stuck T ago\n");
    EXPECT_TRUE(report.objects().at(0)->stuck);
    EXPECT_GE(report.objects().at(0)->stuck_for.count(), 0);
  }
  w.settle();
  EXPECT_EQ(w.live(), 0u);
}

TEST(RetentionReport, WhatIsNotDescribed) {
  world w;
  KeyFrame* const kf = w.key_frame(1);
  {
    const slamgc::intrusive_rc<KeyFrame> first(kf);
    const slamgc::intrusive_rc<KeyFrame> second(kf);
    EXPECT_EQ(retention_report(w.domain, kf).words(),
              "KeyFrame 1 (" + address(kf) + ") is not retired; 2 references are counted\n" +
                  "  2 references are not described: " + hint);
    kf->mpParent = kf;
    EXPECT_EQ(retention_report(w.domain, kf).objects().at(0)->not_described(), 2u);
  }
  slamgc::retire(kf);
  // Before any collector has looked at it.
  EXPECT_EQ(retention_report(w.domain, kf).words(),
            "KeyFrame 1 (" + address(kf) + ") is retired; 1 reference is counted\n" +
                "  held by KeyFrame 1 .mpParent (hold), retired\n" +
                "  nothing else leads to it: the next collections will see that\n");
  w.settle();
  EXPECT_EQ(w.live(), 0u);
}

TEST(RetentionReport, AnObjectThatWaits) {
  world w;
  KeyFrame* const kf = w.key_frame(1);
  EXPECT_EQ(retention_report(w.domain, kf).words(),
            "KeyFrame 1 (" + address(kf) + ") is not retired; nobody counts on it\n");
  slamgc::retire(kf);
  EXPECT_EQ(w.domain.collect().result, slamgc::collected::outcome::waiting);
  const std::string words = retention_report(w.domain, kf).words();
  const std::string expected =
      "KeyFrame 1 (" + address(kf) +
      ") is retired; it waits for a grace period\nthe open grace period waits for mapping (";
  EXPECT_EQ(words.substr(0, expected.size()), expected);
  w.settle();
  EXPECT_EQ(w.live(), 0u);
}

TEST(RetentionReport, ManyHoldersAreCounted) {
  world w;
  Map map(w.domain);
  KeyFrame* const kf = w.key_frame(0);
  for (unsigned long i = 1; i <= 20; ++i) {
    KeyFrame* const child = w.key_frame(i);
    child->mpParent = kf;
    map.mspKeyFrames.insert(child);
  }
  const std::string words = retention_report(w.domain, kf).words();
  EXPECT_NE(words.find("  held by 20 KeyFrame .mpParent (hold): "), std::string::npos) << words;
  EXPECT_NE(words.find(" and 12 more\n"), std::string::npos) << words;
  slamgc::retire(kf);
  w.clear(map.mspKeyFrames);
  EXPECT_EQ(w.live(), 0u);
}

TEST(RetentionReport, OneHolderManyTimes) {
  world w;
  KeyFrame* const kf = w.key_frame(7);
  MapPoint* const point = new MapPoint;
  kf->mvpMapPoints = {point, nullptr, point, point};
  EXPECT_EQ(retention_report(w.domain, point).words(),
            "MapPoint " + address(point) + " is not retired; 3 references are counted\n  " +
                "3 references are not described: " + hint);  // nothing leads to the keyframe
  Map map(w.domain);
  map.mspKeyFrames.insert(kf);
  EXPECT_EQ(retention_report(w.domain, point).words(),
            "MapPoint " + address(point) + " is not retired; 3 references are counted\n" +
                "  held by KeyFrame 7 .mvpMapPoints (null), 3 references\n" +
                "  root Map .mspKeyFrames > KeyFrame 7 .mvpMapPoints > MapPoint " + address(point) +
                "\n");
  slamgc::retire(point);
  w.clear(map.mspKeyFrames);
  EXPECT_EQ(w.live(), 0u);
}

TEST(RetentionReport, TheRetiredObjectsOfAType) {
  world w;
  Map map(w.domain);
  for (unsigned long i = 0; i != 3; ++i) map.mspKeyFrames.insert(w.key_frame(i));
  int n = 0;
  for (KeyFrame* kf : map.mspKeyFrames)
    if (n++ != 0) slamgc::retire(kf);
  w.settle();
  const auto report = retention_report::of_type<KeyFrame>(w.domain);
  EXPECT_EQ(report.objects().size(), 2u);
  const std::string head =
      "2 retired objects of type KeyFrame\n  held by root Map .mspKeyFrames (hold), 2 references\n";
  EXPECT_EQ(report.words().substr(0, head.size()), head);
  EXPECT_EQ(retention_report::of_type<MapPoint>(w.domain).words(),
            "0 retired objects of type MapPoint\n");
  w.clear(map.mspKeyFrames);
  EXPECT_EQ(w.live(), 0u);
}

TEST(RetentionReport, ARegistryThatWasCleared) {
  world w;
  Map map(w.domain);
  KeyFrame* const kf = w.key_frame(3);
  map.mspKeyFrames.insert(kf);
  map.mspKeyFrames.clear();
  EXPECT_EQ(retention_report(w.domain, kf).words(),
            "KeyFrame 3 (" + address(kf) + ") is not retired; 1 reference is counted\n" +
                "  1 reference is not described: " + hint +
                "not visited: what 1 cleared container held, until a collector has dropped it\n");
  w.settle();
  EXPECT_EQ(w.live(), 0u);
}

// A thread that owns a root, and does nothing until this ends.
class other_thread {
 public:
  other_thread(slamgc::domain& d, KeyFrame* kf) : thread_([this, &d, kf] { run(d, kf); }) {
    std::unique_lock<std::mutex> lock(mutex_);
    change_.wait(lock, [this] { return ready_; });
  }
  ~other_thread() {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      ending_ = true;
    }
    change_.notify_all();
    thread_.join();
  }

 private:
  void run(slamgc::domain& d, KeyFrame* kf) {
    slamgc::mutator me(d, "tracking");
    Tracking tracking(me);
    tracking.mpReferenceKF = kf;
    auto* const child = new KeyFrame(99);
    child->mpParent = kf;
    slamgc::retire(child);  // not published yet
    std::unique_lock<std::mutex> lock(mutex_);
    ready_ = true;
    change_.notify_all();
    change_.wait(lock, [this] { return ending_; });
  }
  std::mutex mutex_;
  std::condition_variable change_;
  bool ready_ = false;
  bool ending_ = false;
  std::thread thread_;
};

TEST(RetentionReport, RootsOfOtherThreadsOnlyIfTheyStandStill) {
  slamgc::domain d;
  slamgc::intrusive_rc<KeyFrame> kf;
  {
    slamgc::mutator me(d, "mapping");
    kf = slamgc::intrusive_rc<KeyFrame>(new KeyFrame(5));
    const other_thread tracking(d, kf.get());
    EXPECT_EQ(retention_report(d, kf.get()).words(),
              "KeyFrame 5 (" + address(kf.get()) + ") is not retired; 3 references are counted\n" +
                  "  3 references are not described: " + hint +
                  "not visited: root Tracking of another thread, which may be at work\n");
    slamgc::walk_options still;
    still.threads_stand_still = true;
    EXPECT_EQ(retention_report(d, kf.get(), still).words(),
              "KeyFrame 5 (" + address(kf.get()) + ") is not retired; 3 references are counted\n" +
                  "  held by root Tracking .mpReferenceKF (hold)\n" +
                  "  held by KeyFrame 99 .mpParent (hold), retired\n" +
                  "  1 reference is not described: " + hint);
    slamgc::retire(kf.get());
    kf = nullptr;
  }
  EXPECT_EQ(d.drain(), slamgc::waited::done);
}

struct asks : object<asks> {
  explicit asks(slamgc::domain& of, bool& a) : d(of), answered(a) {}
  ~asks() {
    const slamgc::heap_graph graph = capture(d);
    answered = graph.result == heap_graph::outcome::busy && graph.nodes.empty();
  }
  slamgc::domain& d;
  bool& answered;
};
struct reports_inside {
  template <class Visitor>
  void edges(Visitor&) {
    words = retention_report(*d, kf).words();
  }
  slamgc::domain* d;
  KeyFrame* kf;
  std::string words;
};
TEST(RetentionReport, BusyWhileSomebodyCollects) {
  world w;
  bool answered = false;
  slamgc::retire(new asks(w.domain, answered));
  w.settle();
  EXPECT_TRUE(answered);

  Map map(w.domain);
  KeyFrame* const kf = w.key_frame(1);
  map.mspKeyFrames.insert(kf);
  reports_inside inside{&w.domain, kf, {}};
  {
    const slamgc::root root(w.domain, "inside", inside);
    EXPECT_EQ(capture(w.domain).result, heap_graph::outcome::done);
  }
  EXPECT_EQ(inside.words, "nothing is known: a collection was at work all the time\n");
  w.clear(map.mspKeyFrames);
}

}  // namespace
