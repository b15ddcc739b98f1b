// Elements of containers that several threads assign without a lock, as ORB-SLAM3 does.
#include <gtest/gtest.h>

#include <cstddef>
#include <slamgc/slamgc.hpp>
#include <vector>

#include "support/instances.hpp"
#include "support/stress.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using support::in_threads;

// An exchange of an element has no step at which another thread could be made to come between: only
// many rounds find one that is torn.
int rounds() { return 20 * support::rounds(); }

struct point : slamgc::rc_object<point, support::yielding_fetch_add>, support::instances<point> {};

class RcVectorStress : public ::testing::Test {
 protected:
  ~RcVectorStress() override { EXPECT_EQ(point::live(), 0); }
};

TEST_F(RcVectorStress, TwoThreadsAssignOneElement) {
  slamgc::rc_vector<point> v(3);
  in_threads(2, [&](int me) {
    for (int i = 0; i != rounds(); ++i) {
      if (i % 8 == me)
        v[1] = nullptr;
      else
        v[1] = new point;
    }
  });
  EXPECT_LE(point::live(), 1);
  EXPECT_EQ(v[0], nullptr);
  EXPECT_EQ(v[2], nullptr);
  v.clear();
}

TEST_F(RcVectorStress, ManyThreadsAssignManyElements) {
  std::vector<intrusive_rc<point>> kept;
  for (int i = 0; i != 5; ++i) kept.push_back(make_rc<point>());
  slamgc::rc_vector<point> v(4);
  in_threads(4, [&](int me) {
    for (int i = 0; i != rounds(); ++i) {
      const auto to = static_cast<std::size_t>((i * 7 + me) % 4);
      const auto from = static_cast<std::size_t>((i * 3 + me) % 5);
      if (i % 3 == 0)
        v[to] = v[from % 4];
      else
        v[to] = kept[from].get();
    }
  });
  unsigned counted = 0;
  for (const auto& p : kept) counted += p->use_count() - 1;
  EXPECT_EQ(counted, 4u);
  v.clear();
  for (const auto& p : kept) EXPECT_EQ(p->use_count(), 1u);
}

TEST_F(RcVectorStress, TwoThreadsAssignOneMappedValue) {
  slamgc::rc_value_map<int, point> m;
  m[1] = nullptr;
  in_threads(2, [&](int) {
    const auto value = m.at(1);
    for (int i = 0; i != rounds(); ++i) value = new point;
  });
  EXPECT_EQ(point::live(), 1);
  m.clear();
}

}  // namespace
