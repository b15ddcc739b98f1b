// The lines of a file or of a piece of memory, compressed or not.
#pragma once

#include <cstddef>
#include <string>

namespace replay {

class line_source {
 public:
  // "-" is the standard input. Throws bad_trace, as next() does.
  static line_source of_file(const std::string& path);
  static line_source of_memory(const std::string& name, const std::string& content);
  line_source(line_source&& other) noexcept;
  line_source& operator=(line_source&&) = delete;
  ~line_source();

  // Whether there was one more; without its end.
  bool next(std::string& line);
  const std::string& name() const { return name_; }
  int number() const { return number_; }  // of the last line, from 1

 private:
  explicit line_source(std::string name) : name_(std::move(name)) {}
  bool fill();

  std::string name_;
  int number_ = 0;
  void* file_ = nullptr;  // gzFile
  std::string buffer_;
  std::size_t at_ = 0;
};

}  // namespace replay
