// Objects that are referred to again while they wait to be destroyed, or by their own destructor.
#undef SLAMGC_DEBUG
#define SLAMGC_DEBUG 0  // the checked flavour reports the last case
#include <gtest/gtest.h>

#include <functional>
#include <slamgc/slamgc.hpp>

namespace {

using slamgc::intrusive_rc;
using slamgc::rc_slot;
using slamgc::rc_vector;

struct item : slamgc::rc_object<item> {
  item() { ++alive; }
  ~item() {
    if (when_destroyed) when_destroyed(this);
    --alive;
  }
  std::function<void(item*)> when_destroyed;
  static int alive;
};
int item::alive = 0;

TEST(ReclaimAgain, AnObjectThatIsReferredToWhileItWaitsStays) {
  rc_slot<item> rescued;
  {
    rc_vector<item> both{new item, new item};
    both[0]->when_destroyed = [&rescued, other = both[1].get()](item*) { rescued = other; };
    both.clear();  // counts the last down first, and destroys in the other order
    EXPECT_EQ(item::alive, 1);
  }
  EXPECT_EQ(rescued->use_count(), 1U);
  rescued.reset();
  EXPECT_EQ(item::alive, 0);
}

TEST(ReclaimAgain, AnObjectThatIsDroppedTwiceWhileItWaitsIsDestroyedOnce) {
  rc_vector<item> both{new item, new item};
  both[0]->when_destroyed = [other = both[1].get()](item*) {
    intrusive_rc<item>(other).reset();
    intrusive_rc<item>(other).reset();
  };
  both.clear();
  EXPECT_EQ(item::alive, 0);
}

TEST(ReclaimAgain, AReferenceThatADestructorMakesToItsOwnObjectIsHarmless) {
  intrusive_rc<item> p(new item);
  p->when_destroyed = [](item* self) { intrusive_rc<item>(self).reset(); };
  p.reset();
  EXPECT_EQ(item::alive, 0);
}

TEST(ReclaimAgain, TwoEditsExchangeObjectsThatOnlyTheyHold) {
  rc_vector<item> a{new item, new item};
  rc_vector<item> b{new item};
  item* const of_b = b[0];
  a.edit()->swap(b.edit());
  EXPECT_EQ(item::alive, 3);
  EXPECT_EQ(a.size(), 1U);
  EXPECT_EQ(a[0], of_b);
  EXPECT_EQ(of_b->use_count(), 1U);
  EXPECT_EQ(b.size(), 2U);
  a.clear();
  b.clear();
  EXPECT_EQ(item::alive, 0);
}

TEST(ReclaimAgain, SlotsAndPointersCompareAndConvert) {
  rc_slot<item> slot(new item);
  const intrusive_rc<item> p = slot;
  EXPECT_EQ(p->use_count(), 2U);
  EXPECT_TRUE(slot == p);
  EXPECT_TRUE(p == slot);
  EXPECT_FALSE(slot != p);
  EXPECT_FALSE(p != slot);
  intrusive_rc<item> assigned;
  assigned = slot;
  EXPECT_EQ(assigned->use_count(), 3U);
  intrusive_rc<const item> as_const;
  as_const = slot;
  EXPECT_EQ(as_const->use_count(), 4U);
}

}  // namespace
