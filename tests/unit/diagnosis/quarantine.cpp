// Memory that is held back, and what is reported about it. The checked flavour, with reports that are recorded where a test
// wants to see them, and end the process as usual where it does not.
#undef SLAMGC_DEBUG
#include <string>
#include <vector>

namespace {

std::vector<std::string>* reports = nullptr;

template <class Misuse>
void report(const Misuse& m) {
  if (reports == nullptr) abort_on(m);
  reports->emplace_back(m.what);
}

}  // namespace

#define SLAMGC_ASSERT(condition, found) ((condition) ? void() : ::report(found))

#include <slamgc/diagnosis/quarantine.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <slamgc/mutex_counter.hpp>
#include <slamgc/slamgc.hpp>
#include <thread>

#include "support/instances.hpp"

#if __has_include(<Eigen/Core>)
#include <Eigen/Core>
#define SLAMGC_TEST_EIGEN 1
#elif __has_include(<eigen3/Eigen/Core>)
#include <eigen3/Eigen/Core>
#define SLAMGC_TEST_EIGEN 1
#endif

// Addresses of code, so that a test can tell where a stack leads. Not inlined, not cloned, and it returns from what it calls.
#if defined(__clang__)
#define PLACE(name) __attribute__((noinline, optnone, section("slamgc_" #name)))
#else
#define PLACE(name) __attribute__((noipa, section("slamgc_" #name)))
#endif
extern "C" const char __start_slamgc_retiring[] __attribute__((visibility("hidden")));
extern "C" const char __stop_slamgc_retiring[] __attribute__((visibility("hidden")));
extern "C" const char __start_slamgc_reclaiming[] __attribute__((visibility("hidden")));
extern "C" const char __stop_slamgc_reclaiming[] __attribute__((visibility("hidden")));

namespace {

using slamgc::quarantine;
using slamgc::quarantine_options;

// Its own, so that no other file of the program has these templates with another SLAMGC_ASSERT.
struct env : slamgc::std_env {};
using domain = slamgc::basic_domain<env>;
using mutator = slamgc::basic_mutator<env>;
using counter = slamgc::basic_fetch_add_counter<env>;
using slamgc::reclaim_at_zero;

constexpr unsigned char poison = 0xdd;

struct node : slamgc::rc_object<node, counter, slamgc::reclaim_deferred>, support::instances<node> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("next", next);
  }
  slamgc::rc_slot<node, env> next;
  std::uint64_t value = 1;
};
using borrowed = slamgc::borrow<node, env>;
using pointer = slamgc::intrusive_rc<node>;

PLACE(retiring) int retire_here(node* n) { return slamgc::retire(n) ? 1 : 2; }
PLACE(retiring) int drop_here(pointer& p) {
  p.reset();
  return p ? 1 : 2;
}
PLACE(reclaiming) std::size_t reclaim_here(domain& d) { return d.collect().reclaimed + 1; }

bool leads_through(const std::vector<void*>& stack, const char* begin, const char* end) {
  for (void* const frame : stack)
    if (static_cast<const char*>(frame) >= begin && static_cast<const char*>(frame) < end)
      return true;
  return false;
}
bool leads_through_retiring(const std::vector<void*>& stack) {
  return leads_through(stack, __start_slamgc_retiring, __stop_slamgc_retiring);
}
bool leads_through_reclaiming(const std::vector<void*>& stack) {
  return leads_through(stack, __start_slamgc_reclaiming, __stop_slamgc_reclaiming);
}

quarantine_options at_most(std::size_t objects) {
  quarantine_options o;
  o.objects = objects;
  return o;
}

class Quarantine : public ::testing::Test {
 protected:
  Quarantine() { reports = &recorded_; }
  ~Quarantine() override {
    EXPECT_TRUE(recorded_.empty()) << recorded_.front();
    reports = nullptr;
  }
  void expect(const std::string& what) {
    ASSERT_EQ(recorded_.size(), 1u);
    EXPECT_EQ(recorded_[0], what);
    recorded_.clear();
  }
  static void use_default_reports() { reports = nullptr; }
  // Made and reclaimed.
  node* gone() {
    const mutator m(domain_, "m", {false, false});
    auto* const n = new node;
    retire_here(n);
    EXPECT_EQ(reclaim_here(domain_), 2u);
    return n;
  }
  domain domain_;

