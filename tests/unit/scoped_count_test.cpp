// The thesis's scheme for locals: what a copied container refers to is counted while a scope lasts.
#include <slamgc/scoped_count.hpp>

#include <gtest/gtest.h>

#include <list>
#include <map>
#include <set>
#include <slamgc/containers/rc_map.hpp>
#include <slamgc/containers/rc_vector.hpp>
#include <slamgc/intrusive_rc.hpp>
#include <type_traits>
#include <vector>

#include "support/instances.hpp"

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;
using slamgc::scoped_count;

struct node : slamgc::rc_object<node>, support::instances<node> {};

static_assert(!std::is_copy_constructible<scoped_count<std::vector<node*>>>::value);
static_assert(!std::is_copy_assignable<scoped_count<std::vector<node*>>>::value);
static_assert(!std::is_convertible<std::vector<node*>, scoped_count<std::vector<node*>>>::value,
              "a scope has to be asked for");

class ScopedCount : public ::testing::Test {
 protected:
  ~ScopedCount() override {
    a_.reset();
    b_.reset();
    EXPECT_EQ(node::live(), 0);
  }
  intrusive_rc<node> a_ = make_rc<node>();
  intrusive_rc<node> b_ = make_rc<node>();
};

TEST_F(ScopedCount, CountsEveryElementWhileItExists) {
  const std::vector<node*> content = {a_.get(), nullptr, b_.get(), a_.get()};
  {
    const scoped_count scope(content);
    EXPECT_EQ(a_->use_count(), 3u);
    EXPECT_EQ(b_->use_count(), 2u);
    EXPECT_EQ(*scope, content);
    EXPECT_EQ(scope->size(), 4u);
    EXPECT_EQ(std::vector<node*>(scope.begin(), scope.end()), content);
  }
  EXPECT_EQ(a_->use_count(), 1u);
  EXPECT_EQ(b_->use_count(), 1u);
}

TEST_F(ScopedCount, KeepsObjectsThatTheMapDrops) {
  slamgc::rc_vector<node> map = {new node, new node};
  {
    const scoped_count scope(map.raw());
    map.clear();
    EXPECT_EQ(node::live(), 4);
    for (node* p : scope) EXPECT_EQ(p->use_count(), 1u);
  }
  EXPECT_EQ(node::live(), 2);
}

TEST_F(ScopedCount, HoldsSequencesSetsAndKeyedMaps) {
  const std::list<node*> list = {a_.get(), a_.get()};
  const std::set<node*> set = {a_.get()};
  const std::map<node*, int> map = {{a_.get(), 1}};
  {
    const scoped_count of_list(list);
    const scoped_count of_set(set);
    const scoped_count of_map(map);
    EXPECT_EQ(a_->use_count(), 5u);
    EXPECT_EQ(of_map.begin()->second, 1);
  }
  EXPECT_EQ(a_->use_count(), 1u);
}

TEST_F(ScopedCount, TakesATemporaryOver) {
  slamgc::rc_map<node, int> map;
  map[a_.get()] = 1;
  const auto copy = [&] { return std::vector<node*>{a_.get(), b_.get()}; };
  const scoped_count scope(copy());
  EXPECT_EQ(a_->use_count(), 3u);
  map.clear();
  EXPECT_EQ(a_->use_count(), 2u);
}

TEST_F(ScopedCount, AnEmptyContainerIsFine) {
  const scoped_count scope{std::vector<node*>()};
  EXPECT_EQ(scope.begin(), scope.end());
}

}  // namespace
