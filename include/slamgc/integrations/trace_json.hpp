/// @file
/// What a domain does, as a trace that Perfetto (https://ui.perfetto.dev) and Chrome (chrome://tracing) show.
///
/// Format: Trace Event Format, JSON array. It may end anywhere: what a program wrote before it crashed can be read.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <mutex>
#include <thread>

#include "../diagnosis/hooks.hpp"

namespace slamgc {

/// Writes a trace of one domain to a file: `domain.install(&trace)`.
///
/// Shown are the slices of collect() with their outcomes, the grace periods that span several, for each type the numbers of live and
/// waiting objects, and what the program adds with span. Some 150 bytes for each slice and each type that changed.
///
/// Thread-safety: span and name_thread() on any thread at any time while this exists.
class trace_json final : public collector_hooks {
 public:
  /// Creates the file @p path. Whether that worked, good() says.
  explicit trace_json(const char* path) noexcept
      : file_(std::fopen(path, "w")), start_(clock::now()) {
    if (file_ != nullptr) std::fputs("[", file_);
  }
  /// Ends the file. Not while it is installed.
  ~trace_json() override {
    if (file_ == nullptr) return;
    std::fputs("\n]\n", file_);
    std::fclose(file_);
  }
  trace_json(const trace_json&) = delete;
  trace_json& operator=(const trace_json&) = delete;

  /// Whether all that was written so far could be written, to memory at least.
  [[nodiscard]] bool good() const noexcept {
    const std::lock_guard<std::mutex> lock(mutex_);
    return file_ != nullptr && std::ferror(file_) == 0;
  }

  /// Names the calling thread in the trace.
  void name_thread(const char* name) noexcept {
    const event e(*this, "thread_name", "M", clock::now());
    e.open("args");
    e.text("name", name);
    e.close();
  }

  /// Shows what the program does while this exists: one per frame, say. By one thread.
  class span {
   public:
    /// Begins. @p name has to stay valid until the end.
    span(trace_json& trace, const char* name) noexcept
        : trace_(trace), name_(name), begin_(clock::now()) {}
    /// Ends.
    ~span() {
      const event e(trace_, name_, "X", begin_);
      e.time("dur", clock::now() - begin_);
    }
    span(const span&) = delete;
    span& operator=(const span&) = delete;

   private:
    trace_json& trace_;
    const char* const name_;
    const time_point begin_;
  };

  /// Writes the end of it.
  void grace_period_closed(std::uint64_t number, time_point when) noexcept override {
    if (number == open_) grace_period("e", number, when);
  }
  /// Writes its beginning.
  void grace_period_opened(std::uint64_t number, time_point when) noexcept override {
    open_ = number;
    grace_period("b", number, when);
  }
  /// Writes the numbers.
  void objects(const type_stats& now, std::uint64_t) noexcept override {
    counter("live ", now, now.live);
    counter("backlog ", now, now.backlog);
  }
  /// Writes the slice.
  void slice_ended(const slice_stats& s) noexcept override {
    const event e(*this, "collect", "X", s.begin);
    e.time("dur", s.took);
    e.open("args");
    e.text("outcome", name_of(s.did.result));
    e.number("reclaimed", s.did.reclaimed);
    e.number("grace periods", s.grace_periods);
    e.number("backlog", s.delayed.backlog);
    if (s.delayed.oldest != nullptr) e.text("waits for", s.delayed.oldest);
    e.close();
  }

 private:
  using clock = std::chrono::steady_clock;

  /// One event, written member by member under the lock.
  class event {
   public:
    event(const trace_json& of, const char* name, const char* phase, time_point when,
          const char* more = "") noexcept
        : lock_(of.mutex_), file_(of.file_) {
      if (file_ == nullptr) return;
      std::fputs(of.first_ ? "\n{\"name\":\"" : ",\n{\"name\":\"", file_);
      of.first_ = false;
      characters(name);
      characters(more);
      std::fputs("\"", file_);
      text("ph", phase);
      number("pid", 1);
      // What Chrome takes; threads whose numbers collide are shown as one.
      number("tid", std::hash<std::thread::id>()(std::this_thread::get_id()) % 1000000007);
      time("ts", when - of.start_);
    }
    ~event() {
      if (file_ != nullptr) std::fputs("}", file_);
    }
    event(const event&) = delete;
    event& operator=(const event&) = delete;

    void text(const char* key, const char* value) const noexcept {
      if (file_ == nullptr) return;
      this->key(key);
      std::fputc('"', file_);
      characters(value);
      std::fputc('"', file_);
    }
    void number(const char* key, std::uint64_t value) const noexcept {
      if (file_ == nullptr) return;
      this->key(key);
      std::fprintf(file_, "%llu", static_cast<unsigned long long>(value));
    }
    /// In microseconds.
    void time(const char* key, std::chrono::nanoseconds value) const noexcept {
      if (file_ == nullptr) return;
      this->key(key);
      const long long n = value.count() > 0 ? value.count() : 0;
      std::fprintf(file_, "%lld.%03lld", n / 1000, n % 1000);
    }
    void open(const char* key) const noexcept {
      if (file_ == nullptr) return;
      this->key(key);
      std::fputc('{', file_);
      inside_ = true;
    }
    void close() const noexcept {
      if (file_ != nullptr) std::fputc('}', file_);
    }

   private:
    void key(const char* name) const noexcept {
      std::fprintf(file_, "%s\"%s\":", inside_ ? "" : ",", name);
      inside_ = false;
    }
    void characters(const char* s) const noexcept {
      for (; *s != '\0'; ++s) {
        const auto c = static_cast<unsigned char>(*s);
        if (c < 0x20) {
          std::fprintf(file_, "\\u%04x", static_cast<unsigned>(c));
        } else {
          if (c == '"' || c == '\\') std::fputc('\\', file_);
          std::fputc(c, file_);
        }
      }
    }

    const std::lock_guard<std::mutex> lock_;
    std::FILE* const file_;
    mutable bool inside_ = false;  // an object that has no member yet
  };

  void grace_period(const char* phase, std::uint64_t number, time_point when) noexcept {
    const event e(*this, "grace period", phase, when);
    e.text("cat", "slamgc");
    e.number("id", number);
  }
  void counter(const char* what, const type_stats& of, std::uint64_t value) noexcept {
    const event e(*this, what, "C", clock::now(), of.type);
    e.open("args");
    e.number("objects", value);
    e.close();
  }
  static const char* name_of(collected::outcome o) noexcept {
    using outcome = collected::outcome;
    switch (o) {
      case outcome::done:
        return "done";
      case outcome::waiting:
        return "waiting";
      case outcome::partial:
        return "partial";
      case outcome::busy:
        return "busy";
      case outcome::refused:
        break;
    }
    return "refused";
  }

  mutable std::mutex mutex_;
  std::FILE* const file_;
  const time_point start_;
  mutable bool first_ = true;
  std::uint64_t open_ = 0;  // the collector's: the grace period that was written
};

}  // namespace slamgc
