// What Tracy is told, by a header that stands in for Tracy's (tests/support/fake_tracy).
#define TRACY_ENABLE
#include <slamgc/integrations/tracy.hpp>

#include <gtest/gtest.h>

#include <slamgc/slamgc.hpp>
#include <string>
#include <vector>

namespace {

using slamgc::domain;
using slamgc::mutator;

struct node : slamgc::rc_object<node, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};

std::vector<std::string> calls() {
  auto all = std::move(fake_tracy::calls);
  fake_tracy::calls.clear();
  for (std::string& call : all) {  // the type, without its namespace
    const auto at = call.find("{anonymous}::");
    if (at != std::string::npos) call.erase(at, 13);
    const auto as_clang = call.find("(anonymous namespace)::");
    if (as_clang != std::string::npos) call.erase(as_clang, 23);
  }
  return all;
}

TEST(Tracy, ShowsSlicesGracePeriodsAndNumbers) {
  fake_tracy::names.clear();
  slamgc::tracy_hooks hooks;
  domain d;
  d.install(&hooks);
  mutator m(d, "tracking");
  slamgc::retire(new node);
  (void)d.collect();
  EXPECT_EQ(calls(), (std::vector<std::string>{"zone begins: slamgc collect",
                                               "frame starts: slamgc grace period",
                                               "plot live node = 1", "plot backlog node = 1",
                                               "zone 1: 0", "zone 1: tracking", "zone 1 ends"}));
  {
    const mutator::offline_scope offline(m);
    (void)d.collect();
  }
  EXPECT_EQ(calls(),
            (std::vector<std::string>{"zone begins: slamgc collect",
                                      "frame ends: slamgc grace period", "plot live node = 0",
                                      "plot backlog node = 0", "zone 2: 1", "zone 2 ends"}));
  // Tracy tells names apart by their addresses.
  ASSERT_EQ(fake_tracy::names.size(), 6u);
  for (const std::size_t i : {0u, 1u, 2u})
    EXPECT_EQ(fake_tracy::names[i], fake_tracy::names[i + 3]);
}

TEST(Tracy, AGracePeriodThatBeganBeforeIsNotEnded) {
  slamgc::tracy_hooks hooks;
  domain d;
  {
    mutator m(d, "tracking");
    slamgc::retire(new node);
    (void)d.collect();
  }
  d.install(&hooks);
  (void)d.collect();
  for (const std::string& call : calls()) EXPECT_EQ(call.find("frame"), std::string::npos) << call;
}

}  // namespace
