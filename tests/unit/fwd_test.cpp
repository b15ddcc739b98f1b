// Declarations are enough for headers: every counted member can be declared with an incomplete type.
#include <slamgc/fwd.hpp>

namespace {
class keyframe;

// Names of class templates whose definitions are not in sight yet.
slamgc::intrusive_rc<keyframe> find(long id);
void connect(slamgc::rc_slot<keyframe>& slot, const slamgc::rc_vector<keyframe>& neighbours);
}  // namespace

#include <slamgc/slamgc.hpp>

#include <gtest/gtest.h>

namespace {

// As in a header that forward-declares: members first, ...
struct frame {
  frame();
  frame(const frame&) = delete;
  frame& operator=(const frame&) = delete;
  ~frame();

  slamgc::rc_slot<keyframe> reference;
  slamgc::intrusive_rc<keyframe> last;
  slamgc::rc_vector<keyframe> vector;
  slamgc::rc_list<keyframe> list;
  slamgc::rc_set<keyframe> set;
  slamgc::rc_map<keyframe, int> map;
  slamgc::rc_value_map<long, keyframe> value_map;
  slamgc::rc_unordered_set<keyframe> unordered_set;
  slamgc::rc_unordered_map<keyframe, int> unordered_map;
};
static_assert(sizeof(frame::reference) == sizeof(void*));
static_assert(sizeof(frame::last) == sizeof(void*));

// ... and then, as in the source file, the type and what needs it.
class keyframe : public slamgc::rc_object<keyframe> {
 public:
  long id = 1;
};

frame::frame() : reference(NULL), last(NULL) {}
frame::~frame() = default;

slamgc::intrusive_rc<keyframe> find(long id) {
  auto found = slamgc::make_rc<keyframe>();
  found->id = id;
  return found;
}
void connect(slamgc::rc_slot<keyframe>& slot, const slamgc::rc_vector<keyframe>& neighbours) {
  slot = neighbours[0];
}

TEST(Fwd, MembersOfAnIncompleteTypeWorkOnceItIsComplete) {
  const auto k = find(3);
  {
    frame f;
    EXPECT_TRUE(f.reference == NULL);
    EXPECT_TRUE(f.last == NULL);
    f.last = k;
    f.vector.push_back(k.get());
    connect(f.reference, f.vector);
    f.list.push_back(k.get());
    f.set.insert(k.get());
    f.map[k.get()] = 1;
    f.value_map[3] = k.get();
    f.unordered_set.insert(k.get());
    f.unordered_map[k.get()] = 1;
    EXPECT_EQ(k->use_count(), 10u);
    EXPECT_EQ(f.reference->id, 3);
  }
  EXPECT_EQ(k->use_count(), 1u);
}

}  // namespace
