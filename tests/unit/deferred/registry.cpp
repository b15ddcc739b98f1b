// Registries: what they hold dies with them, in slices; and nothing that somebody else needs.
#include "slamgc/registry.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <slamgc/slamgc.hpp>
#include <string>
#include <thread>
#include <type_traits>
#include <vector>

#include "support/instances.hpp"

namespace {

namespace on_retire = slamgc::on_retire;
using slamgc::collected;
using slamgc::waited;
using online = slamgc::mutator::online_scope;

struct map;
struct item : slamgc::rc_object<item, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
              support::instances<item> {
  explicit item(int i = 0) : id(i) {}
  template <class Visitor>
  void edges(Visitor& v);
  const int id;
  slamgc::rc_slot<item> other;
  slamgc::rc_slot<map> of;
};
// A counted map, as in Atlas: referred to by its keyframes.
struct map : slamgc::rc_object<map, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
             support::instances<map> {
  template <class Visitor>
  void edges(Visitor& v) {
    v.edge("items", items, on_retire::erase);
  }
  slamgc::registry<slamgc::rc_set<item>> items;
};
template <class Visitor>
void item::edges(Visitor& v) {
  v.edge("other", other);
  v.edge("of", of);
}

template <class Container>
void put(Container& into, item* p) {
  using value = typename Container::value_type;
  if constexpr (std::is_pointer<value>::value)
    into.insert(into.end(), p);
  else if constexpr (std::is_convertible<item*, typename Container::key_type>::value)
    into.emplace(p, 0);
  else
    into.insert_or_assign(p->id, p);
}

template <class Container>
class Registry : public ::testing::Test {
 protected:
  void TearDown() override { EXPECT_EQ(item::live() + map::live(), 0); }
  void fill(Container& of, int n) {
    const online scope(me_);
    item* first = nullptr;
    item* last = nullptr;
    for (int i = 0; i != n; ++i) {
      auto* const p = new item(i);
      put(of, p);
      p->other = last;
      last = p;
      if (first == nullptr) first = p;
    }
    first->other = last;  // a ring
  }
  slamgc::domain domain_;
  slamgc::mutator me_{domain_, "test", {false, false}};
};
using containers =
    ::testing::Types<slamgc::rc_vector<item>, slamgc::rc_vector<const item>, slamgc::rc_list<item>,
                     slamgc::rc_set<item>, slamgc::rc_map<item, int>,
                     slamgc::rc_value_map<int, item>, slamgc::rc_unordered_set<item>,
                     slamgc::rc_unordered_map<item, int>>;
TYPED_TEST_SUITE(Registry, containers, );

TYPED_TEST(Registry, RetiresWhatItHoldsWhenItEnds) {
  {
    slamgc::registry<TypeParam> all;
    this->fill(all, 20);
    ASSERT_EQ(this->domain_.drain(), waited::done);
    EXPECT_EQ(item::live(), 20);
  }
  EXPECT_EQ(item::live(), 20);
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(item::live(), 0);
}

TYPED_TEST(Registry, ClearedAndUsedAgain) {
  slamgc::registry<TypeParam> all;
  for (int i = 0; i != 3; ++i) {
    this->fill(all, 20);
    all.clear();
    EXPECT_TRUE(all.empty());
    this->fill(all, 5);
    ASSERT_EQ(this->domain_.drain(), waited::done);
    EXPECT_EQ(item::live(), 5);
    EXPECT_EQ(all.size(), 5U);
    slamgc::drop_map(all);
    ASSERT_EQ(this->domain_.drain(), waited::done);
    EXPECT_EQ(item::live(), 0);
  }
}

TYPED_TEST(Registry, DiesInSlices) {
  slamgc::registry<TypeParam> all;
  this->fill(all, 100);
  all.clear();
  int calls = 0;
  std::uint64_t retired = 0;
  while (this->domain_.collect({7}).result != collected::outcome::done) {
    const std::uint64_t now = this->domain_.stats().types.front().retired;
    ASSERT_LE(now - retired, 7U);
    retired = now;
    ASSERT_LT(++calls, 1000);
  }
  EXPECT_EQ(retired, 100U);
  EXPECT_GE(calls, 14);
  EXPECT_EQ(item::live(), 0);
}

TYPED_TEST(Registry, SparesWhatSomebodyElseKeeps) {
  slamgc::intrusive_rc<item> kept;
  {
    slamgc::registry<TypeParam> all;
    this->fill(all, 20);
    for (const auto& value : all.raw()) {
      if constexpr (std::is_pointer<typename TypeParam::value_type>::value)
        kept = const_cast<item*>(static_cast<const item*>(value));
      else if constexpr (std::is_pointer<typename TypeParam::key_type>::value)
        kept = value.first;
      else
        kept = value.second;
      break;
    }
  }
  ASSERT_EQ(this->domain_.drain(), waited::done);
  EXPECT_EQ(item::live(), 20) << "the ring of which it is a part";
  kept.reset();
  ASSERT_EQ(this->domain_.drain(), waited::done);
}

TYPED_TEST(Registry, TakingOneOutRetiresNothing) {
  slamgc::registry<TypeParam> all;
  {
    const online scope(this->me_);
    put(all, new item(1));
    slamgc::intrusive_rc<item> kept;
    if constexpr (std::is_pointer<typename TypeParam::value_type>::value)
      kept = const_cast<item*>(static_cast<const item*>(*all.raw().begin()));
    else if constexpr (std::is_pointer<typename TypeParam::key_type>::value)
      kept = all.raw().begin()->first;
    else
      kept = all.raw().begin()->second;
    all.erase(all.begin());
    EXPECT_TRUE(slamgc::retire(kept.get())) << "it was not retired before";
  }
  ASSERT_EQ(this->domain_.drain(), waited::done);
}

struct Registries : ::testing::Test {
  void TearDown() override {
    EXPECT_EQ(domain.drain(), waited::done);
    EXPECT_EQ(item::live() + map::live(), 0);
  }
  slamgc::domain domain;
  slamgc::mutator me{domain, "test", {false, false}};
};

// A thread without a mutator makes it, and one with a mutator fills and clears it.
TEST_F(Registries, OfADomainThatIsNamed) {
  slamgc::domain other;
  slamgc::registry<slamgc::rc_set<item>> all(other);
  {
    slamgc::mutator mapping(other, "mapping");
    for (int i = 0; i != 10; ++i) all.insert(new item(i));
    all.clear();
  }
  ASSERT_EQ(other.drain(), waited::done);
  EXPECT_EQ(item::live(), 0);
}

TEST_F(Registries, OfSequencesWithNullElements) {
  slamgc::registry<slamgc::rc_vector<item>> all;
  const online scope(me);
  all.assign({nullptr, new item, nullptr});
  all.push_back(all[1]);
  all.clear();
}

TEST_F(Registries, DropMapTakesAll) {
  slamgc::registry<slamgc::rc_set<item>> a;
  slamgc::registry<slamgc::rc_vector<item>> b;
  {
    const online scope(me);
    for (int i = 0; i != 10; ++i) {
      auto* const p = new item(i);
      a.insert(p);
      b.push_back(p);
    }
  }
  slamgc::drop_map(a, b);
  EXPECT_TRUE(a.empty() && b.empty());
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(item::live(), 0);
}

TEST_F(Registries, EndOnAThreadWithoutAMutator) {
  auto all = std::make_unique<slamgc::registry<slamgc::rc_set<item>>>();
  {
    const online scope(me);
    for (int i = 0; i != 10; ++i) all->insert(new item(i));
  }
  std::thread([&] { all.reset(); }).join();
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(item::live(), 0);
}

TEST_F(Registries, ThatOutliveTheirDomain) {
  slamgc::registry<slamgc::rc_set<item>> all;  // of `domain`, which is current
  std::optional<slamgc::domain> brief(std::in_place);
  std::optional<slamgc::registry<slamgc::rc_set<item>>> of_brief;
  {
    const slamgc::mutator m(*brief, "m");
    of_brief.emplace();
  }
  brief.reset();
  of_brief.reset();
}

// The memory of an allocator with a state may end with the registry.
struct arena {
  alignas(std::max_align_t) std::array<unsigned char, 4096> memory{};
  std::size_t used = 0;
};
template <class T>
struct arena_allocator {
  using value_type = T;
  explicit arena_allocator(arena& a) noexcept : of(&a) {}
  template <class U>
  arena_allocator(const arena_allocator<U>& other) noexcept : of(other.of) {}
  T* allocate(std::size_t n) {
    void* const made = of->memory.data() + of->used;
    of->used += (n * sizeof(T) + 15) / 16 * 16;
    if (of->used > of->memory.size()) throw std::bad_alloc();
    return static_cast<T*>(made);
  }
  void deallocate(T*, std::size_t) noexcept {}
  friend bool operator==(arena_allocator a, arena_allocator b) { return a.of == b.of; }
  friend bool operator!=(arena_allocator a, arena_allocator b) { return a.of != b.of; }
  arena* of;
};
TEST_F(Registries, WithAnAllocatorThatEndsWithThem) {
  using container = slamgc::rc_list<item, arena_allocator<item*>>;
  {
    auto memory = std::make_unique<arena>();
    slamgc::registry<container> all{arena_allocator<item*>(*memory)};
    {
      const online scope(me);
      for (int i = 0; i != 10; ++i) all.push_back(new item(i));
    }
    all.clear();
  }
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(item::live(), 0);
}

// ---- a counted map in a cycle with what its registry holds

struct CountedMap : Registries {
  // A map with n items that refer to it and to each other.
  map* make(int n) {
    auto* const m = new map;
    item* last = nullptr;
    for (int i = 0; i != n; ++i) {
      auto* const p = new item(i);
      p->of = m;
      p->other = last;
      m->items.insert(p);
      last = p;
    }
    return m;
  }
};

TEST_F(CountedMap, DiesWithWhatItHolds) {
  {
    const online scope(me);
    map* const m = make(20);
    for (item* p : m->items) slamgc::retire(p);
    slamgc::retire(m);
  }
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(item::live() + map::live(), 0);
}

// Its items were never retired: they are, when it is severed or destroyed.
TEST_F(CountedMap, RetiresWhatItHeldWhenItDies) {
  {
    const online scope(me);
    map* const m = make(20);
    for (item* p : m->items) p->of = nullptr;
    slamgc::retire(m);
  }
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(item::live() + map::live(), 0);
}
TEST_F(CountedMap, RetiresWhatItHeldWhenItIsSevered) {
  {
    const online scope(me);
    map* const m = make(20);
    bool first = true;
    for (item* p : m->items) {
      if (first)
        slamgc::retire(p);  // in a cycle with the map
      else
        p->of = nullptr;
      p->other = nullptr;
      first = false;
    }
    slamgc::retire(m);
  }
  ASSERT_EQ(domain.drain(), waited::done);
  EXPECT_EQ(item::live() + map::live(), 0);
}

// Cleared at every step of a trial deletion of its owner, by a mutator that had borrowed it.
TEST_F(CountedMap, ClearedWhileItIsTried) {
  for (int when = 0; when != 120; ++when) {
    SCOPED_TRACE(when);
    {
      slamgc::mutator uses(domain, "uses");
      map* const m = make(5);
      for (item* p : m->items) slamgc::retire(p);
      slamgc::retire(m);
      bool cleared = false;
      for (int i = 0; i != 240; ++i) {
        if (i == when) {
          m->items.clear();  // borrowed since it was made
          cleared = true;
        }
        (void)domain.collect({1});
        if (i > when + 1) uses.quiescent();
        if (item::live() + map::live() == 0) break;
      }
      EXPECT_TRUE(cleared);
    }
    ASSERT_EQ(domain.drain(), waited::done);
    ASSERT_EQ(item::live() + map::live(), 0);
  }
}

// The same with an item that is kept: what the registry dropped is retired, and lives while it is needed.
TEST_F(CountedMap, ClearedWhileAnItemIsKept) {
  for (int when = 0; when != 60; ++when) {
    SCOPED_TRACE(when);
    slamgc::intrusive_rc<item> kept;
    {
      slamgc::mutator uses(domain, "uses");
      map* const m = make(5);
      kept = *m->items.begin();
      slamgc::retire(m);
      for (int i = 0; i != 120; ++i) {
        if (i == when) m->items.clear();
        (void)domain.collect({1});
        if (i > when) uses.quiescent();
      }
    }
    ASSERT_EQ(domain.drain(), waited::done);
    ASSERT_EQ(kept->id * 0, 0) << "it can be read";
    kept.reset();
    ASSERT_EQ(domain.drain(), waited::done);
    ASSERT_EQ(item::live() + map::live(), 0);
  }
}

}  // namespace
