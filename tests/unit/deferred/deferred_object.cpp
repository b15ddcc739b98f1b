// What a deferred reclaimer adds to a class: nothing but that making an object may throw.
#include <slamgc/deferred.hpp>

#include <gtest/gtest.h>

#include <type_traits>

namespace {

struct plain : slamgc::rc_object<plain> {};
struct waits : slamgc::rc_object<waits, slamgc::fetch_add_counter, slamgc::reclaim_deferred> {};
struct stays : slamgc::rc_object<stays, slamgc::fetch_add_counter, slamgc::reclaim_retired> {};

TEST(DeferredObject, IsAsLargeAsAnyOther) {
  EXPECT_EQ(sizeof(waits), sizeof(plain));
  EXPECT_EQ(sizeof(stays), sizeof(plain));
  EXPECT_FALSE(std::is_polymorphic<waits>::value);
}

TEST(DeferredObject, MayThrowWhenItIsMade) {
  EXPECT_TRUE(std::is_nothrow_default_constructible<plain>::value);
  EXPECT_FALSE(std::is_nothrow_default_constructible<waits>::value);
  EXPECT_FALSE(std::is_nothrow_copy_constructible<stays>::value);
  EXPECT_TRUE(std::is_nothrow_destructible<waits>::value);
  EXPECT_TRUE(std::is_nothrow_copy_assignable<waits>::value);
}

}  // namespace
