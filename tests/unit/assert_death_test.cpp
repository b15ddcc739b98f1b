// The default of SLAMGC_ASSERT: one line that names what was done to which object, and the end.
#undef SLAMGC_DEBUG
#define SLAMGC_DEBUG 1

#include <gtest/gtest.h>
#include <slamgc/slamgc.hpp>

#include <type_traits>

// A forked ThreadSanitizer process may hang.
#if defined(__SANITIZE_THREAD__)
#define SLAMGC_TEST_DEATH 0
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define SLAMGC_TEST_DEATH 0
#endif
#endif
#ifndef SLAMGC_TEST_DEATH
#define SLAMGC_TEST_DEATH 1
#endif

#if SLAMGC_TEST_DEATH

namespace {

using slamgc::intrusive_rc;

static_assert(std::is_same<slamgc::misuse, slamgc::checked::misuse>::value);

struct node : slamgc::rc_object<node> {
  node() = default;
  explicit node(void (*f)(node&)) : at_end(f) {}
  ~node() {
    if (at_end != nullptr) at_end(*this);
  }
  void (*at_end)(node&) = nullptr;
};

TEST(AssertDeathTest, ADropWithoutAReference) {
  const node o;
  EXPECT_DEATH(intrusive_ptr_release(&o),
               "slamgc: removes a reference that was never counted: object 0x[0-9a-f]+ of type "
               ".*node, count 0");
}

TEST(AssertDeathTest, AdoptingWhatNobodyCounted) {
  node o;
  EXPECT_DEATH((void)intrusive_rc<node>::adopt(&o),
               "slamgc: adopts a reference that nobody counted: object .* of type .*node, count 0");
}

TEST(AssertDeathTest, AReferenceToAnObjectInItsDestructor) {
  const auto refer = [](node& o) { const intrusive_rc<node> self(&o); };
  EXPECT_DEATH(intrusive_rc<node>(new node(refer)).reset(),
               "slamgc: refers to an object that is being destroyed: object .* of type .*node");
}

TEST(AssertDeathTest, DestroyingAReferencedObject) {
  EXPECT_DEATH(
      {
        const node o;
        intrusive_ptr_add_ref(&o);
      },
      "slamgc: destroys an object that is still referred to: object .* of type .*node, count 1");
}

TEST(AssertDeathTest, ASecondEdit) {
  slamgc::rc_vector<node> v;
  EXPECT_DEATH(
      {
        const auto first = v.edit();
        const auto second = v.edit();
      },
      "slamgc: edits a container that is being edited");
}

}  // namespace

#endif
