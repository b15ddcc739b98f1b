#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

using layout = std::vector<std::pair<std::string, std::size_t>>;

// Each uses every type once and says how it lies in memory; the layout is empty if a use failed.
layout unit_a();
layout unit_b();
layout unit_checked();
layout unit_unchecked();

// Runs @p inside while the thread is an online mutator of the default domain.
void borrow_checked(const std::function<void()>& inside);
void borrow_unchecked(const std::function<void()>& inside);

// Retires an object in the default domain and collects; returns how many of those are alive.
int retire_checked();
int retire_unchecked();
