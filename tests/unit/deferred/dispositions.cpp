// What becomes of the edges to retired objects: each disposition on each member, wherever the member is.
#include "slamgc/dispositions.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <functional>
#include <list>
#include <optional>
#include <set>
#include <slamgc/slamgc.hpp>
#include <string>
#include <type_traits>
#include <vector>

#include "support/instances.hpp"

namespace {

namespace on_retire = slamgc::on_retire;
using slamgc::waited;

struct item : slamgc::rc_object<item, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
              support::instances<item> {
  explicit item(int i) : id(i) {}
  virtual ~item() = default;
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("next", next);
  }
  const int id;
  slamgc::rc_slot<item> next;
};
struct special : item {
  using item::item;
};

// Who purges the member: a collector, or the owner of the root.
enum class purger { collector, owner_is_quiescent, owner_goes_offline };
constexpr purger purgers[] = {purger::collector, purger::owner_is_quiescent,
                              purger::owner_goes_offline};

// Item i has the number i; fill(place, items) refers to them, those of @p dead are retired and purged.
template <class Place>
using action = std::function<void(Place&, const std::vector<special*>&)>;
template <class Place>
void purge(int n, const std::set<int>& dead, const action<Place>& fill,
           const action<Place>& check) {
  for (const purger way : purgers) {
    SCOPED_TRACE(static_cast<int>(way));
    slamgc::domain domain;
    slamgc::mutator me(domain, "test", {false, false});
    std::vector<special*> all;
    std::optional<Place> made(std::in_place);
    Place& place = *made;
    {
      std::optional<slamgc::root> root;
      {
        const slamgc::mutator::online_scope scope(me);
        for (int i = 0; i != n; ++i) all.push_back(new special(i));
        fill(place, all);
        if (way == purger::collector) {
          root.emplace(domain, "place", place);
        } else {
          root.emplace(me, "place", place);
        }
        for (const int i : dead) slamgc::retire(all[static_cast<std::size_t>(i)]);
        if (way == purger::owner_is_quiescent) {
          for (int i = 0; i != 10; ++i) {
            (void)domain.collect();
            me.quiescent();
          }
          check(place, all);
        } else if (way == purger::owner_goes_offline) {
          for (int i = 0; i != 3; ++i) {
            (void)domain.collect();
            if (i == 0) me.quiescent();
          }
        }
      }
      ASSERT_EQ(domain.drain(), waited::done);
      check(place, all);
    }
    {
      const slamgc::mutator::online_scope scope(me);
      for (int i = 0; i != n; ++i)
        if (dead.count(i) == 0) slamgc::retire(all[static_cast<std::size_t>(i)]);
      made.reset();
    }
    ASSERT_EQ(domain.drain(), waited::done);
    EXPECT_EQ(item::live(), 0) << "every reference was dropped once";
  }
}

template <class Range>
std::vector<int> ids(const Range& range) {
  std::vector<int> found;
  for (auto* p : range) found.push_back(p != nullptr ? p->id : -1);
  return found;
}
std::vector<int> all_but(int n, const std::set<int>& dead) {
  std::vector<int> left;
  for (int i = 0; i != n; ++i)
    if (dead.count(i) == 0) left.push_back(i);
  return left;
}
const std::set<int> some{0, 2, 3, 7, 9};

// A place with one member.
template <class Member, class Disposition>
struct place_of {
  Member member;
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("member", member, Disposition());
  }
};

template <class Slot>
class DispositionOfSlot : public ::testing::Test {};
using slots = ::testing::Types<slamgc::rc_slot<item>, slamgc::rc_slot<const item>,
                               slamgc::rc_slot<special>, slamgc::atomic_rc<item>>;
TYPED_TEST_SUITE(DispositionOfSlot, slots, );

template <class Slot>
void fill_slot(Slot& slot, special* p) {
  if constexpr (std::is_same<Slot, slamgc::atomic_rc<item>>::value)
    slot.store(slamgc::intrusive_rc<item>(p));
  else
    slot = p;
}

