#include "line_source.hpp"

#include <unistd.h>
#include <zlib.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "trace.hpp"

namespace replay {
namespace {

constexpr std::size_t longest_line = std::size_t{1} << 20;

std::string inflated(const std::string& name, const std::string& content) {
  z_stream z{};
  if (inflateInit2(&z, 15 + 16) != Z_OK) throw bad_trace(name, 0, "zlib does not start");
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  z.avail_in = static_cast<uInt>(content.size());
  std::string out;
  int result = Z_OK;
  while (result == Z_OK) {
    const std::size_t old = out.size();
    out.resize(old + (std::size_t{1} << 18));
    z.next_out = reinterpret_cast<Bytef*>(&out[old]);
    z.avail_out = static_cast<uInt>(out.size() - old);
    result = inflate(&z, Z_NO_FLUSH);
    out.resize(out.size() - z.avail_out);
  }
  inflateEnd(&z);
  if (result != Z_STREAM_END)
    throw bad_trace(name, 0, "the compressed data is damaged or ends early");
  return out;
}

}  // namespace

line_source line_source::of_file(const std::string& path) {
  line_source lines(path == "-" ? "standard input" : path);
  const gzFile file = path == "-" ? gzdopen(dup(STDIN_FILENO), "rb") : gzopen(path.c_str(), "rb");
  if (file == nullptr)
    throw bad_trace(lines.name_, 0, std::string("cannot be opened: ") + std::strerror(errno));
  gzbuffer(file, 1U << 17);
  lines.file_ = file;
  return lines;
}

line_source line_source::of_memory(const std::string& name, const std::string& content) {
  line_source lines(name);
  lines.buffer_ = content.compare(0, 2, "\x1f\x8b") == 0 ? inflated(name, content) : content;
  return lines;
}

line_source::line_source(line_source&& other) noexcept
    : name_(std::move(other.name_)),
      number_(other.number_),
      file_(std::exchange(other.file_, nullptr)),
      buffer_(std::move(other.buffer_)),
      at_(other.at_) {}

line_source::~line_source() {
  if (file_ != nullptr) gzclose(static_cast<gzFile>(file_));
}

bool line_source::fill() {
  if (file_ == nullptr) return false;
  buffer_.erase(0, std::exchange(at_, 0));
  const std::size_t old = buffer_.size();
  buffer_.resize(old + (std::size_t{1} << 16));
  const int n = gzread(static_cast<gzFile>(file_), &buffer_[old], 1U << 16);
  buffer_.resize(old + static_cast<std::size_t>(n > 0 ? n : 0));
  int error = Z_OK;
  const char* const why = gzerror(static_cast<gzFile>(file_), &error);
  // What ends in the middle of the compressed data is Z_BUF_ERROR.
  if (error != Z_OK && error != Z_STREAM_END)
    throw bad_trace(name_, number_ + 1, std::string("cannot be read: ") + why);
  return n > 0;
}

bool line_source::next(std::string& line) {
  for (;;) {
    const std::size_t end = buffer_.find('\n', at_);
    if (end != std::string::npos) {
      line.assign(buffer_, at_, end - at_);
      at_ = end + 1;
      break;
    }
    if (buffer_.size() - at_ > longest_line)
      throw bad_trace(name_, number_ + 1, "the line is longer than a megabyte");
    if (fill()) continue;
    if (at_ == buffer_.size()) return false;
    line.assign(buffer_, at_, std::string::npos);
    at_ = buffer_.size();
    break;
  }
  ++number_;
  if (!line.empty() && line.back() == '\r') line.pop_back();
  return true;
}

}  // namespace replay
