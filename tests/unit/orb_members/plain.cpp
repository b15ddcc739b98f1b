// The members of ORB-SLAM3 as they are, and the code over them.
#include "plain.hpp"

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

std::vector<long> orb_members::run_with_plain_members() {
  return run_session([](const Session&) {});
}