TYPED_TEST(DispositionOfSlot, NullMakesItNull) {
  using place = place_of<TypeParam, on_retire::null_edge>;
  purge<place>(
      2, {0}, [](place& at, const auto& all) { fill_slot(at.member, all[0]); },
      [](place& at, const auto&) {
        EXPECT_EQ(at.member.get(), nullptr);
        EXPECT_EQ(item::live(), 1);
      });
  purge<place>(
      2, {0}, [](place& at, const auto& all) { fill_slot(at.member, all[1]); },
      [](place& at, const auto& all) {
        EXPECT_EQ(at.member.get(), all[1]) << "it is not stale";
        EXPECT_EQ(item::live(), 1);
      });
}

TYPED_TEST(DispositionOfSlot, HoldKeepsTheObject) {
  using place = place_of<TypeParam, on_retire::hold_edge>;
  purge<place>(
      2, {0}, [](place& at, const auto& all) { fill_slot(at.member, all[0]); },
      [](place& at, const auto& all) {
        EXPECT_EQ(at.member.get(), all[0]);
        EXPECT_EQ(item::live(), 2);
      });
}

template <class Slot>
struct bypassing {
  Slot member;
  int asked = 0;
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("member", member, on_retire::bypass([this](auto& retired) {
             ++asked;
             return static_cast<decltype(member.get())>(static_cast<special*>(retired.next.get()));
           }));
  }
};

TYPED_TEST(DispositionOfSlot, BypassStepsOverAChain) {
  using place = bypassing<TypeParam>;
  const auto chain = [](place& at, const auto& all) {
    for (std::size_t i = 0; i + 1 != all.size(); ++i) all[i]->next = all[i + 1];
    fill_slot(at.member, all[0]);
  };
  for (int dead = 0; dead != 8; ++dead) {
    SCOPED_TRACE(dead);
    std::set<int> all_dead;
    for (int i = 0; i != dead; ++i) all_dead.insert(i);
    purge<place>(8, all_dead, chain, [dead](place& at, const auto&) {
      ASSERT_NE(at.member.get(), nullptr);
      EXPECT_EQ(at.member.get()->id, dead);
      EXPECT_EQ(item::live(), 8 - dead);
    });
  }
}

TYPED_TEST(DispositionOfSlot, BypassOfAChainThatEnds) {
  using place = bypassing<TypeParam>;
  purge<place>(
      5, {0, 1, 2, 3, 4},
      [](place& at, const auto& all) {
        for (std::size_t i = 0; i != 4; ++i) all[i]->next = all[i + 1];
        fill_slot(at.member, all[0]);
      },
      [](place& at, const auto&) {
        EXPECT_EQ(at.member.get(), nullptr);
        EXPECT_EQ(item::live(), 0);
      });
}

// Told of what goes, while it is there.
template <class Slot>
struct announcing_slot {
  Slot member;
  std::vector<int> told;
  template <class Visitor>
  void edges(Visitor& v) {
    const auto tell = [this](auto& retired) {
      EXPECT_EQ(member.get(), &retired);
      told.push_back(retired.id);
    };
    v.edge("member", member, on_retire::announce(tell, on_retire::null));
  }
};

TYPED_TEST(DispositionOfSlot, AnnounceTellsOnce) {
  using place = announcing_slot<TypeParam>;
  for (const int dead : {0, 1})
    purge<place>(
        2, {dead}, [](place& at, const auto& all) { fill_slot(at.member, all[0]); },
        [dead](place& at, const auto&) {
          EXPECT_EQ(at.member.get() == nullptr, dead == 0);
          EXPECT_EQ(at.told, dead == 0 ? std::vector<int>{0} : std::vector<int>{});
        });
}

// Circles with a tail of every length.
TYPED_TEST(DispositionOfSlot, BypassOfACircleGivesNull) {
  using place = bypassing<TypeParam>;
  for (std::size_t tail = 0; tail != 5; ++tail)
    for (std::size_t circle = 1; circle != 6; ++circle) {
      SCOPED_TRACE(std::to_string(tail) + " and " + std::to_string(circle));
      std::set<int> dead;
      for (std::size_t i = 0; i != tail + circle; ++i) dead.insert(static_cast<int>(i));
      purge<place>(
          static_cast<int>(tail + circle), dead,
          [tail](place& at, const auto& all) {
            for (std::size_t i = 0; i != all.size(); ++i)
              all[i]->next = i + 1 == all.size() ? all[tail] : all[i + 1];
            fill_slot(at.member, all[0]);
          },
          [](place& at, const auto& all) {
            EXPECT_EQ(at.member.get(), nullptr);
            EXPECT_LE(at.asked, static_cast<int>(4 * all.size() + 4));
            EXPECT_EQ(item::live(), 0);
          });
    }
}

