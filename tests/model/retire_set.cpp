/// @file
/// Model of the retire set: two threads insert and scan, and count their locals under the lock of the slot.
#include "../support/relacy_env.hpp"

struct dead : slamgc::rc_object<dead, relacy_fetch_add_counter, slamgc::reclaim_by_scan> {
  plain<int> value;
  explicit dead(int v) { value.set(v); }
  ~dead() {
    require(value.get() > 0, "destroyed once");
    value.set(-1);
  }
};

struct insert_and_scan : model_base<insert_and_scan, 2> {
  relacy_mutex mutex;
  slamgc::rc_slot<dead, relacy_env> shared;
  slamgc::retire_set<dead> set;
  int inserted = 0;
  std::size_t destroyed = 0;

  void before() { shared = new dead(1); }
  void thread(unsigned i) {
    {
      slamgc::intrusive_rc<dead> mine;  // counted under the lock
      {
        const std::lock_guard<relacy_mutex> lock(mutex);
        mine = slamgc::intrusive_rc<dead>(shared.get());
      }
      if (mine) {
        {
          const std::lock_guard<relacy_mutex> lock(mutex);
          shared.reset();
        }
        if (set.insert(mine.get())) ++inserted;
        destroyed += set.scan();
        require(mine->value.get() == 1, "alive while counted");
      }
    }
    set.insert(new dead(2));
    destroyed += set.scan();
  }
  void after() {
    require(inserted == 1, "only one was the first");
    destroyed += set.scan();
    require(set.empty() && destroyed == 3, "each is destroyed once");
  }
};

int main() { return check_models<insert_and_scan>(); }
