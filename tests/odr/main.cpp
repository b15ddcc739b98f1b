#include <cstdio>

#include "unit.hpp"

int main() {
  const layout expected = unit_a();
  const layout others[] = {unit_b(), unit_checked(), unit_unchecked()};
  int failures = expected.empty() ? 1 : 0;
  for (const layout& other : others) {
    if (other.size() != expected.size()) {
      ++failures;
      continue;
    }
    for (std::size_t i = 0; i != expected.size(); ++i) {
      if (other[i] == expected[i]) continue;
      std::printf("%s: %zu and %zu\n", expected[i].first.c_str(), expected[i].second,
                  other[i].second);
      ++failures;
    }
  }
  // A mutator of one flavour holds the reclamation of the other up: they share the domain.
  const struct {
    void (*borrow)(const std::function<void()>&);
    int (*retire)();
  } pairs[] = {{borrow_checked, retire_unchecked}, {borrow_unchecked, retire_checked}};
  for (const auto& pair : pairs) {
    int alive = -1;
    pair.borrow([&alive, &pair] { alive = pair.retire(); });
    const int alive_later = pair.retire();
    if (alive == 1 && alive_later == 0) continue;
    std::printf("alive: %d while borrowed, %d later\n", alive, alive_later);
    ++failures;
  }
  for (const auto& [name, value] : expected) std::printf("%-24s %zu\n", name.c_str(), value);
  return failures;
}