// ---- containers

struct by_id {
  template <class T>
  bool operator()(const T* a, const T* b) const noexcept {
    return a->id < b->id;
  }
};
struct hash_of_id {
  template <class T>
  std::size_t operator()(const T* p) const noexcept {
    return static_cast<std::size_t>(p->id % 7);
  }
};

template <class T>
struct counting_allocator {
  using value_type = T;
  counting_allocator() = default;
  template <class U>
  counting_allocator(const counting_allocator<U>&) noexcept {}
  T* allocate(std::size_t n) {
    ++blocks;
    return static_cast<T*>(::operator new(n * sizeof(T)));
  }
  void deallocate(T* p, std::size_t) noexcept {
    --blocks;
    ::operator delete(p);
  }
  friend bool operator==(counting_allocator, counting_allocator) { return true; }
  friend bool operator!=(counting_allocator, counting_allocator) { return false; }
  static inline long blocks = 0;
};

template <class Container>
void put(Container& into, special* p) {
  using value = typename Container::value_type;
  if constexpr (std::is_pointer<value>::value)
    into.insert(into.end(), p);
  else if constexpr (std::is_convertible<special*, typename Container::key_type>::value)
    into.emplace(p, std::string("of ") + std::to_string(p->id));
  else
    into.insert_or_assign(p->id, p);
}
template <class Container>
std::vector<int> ids_in(const Container& container) {
  std::vector<int> found;
  for (const auto& value : container.raw()) {
    if constexpr (std::is_pointer<typename Container::value_type>::value)
      found.push_back(value->id);
    else if constexpr (std::is_pointer<typename Container::key_type>::value)
      found.push_back(value.first->id);
    else
      found.push_back(value.second->id);
  }
  std::sort(found.begin(), found.end());
  return found;
}

template <class Container>
class DispositionOfContainer : public ::testing::Test {};
using containers = ::testing::Types<
    slamgc::rc_vector<const item>, slamgc::rc_list<item, counting_allocator<item*>>,
    slamgc::rc_set<item>, slamgc::rc_set<const item, by_id>, slamgc::rc_map<special, std::string>,
    slamgc::rc_value_map<long, const item, std::greater<long>>,
    slamgc::rc_unordered_set<const item, hash_of_id>, slamgc::rc_unordered_map<item, std::string>>;
TYPED_TEST_SUITE(DispositionOfContainer, containers, );

// Few elements are walked; of many, few stuck ones are looked up (by a collector).
TYPED_TEST(DispositionOfContainer, EraseTakesTheStaleOnesOut) {
  using place = place_of<TypeParam, on_retire::erase_edge>;
  for (const int n : {10, 300})
    for (const std::set<int>& dead : {some, std::set<int>{3}, std::set<int>{}}) {
      SCOPED_TRACE(n);
      purge<place>(
          n, dead,
          [](place& at, const auto& all) {
            for (special* p : all) put(at.member, p);
          },
          [&](place& at, const auto&) {
            EXPECT_EQ(ids_in(at.member), all_but(n, dead));
            EXPECT_EQ(item::live(), n - static_cast<int>(dead.size()));
          });
    }
}

template <class Container>
struct announcing_container {
  Container member;
  std::vector<int> told;
  template <class Visitor>
  void edges(Visitor& v) {
    const auto tell = [this](auto& retired) { told.push_back(retired.id); };
    v.edge("member", member, on_retire::announce(tell, on_retire::erase));
  }
};

TYPED_TEST(DispositionOfContainer, AnnounceTellsOfEachThatGoes) {
  using place = announcing_container<TypeParam>;
  for (const int n : {10, 300})
    for (const std::set<int>& dead : {some, std::set<int>{3}, std::set<int>{}}) {
      SCOPED_TRACE(n);
      purge<place>(
          n, dead,
          [](place& at, const auto& all) {
            for (special* p : all) put(at.member, p);
          },
          [&](place& at, const auto&) {
            EXPECT_EQ(ids_in(at.member), all_but(n, dead));
            std::sort(at.told.begin(), at.told.end());
            EXPECT_EQ(at.told, std::vector<int>(dead.begin(), dead.end()));
          });
    }
}

