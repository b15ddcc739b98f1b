// The members of ORB-SLAM3 as counted slots and containers, and the code over them.
#include "counted.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <list>
#include <map>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "orb_members.hpp"

// The code under test says `vector<KeyFrame*>`, as ORB-SLAM3 does.
using namespace std;  // NOLINT
// In this order, hence the empty lines.

#include "members.inc"

#include "code_graph.inc"
#include "code_threads.inc"

#include "code_changed.inc"

#include "session.inc"

namespace {

/// How often each object is referred to, found by a walk over all members.
class References {
 public:
  template <class Pointer>
  auto add(const Pointer& p) -> decltype(static_cast<void>(p.get())) {
    ++found_[p.get()];
  }
  template <class Container>
  auto add(const Container& c) -> decltype(static_cast<void>(c.begin())) {
    for (const auto& e : c) ++found_[key(e)];
  }
  unsigned to(const void* p) const { return found_.count(p) ? found_.at(p) : 0; }

 private:
  static const void* key(const void* p) { return p; }
  template <class T, class Mapped>
  static const void* key(const pair<T* const, Mapped>& e) {
    return e.first;
  }
  map<const void*, unsigned> found_;
};

/// Objects whose count is not their number of references, the session's own one included.
size_t wrong_counts(const Session& s, size_t& references) {
  References found;
  s.edges([&](const auto&... member) { (found.add(member), ...); });
  size_t wrong = 0;
  references = 0;
  const auto compare = [&](const auto& owner) {
    wrong += owner->use_count() != found.to(owner.get()) + 1;
    references += found.to(owner.get());
  };
  for (const auto& pKF : s.vpKFs) compare(pKF);
  for (const auto& pMP : s.vpMPs) compare(pMP);
  return wrong;
}

TEST(OrbMembers, CountsEqualReferencesAfterEachStep) {
  size_t step = 0, references = 0, most = 0;
  run_session([&](const Session& s) {
    EXPECT_EQ(wrong_counts(s, references), 0u) << "step " << step;
    most = max(most, references);
    step++;
  });
  EXPECT_GT(step, 100u);
  EXPECT_GT(most, 500u) << "the session does not do much";
  EXPECT_EQ(references, 0u) << "after all was cleared";
}

TEST(OrbMembers, CodeDoesTheSameWithPlainMembers) {
  const vector<long> counted = run_session([](const Session&) {});
  EXPECT_EQ(counted, orb_members::run_with_plain_members());
}

}  // namespace
