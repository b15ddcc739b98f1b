// Reading traces: what is written is read again, and what is wrong is refused with its line and the reason.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "trace.hpp"
#include "trace_recorder.hpp"

namespace {

using replay::bad_trace;
using replay::read_trace;
using replay::trace;
using replay::trace_format;

TEST(Recorder, WhatItWritesIsRead) {
  std::ostringstream out;
  trace_recorder r(out, "a test\nof two lines");
  const auto t = trace_recorder::tracking, m = trace_recorder::local_mapping;
  r.frame_begins(7);
  r.keyframe_made(t, 0, 7, 3);
  r.keyframe_made(t, 1, 7, 3);
  r.keyframe_inserted(m, 0);
  r.point_made(t, 0);
  r.point_made(t, 1);
  r.point_inserted(t, 0);
  r.observation(t, 0, 0, 2, 5);
  r.slot_set(t, 0, 2, 0);
  r.matched(7, {0, 1});
  r.local_map(7, {0}, 2);
  r.reference(7, 0);
  r.frame_ends(7);
  r.iteration_begins(m);
  r.observation_erased(m, 0, 0);
  r.slot_cleared(m, 0, 2);
  r.covisibility(m, 0, 1, 15);
  r.covisibility_erased(m, 0, 1);
  r.parent(m, 1, 0);
  r.parent(m, 0, -1);
  r.child(m, 0, 1);
  r.child_erased(m, 0, 1);
  r.loop_edge(m, 0, 1);
  r.merge_edge(m, 0, 1);
  r.temporal(t, 0, -1, 1);
  r.database_add(trace_recorder::loop_closing, 0);
  r.database_erase(m, 0);
  r.point_replaced(m, 0, 1);
  r.point_bad(m, 1);
  r.loop_corrected(trace_recorder::loop_closing, 0, 1);
  r.keyframe_bad(m, 1);
  r.iteration_ends(m);

  const trace read = read_trace("memory", out.str());
  EXPECT_EQ(trace_format::edges, read.format);
  EXPECT_EQ("a test of two lines", read.about);
  EXPECT_EQ(2, read.keyframes);
  EXPECT_EQ(2, read.points);
  std::string letters;
  for (const auto& e : read.events) letters += e.letter;
  EXPECT_EQ("FkkKppPOsmlrESXzCcTTHhGgNQqRBLDZ", letters);
  EXPECT_EQ((std::vector<int>{0, 1, 0}), read.lists);
  EXPECT_EQ(2, read.events[10].d);
  EXPECT_EQ(2, read.events[25].thread);
}

TEST(Reader, FindsOutWhatItReads) {
  EXPECT_EQ(trace_format::graph, read_trace("x", "K 0\nO 0 0 1.5 2\n").format);
  EXPECT_EQ(trace_format::graph, read_trace("x", "# c\nK 5 0 0 0 0 0 0 1\nO 5 0 1 2 3\n").format);
  EXPECT_EQ(trace_format::objects, read_trace("x", "F 0 1.0 0\n").format);
  EXPECT_EQ(trace_format::objects, read_trace("x", "# slamtrace 1\nF 0 1.0 0\r\n").format);
}

TEST(Reader, TellsFeaturesApartByTheirPositions) {
  const trace t =
      read_trace("x",
                 "F 0 1.0 0\nO 0 0 1.5 2.5 3 0\nP 0 1 2 3 0\nO 0 1 1.5 2.5 3 0\nP 1 1 2 3 0\n"
                 "O 0 2 9 9 3 0\nP 2 1 2 3 0\nK 0 1.0 0 0 0 0 0 0 1 10 f0 0\n");
  EXPECT_EQ(0, t.events[1].c);
  EXPECT_EQ(0, t.events[3].c);
  EXPECT_EQ(1, t.events[5].c);
  EXPECT_EQ(1, t.has_pose[0]);
  EXPECT_EQ(3.0F, t.positions[2][2]);
}

struct bad {
  const char* name;
  int line;
  const char* reason;
  const char* text;
};
class BadLine : public testing::TestWithParam<bad> {};

TEST_P(BadLine, IsRefusedWithItsNumberAndTheReason) {
  try {
    read_trace("file", GetParam().text);
    FAIL() << "it was read";
  } catch (const bad_trace& e) {
    EXPECT_EQ(GetParam().line, e.line());
    EXPECT_NE(std::string::npos, std::string(e.what()).find(GetParam().reason)) << e.what();
    EXPECT_EQ(0U, std::string(e.what()).find("file:"));
  }
}

#define V2 "# slamtrace 2\nk 0 0 0 0 4\np 0 0 0\n"
const bad all_bad[] = {
    {"empty", 0, "no event", ""},
    {"text", 1, "neither a trace nor a graph", "h 1\n"},
    {"version", 1, "version '9'", "# slamtrace 9\n"},
    {"late_version", 2, "not on the first line", "F 0 1 0\n# slamtrace 2\n"},
    {"letter", 4, "no event 'Y'", V2 "Y 0 0\n"},
    {"word", 4, "no event: 'hello'", V2 "hello\n"},
    {"missing", 4, "index is missing", V2 "O 0 0 0 0\n"},
    {"too_many", 4, "a field too many: '9'", V2 "z 0 0 0 1 9\n"},
    {"integer", 4, "no integer: '1x'", V2 "z 0 0 0 1x\n"},
    {"time", 4, "the time is out of range", V2 "z -1 0 0 1\n"},
    {"thread", 4, "the thread is out of range", V2 "z 0 4 0 1\n"},
    {"unknown_keyframe", 4, "keyframe 3 was not made", V2 "z 0 0 3 1\n"},
    {"unknown_point", 4, "point 3 was not made", V2 "B 0 1 3\n"},
    {"index", 4, "has 4 features, no number 4", V2 "s 0 0 0 4 0\n"},
    {"octave", 4, "the octave is out of range", V2 "O 0 0 0 0 1 64\n"},
    {"made_twice", 4, "keyframe 0 was made before", V2 "k 0 0 0 0 4\n"},
    {"point_made_twice", 4, "point 0 was made before", V2 "p 0 0 0\n"},
    {"inserted_twice", 5, "inserted a second time", V2 "K 0 1 0\nK 0 1 0\n"},
    {"inserted_dead", 5, "inserted after it was marked", V2 "B 0 1 0\nP 0 1 0\n"},
    {"marked_twice", 5, "was marked before", V2 "D 0 1 0\nD 0 1 0\n"},
    {"replaced_by_itself", 4, "by itself", V2 "R 0 1 0 0\n"},
    {"frame_in_frame", 5, "has not ended", V2 "F 0 0 0\nF 0 0 1\n"},
    {"end_without", 4, "has not begun", V2 "E 0 0 0\n"},
    {"iteration_without", 4, "no iteration has begun", V2 "Z 0 1\n"},
    {"iteration_twice", 5, "the last iteration has not ended", V2 "S 0 1\nS 0 1\n"},
    {"frame_thread", 4, "another thread than 0", V2 "F 0 1 0\n"},
    {"matched_outside", 4, "not the current one", V2 "m 0 0 5 1 0\n"},
    {"list_too_short", 5, "the point is missing", V2 "F 0 0 5\nm 0 0 5 2 0\n"},
    {"leap", 4, "leaps ahead", V2 "p 0 0 60000000\n"},
    {"v1_nowhere", 2, "keyframe 1 is made nowhere", "F 0 1 0\nO 1 0 1 1 0 0\nP 0 1 2 3 0\n"},
    {"v1_point_nowhere", 3, "point 7 is made nowhere",
     "F 0 1 0\nK 0 1 0 0 0 0 0 0 1 9 f0 0\nO 0 7 1 1 0 0\n"},
    {"v1_number", 2, "no number: 'nan'", "F 0 1 0\nP 0 nan 2 3 0\n"},
    {"v1_observed_dead", 4, "observed after it was removed",
     "F 0 1 0\nP 0 1 2 3 0\nB 0 1\nO 0 0 1 1 0 0\n"},
    {"v1_removed_twice", 4, "was removed before", "F 0 1 0\nP 0 1 2 3 0\nB 0 1\nB 0 1\n"},
    {"v1_frame_order", 2, "not later", "F 5 1 0\nF 5 1 0\n"},
    {"v1_back_in_time", 2, "before the first", "F 5 1 0\nF 6 0.5 0\n"},
    {"graph_letter", 2, "in a graph", "K 0\nB 0\n"},
    {"graph_unknown", 2, "keyframe 4 was not made", "K 0\nO 4 0 1 1\n"},
};
INSTANTIATE_TEST_SUITE_P(All, BadLine, testing::ValuesIn(all_bad),
                         [](const auto& of) { return std::string(of.param.name); });

TEST(Reader, RefusesDamagedCompression) {
  EXPECT_THROW(read_trace("x", std::string("\x1f\x8b\x08\x00garbage", 11)), bad_trace);
}
TEST(Reader, RefusesAFileThatIsNotThere) {
  EXPECT_THROW(read_trace("/nowhere/at/all.trace"), bad_trace);
}
TEST(Reader, ReadsAFileWithoutALastLineEnd) {
  const std::string path = testing::TempDir() + "replay_trace_test.trace";
  std::ofstream(path) << "F 0 1.0 0\nF 1 1.1 0";
  EXPECT_EQ(2U, read_trace(path).events.size());
}

}  // namespace
