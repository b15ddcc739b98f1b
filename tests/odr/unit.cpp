// Compiled several times, see CMakeLists.txt.
#include "unit.hpp"

#include <slamgc/mutex_counter.hpp>
#include <slamgc/slamgc.hpp>

namespace {

struct node : slamgc::rc_object<node> {
  char payload = 0;
  slamgc::rc_slot<node> slot;
  slamgc::rc_vector<node> vector;
  slamgc::rc_list<node> list;
  slamgc::rc_set<node> set;
  slamgc::rc_map<node, int> map;
  slamgc::rc_value_map<int, node> value_map;
  slamgc::rc_unordered_set<node> unordered_set;
  slamgc::rc_unordered_map<node, int> unordered_map;
};
struct cas_node : slamgc::rc_object<cas_node, slamgc::cas_counter> {
  char payload = 0;
};
struct unsync_node : slamgc::rc_object<unsync_node, slamgc::unsync_counter> {
  char payload = 0;
};
struct mutex_node : slamgc::rc_object<mutex_node, slamgc::mutex_counter> {
  char payload = 0;
};

struct doomed : slamgc::rc_object<doomed, slamgc::fetch_add_counter, slamgc::reclaim_retired> {
  doomed() { ++alive; }
  ~doomed() { --alive; }
  static int alive;
};
int doomed::alive = 0;

template <class T, class Member>
std::size_t offset(const T& object, const Member& member) {
  return static_cast<std::size_t>(reinterpret_cast<const char*>(&member) -
                                  reinterpret_cast<const char*>(&object));
}

template <class T>
void add(layout& result, const char* name) {
  const auto object = slamgc::make_rc<T>();
  result.emplace_back(std::string("sizeof ") + name, sizeof(T));
  result.emplace_back(std::string("alignof ") + name, alignof(T));
  result.emplace_back(std::string("header of ") + name, offset(*object, object->payload));
}

bool use() {
  const auto a = slamgc::make_rc<node>();
  const auto b = slamgc::make_rc<node>();
  a->slot = b;
  a->vector.push_back(b.get());
  a->list.push_back(b.get());
  a->set.insert(b.get());
  a->map[b.get()] = 1;
  a->value_map.insert({1, b.get()});
  a->unordered_set.insert(b.get());
  a->unordered_map[b.get()] = 1;
  if (b->use_count() != 9) return false;
  a->slot = nullptr;
  a->vector.clear();
  a->list.clear();
  a->set.clear();
  a->map.clear();
  a->value_map.clear();
  a->unordered_set.clear();
  a->unordered_map.clear();
  return b->use_count() == 1;
}

}  // namespace

layout SLAMGC_ODR_UNIT() {
  if (!use()) return {};
  layout result;
  add<node>(result, "node");
  add<cas_node>(result, "cas_node");
  add<unsync_node>(result, "unsync_node");
  add<mutex_node>(result, "mutex_node");
  const auto object = slamgc::make_rc<node>();
  result.emplace_back("sizeof intrusive_rc", sizeof(slamgc::intrusive_rc<node>));
  result.emplace_back("slot", offset(*object, object->slot));
  result.emplace_back("vector", offset(*object, object->vector));
  result.emplace_back("list", offset(*object, object->list));
  result.emplace_back("set", offset(*object, object->set));
  result.emplace_back("map", offset(*object, object->map));
  result.emplace_back("value_map", offset(*object, object->value_map));
  result.emplace_back("unordered_set", offset(*object, object->unordered_set));
  result.emplace_back("unordered_map", offset(*object, object->unordered_map));
  return result;
}

void SLAMGC_ODR_BORROW(const std::function<void()>& inside) {
  const slamgc::mutator reader("reader");
  inside();
}

int SLAMGC_ODR_RETIRE() {
  slamgc::mutator me("mapping");
  slamgc::retire(new doomed);
  for (int i = 0; i != 3; ++i) {
    me.quiescent();
    (void)slamgc::default_domain().collect();
  }
  return doomed::alive;
}
