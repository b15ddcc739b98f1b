// What is reported when slamgc is misused, in a program that replaces SLAMGC_ASSERT and goes on.
#undef SLAMGC_DEBUG
#include <cstdint>
#include <string>
#include <vector>

namespace {

struct report {
  std::string what;
  std::string type;
  const void* object;
  std::uint32_t count;
};
std::vector<report> reports;

template <class Misuse>
void record(const Misuse& m) {
  reports.push_back({m.what, m.type, m.object, m.count});
}

}  // namespace

#define SLAMGC_ASSERT(condition, found) ((condition) ? void() : ::record(found))

#include <gtest/gtest.h>

#include <optional>
#include <slamgc/slamgc.hpp>

#include <functional>
#include <type_traits>

namespace {

using slamgc::intrusive_rc;
using slamgc::make_rc;

static_assert(std::is_same<slamgc::misuse, slamgc::checked::misuse>::value,
              "bringing an assertion turns the checks on");

struct misused_node : slamgc::rc_object<misused_node> {
  virtual ~misused_node() {
    if (at_end) at_end();
  }
  std::function<void()> at_end;
};
struct derived_node : misused_node {};

// At the end of the object only its base class is left to be named.
const void* base_of(const misused_node* o) {
  return static_cast<const slamgc::rc_object<misused_node>*>(o);
}

class Assert : public ::testing::Test {
 protected:
  Assert() { reports.clear(); }

  // The one report, which names the object.
  static void expect_report(const std::string& what, const void* object, std::uint32_t count) {
    ASSERT_EQ(reports.size(), 1u);
    EXPECT_EQ(reports[0].what, what);
    EXPECT_NE(reports[0].type.find("misused_node"), std::string::npos) << reports[0].type;
    EXPECT_EQ(reports[0].object, object);
    EXPECT_EQ(reports[0].count, count);
    reports.clear();
  }
};

TEST_F(Assert, CorrectUseIsNotReported) {
  auto p = make_rc<misused_node>();
  intrusive_rc<misused_node> q = p;
  slamgc::rc_slot<misused_node> slot(q);
  q = intrusive_rc<misused_node>::adopt(p.detach());
  p.reset(q.detach(), false);
  intrusive_rc<misused_node>(nullptr, false).reset();
  slot = nullptr;
  p.reset();
  { const misused_node on_the_stack; }
  EXPECT_TRUE(reports.empty());
}

TEST_F(Assert, ADropWithoutAReferenceIsReportedAndUndone) {
  const misused_node o;
  const auto before = o.state();
  intrusive_ptr_release(&o);
  expect_report("removes a reference that was never counted", &o, 0);
  EXPECT_EQ(o.state().bits, before.bits);
}

TEST_F(Assert, AdoptingWhatNobodyCountedIsReported) {
  misused_node o;
  auto p = intrusive_rc<misused_node>::adopt(&o);
  expect_report("adopts a reference that nobody counted", &o, 0);
  (void)p.detach();
  p.reset(&o, false);
  expect_report("adopts a reference that nobody counted", &o, 0);
  (void)p.detach();
}

TEST_F(Assert, AReferenceToAnObjectInItsDestructorIsReported) {
  auto* const o = new misused_node;
  o->at_end = [o] {
    intrusive_rc<misused_node> self(o);
    expect_report("refers to an object that is being destroyed", o, 0);
    (void)self.detach();
  };
  const void* const base = base_of(o);
  intrusive_rc<misused_node>(o).reset();
  expect_report("destroys an object that is still referred to", base, 1);
}

TEST_F(Assert, AdoptingAnObjectInItsDestructorIsReported) {
  auto* const o = new misused_node;
  o->at_end = [o] {
    intrusive_ptr_add_ref(o);
    expect_report("refers to an object that is being destroyed", o, 0);
    auto self = intrusive_rc<misused_node>::adopt(o);
    expect_report("adopts a reference that nobody counted", o, 1);
    (void)self.detach();
  };
  const void* const base = base_of(o);
  intrusive_rc<misused_node>(o).reset();
  expect_report("destroys an object that is still referred to", base, 1);
}

TEST_F(Assert, AnAssignmentInTheDestructorIsReported) {
  auto* const o = new misused_node;
  slamgc::rc_slot<misused_node> slot;
  o->at_end = [&] {
    slot = o;
    expect_report("refers to an object that is being destroyed", o, 0);
    (void)slot.exchange(nullptr).detach();
    reports.clear();  // that adopts a dying object, too
  };
  const void* const base = base_of(o);
  intrusive_rc<misused_node>(o).reset();
  expect_report("destroys an object that is still referred to", base, 1);
}

TEST_F(Assert, DestroyingAReferencedObjectIsReported) {
  std::optional<misused_node> o(std::in_place);
  intrusive_rc<misused_node> p(&*o);
  const void* const base = base_of(&*o);
  o.reset();
  expect_report("destroys an object that is still referred to", base, 1);
  (void)p.detach();
}

TEST_F(Assert, ADerivedObjectIsReportedAsTheTypeThatIsCounted) {
  const derived_node o;
  intrusive_ptr_release(&o);
  expect_report("removes a reference that was never counted", &o, 0);
}

template <class T>
struct wrapped {};

TEST(TypeName, SpellsTheType) {
  using slamgc::detail::type_name;
  EXPECT_STREQ(type_name<int>::get(), "int");
  const std::string of_report = type_name<report>::get();
  EXPECT_EQ(of_report.substr(of_report.rfind(':') + 1), "report");
  const std::string of_array = type_name<wrapped<int[3]>>::get();
  EXPECT_NE(of_array.find("wrapped<int"), std::string::npos) << of_array;
  EXPECT_EQ(of_array.substr(of_array.size() - 4), "[3]>");
}

}  // namespace
