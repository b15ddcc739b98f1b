// Results in words and tables, for people.
#pragma once

#include <string>

#include "report_json.hpp"

namespace replay {

// What will be replayed, and with which memory per object.
std::string heading(const report& what);
// The thesis's tables side by side, next to what it published, and what it did not measure.
std::string tables(const report& what);

}  // namespace replay