 private:
  std::vector<std::string> recorded_;
};
using QuarantineDeathTest = Quarantine;

TEST_F(Quarantine, HoldsWhatWasReclaimed) {
  {
    const quarantine q;
    EXPECT_EQ(q.held(), 0u);
    gone();
    EXPECT_EQ(node::live(), 0);  // the destructor has run
    EXPECT_EQ(domain_.stats().total(&slamgc::type_stats::live), 0u);
    gone();
    EXPECT_EQ(q.held(), 2u);
    EXPECT_EQ(q.bytes(), 2 * sizeof(node));
    EXPECT_EQ(q.not_held(), 0u);
  }
  gone();
}

TEST_F(Quarantine, DoesNotUseMemoryAgain) {
  const quarantine q;
  node* const first = gone();
  for (int i = 0; i != 100; ++i) EXPECT_NE(gone(), first);
}

TEST_F(Quarantine, IsBounded) {
  const quarantine q(at_most(3));
  node* const first = gone();
  for (int i = 0; i != 3; ++i) {
    EXPECT_NE(q.history(first).object, nullptr) << i;
    gone();
  }
  EXPECT_EQ(q.history(first).object, nullptr);  // the oldest leaves
  EXPECT_EQ(q.held(), 3u);
}

TEST_F(Quarantine, IsBoundedInBytes) {
  quarantine_options o;
  o.bytes = 5 * sizeof(node) - 1;
  const quarantine q(o);
  for (int i = 0; i != 10; ++i) gone();
  EXPECT_EQ(q.held(), 4u);
  EXPECT_EQ(q.bytes(), 4 * sizeof(node));
}

TEST_F(Quarantine, KnowsBothPlacesOfARetiredObject) {
  const quarantine q;
  const mutator m(domain_, "m", {false, false});
  pointer p(new node);
  node* const n = p.get();
  retire_here(n);
  EXPECT_EQ(q.history(n).size, 0u);  // not reclaimed yet
  EXPECT_EQ(q.history(n).object, n);
  p.reset();
  ASSERT_EQ(reclaim_here(domain_), 2u);
  const slamgc::object_history h = q.history(&n->value);  // from inside, too
  EXPECT_EQ(h.object, n);
  EXPECT_EQ(h.size, sizeof(node));
  EXPECT_NE(std::strstr(h.type, "node"), nullptr);
  EXPECT_TRUE(h.was_retired);
#if defined(SLAMGC_HAS_EXECINFO)
  EXPECT_TRUE(leads_through_retiring(h.ended));
  EXPECT_FALSE(leads_through_reclaiming(h.ended));
  EXPECT_TRUE(leads_through_reclaiming(h.reclaimed));
  EXPECT_FALSE(leads_through_retiring(h.reclaimed));
#endif
  EXPECT_EQ(q.history(nullptr).object, nullptr);
  EXPECT_EQ(q.history(&h).object, nullptr);
}

TEST_F(Quarantine, KnowsWhoDroppedTheLastReference) {
  const quarantine q;
  const mutator m(domain_, "m", {false, false});
  pointer p(new node);
  const node* const n = p.get();
  drop_here(p);
  ASSERT_EQ(reclaim_here(domain_), 2u);
  const slamgc::object_history h = q.history(n);
  EXPECT_FALSE(h.was_retired);
#if defined(SLAMGC_HAS_EXECINFO)
  EXPECT_TRUE(leads_through_retiring(h.ended));
  EXPECT_TRUE(leads_through_reclaiming(h.reclaimed));
#endif
}

TEST_F(Quarantine, HoldsCyclesAndWhatTheyAloneReferTo) {
  const quarantine q;
  const mutator m(domain_, "m", {false, false});
  {
    const pointer a(new node);
    const pointer b(new node);
    a->next = b.get();
    b->next = a.get();
    slamgc::retire(a.get());
    slamgc::retire(b.get());
  }
  EXPECT_EQ(domain_.drain(), slamgc::waited::done);
  EXPECT_EQ(q.held(), 2u);
}

