// What cannot be written, and where nothing is. What is written is read in tests/trace.
#include <slamgc/integrations/trace_json.hpp>

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <slamgc/slamgc.hpp>
#include <sstream>
#include <string>

namespace {

using slamgc::domain;
using slamgc::mutator;
using slamgc::trace_json;

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};

std::string read(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

class TraceJson : public ::testing::Test {
 protected:
  ~TraceJson() override { std::remove(path_.c_str()); }
  static void use(trace_json& trace) {
    domain d;
    d.install(&trace);
    const mutator m(d, "m", {false, false});
    slamgc::retire(new node);
    EXPECT_EQ(d.collect().reclaimed, 1u);
    const trace_json::span span(trace, "span");
    trace.name_thread("name");
  }
  const std::string path_ = ::testing::TempDir() + "slamgc_trace_" +
                            ::testing::UnitTest::GetInstance()->current_test_info()->name() +
                            ".json";
};

TEST_F(TraceJson, AnEmptyTrace) {
  { const trace_json trace(path_.c_str()); }
  EXPECT_EQ(read(path_), "[\n]\n");
}

TEST_F(TraceJson, AFileThatCannotBeMadeIsSaidAndDoesNoHarm) {
  trace_json trace("/nowhere/trace.json");
  EXPECT_FALSE(trace.good());
  use(trace);
  EXPECT_FALSE(trace.good());
}

TEST_F(TraceJson, AGracePeriodThatBeganBeforeIsNotEnded) {
  {
    trace_json trace(path_.c_str());
    domain d;
    {
      const mutator m(d, "m");
      slamgc::retire(new node);
      EXPECT_EQ(d.collect().result, slamgc::collected::outcome::waiting);
    }
    d.install(&trace);
    EXPECT_EQ(d.collect().reclaimed, 1u);
    d.install(nullptr);
    EXPECT_TRUE(trace.good());
  }
  EXPECT_NE(read(path_).find("\"reclaimed\":1"), std::string::npos);
  EXPECT_EQ(read(path_).find("grace period\","), std::string::npos);
}

}  // namespace
