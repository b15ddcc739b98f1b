// Results as JSON (docs/replay.md), CSV, and from one process to another.
#pragma once

#include <string>
#include <vector>

#include "result.hpp"

namespace replay {

// What was asked for, and on what.
struct report {
  const session* of = nullptr;
  play_options options;
  std::string command;
  std::vector<run_result> runs;  // with repetitions: scheme by scheme, then again
};

// What one keyframe and one point take, measured by making them.
struct footprints {
  int features = 0;
  std::size_t object_size[2] = {};  // sizeof: keyframe, point
  std::int64_t bytes[2] = {};       // with all that they own
};
footprints measured_footprints(const session& s);

std::string to_text(const run_result& r);
bool from_text(const std::string& text, run_result& r);

// Throw std::runtime_error if the file cannot be written.
void write_json(const std::string& path, const report& what);
void write_csv(const std::string& path, const report& what);

}  // namespace replay