TEST_F(Quarantine, ARetirementOfAReclaimedObjectIsReported) {
  const quarantine q;
  node* const n = gone();
  const mutator m(domain_, "m");
  EXPECT_FALSE(slamgc::retire(n));
  expect("retires an object that was reclaimed");
}

TEST_F(Quarantine, ABorrowOfAReclaimedObjectIsReported) {
  const quarantine q;
  node* const n = gone();
  const mutator m(domain_, "m");
  const borrowed b = n;
  expect("borrows an object that was reclaimed");
  (void)b;
}

TEST_F(Quarantine, ASecondRetirementIsReportedOnDemandOnly) {
  const mutator m(domain_, "m", {false, false});
  pointer p(new node);
  {
    const quarantine q;
    EXPECT_TRUE(slamgc::retire(p.get()));
    EXPECT_FALSE(slamgc::retire(p.get()));
  }
  {
    quarantine_options o;
    o.double_retire = true;
    const quarantine q(o);
    EXPECT_FALSE(slamgc::retire(p.get()));
    expect("retires an object that was retired before");
  }
  EXPECT_FALSE(slamgc::retire(p.get()));
  p.reset();
  EXPECT_EQ(domain_.collect().reclaimed, 1u);
}

TEST_F(Quarantine, ASecondOneIsReportedAndDoesNothing) {
  const quarantine q;
  {
    const quarantine second;
    expect("starts a second quarantine");
    gone();
    EXPECT_EQ(second.held(), 0u);
  }
  gone();
  EXPECT_EQ(q.held(), 2u);
}

#if !defined(SLAMGC_HAS_ASAN)

// The header comes first; the state of a slot is one pointer.
constexpr std::size_t at_value = sizeof(node) - sizeof(std::uint64_t);
constexpr std::size_t at_next = at_value - sizeof(void*);

// Written by a thread that the library does not see, so not through the type.
void write(void* object, std::size_t offset) {
  unsigned char* volatile bytes = static_cast<unsigned char*>(object);
  bytes[offset] = 0x5a;
}

TEST_F(Quarantine, PoisonsWhatItHolds) {
  const quarantine q;
  node* const n = gone();
  unsigned char value[sizeof(n->value)];
  std::memcpy(value, reinterpret_cast<unsigned char*>(n) + at_value, sizeof(value));
  for (const unsigned char byte : value) EXPECT_EQ(byte, poison);
}

TEST_F(Quarantine, AWriteIsReportedOnceByCheck) {
  quarantine q;
  node* const one = gone();
  gone();
  node* const other = gone();
  EXPECT_EQ(q.check(), 0u);
  write(one, at_value);
  EXPECT_EQ(q.check(), 1u);
  expect("writes into an object that was reclaimed");
  EXPECT_EQ(q.check(), 0u);
  write(other, sizeof(node) - 1);
  EXPECT_EQ(q.check(), 1u);
  expect("writes into an object that was reclaimed");
}

TEST_F(Quarantine, AWriteIsReportedWhenTheObjectLeaves) {
  {
    const quarantine q(at_most(1));
    write(gone(), at_next);
    gone();
    expect("writes into an object that was reclaimed");
    write(gone(), at_value);
  }
  expect("writes into an object that was reclaimed");
}

TEST_F(Quarantine, ACountIsReportedAtOnceAndDoesNoHarm) {
  quarantine q;
  node* const n = gone();
  {
    const pointer p(n);
    expect("refers to an object that is being destroyed");
    EXPECT_EQ(q.check(), 1u);  // code of the unchecked flavour is found out by this
    expect("writes into an object that was reclaimed");
  }
  intrusive_ptr_release(n);
  expect("removes a reference that was never counted");
  EXPECT_EQ(domain_.collect().reclaimed, 0u);
}

