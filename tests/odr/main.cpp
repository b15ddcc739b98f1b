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
  for (const auto& [name, value] : expected) std::printf("%-24s %zu\n", name.c_str(), value);
  return failures;
}
