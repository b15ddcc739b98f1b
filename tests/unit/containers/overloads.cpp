// What has to compile, and what must not, because it would change an element uncounted.
#include "support.hpp"

#include <algorithm>
#include <numeric>

namespace {

struct point;

/// Containers of a type that is declared only; its pointer converts without being asked.
struct frame : slamgc::rc_object<frame> {
  slamgc::rc_vector<point> points;
  slamgc::rc_list<point> queue;
  slamgc::rc_set<point> set;
  slamgc::rc_map<point, int> map;
  slamgc::rc_unordered_set<point> hashed;
  slamgc::rc_value_map<long, point> by_key;
};
struct point : slamgc::rc_object<point> {
  bool bad = false;
  bool is_bad() const { return bad; }
};

}  // namespace

template <>
inline constexpr bool slamgc::implicit_to_raw<point> = true;

namespace {

using vector = slamgc::rc_vector<point>;
using plain_vector = std::vector<point*>;

class ContainerOverloads : public testing::Test {
 protected:
  slamgc::intrusive_rc<point> p = slamgc::make_rc<point>(), q = slamgc::make_rc<point>();
  frame f;
};

TEST_F(ContainerOverloads, Assignment) {
  f.points = {};
  EXPECT_TRUE(f.points.empty());
  f.points = {p, q};
  f.set = {p, q};
  f.map = {{p, 1}, {q, 2}};
  f.by_key = {{1, p}, {2, q}};
  f.points = plain_vector(3, nullptr);
  f.points = plain_vector(2, static_cast<point*>(NULL));
  f.points = std::vector<point*>(f.set.begin(), f.set.end());
  f.set = std::set<point*>(f.points.begin(), f.points.end());
  const plain_vector plain = f.points;
  plain_vector assigned;
  assigned = f.points;
  EXPECT_TRUE(f.points == plain && assigned == f.points && f.points != plain_vector());
  EXPECT_EQ(plain_vector(f.points), plain);
  const slamgc::rc_set<point> braces{p, q}, parentheses(f.set), copy = f.set.raw();
  const slamgc::rc_map<point, int> pairs{{p, 1}};
  EXPECT_TRUE(braces == copy && parentheses == copy && pairs.at(p) == 1);
  EXPECT_EQ(vector(2).size(), 2u);
  EXPECT_EQ(vector(2, NULL).size(), 2u);
  EXPECT_EQ(vector(2, p).size(), 2u);
  EXPECT_EQ((vector{p, q}).size(), 2u);
  EXPECT_EQ(slamgc::rc_list<point>(2).size(), 2u);
}

TEST_F(ContainerOverloads, Elements) {
  const slamgc::rc_slot<point> slot(p);
  f.points.push_back(slot);
  f.points.push_back(p);
  f.points.push_back(p.get());
  f.points.push_back(NULL);
  f.points.push_back(nullptr);
  f.points[3] = slot;
  f.points[3] = q;
  f.points[3] = NULL;
  f.points[3] = nullptr;
  f.points[3] = static_cast<point*>(NULL);
  f.points[3] = f.points[0];
  f.points.insert(f.points.begin(), slot);
  f.points.insert(f.points.end(), 2, NULL);
  f.points.resize(9, slot);
  f.queue.push_back(slot);
  f.queue.push_front(q);
  f.set.insert(slot);
  f.set.insert(f.set.begin(), q);
  f.set.insert(f.points[0]);
  f.map[slot] = 1;
  f.map[f.points[0]]++;
  f.map.insert(std::make_pair(q.get(), 3));
  f.map.insert({slot, 3});
  f.map.insert(std::pair<point* const, int>(q, 4));
  f.map.emplace(q, 4);
  f.by_key[7] = slot;
  f.by_key[7] = f.points[0];
  f.by_key[7]->bad = false;
  f.by_key.insert({8, q});
  EXPECT_EQ(f.set.count(slot) + f.map.count(q) + f.set.erase(slot) + f.hashed.count(p), 3u);
  EXPECT_TRUE(f.map.find(slot) != f.map.end() && f.by_key.find(9) == f.by_key.end());
  EXPECT_EQ(f.map.at(p), 2);
}

TEST_F(ContainerOverloads, ReadingElements) {
  f.points = {p, q, nullptr};
  point* const read = f.points[0];
  EXPECT_TRUE(f.points[0] && !f.points[2] && f.points[0] == read && read == f.points[0]);
  EXPECT_TRUE(f.points[0] != f.points[1] && f.points[2] == nullptr && f.points[2] == NULL);
  EXPECT_TRUE(f.points[0] == p && f.points[0] == p.get());
  EXPECT_FALSE(f.points[0]->is_bad() || (*f.points[0]).is_bad() || f.points.at(1)->is_bad());
  EXPECT_EQ(true ? f.points[0] : read, read);
  EXPECT_EQ(false ? f.points[0] : static_cast<point*>(NULL), nullptr);
  EXPECT_EQ(static_cast<point*>(f.points[0]), read);
  std::vector<std::pair<int, point*>> ranked;
  ranked.push_back(std::make_pair(3, f.points[1]));
  EXPECT_EQ(ranked[0].second, q.get());
  int found = 0;
  for (point* e : f.points) found += e != nullptr;
  for (const auto& e : f.points) found += e != nullptr;
  for (auto& [key, value] : f.map) found += key != nullptr && value != 0;
  for (plain_vector::const_iterator i = f.points.begin(); i != f.points.end(); i++)
    found += *i != 0;
  for (vector::reverse_iterator i = f.points.rbegin(); i != f.points.rend(); ++i) found += *i != 0;
  EXPECT_EQ(found, 8);
}

TEST_F(ContainerOverloads, OldStyleLoops) {
  f.map = {{p, 1}, {q, 2}};
  for (std::map<point*, int>::iterator i = f.map.begin(), last = f.map.end(); i != last; i++)
    i->second++;
  for (std::map<point*, int>::iterator i = f.map.begin(); i != f.map.end();)
    i = i->second == 2 ? f.map.erase(i) : std::next(i);
  EXPECT_EQ(f.map.size(), 1u);
  f.queue = {p, q, p};
  for (std::list<point*>::iterator i = f.queue.begin(); i != f.queue.end();)
    if (*i == p)
      i = f.queue.erase(i);
    else
      i++;
  EXPECT_EQ(f.queue.size(), 1u);
  f.set = {p, q};
  for (std::set<point*>::iterator i = f.set.begin(), last = f.set.end(); i != last;)
    f.set.erase(i++);
  EXPECT_EQ(p->use_count(), 1u);
}

TEST_F(ContainerOverloads, Algorithms) {
  f.points = {p, nullptr, q, p};
  std::copy(f.points.begin(), f.points.end(), std::inserter(f.set, f.set.begin()));
  std::copy(f.points.begin(), f.points.end(), std::inserter(f.hashed, f.hashed.end()));
  std::copy(f.set.begin(), f.set.end(), std::back_inserter(f.points));
  std::copy(f.set.begin(), f.set.end(), std::back_inserter(f.queue));
  std::copy(f.set.begin(), f.set.end(), std::front_inserter(f.queue));
  std::copy(f.points.begin(), f.points.begin() + 1, std::inserter(f.points, f.points.begin()));
  EXPECT_EQ(f.points.size(), 8u);
  EXPECT_EQ(f.queue.size(), 6u);
  EXPECT_EQ(std::count(f.points.begin(), f.points.end(), p.get()), 4);
  EXPECT_EQ(*std::find(f.points.begin(), f.points.end(), f.points[3]), q.get());
  EXPECT_TRUE(std::is_permutation(f.set.begin(), f.set.end(), f.hashed.begin()));
  EXPECT_EQ(std::accumulate(f.set.begin(), f.set.end(), 0,
                            [](int n, point* e) { return n + (e != nullptr); }),
            2);
  std::vector<point*> out(f.points.size());
  std::copy(f.points.begin(), f.points.end(), out.begin());
  std::transform(f.map.begin(), f.map.end(), out.begin(), [](auto& e) { return e.first; });
}

TEST_F(ContainerOverloads, BaseClassesAndConst) {
  slamgc::rc_vector<const point> constant{p.get(), q.get()};
  constant[0] = q.get();
  EXPECT_EQ(q->use_count(), 3u);
  const frame& read = f;
  f.points = {p};
  point* const from_const = read.points[0];
  EXPECT_EQ(from_const, p.get());
}

// What must not compile, by container and expression.
template <class C, class Try, class = void>
struct compiles : std::false_type {};
template <class C, class Try>
struct compiles<C, Try, std::void_t<decltype(std::declval<Try>()(std::declval<C&>()))>>
    : std::true_type {};
#define SLAMGC_COMPILES(name, ...)                        \
  struct name {                                           \
    template <class C>                                    \
    auto operator()(C& c) const -> decltype(__VA_ARGS__); \
  }
SLAMGC_COMPILES(write_through_iterator, *c.begin() = nullptr);
SLAMGC_COMPILES(write_through_reverse, *c.rbegin() = nullptr);
SLAMGC_COMPILES(write_through_data, c.data()[0] = nullptr);
SLAMGC_COMPILES(write_through_value, c.begin()->second = nullptr);
SLAMGC_COMPILES(bind_to_element, static_cast<point*&>(c[0]));
SLAMGC_COMPILES(write_through_front, static_cast<point*&>(c.front()));
SLAMGC_COMPILES(address_of_element, &c[0]);
SLAMGC_COMPILES(mutable_iterator, static_cast<plain_vector::iterator>(c.begin()));
SLAMGC_COMPILES(plain_reference, static_cast<plain_vector&>(c));
SLAMGC_COMPILES(iterator_of_map, static_cast<std::map<long, point*>::iterator>(c.begin()));
SLAMGC_COMPILES(edit_of_a_temporary, C().edit());
#undef SLAMGC_COMPILES
using list = slamgc::rc_list<point>;
using value_map = slamgc::rc_value_map<long, point>;
static_assert(compiles<plain_vector, write_through_iterator>::value, "the check itself works");
static_assert(compiles<plain_vector, bind_to_element>::value, "the check itself works");
static_assert(!compiles<vector, write_through_iterator>::value, "");
static_assert(!compiles<vector, write_through_reverse>::value, "");
static_assert(!compiles<vector, write_through_data>::value, "");
static_assert(!compiles<vector, bind_to_element>::value, "");
static_assert(!compiles<vector, write_through_front>::value, "");
static_assert(!compiles<vector, address_of_element>::value, "");
static_assert(!compiles<vector, mutable_iterator>::value, "");
static_assert(!compiles<vector, plain_reference>::value, "");
static_assert(!compiles<list, write_through_front>::value, "");
static_assert(!compiles<list, edit_of_a_temporary>::value, "");
static_assert(!compiles<slamgc::rc_set<point>, write_through_iterator>::value, "");
static_assert(!compiles<value_map, write_through_value>::value, "");
static_assert(!compiles<value_map, iterator_of_map>::value, "");
// A decision: old loops need the iterators of the standard list, and those can write. The counted
// write is replace(); see ListMisuse.
static_assert(compiles<list, write_through_iterator>::value, "");
static_assert(std::is_same<list::iterator, std::list<point*>::iterator>::value, "");

}  // namespace
