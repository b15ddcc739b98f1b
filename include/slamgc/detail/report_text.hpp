/// @file
/// How reports are written: names, times, JSON.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>

#include "../fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

inline std::string text_of(const void* address) {
  char text[2 + 2 * sizeof address + 1];
  std::snprintf(text, sizeof text, "0x%llx",
                static_cast<unsigned long long>(reinterpret_cast<std::uintptr_t>(address)));
  return text;
}
/// "3.2 s", "45 ms".
inline std::string text_of(std::chrono::nanoseconds time) {
  char text[40];
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(time).count();
  if (ms < 1000)
    std::snprintf(text, sizeof text, "%lld ms", static_cast<long long>(ms));
  else
    std::snprintf(text, sizeof text, "%lld.%lld s", static_cast<long long>(ms / 1000),
                  static_cast<long long>(ms % 1000 / 100));
  return text;
}
/// "1 reference", "3 references".
inline std::string text_of(std::uint64_t n, const char* what) {
  return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

/// The last part of a qualified name: `ORB_SLAM3::KeyFrame` is a KeyFrame.
inline std::string short_name(const char* type) {
  std::size_t begin = 0;
  int depth = 0;
  for (std::size_t i = 0; type[i] != '\0'; ++i) {
    if (std::strchr("<({[", type[i]) != nullptr) ++depth;
    if (std::strchr(">)}]", type[i]) != nullptr) --depth;
    if (depth == 0 && type[i] == ':' && type[i + 1] == ':') begin = i + 2;
  }
  return type + begin;
}

/// Puts a backslash where a string in double quotes needs one.
inline std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      char code[8];
      std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(c));
      out += code;
    } else {
      out += c;
    }
  }
  return out;
}

/// Writes JSON (RFC 8259), without spaces.
class json_text {
 public:
  json_text& begin(char bracket) {
    item();
    text_ += bracket;
    first_ = true;
    return *this;
  }
  json_text& end(char bracket) {
    text_ += bracket;
    first_ = false;
    return *this;
  }
  json_text& key(const char* name) {
    item();
    text_ += '"';
    text_ += name;
    text_ += "\":";
    first_ = true;
    return *this;
  }
  json_text& value(const std::string& text) { return raw('"' + escaped(text) + '"'); }
  json_text& value(const char* text) { return value(std::string(text)); }
  json_text& value(std::uint64_t number) { return raw(std::to_string(number)); }
  json_text& value(bool b) { return raw(b ? "true" : "false"); }
  template <class T>
  json_text& field(const char* name, const T& content) {
    return key(name).value(content);
  }
  const std::string& text() const noexcept { return text_; }

 private:
  json_text& raw(const std::string& text) {
    item();
    text_ += text;
    return *this;
  }
  void item() {
    if (!first_) text_ += ',';
    first_ = false;
  }

  std::string text_;
  bool first_ = true;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
