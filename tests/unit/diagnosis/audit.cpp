// Do the descriptions say what the counts say? Seeded faults, each named.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <slamgc/diagnosis/audit.hpp>
#include <slamgc/slamgc.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "unit/diagnosis/map.hpp"

namespace {

using namespace diagnosis_map;
using slamgc::audit;

const std::string hint =
    "a pin, an intrusive_rc, a member that edges() does not name, a root that nobody told the "
    "domain of\n";

TEST(Audit, ARightMapAgrees) {
  world w;
  Map map(w.domain);
  Tracking tracking(w.me);
  KeyFrame* const a = w.key_frame(1);
  KeyFrame* const b = w.key_frame(2);
  map.mspKeyFrames.insert(a);
  map.mspKeyFrames.insert(b);
  MapPoint* const p = new MapPoint;
  a->mvpMapPoints = {p, nullptr, p};
  p->mObservations[a] = 2;
  p->mpRefKF = b;
  b->mpParent = a;
  a->mspChildrens.insert(b);
  tracking.mpReferenceKF = b;
  const audit found(w.domain);
  EXPECT_TRUE(found.agrees());
  EXPECT_EQ(found.words(), "3 objects, 9 described references; all counts agree\n");
  EXPECT_EQ(found.not_found(), 0u);

  // Retired, waiting, being looked at: the references of those count, too.
  tracking.mpReferenceKF = nullptr;
  slamgc::retire(a);
  slamgc::retire(p);
  map.mspKeyFrames.erase(a);
  for (int i = 0; i != 6; ++i) {
    EXPECT_TRUE(audit(w.domain).agrees()) << i << ": " << audit(w.domain).words();
    w.domain.collect({1, std::chrono::nanoseconds::max()});
    EXPECT_TRUE(audit(w.domain).agrees()) << i << ": " << audit(w.domain).words();
    w.me.quiescent();
  }
  w.clear(map.mspKeyFrames);
  EXPECT_EQ(w.live(), 0u);
}

// Without a root, and waiting: what they refer to is described.
TEST(Audit, ObjectsThatWaitAreWalked) {
  world w;
  Map map(w.domain);
  KeyFrame* const parent = w.key_frame(0);
  map.mspKeyFrames.insert(parent);
  for (unsigned long i = 1; i != 600; ++i) {
    KeyFrame* const child = w.key_frame(i);
    child->mpParent = parent;
    slamgc::retire(child);
  }
  EXPECT_TRUE(audit(w.domain).agrees()) << audit(w.domain).words();  // in the mutator's chain
  for (int i = 0; i != 100; ++i) {
    w.domain.collect({17, std::chrono::nanoseconds::max()});  // noted in part, reclaimed in part
    const audit found(w.domain);
    ASSERT_TRUE(found.agrees()) << i << ": " << found.words();
    ASSERT_EQ(found.not_found(), 0u) << i;
    if (i > 40) w.me.quiescent();
  }
  w.clear(map.mspKeyFrames);
  EXPECT_EQ(w.live(), 0u);
}

struct careless : object<careless> {
  explicit careless(unsigned long id) : mnId(id) {}
  unsigned long report_id() const { return mnId; }
  template <class Visitor>
  void edges(Visitor& v) {
    if (describes_first) v.edge("first", first);
    if (describes_again) v.edge("first again", first);
    if (throws) throw std::runtime_error("edges");
    v.edge("list", list);
  }
  const unsigned long mnId;
  bool describes_first = true;
  bool describes_again = false;
  bool throws = false;
  slamgc::rc_slot<careless> first;
  slamgc::rc_vector<careless> list;
};
struct owner {
  explicit owner(slamgc::domain& d) : root(d, "owner", *this) {}
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("all", all);
  }
  slamgc::registry<slamgc::rc_set<careless>> all;
  slamgc::root root;
};

class AuditFaults : public ::testing::Test {
 protected:
  AuditFaults() {
    of.all.insert(a);
    of.all.insert(b);
    a->first = b;
  }
  ~AuditFaults() override {
    w.clear(of.all);
    EXPECT_EQ(w.live(), 0u);
  }
  world w;
  owner of{w.domain};
  careless* const a = new careless(1);
  careless* const b = new careless(2);
};

TEST_F(AuditFaults, AMemberLeftOut) {
  EXPECT_TRUE(audit(w.domain).agrees());
  a->describes_first = false;
  const audit found(w.domain);
  EXPECT_FALSE(found.agrees());
  ASSERT_EQ(found.more_counted().size(), 1u);
  EXPECT_EQ(found.more_counted()[0]->address, b);
  EXPECT_EQ(found.words(),
            "2 objects, 2 described references; 1 count differs\n"
            "careless 2: 2 references counted, 1 described\n"
            "  held by root owner .all (hold)\n"
            "  1 reference is not described: " +
                hint);
  a->first = nullptr;
}

TEST_F(AuditFaults, AMemberDescribedTwice) {
  a->describes_again = true;
  const audit found(w.domain);
  EXPECT_FALSE(found.agrees());
  ASSERT_EQ(found.more_described().size(), 1u);
  EXPECT_EQ(found.words(),
            "2 objects, 4 described references; 1 count differs\n"
            "careless 2: 2 references counted, 3 described\n"
            "  held by root owner .all (hold)\n"
            "  held by careless 1 .first (hold)\n"
            "  held by careless 1 .first again (hold)\n"
            "  1 described reference too many: a member that edges() names twice, or a container "
            "written past its interface\n");
  a->describes_again = false;
}

TEST_F(AuditFaults, AReferenceThatNobodyCounted) {
  auto& raw = const_cast<std::vector<careless*>&>(a->list.raw());
  raw.push_back(b);
  const audit found(w.domain);
  ASSERT_EQ(found.more_described().size(), 1u);
  EXPECT_EQ(found.more_described()[0]->address, b);
  raw.clear();
  EXPECT_TRUE(audit(w.domain).agrees());
}

TEST_F(AuditFaults, ARawPointerIsNobodysBusiness) {
  careless* const uncounted = b;
  EXPECT_TRUE(audit(w.domain).agrees());
  EXPECT_EQ(uncounted->report_id(), 2u);
}

TEST_F(AuditFaults, AnObjectThatNothingLeadsTo) {
  const slamgc::intrusive_rc<careless> alone(new careless(3));
  const audit found(w.domain);
  EXPECT_TRUE(found.agrees());  // of what it has met
  EXPECT_EQ(found.not_found(), 1u);
  EXPECT_EQ(found.words(),
            "2 objects, 3 described references; all counts agree\n"
            "1 object of type careless to which no described reference leads\n");
  slamgc::retire(alone.get());
}

TEST_F(AuditFaults, EdgesThatThrow) {
  a->throws = true;
  a->list.push_back(b);
  const audit found(w.domain);
  EXPECT_FALSE(found.agrees());
  EXPECT_EQ(found.unfinished(), 1u);
  EXPECT_NE(found.words().find("careless 1: its edges() threw\n"), std::string::npos);
  EXPECT_EQ(found.more_counted().size(), 1u);
  a->throws = false;
  EXPECT_TRUE(audit(w.domain).agrees());
}

TEST_F(AuditFaults, ACountThatOverflowedIsNoDifference) {
  constexpr std::uint64_t many = slamgc::state_word::sticky_count * slamgc::state_word::count_unit;
  auto& state = slamgc::detail::access::header_of(*b).state;
  slamgc::fetch_add_counter::add(state, many);
  EXPECT_TRUE(audit(w.domain).agrees());
  slamgc::fetch_add_counter::subtract(state, many);
}

}  // namespace