TEST_F(QuarantineDeathTest, ReportsNameTheirPlaces) {
  const quarantine q(at_most(3));
  use_default_reports();
  node* const n = gone();
  write(n, sizeof(node) - 1);
  EXPECT_DEATH(
      { const pointer p(n); },
      "refers to an object that is being destroyed: object 0x.*node"
      "(.|\n)*the misuse was found here(.|\n)*it was retired here(.|\n)*it was reclaimed here"
      "(.|\n)*written to afterwards, first at byte ");
  EXPECT_DEATH(
      {
        quarantine mine(at_most(100));
        (void)mine;
      },
      "starts a second quarantine");
  EXPECT_DEATH(
      {
        for (int i = 0; i != 3; ++i) gone();
      },
      "writes into an object that was reclaimed(.|\n)*it was retired here(.|\n)*"
      "it was reclaimed here(.|\n)*written to afterwards");
  std::memset(reinterpret_cast<unsigned char*>(n) + at_value, poison, sizeof(n->value));
}

#else

TEST_F(QuarantineDeathTest, AddressSanitizerTrapsEveryUse) {
  const quarantine q;
  node* const n = gone();
  const char* const both =
      "use-after-poison(.|\n)*of the object of type .*node at 0x.* is known"
      "(.|\n)*it was retired here(.|\n)*it was reclaimed here";
  volatile std::uint64_t value = 0;
  EXPECT_DEATH(value = n->value, both);
  EXPECT_DEATH(n->value = value, both);
  EXPECT_DEATH({ const pointer p(n); }, both);
  EXPECT_DEATH(n->next = nullptr, both);
}

struct pooled : slamgc::rc_object<pooled, counter> {
  static void* operator new(std::size_t) { return memory; }
  static void operator delete(void*) noexcept {}
  alignas(16) static inline unsigned char memory[64] = {};
};

TEST_F(Quarantine, AddressSanitizerAllowsMemoryThatHasLeft) {
  {
    const quarantine q;
    slamgc::make_rc<pooled>().reset();
    EXPECT_EQ(__asan_region_is_poisoned(pooled::memory, sizeof(pooled)), pooled::memory);
  }
  EXPECT_EQ(__asan_region_is_poisoned(pooled::memory, sizeof(pooled)), nullptr);
}

#endif

TEST_F(QuarantineDeathTest, AStaleBorrowedPointerNamesItsPlaces) {
  const quarantine q;
  use_default_reports();
  mutator m(domain_, "m");
  const pointer p(new node);
  const borrowed b = p.get();
  m.quiescent();
  EXPECT_DEATH((void)b->value,
               "uses a borrowed pointer after a quiescent state(.|\n)*the misuse was found here"
               "(.|\n)*the pointer was borrowed here");
}

TEST_F(QuarantineDeathTest, ASecondRetirementNamesBothPlaces) {
  quarantine_options o;
  o.double_retire = true;
  const quarantine q(o);
  use_default_reports();
  const mutator m(domain_, "m");
  const pointer p(new node);
  slamgc::retire(p.get());
  EXPECT_DEATH(slamgc::retire(p.get()),
               "retired before(.|\n)*the misuse was found here(.|\n)*it was retired here");
}

TEST_F(Quarantine, IsUsedByManyThreads) {
  quarantine q(at_most(50));
  std::atomic<int> at_work{3};
  std::thread others[3];
  for (std::thread& t : others)
    t = std::thread([&] {
      mutator m(domain_, "m");
      for (int i = 0; i != 300; ++i) {
        {
          const borrowed b = new node;
          slamgc::retire(b.get());
        }
        m.quiescent();
        (void)domain_.collect();
        EXPECT_EQ(q.check(), 0u);
      }
      --at_work;
    });
  for (std::thread& t : others) t.join();
  EXPECT_EQ(domain_.drain(), slamgc::waited::done);
  EXPECT_EQ(q.held(), 50u);
  EXPECT_EQ(node::live(), 0);
}

// ---- memory goes back where it came from

template <class T>
struct freed {
  static inline int times = 0;
  static inline void* last = nullptr;
  static inline std::size_t size = 0;
  static void note(void* p, std::size_t n) {
    ++times;
    last = p;
    size = n;
  }
};

