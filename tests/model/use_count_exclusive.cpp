/// @file
/// Model of use_count(): when it returns 1 to the holder of that one reference, everything that was
/// done under the other references happened before.
#include "../support/relacy_env.hpp"

template <class Policy>
struct changed_object : slamgc::rc_object<changed_object<Policy>, Policy> {
  plain<int> value;
  changed_object() { value.set(0); }
  ~changed_object() { value.set(-1); }
};

template <class Policy>
struct change_when_alone : model_base<change_when_alone<Policy>, 2> {
  using object = changed_object<Policy>;
  slamgc::intrusive_rc<object> references[2];

  void before() { references[0] = references[1] = slamgc::make_rc<object>(); }
  void thread(unsigned i) {
    if (i == 0) {
      references[0]->value.set(1);
      references[0].reset();
    } else if (references[1]->use_count() == 1) {
      require(references[1]->value.get() == 1, "the other's work is there");
      references[1]->value.set(2);
    }
  }
};

int main() {
  return check_models<change_when_alone<relacy_fetch_add_counter>,
                      change_when_alone<relacy_cas_counter>,
                      change_when_alone<relacy_mutex_counter>>();
}
