// Everything that boost::intrusive_ptr has is there under the same name: one program, compiled with
// both, does the same.
#include <slamgc/intrusive_rc.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#if __has_include(<boost/smart_ptr/intrusive_ptr.hpp>)
#include <boost/smart_ptr/intrusive_ptr.hpp>
#include <boost/smart_ptr/intrusive_ref_counter.hpp>
#define SLAMGC_TEST_BOOST 1
#endif

namespace {

namespace with_slamgc {
using slamgc::const_pointer_cast;
using slamgc::dynamic_pointer_cast;
using slamgc::static_pointer_cast;
template <class T>
using counted_ptr = slamgc::intrusive_rc<T>;
template <class T>
using counted_base = slamgc::rc_object<T>;
#include "ported_program.inc"
}  // namespace with_slamgc

TEST(PortedProgram, FreesEverything) {
  std::istringstream words(with_slamgc::run());
  int parts = 0;
  for (std::string word; words >> word;) {
    if (word != "alive") continue;
    words >> word;
    EXPECT_EQ(word[0], '0') << with_slamgc::run();
    ++parts;
  }
  EXPECT_EQ(parts, 4);
}

#ifdef SLAMGC_TEST_BOOST

namespace with_boost {
using boost::const_pointer_cast;
using boost::dynamic_pointer_cast;
using boost::static_pointer_cast;
template <class T>
using counted_ptr = boost::intrusive_ptr<T>;
template <class T>
using counted_base = boost::intrusive_ref_counter<T>;
#include "ported_program.inc"
}  // namespace with_boost

TEST(PortedProgram, DoesTheSameAsWithBoost) { EXPECT_EQ(with_slamgc::run(), with_boost::run()); }

// boost's pointer holds slamgc's objects, next to slamgc's own.
struct node : slamgc::rc_object<node> {
  explicit node(int& live) : live_(live) { ++live_; }
  node(const node&) = delete;
  node& operator=(const node&) = delete;
  ~node() { --live_; }
  int& live_;
};

TEST(BoostIntrusivePtr, HoldsSlamgcObjects) {
  int live = 0;
  boost::intrusive_ptr<node> p(new node(live));
  {
    const boost::intrusive_ptr<const node> q = p;
    const slamgc::intrusive_rc<node> r(p.get());
    EXPECT_EQ(p->use_count(), 3u);
  }
  slamgc::intrusive_rc<node> r = slamgc::intrusive_rc<node>::adopt(p.detach());
  EXPECT_EQ(r->use_count(), 1u);
  EXPECT_EQ(live, 1);
  p = r.get();
  r = nullptr;
  p.reset();
  EXPECT_EQ(live, 0);
}

#endif

}  // namespace