// Held back, and freed with `size`.
template <class T>
void expect_held(std::size_t size) {
  const int before = freed<T>::times;
  void* object = nullptr;
  {
    const quarantine q;
    auto p = slamgc::make_rc<T>();
    object = p.get();
    p.reset();
    EXPECT_EQ(q.held(), 1u);
    EXPECT_EQ(freed<T>::times, before);
  }
  EXPECT_EQ(freed<T>::times, before + 1);
  EXPECT_EQ(freed<T>::last, object);
  EXPECT_EQ(freed<T>::size, size);
}
// Deleted as usual.
template <class T, class P = T>
void expect_deleted() {
  const int before = freed<P>::times;
  const quarantine q;
  slamgc::intrusive_rc<T>(new P).reset();
  EXPECT_EQ(q.held(), 0u);
  EXPECT_EQ(q.not_held(), 1u);
  EXPECT_EQ(freed<P>::times, before + 1);
}

struct plain_delete : slamgc::rc_object<plain_delete, counter> {
  static void operator delete(void* p) noexcept {
    freed<plain_delete>::note(p, 1);
    ::operator delete(p);
  }
  static void operator delete(void*, std::size_t) noexcept { ADD_FAILURE() << "the plain one"; }
};
TEST_F(Quarantine, FreesByThePlainMember) { expect_held<plain_delete>(1); }

struct sized_delete : slamgc::rc_object<sized_delete, counter> {
  static void operator delete(void* p, std::size_t size) noexcept {
    freed<sized_delete>::note(p, size);
    ::operator delete(p);
  }
  char payload[100] = {};
};
TEST_F(Quarantine, FreesByTheSizedMember) { expect_held<sized_delete>(sizeof(sized_delete)); }

struct aligned_delete : slamgc::rc_object<aligned_delete, counter> {
  static void operator delete(void*) noexcept { ADD_FAILURE() << "the aligned one"; }
  static void operator delete(void* p, std::align_val_t alignment) noexcept {
    freed<aligned_delete>::note(p, static_cast<std::size_t>(alignment));
    ::operator delete(p, alignment);
  }
  alignas(64) char payload[100] = {};
};
TEST_F(Quarantine, FreesByTheAlignedMember) { expect_held<aligned_delete>(64); }

struct sized_aligned_delete : slamgc::rc_object<sized_aligned_delete, counter> {
  static void operator delete(void* p, std::size_t size, std::align_val_t alignment) noexcept {
    freed<sized_aligned_delete>::note(p, size);
    ::operator delete(p, alignment);
  }
  alignas(64) char payload[100] = {};
};
TEST_F(Quarantine, FreesByTheSizedAlignedMember) {
  expect_held<sized_aligned_delete>(sizeof(sized_aligned_delete));
}

// As EIGEN_MAKE_ALIGNED_OPERATOR_NEW does: with forms for other purposes, and none of them for over-aligned types.
struct with_placement : slamgc::rc_object<with_placement, counter> {
  static void* operator new(std::size_t size) { return ::operator new(size); }
  static void* operator new(std::size_t, void* p) { return p; }
  static void operator delete(void* p) noexcept {
    freed<with_placement>::note(p, 1);
    ::operator delete(p);
  }
  static void operator delete(void*, const std::nothrow_t&) noexcept { ADD_FAILURE(); }
  static void operator delete(void*, void*) noexcept { ADD_FAILURE(); }
};
TEST_F(Quarantine, FreesByNoOtherForm) { expect_held<with_placement>(1); }

template <class T>
struct counts_frees {
  static void operator delete(void* p, std::size_t size) noexcept {
    freed<T>::note(p, size);
    ::operator delete(p);
  }
};
struct inherits_delete : counts_frees<inherits_delete>,
                         slamgc::rc_object<inherits_delete, counter> {
  std::uint64_t value = 0;
};
TEST_F(Quarantine, FreesByTheMemberOfABase) {
  expect_held<inherits_delete>(sizeof(inherits_delete));
}

