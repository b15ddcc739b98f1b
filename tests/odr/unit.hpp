#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

using layout = std::vector<std::pair<std::string, std::size_t>>;

// Each uses every type once and says how it lies in memory; the layout is empty if a use failed.
layout unit_a();
layout unit_b();
layout unit_checked();
layout unit_unchecked();
