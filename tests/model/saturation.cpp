/// @file
/// Model of the count at its limit: once it sticks it stays, no change is lost before, and neither the
/// flags nor the version suffer.
#include "../support/relacy_env.hpp"

using word = slamgc::state_word;

/// Sets the word of @p object as if @p count references had been counted.
template <class T>
void set_count(T& object, std::uint32_t count) {
  auto& state = slamgc::detail::access::header_of(object).state;
  const std::uint64_t now = T::policy::load(state);
  T::policy::subtract(state, now - (std::uint64_t{count} * word::count_unit | word::retired_flag));
}

/// Where a case starts, below the limit (negative: above), and what each thread does: '+' adds a
/// reference, '-' removes one.
struct plan {
  int below;
  const char* steps[3];
};
constexpr plan plans[] = {{1, {"+-", "+-", "-+"}},
                          {0, {"+-", "+-", "-+"}},
                          {0, {"--", "--", "+"}},
                          {1, {"++", "++", "-"}},
                          {-2, {"--", "--", "+"}}};

template <class Policy>
struct crowd : model_base<crowd<Policy>, 3> {
  struct object : slamgc::rc_object<object, Policy> {
    using policy = Policy;
    plain<int> alive;
    object() { alive.set(1); }
    ~object() { alive.set(-1); }
  };
  static constexpr unsigned context_bound = std::is_same<Policy, relacy_cas_counter>::value ? 1 : 2;
  static constexpr unsigned cases = sizeof(plans) / sizeof(plans[0]);
  static constexpr std::uint32_t middle = word::sticky_count / 2 * 3;

  const plan& current = plans[crowd::current_case];
  const std::uint32_t start = word::sticky_count - static_cast<std::uint32_t>(current.below);
  object* crowded = nullptr;

  static bool stuck(word w) { return w.count() > middle - 100 && w.count() < middle + 100; }

  void before() {
    crowded = new object;
    set_count(*crowded, start);
  }
  void thread(unsigned i) {
    bool was_stuck = false;
    for (const char* step = current.steps[i]; *step != '\0'; ++step) {
      if (*step == '+')
        slamgc::detail::add_reference(crowded);
      else
        slamgc::detail::drop_reference(crowded);
      const word now = crowded->state();
      require(!was_stuck || stuck(now), "a count that sticks stays");
      was_stuck = stuck(now);
    }
  }
  void after() {
    const word now = crowded->state();
    std::uint32_t exact = start;
    std::uint32_t added = 0;
    for (const char* step : current.steps) {
      for (; *step != '\0'; ++step) {
        exact += *step == '+' ? 1U : ~0U;
        added += *step == '+';
      }
    }
    require(stuck(now) || now.count() == exact, "the count is exact or sticks");
    require(now.version() == added, "the version counts additions");
    require(now.is_retired() && !now.is_queued(), "the flags stay");
    require(crowded->alive.get() == 1, "the object stays");
    set_count(*crowded, 0);
    delete crowded;
  }
};

int main() { return check_models<crowd<relacy_fetch_add_counter>, crowd<relacy_cas_counter>>(); }