template <class Policy>
struct no_member : slamgc::rc_object<no_member<Policy>, Policy> {
  std::string text = std::string(100, 'x');
};
struct over_aligned : slamgc::rc_object<over_aligned, counter> {
  alignas(128) double pose[16] = {};
};
struct other_base {
  virtual ~other_base() = default;
  int number = 1;
};
struct second_base final : other_base, slamgc::rc_object<second_base, counter> {};
TEST_F(Quarantine, FreesByTheGlobalOne) {  // AddressSanitizer would notice another
  quarantine q;
  slamgc::make_rc<no_member<counter>>().reset();
  slamgc::make_rc<no_member<slamgc::basic_mutex_counter<env, std::mutex>>>().reset();
  slamgc::make_rc<over_aligned>().reset();
  slamgc::make_rc<second_base>().reset();
  EXPECT_EQ(q.held(), 4u);
  EXPECT_EQ(q.check(), 0u);
}

#ifdef SLAMGC_TEST_EIGEN
struct eigen_keyframe : slamgc::rc_object<eigen_keyframe, counter> {
  EIGEN_MAKE_ALIGNED_OPERATOR_NEW
  Eigen::Matrix4f pose = Eigen::Matrix4f::Identity();
};
TEST_F(Quarantine, FreesByEigensMember) {
  const quarantine q;
  slamgc::make_rc<eigen_keyframe>().reset();
  EXPECT_EQ(q.held(), 1u);
}
#endif

struct base : slamgc::rc_object<base, counter> {
  virtual ~base() = default;
  static void operator delete(void* p, std::size_t size) noexcept {
    freed<base>::note(p, size);
    ::operator delete(p);
  }
};
struct derived : base {
  static void operator delete(void* p, std::size_t size) noexcept {
    freed<derived>::note(p, size);
    ::operator delete(p);
  }
  long more = 0;
};
TEST_F(Quarantine, ATypeWithAVirtualDestructorIsHeldIfItIsTheMostDerivedOne) {
#if defined(__cpp_rtti)
  expect_held<base>(sizeof(base));
#else
  expect_deleted<base>();
#endif
  expect_deleted<base, derived>();
}

struct final_type final : slamgc::rc_object<final_type, counter> {
  virtual ~final_type() = default;
  static void operator delete(void* p, std::size_t size) noexcept {
    freed<final_type>::note(p, size);
    ::operator delete(p);
  }
};
TEST_F(Quarantine, AFinalTypeIsHeld) { expect_held<final_type>(sizeof(final_type)); }

class private_destructor : public slamgc::rc_object<private_destructor, counter> {
 public:
  private_destructor() = default;
  static void operator delete(void* p, std::size_t size) noexcept {
    freed<private_destructor>::note(p, size);
    ::operator delete(p);
  }

 private:
  friend void slamgc::destroy_object<>(private_destructor*) noexcept;
  ~private_destructor() = default;
};
TEST_F(Quarantine, ATypeWithAPrivateDestructorIsDeleted) { expect_deleted<private_destructor>(); }

#if defined(__cpp_lib_destroying_delete)
struct destroys_itself : slamgc::rc_object<destroys_itself, counter> {
  static void operator delete(destroys_itself* p, std::destroying_delete_t) noexcept {
    p->~destroys_itself();
    freed<destroys_itself>::note(p, 0);
    ::operator delete(p);
  }
};
TEST_F(Quarantine, ATypeWithADestroyingDeleteIsDeleted) { expect_deleted<destroys_itself>(); }
#endif

// ---- other reclaimers

struct scanned : slamgc::rc_object<scanned, counter, slamgc::reclaim_by_scan>,
                 support::instances<scanned> {};

TEST_F(Quarantine, HoldsWhatAScanReclaims) {
  const quarantine q;
  slamgc::retire_set<scanned> set;
  auto* const s = new scanned;
  set.insert(s);
  EXPECT_TRUE(q.history(s).was_retired);
  EXPECT_EQ(set.scan(), 1u);
  EXPECT_EQ(q.held(), 1u);
  EXPECT_EQ(scanned::live(), 0);
#if !defined(SLAMGC_HAS_ASAN)
  EXPECT_FALSE(set.insert(s));
#endif
}

}  // namespace