TYPED_TEST(DispositionOfContainer, HoldKeepsThem) {
  using place = place_of<TypeParam, on_retire::hold_edge>;
  purge<place>(
      10, some,
      [](place& at, const auto& all) {
        for (special* p : all) put(at.member, p);
      },
      [&](place& at, const auto&) {
        EXPECT_EQ(ids_in(at.member), all_but(10, {}));
        EXPECT_EQ(item::live(), 10);
      });
}

struct numbered_items {
  slamgc::rc_set<item, by_id> numbered;
  slamgc::rc_slot<item> elsewhere;
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("numbered", numbered, on_retire::erase);
    v.edge("elsewhere", elsewhere, on_retire::null);
  }
};

// A look-up finds the object itself, not one that the comparator takes for the same.
TEST(Dispositions, EraseSparesWhatIsOnlyEquivalent) {
  slamgc::domain domain;
  slamgc::mutator me(domain, "test", {false, false});
  numbered_items at;
  const slamgc::root root(domain, "place", at);
  slamgc::intrusive_rc<item> twin;
  {
    const slamgc::mutator::online_scope scope(me);
    for (int i = 0; i != 100; ++i) at.numbered.insert(new item(i));
    twin = new item(5);  // another one with this number
    at.elsewhere = twin.get();
    slamgc::retire(twin.get());
  }
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(at.elsewhere, nullptr);
  EXPECT_EQ(at.numbered.size(), 100U);
  twin.reset();
  {
    const slamgc::mutator::online_scope scope(me);
    for (item* p : at.numbered) slamgc::retire(p);
  }
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(item::live(), 0);
}

// The key of an rc_value_map is not the edge, even if it looks like one.
TEST(Dispositions, EraseLooksAtTheValuesOfAValueMap) {
  using place = place_of<slamgc::rc_value_map<item*, item>, on_retire::erase_edge>;
  for (const int n : {6, 200})
    purge<place>(
        n, {1},
        [](place& at, const auto& all) {
          for (std::size_t i = 0; i != all.size(); ++i)
            at.member[all[i]] = all[(i + 1) % all.size()];
        },
        [n](place& at, const auto& all) {
          EXPECT_EQ(at.member.raw().count(all[0]), 0U) << "its value was retired";
          EXPECT_EQ(at.member.raw().count(all[1]), 1U) << "its key is nobody's reference";
          EXPECT_EQ(item::live(), n - 1);
        });
}

TEST(Dispositions, NullInASequence) {
  using place = place_of<slamgc::rc_vector<item>, on_retire::null_edge>;
  purge<place>(
      10, some, [](place& at, const auto& all) { at.member.assign(all.begin(), all.end()); },
      [](place& at, const auto&) {
        EXPECT_EQ(ids(at.member), (std::vector<int>{-1, 1, -1, -1, 4, 5, 6, -1, 8, -1}));
      });
}

TEST(Dispositions, NullInAValueMap) {
  using place = place_of<slamgc::rc_value_map<int, item, std::greater<int>>, on_retire::null_edge>;
  purge<place>(
      10, some,
      [](place& at, const auto& all) {
        for (int i = 0; i != 10; ++i) at.member[i] = all[static_cast<std::size_t>(i)];
      },
      [](place& at, const auto&) {
        ASSERT_EQ(at.member.size(), 10U);
        for (const auto& [key, value] : at.member)
          EXPECT_EQ(value != nullptr ? value->id : -1, some.count(key) != 0 ? -1 : key);
      });
}

struct bypassed_sequence {
  slamgc::rc_vector<item> member;
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("member", member, on_retire::bypass([](item& retired) { return retired.next.get(); }));
  }
};
TEST(Dispositions, BypassInASequence) {
  purge<bypassed_sequence>(
      10, some,
      [](bypassed_sequence& at, const auto& all) {
        for (const int i : {0, 2, 3, 7})
          all[static_cast<std::size_t>(i)]->next = all[static_cast<std::size_t>(i + 1)];
        at.member.assign(all.begin(), all.end());
        at.member.push_back(nullptr);
      },
      [](bypassed_sequence& at, const auto&) {
        EXPECT_EQ(ids(at.member), (std::vector<int>{1, 1, 4, 4, 4, 5, 6, 8, 8, -1, -1}));
        EXPECT_EQ(item::live(), 5);
      });
}

