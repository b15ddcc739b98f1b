// What counting adds to an object and to a pointer, in bytes.
#include <cstdio>

#include "contenders.hpp"

namespace {

struct empty {};
template <class Policy>
struct counted : slamgc::rc_object<counted<Policy>, Policy> {};
struct boosted : boost::intrusive_ref_counter<boosted> {};

void print(const char* what, std::size_t bytes) {
  std::printf("{\"what\": \"%s\", \"bytes\": %zu}\n", what, bytes);
}

}  // namespace

int main() {
  using object = counted<slamgc::fetch_add_counter>;
  print("object, fetch_add_counter", sizeof(object));
  print("object, cas_counter", sizeof(counted<slamgc::cas_counter>));
  print("object, unsync_counter", sizeof(counted<slamgc::unsync_counter>));
  print("object, mutex_counter", sizeof(counted<slamgc::mutex_counter>));
  print("object, boost::intrusive_ref_counter", sizeof(boosted));
  print("T*", sizeof(object*));
  print("intrusive_rc<T>", sizeof(slamgc::intrusive_rc<object>));
  print("rc_slot<T>", sizeof(slamgc::rc_slot<object>));
  print("std::shared_ptr<T>", sizeof(std::shared_ptr<empty>));
  print("std::vector<T*>", sizeof(std::vector<object*>));
  print("rc_vector<T>", sizeof(slamgc::rc_vector<object>));
  print("std::set<T*>", sizeof(std::set<object*>));
  print("rc_set<T>", sizeof(slamgc::rc_set<object>));
}
