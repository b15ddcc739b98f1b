// A trace in memory: what a SLAM system did to its map, event by event (docs/trace-format.md).
#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace replay {

enum class trace_format {
  graph,
  objects,
  edges
};  // no header or version 1: objects; version 2: edges

// Threads of the recorded system.
enum thread_id { tracking = 0, local_mapping = 1, loop_closing = 2, global_adjustment = 3 };
constexpr int most_threads = 4;

// One line. Which numbers mean what is the letter's matter.
struct trace_event {
  char letter;
  std::uint8_t thread = 0;
  int line;
  std::int64_t time = 0;  // microseconds
  int a = -1, b = -1, c = -1, d = -1;
};

struct trace {
  trace_format format = trace_format::edges;
  std::string name;   // of the file
  std::string about;  // the first comment
  std::vector<trace_event> events;
  std::vector<int> lists;                       // of m and l: b is the first, c the number
  std::vector<std::array<float, 7>> poses;      // by keyframe, camera to world; empty: not known
  std::vector<char> has_pose;                   // by keyframe
  std::vector<std::array<float, 3>> positions;  // by point; empty: not known
  int keyframes = 0, points = 0;                // one more than the largest id
};

// A file that is not a trace: nothing of it was loaded.
class bad_trace : public std::runtime_error {
 public:
  bad_trace(const std::string& file, int line, const std::string& reason)
      : std::runtime_error(file + ":" + std::to_string(line) + ": " + reason), line_(line) {}
  int line() const { return line_; }

 private:
  int line_;
};

// A file, compressed or not; "-" is the standard input. Throws bad_trace.
trace read_trace(const std::string& path);
// From memory, compressed or not.
trace read_trace(const std::string& name, const std::string& content);

}  // namespace replay
