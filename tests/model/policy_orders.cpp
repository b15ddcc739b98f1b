/// @file
/// Model of what the concept of a counter policy promises about load, subtract and compare_exchange,
/// whoever uses it: each passes on what its thread did before, and sees what the others passed on.
#include "../support/relacy_env.hpp"

/// Thread 0 writes a datum and changes the word in one way; thread 1 reads the datum if it sees the change
/// in another way. The cases are all pairs of ways.
template <class Policy>
struct pass_on : model_base<pass_on<Policy>, 2> {
  static constexpr unsigned cases = 9;
  typename Policy::storage word;
  plain<int> datum;

  void before() { Policy::add(word, 10); }
  void thread(unsigned i) {
    if (i == 0) {
      datum.set(1);
      change(pass_on::current_case % 3);
    } else if (sees_change(pass_on::current_case / 3)) {
      require(datum.get() == 1, "the datum is there");
    }
  }

  /// Makes the word 9.
  void change(unsigned way) {
    std::uint64_t expected = 10;
    switch (way) {
      case 0:
        require(Policy::subtract(word, 1) == 10, "subtract returns the word before");
        break;
      case 1:
        require(Policy::compare_exchange(word, expected, 9), "it is 10");
        break;
      default:  // an add in between changes nothing
        Policy::subtract(word, 2);
        require(Policy::add(word, 1) == 8, "add returns the word before");
    }
  }
  /// Whether the word is 9.
  bool sees_change(unsigned way) {
    std::uint64_t expected = way == 1 ? 9 : 0;
    switch (way) {
      case 0:
        return Policy::load(word) == 9;
      case 1:
        return Policy::compare_exchange(word, expected, 7);
      default:
        require(!Policy::compare_exchange(word, expected, 7), "compare_exchange compares");
        return expected == 9;
    }
  }
};

/// subtract, too, sees what was passed on; it changes the word, so it is not among the ways above.
template <class Policy>
struct pass_on_to_subtract : model_base<pass_on_to_subtract<Policy>, 2> {
  typename Policy::storage word;
  plain<int> datum[2];

  void before() { Policy::add(word, 2); }
  void thread(unsigned i) {
    datum[i].set(1);
    if (Policy::subtract(word, 1) == 1) require(datum[1 - i].get() == 1, "the datum is there");
  }
};

int main() {
  return check_models<pass_on<relacy_fetch_add_counter>,
                      pass_on_to_subtract<relacy_fetch_add_counter>, pass_on<relacy_cas_counter>,
                      pass_on_to_subtract<relacy_cas_counter>, pass_on<relacy_mutex_counter>,
                      pass_on_to_subtract<relacy_mutex_counter>>();
}
