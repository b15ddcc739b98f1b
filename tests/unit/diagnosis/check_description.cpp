// The test of tests: a description that misses a counted member is found, whether the member is empty or not.
#undef SLAMGC_DEBUG
#define SLAMGC_DEBUG 1

#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <slamgc/diagnosis/check_description.hpp>
#include <slamgc/slamgc.hpp>
#include <string>
#include <thread>
#include <vector>

namespace {

using slamgc::check_description;

template <class T>
using object = slamgc::rc_object<T, slamgc::fetch_add_counter, slamgc::reclaim_retired>;

// One member of each kind; leaves out the one at which `left_out` points.
struct all_kinds : object<all_kinds> {
  template <class Visitor>
  void edges(Visitor& v) {
    int n = 0;
    const auto name = [&](const char* as, auto& member) {
      if (n++ != left_out) v.edge(as, member);
    };
    name("slot", slot);
    name("atomic", atomic);
    name("vector", vector);
    name("list", list);
    name("set", set);
    name("map", map);
    name("value_map", value_map);
    name("unordered_set", unordered_set);
    name("unordered_map", unordered_map);
    name("owned", owned);
  }
  static int left_out;
  slamgc::rc_slot<all_kinds> slot;
  int other = 0;
  slamgc::atomic_rc<all_kinds> atomic;
  slamgc::rc_vector<all_kinds> vector;
  slamgc::rc_list<all_kinds> list;
  slamgc::rc_set<all_kinds> set;
  slamgc::rc_map<all_kinds, int> map;
  slamgc::rc_value_map<int, all_kinds> value_map;
  slamgc::rc_unordered_set<all_kinds> unordered_set;
  slamgc::rc_unordered_map<all_kinds, int> unordered_map;
  slamgc::registry<slamgc::rc_set<all_kinds>> owned;
};
int all_kinds::left_out = -1;

TEST(CheckDescription, EachKindOfMemberIsSeen) {
  all_kinds::left_out = -1;
  EXPECT_TRUE(check_description<all_kinds>().ok()) << check_description<all_kinds>().words();
  EXPECT_EQ(check_description<all_kinds>().words(), "");
  const all_kinds whole;
  const auto offset = [&](const auto& member) {
    return static_cast<std::size_t>(reinterpret_cast<const char*>(&member) -
                                    reinterpret_cast<const char*>(&whole));
  };
  const std::size_t offsets[] = {offset(whole.slot),          offset(whole.atomic),
                                 offset(whole.vector),        offset(whole.list),
                                 offset(whole.set),           offset(whole.map),
                                 offset(whole.value_map),     offset(whole.unordered_set),
                                 offset(whole.unordered_map), offset(whole.owned)};
  for (int i = 0; i != 10; ++i) {
    all_kinds::left_out = i;
    const auto check = check_description<all_kinds>();
    ASSERT_EQ(check.missing.size(), 1u) << i;
    EXPECT_TRUE(check.missing[0].inside);
    EXPECT_EQ(check.missing[0].offset, offsets[i]) << i;
    EXPECT_FALSE(check.ok());
    EXPECT_TRUE(check.repeated.empty() && check.foreign.empty() && !check.threw);
  }
  all_kinds::left_out = 0;
  const std::string words = check_description<all_kinds>().words();
  EXPECT_EQ(words.find("all_kinds: has a counted member that edges() does not name: "), 0u);
  EXPECT_NE(words.find("rc_slot<"), std::string::npos) << words;
  EXPECT_NE(words.find(", at offset 16\n"), std::string::npos) << words;
}

struct twice : object<twice> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("mpParent", mpParent);
    v.edge("mpFirstParent", mpParent);
    v.edge("mpElsewhere", elsewhere());
  }
  static slamgc::rc_slot<twice>& elsewhere() {
    static slamgc::rc_slot<twice> slot;
    return slot;
  }
  slamgc::rc_slot<twice> mpParent;
};
TEST(CheckDescription, AMemberNamedTwiceOrOfSomethingElse) {
  (void)twice::elsewhere();
  const auto check = check_description<twice>();
  EXPECT_TRUE(check.missing.empty());
  ASSERT_EQ(check.repeated.size(), 1u);
  EXPECT_EQ(check.repeated[0].name, "mpParent\" and \"mpFirstParent");
  ASSERT_EQ(check.foreign.size(), 1u);
  EXPECT_EQ(check.foreign[0].name, "mpElsewhere");
  EXPECT_FALSE(check.ok());
}

