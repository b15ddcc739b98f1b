// The fields of one line of a trace, checked. What is wrong is thrown as a string.
#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

namespace replay {

inline constexpr int largest_id = (1 << 26) - 1;

// The fields of one line, taken from left to right.
class fields {
 public:
  explicit fields(const std::string& line) : rest_(line) {}

  bool more() {
    while (!rest_.empty() && rest_.front() == ' ') rest_.remove_prefix(1);
    return !rest_.empty();
  }
  std::string_view word(const char* what) {
    if (!more()) throw std::string(what) + " is missing";
    const std::size_t n = rest_.find(' ');
    const std::string_view w = rest_.substr(0, n);
    rest_.remove_prefix(w.size());
    return w;
  }
  std::int64_t integer(const char* what, std::int64_t least, std::int64_t most) {
    const std::string_view w = word(what);
    std::int64_t value = 0;
    const auto end = std::from_chars(w.data(), w.data() + w.size(), value);
    if (end.ec != std::errc() || end.ptr != w.data() + w.size())
      throw std::string(what) + " is no integer: '" + std::string(w) + "'";
    if (value < least || value > most)
      throw std::string(what) + " is out of range: " + std::string(w);
    return value;
  }
  int id(const char* what) { return static_cast<int>(integer(what, 0, largest_id)); }
  int id_or_none(const char* what) { return static_cast<int>(integer(what, -1, largest_id)); }
  float real(const char* what) {
    const std::string w(word(what));
    char* end = nullptr;
    const double value = std::strtod(w.c_str(), &end);
    if (end != w.c_str() + w.size() || !std::isfinite(value))
      throw std::string(what) + " is no number: '" + w + "'";
    return static_cast<float>(value);
  }
  double seconds(const char* what) {
    const std::string w(word(what));
    char* end = nullptr;
    const double value = std::strtod(w.c_str(), &end);
    if (end != w.c_str() + w.size() || !(value >= 0 && value < 1e12))
      throw std::string(what) + ": no time: '" + w + "'";
    return value;
  }
  void end() {
    if (more()) throw "a field too many: '" + std::string(word("")) + "'";
  }

 private:
  std::string_view rest_;
};

}  // namespace replay
