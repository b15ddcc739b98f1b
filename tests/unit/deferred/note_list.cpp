// The collector's queue: order, reuse, and what it keeps.
#include <slamgc/detail/note_list.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <random>

namespace {

using list = slamgc::detail::note_list<std::size_t>;

void fill_and_empty(list& l, std::size_t n) {
  EXPECT_TRUE(l.empty());
  for (std::size_t i = 0; i != n; ++i) ASSERT_TRUE(l.add(i));
  EXPECT_EQ(l.empty(), n == 0);
  for (std::size_t i = 0; i != n; ++i) {
    ASSERT_FALSE(l.empty());
    ASSERT_EQ(l.take(), i);
  }
  EXPECT_TRUE(l.empty());
}

TEST(NoteList, GivesBackInTheOrderOfAddingAtEveryLength) {
  list l;
  for (std::size_t n = 0; n != 100; ++n) fill_and_empty(l, n);
  for (const std::size_t n :
       {1000u, 1022u, 1023u, 1024u, 1054u, 1055u, 1056u, 2078u, 2079u, 10000u})
    fill_and_empty(l, n);
}

TEST(NoteList, IsUsedAgainWithAnyLengths) {
  std::minstd_rand random(1);
  list l;
  for (int i = 0; i != 100; ++i) fill_and_empty(l, random() % 4000);
}

TEST(NoteList, ATakeMayPauseAtAnyPlace) {
  // A call of collect() that uses its budget up leaves notes behind.
  list l;
  for (std::size_t n = 0; n != 3000; ++n) ASSERT_TRUE(l.add(n));
  std::size_t next = 0;
  for (std::size_t stop = 1; next != 3000; ++stop)
    for (const std::size_t end = std::min<std::size_t>(next + stop, 3000); next != end; ++next)
      ASSERT_EQ(l.take(), next);
  EXPECT_TRUE(l.empty());
}

TEST(NoteList, APrefetchIsOfAPlaceInTheList) {
  list l;
  for (std::size_t n = 0; n != 3000; ++n) ASSERT_TRUE(l.add(n));
  for (std::size_t n = 0; n != 3000; ++n) {
    if (const std::size_t* const soon = l.soon()) {
      ASSERT_LE(*soon, 3000u);  // readable
    }
    ASSERT_EQ(l.take(), n);
  }
}

TEST(NoteList, EachNoteThatIsLeft) {
  for (const std::size_t n : {0u, 1u, 32u, 33u, 1055u, 1056u, 5000u}) {
    list l;
    for (std::size_t i = 0; i != n; ++i) ASSERT_TRUE(l.add(i));
    for (std::size_t taken = 0; taken <= n; ++taken) {
      if (n < 2000 || taken % 97 == 0) {
        std::size_t expected = taken;
        l.each([&](std::size_t note) { ASSERT_EQ(note, expected++); });
        ASSERT_EQ(expected, n) << taken;
      }
      if (taken != n) {
        ASSERT_EQ(l.take(), taken);
      }
    }
  }
}

TEST(NoteList, MayEndWithNotes) {
  for (const std::size_t n : {1u, 33u, 5000u}) {
    list l;
    for (std::size_t i = 0; i != n; ++i) ASSERT_TRUE(l.add(i));
    for (std::size_t i = 0; i != n / 2; ++i) ASSERT_EQ(l.take(), i);
  }  // the leak check has the last word
}

}  // namespace