// Members on the heap, in a base class, in an array, in a struct of its own, or in an optional.
struct base {
  slamgc::rc_slot<all_kinds> in_base;
};
struct part {
  slamgc::rc_slot<all_kinds> in_part;
  slamgc::rc_vector<all_kinds> array[3];
};
struct nested : base, object<nested> {
  nested() : grid(4), own(new part) {
    slamgc::rc_slot<all_kinds> local;  // ends here
    std::vector<slamgc::rc_set<all_kinds>> gone(3);
    gone.clear();
    engaged.emplace();
    emptied.emplace();
    emptied.reset();
  }
  template <class Visitor>
  void edges(Visitor& v) {
    if (!forgets) {
      v.edge("in_base", in_base);
      v.edge("in_part", inner.in_part);
      for (auto& a : inner.array) v.edge("array", a);
      for (auto& cell : grid) v.edge("grid", cell);
      v.edge("own.in_part", own->in_part);
      for (auto& a : own->array) v.edge("own.array", a);
      v.edge("engaged", *engaged);
    }
  }
  static bool forgets;
  part inner;
  std::vector<slamgc::rc_vector<all_kinds>> grid;
  std::unique_ptr<part> own;
  std::optional<slamgc::rc_slot<all_kinds>> engaged;
  std::optional<slamgc::rc_slot<all_kinds>> emptied;
};
bool nested::forgets = false;
TEST(CheckDescription, MembersWhereverTheyAre) {
  nested::forgets = false;
  EXPECT_EQ(check_description<nested>().words(), "");
  nested::forgets = true;
  const auto check = check_description<nested>();
  std::size_t inside = 0;
  for (const auto& m : check.missing) inside += m.inside ? 1 : 0;
  EXPECT_EQ(inside, 1u + 4u + 1u);                         // base, inner, engaged
  EXPECT_EQ(check.missing.size() - inside, 4u + 1u + 3u);  // grid, own
  EXPECT_NE(check.words().find(", outside of the object\n"), std::string::npos);
}

// What cannot be seen, so that the documentation stays true.
struct with_local : object<with_local> {
  with_local() {
    std::thread([this] { late = std::make_unique<slamgc::rc_slot<with_local>>(); }).join();
  }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("slot", slot);
  }
  slamgc::rc_slot<with_local> slot;
  slamgc::intrusive_rc<with_local> handle;
  std::unique_ptr<slamgc::rc_slot<with_local>> late;
};
TEST(CheckDescription, DoesNotSeeHandlesNorMembersThatAnotherThreadMakes) {
  EXPECT_TRUE(check_description<with_local>().ok());
}

struct registered : object<registered> {
  explicit registered(slamgc::rc_set<registered>& all) { all.insert(this); }
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("slot", slot);
  }
  slamgc::rc_slot<registered> slot;
};
TEST(CheckDescription, ObjectsMadeByTheProgram) {
  slamgc::domain d;
  {
    const slamgc::mutator me(d, "test");
    slamgc::rc_set<registered> all;
    EXPECT_TRUE(check_description<registered>([&] { return new registered(all); }).ok());
    ASSERT_EQ(all.size(), 1u);  // it has not deleted what somebody refers to
    slamgc::retire(*all.begin());
  }
  EXPECT_EQ(d.drain(), slamgc::waited::done);
}

// What a root describes is checked in the same way.
struct map_of {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("all", all);
  }
  slamgc::registry<slamgc::rc_set<all_kinds>> all;
  slamgc::rc_set<all_kinds> forgotten;
};
TEST(CheckDescription, OfARoot) {
  const auto check = check_description<map_of>();
  ASSERT_EQ(check.missing.size(), 1u);
  EXPECT_EQ(check.missing[0].offset, sizeof(map_of) - sizeof(map_of::forgotten));
}

struct throwing : object<throwing> {
  throwing() { throw 1; }
  template <class Visitor>
  void edges(Visitor&) {}
  slamgc::rc_slot<throwing> slot;
};
TEST(CheckDescription, AConstructorThatThrows) {
  EXPECT_THROW((void)check_description<throwing>(), int);
  EXPECT_EQ(slamgc::detail::member_watcher::current(), nullptr);
}

// Nothing of it in the layout, in either flavour.
static_assert(sizeof(slamgc::checked::rc_slot<all_kinds>) == sizeof(void*));
static_assert(sizeof(slamgc::checked::atomic_rc<all_kinds>) == sizeof(void*));
static_assert(sizeof(slamgc::checked::rc_vector<all_kinds>) == sizeof(std::vector<all_kinds*>));
static_assert(sizeof(slamgc::checked::rc_set<all_kinds>) == sizeof(std::set<all_kinds*>));
static_assert(sizeof(slamgc::checked::rc_map<all_kinds, int>) == sizeof(std::map<all_kinds*, int>));

// A static member is made before any program code.
slamgc::rc_slot<all_kinds> constant_initialized;
TEST(CheckDescription, StaticMembersAreConstants) {
  EXPECT_EQ(constant_initialized.get(), nullptr);
}

}  // namespace
