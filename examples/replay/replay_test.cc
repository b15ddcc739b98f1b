// Playing sessions: the same map under every safe scheme, with and without threads, and who frees what.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "child.hpp"
#include "default_session.hpp"
#include "report_json.hpp"
#include "session.hpp"
#include "trace.hpp"

namespace {

using replay::play_options;
using replay::run_request;
using replay::run_result;
using replay::session;
using replay::step;
using replay::step_kind;

// The beginning of the session in the program: no keyframe is culled yet.
const session& short_session() {
  static const session s = [] {
    replay::trace t = replay::read_trace("default", replay::default_session());
    int frames = 0;
    std::size_t end = 0;
    while (frames != 40) frames += t.events[end++].letter == 'F';
    t.events.resize(end);
    return replay::make_session(t);
  }();
  return s;
}

const replay::scheme_entry& scheme(const std::string& name) {
  for (const auto& s : replay::all_schemes())
    if (name == s.name) return s;
  throw std::runtime_error("no scheme " + name);
}

// Boehm's collector may not be installed.
bool has(const std::string& name) {
  const auto& all = replay::all_schemes();
  return std::any_of(all.begin(), all.end(), [&](const auto& s) { return name == s.name; });
}

run_result run(const std::string& name, play_options how, const session& s = short_session()) {
  const auto steps = replay::schedule(s);
  run_request request;
  request.of = &s;
  request.steps = &steps;
  request.options = how;
  return scheme(name).run(request);
}
play_options in_order(int laps = 1) {
  play_options how;
  how.threads = false;
  how.laps = laps;
  return how;
}

// Keyframe 1 is culled, and referred to by all kinds of edges that ORB-SLAM3 leaves; point 0 too.
const char* const stale =
    "# slamtrace 2 stale edges\n"
    "F 0 0 0\nk 0 0 0 0 4\nk 0 0 1 0 4\nk 0 0 2 0 4\np 0 0 0\np 0 0 1\nP 0 0 0\nP 0 0 1\n"
    "N 0 0 0 -1 1\nN 0 0 1 0 2\nN 0 0 2 1 -1\n"
    "O 0 0 0 0 0 0\ns 0 0 0 0 0\nO 0 0 1 0 1 0\ns 0 0 1 1 0\ns 0 0 2 2 0\nO 0 0 0 1 3 0\ns 0 0 0 3 "
    "1\nO 0 0 1 1 2 0\n"
    "m 0 0 0 2 0 1\nr 0 0 0 1\nE 0 0 0\n"
    "S 0 1\nK 0 1 0\nK 0 1 1\nK 0 1 2\nC 0 1 0 1 2\nC 0 1 2 1 1\nT 0 1 1 0\nH 0 1 0 1\nT 0 1 2 "
    "0\nH 0 1 0 2\nZ 0 1\n"
    "S 0 2\nQ 0 2 0\nQ 0 2 1\nG 0 2 2 0\nZ 0 2\n"
    "S 0 1\nX 0 1 1 0\nX 0 1 0 0\nz 0 1 0 0\nB 0 1 0\nh 0 1 0 1\nD 0 1 1\nq 0 1 1\nZ 0 1\n"
    "F 0 0 1\nr 0 0 1 2\nE 0 0 1\n";
session stale_session() { return replay::make_session(replay::read_trace("stale", stale)); }

TEST(Session, EveryMarkedObjectIsRetiredOnceAndThenReleased) {
  std::map<std::pair<step_kind, int>, std::size_t> seen;
  const session s = short_session();
  for (std::size_t i = 0; i != s.steps.size(); ++i)
    EXPECT_TRUE(s.steps[i].kind < step_kind::retire_keyframe ||
                s.steps[i].kind > step_kind::release_point ||
                seen.insert({{s.steps[i].kind, s.steps[i].a}, i}).second);
  int marks = 0;
  std::vector<char> released(static_cast<std::size_t>(s.points));
  for (std::size_t i = 0; i != s.steps.size(); ++i) {
    const step& x = s.steps[i];
    for (const int p : replay::names_of(x).points)
      EXPECT_FALSE(p >= 0 && x.kind != step_kind::release_point &&
                   released[static_cast<std::size_t>(p)]);
    if (x.kind == step_kind::release_point) released[static_cast<std::size_t>(x.a)] = 1;
    if (x.kind != step_kind::mark_point) continue;
    ++marks;
    ASSERT_EQ(1U, seen.count({step_kind::retire_point, x.a}));
    ASSERT_EQ(1U, seen.count({step_kind::release_point, x.a}));
    EXPECT_LT(i, seen[std::make_pair(step_kind::retire_point, x.a)]);
    EXPECT_LT(seen[std::make_pair(step_kind::retire_point, x.a)],
              seen[std::make_pair(step_kind::release_point, x.a)]);
  }
  EXPECT_EQ(s.marked_points, marks);
  EXPECT_GT(marks, 1000);
}

// Threads that are as unfair as can be: each runs until it has to wait. Each object sees its steps in the order of the trace.
TEST(Schedule, KeepsTheOrderOfEachObjectWhateverThreadsDo) {
  const session& s = short_session();
  const auto all = replay::schedule(s);
  std::map<std::pair<bool, int>, std::vector<int>> expected, found;
  const auto enter = [](auto& to, const step& x, const session& of) {
    const auto names = replay::names_of(x);
    const int tag = static_cast<int>(x.kind) * 8 + x.thread;
    std::set<std::pair<bool, int>> once;
    for (const int k : names.keyframes)
      if (k >= 0) once.insert({true, k});
    for (const int p : names.points)
      if (p >= 0) once.insert({false, p});
    (void)of;
    for (const auto& id : once) to[id].push_back(tag);
  };
  for (const step& x : s.steps) enter(expected, x, s);
  for (const bool forward : {true, false}) {
    found.clear();
    std::vector<std::size_t> at(all.size());
    std::vector<int> posted(all.size());
    bool moved = true;
    while (moved) {
      moved = false;
      for (std::size_t i = 0; i != all.size(); ++i) {
        const std::size_t t = forward ? i : all.size() - 1 - i;
        for (; at[t] != all[t].size(); ++at[t], moved = true) {
          const step& x = all[t][at[t]];
          if (x.kind == step_kind::wait && posted[static_cast<std::size_t>(x.a)] < x.b) break;
          if (x.kind == step_kind::post)
            posted[t] = x.a;
          else if (x.kind != step_kind::wait)
            enter(found, x, s);
        }
      }
    }
    for (std::size_t t = 0; t != all.size(); ++t)
      EXPECT_EQ(all[t].size(), at[t]) << "thread " << t << " waits for ever";
    EXPECT_TRUE(expected == found);
  }
}

TEST(Leak, FreesNothing) {
  const run_result r = run("leak", in_order(2));
  EXPECT_EQ(2U * static_cast<unsigned>(short_session().marked_points), r.marked[1]);
  EXPECT_EQ(0U, r.freed[0] + r.freed[1]);
  EXPECT_GT(r.lap_live[1], r.lap_live[0] + r.lap_live[0] / 2);
}

TEST(Deferred, FreesAllThatWasMarkedAndEverythingAtAReset) {
  const run_result plain = run("leak", in_order());
  const run_result r = run("deferred", in_order(3));
  EXPECT_EQ(r.marked[0], r.freed[0]);
  EXPECT_EQ(r.marked[1], r.freed[1]);
  EXPECT_EQ(plain.map_digest, r.map_digest);
  std::uint64_t destroyed[2] = {};
  for (const auto& t : r.threads)
    for (std::size_t k = 0; k != 2; ++k) destroyed[k] += t.destroyed[k];
  EXPECT_EQ(r.made[0], destroyed[0]);
  EXPECT_EQ(r.made[1], destroyed[1]);
  EXPECT_LT(r.lap_live[2], r.lap_live[0] + 1000000);
}

TEST(Deferred, FreesWhatOnlyStaleEdgesReferTo) {
  const session s = stale_session();
  const run_result plain = run("leak", in_order(), s), r = run("deferred", in_order(), s);
  EXPECT_EQ(1U, r.marked[0]);
  EXPECT_EQ(1U, r.freed[0]);
  EXPECT_EQ(1U, r.marked[1]);
  EXPECT_EQ(1U, r.freed[1]);
  EXPECT_EQ(plain.map_digest, r.map_digest);
}
TEST(RetireSet, KeepsWhatStaleEdgesReferTo) {
  const session s = stale_session();
  const run_result plain = run("leak", in_order(), s), r = run("fetch_add_all", in_order(), s);
  EXPECT_EQ(0U, r.freed[0]);
  EXPECT_EQ(0U, r.freed[1]);
  EXPECT_EQ(plain.map_digest, r.map_digest);
}

// A conservative collector promises neither what it frees nor when: a word on a stack may look like a reference.
TEST(Boehm, FreesNearlyAllThatNothingRefersTo) {
  if (!has("boehm")) GTEST_SKIP() << "it needs libgc-dev, and no sanitizer";
  const run_result plain = run("leak", in_order(3)), r = run("boehm", in_order(3));
  EXPECT_EQ(plain.marked[1], r.marked[1]);
  EXPECT_GT(r.freed[1], r.marked[1] * 9 / 10);
  EXPECT_LE(r.freed[1], r.marked[1]);
  EXPECT_EQ(plain.map_digest, r.map_digest);
  EXPECT_LT(r.lap_live[2], plain.lap_live[2] / 2);
}
TEST(Boehm, KeepsWhatStaleEdgesReferTo) {
  if (!has("boehm")) GTEST_SKIP() << "it needs libgc-dev, and no sanitizer";
  const session s = stale_session();
  const run_result plain = run("leak", in_order(), s), r = run("boehm", in_order(), s);
  EXPECT_EQ(1U, r.marked[0]);
  EXPECT_EQ(0U, r.freed[0]);
  EXPECT_EQ(0U, r.freed[1]);
  EXPECT_EQ(plain.map_digest, r.map_digest);
}

class Threads : public testing::TestWithParam<const char*> {};
TEST_P(Threads, LeaveTheSameMapAsOneThread) {
  if (!has(GetParam())) GTEST_SKIP() << "it needs libgc-dev, and no sanitizer";
  play_options how;
  how.viewer = true;
  const run_result r = run(GetParam(), how);
  EXPECT_EQ(run("leak", in_order()).map_digest, r.map_digest);
  if (std::string(GetParam()) != "deferred") return;
  EXPECT_EQ(r.marked[0], r.freed[0]);
  EXPECT_EQ(r.marked[1], r.freed[1]);
  for (const auto& t : r.threads)
    EXPECT_TRUE(t.name != "tracking" || t.destroyed[0] + t.destroyed[1] == 0);
}
INSTANTIATE_TEST_SUITE_P(Safe, Threads,
                         testing::Values("leak", "shared_ptr", "mutex_all", "boehm", "deferred"),
                         [](const auto& of) { return std::string(of.param); });

TEST(Deferred, LocalMappingMayReclaim) {
  play_options how;
  how.background = false;
  const run_result r = run("deferred", how);
  EXPECT_EQ(r.marked[1], r.freed[1]);
}

TEST(Child, ExplainsACrash) {
  const session& s = short_session();
  run_request request;
  request.of = &s;
  request.options.threads = false;
  const run_result r =
      replay::run_in_child(scheme("direct_delete"), request, 60, [](const auto&) {});
  EXPECT_FALSE(r.finished);
  EXPECT_NE("", r.explanation);
  EXPECT_NE(std::string::npos, r.explanation.find("after")) << r.explanation;
}
TEST(Child, HandsItsResultOver) {
  const session& s = short_session();
  run_request request;
  request.of = &s;
  request.options.threads = false;
  const run_result r = replay::run_in_child(scheme("deferred"), request, 60, [](const auto&) {});
  EXPECT_TRUE(r.finished) << r.explanation << r.complaint;
  EXPECT_EQ(static_cast<std::uint64_t>(s.marked_points), r.freed[1]);
  EXPECT_FALSE(r.samples.empty());
  run_result copy;
  EXPECT_TRUE(replay::from_text(replay::to_text(r), copy));
  EXPECT_EQ(replay::to_text(r), replay::to_text(copy));
}

}  // namespace
