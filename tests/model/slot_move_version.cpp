/// @file
/// Model of a walk that counts edges without a lock while an edge moves.
///
/// What trial deletion needs: if the state word is the same before and after the walk, the walk counted
/// no more edges than there are. Else it would take references from outside for its own, and reclaim
/// an object that is in use.
#include "../support/relacy_env.hpp"

struct target : slamgc::rc_object<target, relacy_fetch_add_counter> {};
using slot = slamgc::rc_slot<target, relacy_env>;

/// Two slots, one edge, and one reference from outside. Each case is a way to take the edge from a to b.
struct walk : model_base<walk, 2> {
  static constexpr unsigned context_bound = 3;
  static constexpr unsigned cases = 7;
  slamgc::intrusive_rc<target> outside;
  slamgc::intrusive_rc<target> other;
  slot a, b;

  void before() {
    outside = slamgc::make_rc<target>();
    other = slamgc::make_rc<target>();
    a = outside;
  }
  void thread(unsigned i) {
    if (i == 0) {
      move_edge();
    } else {
      const slamgc::state_word before = outside->state();
      const bool forwards = rl::rand(2) == 0;
      std::uint32_t edges = (forwards ? a : b) == outside.get();
      edges += (forwards ? b : a) == outside.get();
      const slamgc::state_word after = outside->state();
      require(!before.same_references(after) || edges + 1 <= before.count(),
              "an unchanged word means that no edge was counted twice");
    }
  }
  void move_edge() {
    switch (current_case) {
      case 0:
        b = std::move(a);
        break;
      case 1:
        a.swap(b);
        break;
      case 2:
        b.swap(a);
        break;
      case 3:
        b = a.exchange(other.get());
        break;
      case 4: {
        slot between(std::move(a));
        b = std::move(between);
        break;
      }
      case 5: {
        slot between(a.exchange(nullptr));
        b.swap(between);
        break;
      }
      default:  // as two steps
        b = a;
        a.reset();
    }
  }
  void after() {
    a.reset();
    b.reset();
    require(outside->use_count() == 1 && other->use_count() == 1, "every count is exact");
  }
};

int main() { return check_models<walk>(); }