// ---- companions

template <class Sequence>
struct accompanied {
  Sequence member;
  std::vector<int> plain;
  std::vector<bool> bits;
  std::deque<std::string> strings;
  std::list<int> list;
  slamgc::rc_vector<item> counted;
  slamgc::rc_list<item> counted_list;
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("member", member,
           on_retire::erase_with(plain, bits, strings, list, counted, counted_list));
    v.edge("counted", counted);
    v.edge("counted_list", counted_list);
  }
};
template <class Sequence>
class Companions : public ::testing::Test {};
using sequences = ::testing::Types<slamgc::rc_vector<item>, slamgc::rc_list<special>>;
TYPED_TEST_SUITE(Companions, sequences, );

TYPED_TEST(Companions, LoseWhatStoodAtTheSamePlace) {
  using place = accompanied<TypeParam>;
  for (const std::set<int>& dead : {some, std::set<int>{}, std::set<int>{0}, std::set<int>{9},
                                    std::set<int>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}})
    purge<place>(
        20, dead,
        [](place& at, const auto& all) {
          for (int i = 0; i != 10; ++i) {
            at.member.push_back(all[static_cast<std::size_t>(i)]);
            at.plain.push_back(i);
            at.bits.push_back(i % 3 == 0);
            at.strings.push_back(std::to_string(i));
            at.list.push_back(i);
            at.counted.push_back(all[static_cast<std::size_t>(10 + i)]);
            at.counted_list.push_back(all[static_cast<std::size_t>(10 + i)]);
          }
        },
        [&](place& at, const auto& all) {
          const std::vector<int> left = all_but(10, dead);
          EXPECT_EQ(ids(at.member), left);
          EXPECT_EQ(at.plain, left);
          EXPECT_EQ(std::vector<int>(at.list.begin(), at.list.end()), left);
          ASSERT_EQ(at.bits.size(), left.size());
          ASSERT_EQ(at.strings.size(), left.size());
          ASSERT_EQ(at.counted.size(), left.size());
          ASSERT_EQ(at.counted_list.size(), left.size());
          auto from_list = at.counted_list.begin();
          for (std::size_t i = 0; i != left.size(); ++i, ++from_list) {
            EXPECT_EQ(at.bits[i], left[i] % 3 == 0);
            EXPECT_EQ(at.strings[i], std::to_string(left[i]));
            EXPECT_EQ(at.counted[i]->id, 10 + left[i]);
            EXPECT_EQ((*from_list)->id, 10 + left[i]);
          }
          for (int i = 0; i != 10; ++i)
            EXPECT_EQ(all[static_cast<std::size_t>(10 + i)]->use_count(),
                      dead.count(i) != 0 ? 0U : 2U);
        });
}

#if !SLAMGC_DEBUG
TYPED_TEST(Companions, OfAnotherLengthStayAsTheyAre) {
  using place = accompanied<TypeParam>;
  purge<place>(
      20, some,
      [](place& at, const auto& all) {
        for (int i = 0; i != 10; ++i) at.member.push_back(all[static_cast<std::size_t>(i)]);
        at.plain = {1, 2, 3};
      },
      [](place& at, const auto&) {
        EXPECT_EQ(at.member.size(), 10U);
        EXPECT_EQ(at.plain.size(), 3U);
        EXPECT_EQ(item::live(), 20);
      });
}
#endif

TEST(Dispositions, HaveNames) {
  EXPECT_STREQ(on_retire::name_of(&on_retire::hold), "hold");
  EXPECT_STREQ(on_retire::name_of(&on_retire::null), "null");
  EXPECT_STREQ(on_retire::name_of(&on_retire::erase), "erase");
  std::vector<int> weights;
  const auto with = on_retire::erase_with(weights);
  EXPECT_STREQ(on_retire::name_of(&with), "erase");
  const auto by = on_retire::bypass([](item&) -> item* { return nullptr; });
  EXPECT_STREQ(on_retire::name_of(&by), "bypass");
  const auto told = on_retire::announce([](item&) {}, on_retire::null);
  EXPECT_STREQ(on_retire::name_of(&told), "null");
}

}  // namespace
