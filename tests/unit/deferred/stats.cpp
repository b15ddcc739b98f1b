// The numbers that a domain gives.
#include <slamgc/stats.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <slamgc/slamgc.hpp>
#include <string>
#include <type_traits>

namespace {

using slamgc::domain;
using slamgc::make_rc;
using slamgc::mutator;
using slamgc::type_stats;

struct small_type
    : slamgc::rc_object<small_type, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};
struct large_type : slamgc::rc_object<large_type, slamgc::cas_counter, slamgc::reclaim_retired> {
  char bytes[1000] = {};
};

const type_stats* of(const slamgc::domain_stats& all, const std::string& name) {
  for (const type_stats& t : all.types)
    if (std::string(t.type).find(name) != std::string::npos) return &t;
  return nullptr;
}

TEST(Stats, ArePlain) {
  EXPECT_TRUE(std::is_trivially_copyable<type_stats>::value);
  EXPECT_TRUE(std::is_trivially_copyable<slamgc::mutator_stats>::value);
  EXPECT_TRUE(std::is_trivially_copyable<slamgc::delay>::value);
  EXPECT_TRUE(std::is_copy_assignable<slamgc::domain_stats>::value);
}

TEST(Stats, OfAnEmptyDomain) {
  const domain d;
  const auto none = d.stats();
  EXPECT_TRUE(none.types.empty());
  EXPECT_TRUE(none.mutators.empty());
  EXPECT_EQ(none.delayed.oldest, nullptr);
  EXPECT_EQ(none.delayed.age.count(), 0);
  EXPECT_EQ(none.delayed.backlog, 0u);
  EXPECT_EQ(none.grace_periods, 0u);
  EXPECT_EQ(none.longest_collect.count(), 0);
  EXPECT_EQ(none.refused_collects, 0u);
  EXPECT_EQ(none.total(&type_stats::created), 0u);
  EXPECT_EQ(none.live_bytes(), 0u);
}

TEST(Stats, OfEachType) {
  domain d;
  mutator m(d, "m");
  auto a = make_rc<small_type>();
  auto b = make_rc<small_type>();
  auto c = make_rc<large_type>();
  {
    const auto now = d.stats();
    ASSERT_EQ(now.types.size(), 2u);
    const auto* const s = of(now, "small_type");
    const auto* const l = of(now, "large_type");
    ASSERT_NE(s, nullptr);
    ASSERT_NE(l, nullptr);
    EXPECT_EQ(s->object_size, sizeof(small_type));
    EXPECT_EQ(s->created, 2u);
    EXPECT_EQ(s->live, 2u);
    EXPECT_EQ(l->live_bytes(), sizeof(large_type));
    EXPECT_EQ(now.live_bytes(), 2 * sizeof(small_type) + sizeof(large_type));
    EXPECT_EQ(now.total(&type_stats::live), 3u);
  }
  a.reset();
  EXPECT_TRUE(slamgc::retire(c.get()));
  {
    const auto now = d.stats();
    EXPECT_EQ(of(now, "small_type")->backlog, 1u);
    EXPECT_EQ(of(now, "small_type")->retired, 0u);
    EXPECT_EQ(of(now, "large_type")->backlog, 0u);
    EXPECT_EQ(of(now, "large_type")->retired, 1u);
    EXPECT_EQ(now.total(&type_stats::reclaimed), 0u);
  }
  b.reset();
  c.reset();
  (void)d.collect();
  m.quiescent();
  (void)d.collect();
  const auto now = d.stats();
  EXPECT_EQ(of(now, "small_type")->reclaimed, 2u);
  EXPECT_EQ(of(now, "small_type")->reclaimed_bytes(), 2 * sizeof(small_type));
  EXPECT_EQ(of(now, "large_type")->reclaimed, 1u);
  EXPECT_EQ(of(now, "large_type")->live, 0u);
  EXPECT_EQ(now.total(&type_stats::created), 3u);
  EXPECT_EQ(now.total(&type_stats::backlog), 0u);
  EXPECT_GT(now.longest_collect.count(), 0);
  EXPECT_EQ(now.grace_periods, 1u);
}

TEST(Stats, OfAnObjectThatTheProgramDeletes) {
  domain d;
  const mutator m(d, "m");
  delete new small_type;
  {
    const mutator inner(d, "inner");
    delete new small_type;
  }
  auto* const by_another = new small_type;
  {
    domain foreign;
    const mutator elsewhere(foreign, "elsewhere");
    delete by_another;
    EXPECT_TRUE(foreign.stats().types.empty());
  }
  const auto now = d.stats();
  EXPECT_EQ(now.total(&type_stats::created), 3u);
  EXPECT_EQ(now.total(&type_stats::live), 0u);
  EXPECT_EQ(now.total(&type_stats::reclaimed), 0u);
}

TEST(Stats, OfMutators) {
  domain d;
  mutator a(d, "tracking");
  const mutator b(d, "viewer", {false, false});
  slamgc::retire(new small_type);
  (void)d.collect();
  const auto now = d.stats();
  ASSERT_EQ(now.mutators.size(), 2u);
  for (const auto& m : now.mutators) {
    const bool tracking = std::strcmp(m.name, "tracking") == 0;
    EXPECT_TRUE(tracking || std::strcmp(m.name, "viewer") == 0);
    EXPECT_EQ(m.online, tracking);
    EXPECT_EQ(m.delays, tracking);
  }
  EXPECT_STREQ(now.delayed.oldest, "tracking");
  a.quiescent();
  EXPECT_EQ(d.delayed().oldest, nullptr);
}

}  // namespace
