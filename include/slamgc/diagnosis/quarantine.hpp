/// @file
/// Finding a use after reclaim: memory is poisoned and held back, and reports say where the object came to its end.
///
/// A reclaimed object's destructor runs as always; then its bytes are overwritten with 0xdd, and its memory is freed only when
/// enough others have followed. Meanwhile
/// - a reference to it that is counted or uncounted, a retire() of it and a slamgc::borrow of it are reported at once;
/// - a write into it is reported when it leaves the quarantine, and by check();
/// - a pointer read from it is 0xdddddddddddddddd, and using that traps on most machines;
/// - with AddressSanitizer its memory is poisoned for that, too: any use of it traps with AddressSanitizer's own report.
///
/// Reports are those of `SLAMGC_ASSERT`; the default one prints the places, too: of the use, of retire() or of the drop of the last
/// reference, of the reclamation, and where a pointer was borrowed. Places need `<execinfo.h>` (glibc, macOS).
///
/// What cannot be held back, and is deleted as usual: detail/hold_back.hpp. Memory that a member had allocated is its
/// allocator's, and is freed as usual.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <map>
#include <mutex>
#include <new>
#include <vector>

#include "../assert.hpp"
#include "../detail/object_watch.hpp"
#include "../detail/poison.hpp"
#include "../detail/stacks.hpp"
#include "../fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// How much a quarantine holds back, and what it reports.
struct quarantine_options {
  std::size_t bytes = std::size_t{64} << 20;           ///< Most bytes held back, of objects alone.
  std::size_t objects = static_cast<std::size_t>(-1);  ///< Most objects held back.
  bool double_retire = false;  ///< Report a second retire() of an object, which programs may mean.
};

/// What is known of the end of an object.
struct object_history {
  const void* object = nullptr;  ///< Its address; null: nothing is known.
  const char* type = "";         ///< Its type, as the compiler spells it.
  std::size_t size = 0;          ///< Bytes that are held back, or 0: it was not reclaimed yet.
  bool was_retired =
      false;  ///< Whether `ended` is a retire(); else the drop of the last reference.
  std::vector<void*> ended;  ///< Return addresses of that, the innermost first; empty: not known.
  std::vector<void*> reclaimed;  ///< Return addresses of its reclamation.
};

/// Holds back the memory of all objects that are reclaimed in the process while this exists, the oldest for the longest time.
///
/// One at a time, made and destroyed while no other thread uses objects: first in `main`, say. In the checked flavour; code in the
/// unchecked one does not know of it. Without one, the checked flavour costs a branch for each object that is retired, falls to zero or is destroyed,
/// and the unchecked one nothing.
///
/// Thread-safety: all other operations by any thread at any time. Each reclamation, retirement and borrow takes a lock and
/// two stack walks at most.
class quarantine final : private runtime::object_watch {
 public:
  /// Begins to hold back. A second one at the same time is reported, and does nothing.
  explicit quarantine(quarantine_options options = {}) noexcept
      : options_(options), works_(runtime::watch == nullptr) {
    SLAMGC_ASSERT(works_, (misuse{"starts a second quarantine", "quarantine", this, 0}));
    if (!works_) return;
    (void)here();  // the first stack walk may load a library
    runtime::watch = this;
#if defined(SLAMGC_HAS_ASAN)
    __asan_set_error_report_callback(&after_asan);
#endif
  }
  /// Checks and frees what it holds.
  ~quarantine() {
    if (!works_) return;
    options_.bytes = options_.objects = 0;
    trim();
    runtime::watch = nullptr;
#if defined(SLAMGC_HAS_ASAN)
    __asan_set_error_report_callback(nullptr);
#endif
  }
  quarantine(const quarantine&) = delete;
  quarantine& operator=(const quarantine&) = delete;

  /// Looks for writes into what is held, and reports each object once; returns how many were found. O(bytes held).
  std::size_t check() noexcept {
    std::size_t found = 0;
    for (held_memory at{}; next_damaged(at); ++found) report_damage(at);
    return found;
  }
  /// Objects held back now.
  [[nodiscard]] std::size_t held() const noexcept {
    return locked([this] { return order_.size(); });
  }
  /// Their bytes.
  [[nodiscard]] std::size_t bytes() const noexcept {
    return locked([this] { return bytes_; });
  }
  /// Objects that could not be held back so far.
  [[nodiscard]] std::size_t not_held() const noexcept {
    return locked([this] { return not_held_; });
  }

  /// What is known of the object at @p p, or around it if it is held. Throws std::bad_alloc. O(log(objects)).
  [[nodiscard]] object_history history(const void* p) const {
    return locked([&] {
      object_history h;
      const auto found = find(p);
      if (found == records_.end()) return h;
      const record& r = found->second;
      h.object = found->first;
      h.type = r.type;
      h.size = r.held ? r.memory.size : 0;
      h.was_retired = r.was_retired;
      h.ended = stacks_.frames(r.ended);
      h.reclaimed = stacks_.frames(r.reclaimed);
      return h;
    });
  }

 private:
  using held_memory = runtime::held_memory;
  using address = const unsigned char*;

  struct record {
    const char* type = "";
    bool was_retired = false;
    bool held = false;
    bool reported = false;
    place ended = 0;
    place reclaimed = 0;
    held_memory memory{};
  };
  using records = std::map<address, record>;

  // ---- told by the library

  void falls_to_zero(const void* object, const char* type) noexcept override {
    note(object, type, false);
  }
  void retired(const void* object, const char* type) noexcept override { note(object, type, true); }
  bool reports_double_retire() const noexcept override { return options_.double_retire; }
  void hold(const held_memory& m) noexcept override {
    const place now = here();
    const bool kept = attempt([&] {
      record& r = records_[static_cast<address>(m.begin)];
      order_.push_back(static_cast<address>(m.begin));
      r.type = m.type;
      r.held = true;
      r.reclaimed = now;
      r.memory = m;
      bytes_ += m.size;
      detail::poison(m);
    });
    if (kept)
      trim();
    else
      m.free(m);
  }
  void let_go(const void* object) noexcept override {
    locked([&] {
      records_.erase(static_cast<address>(object));
      ++not_held_;
    });
  }
  bool holds(const void* p) noexcept override {
    return locked([&] {
      const auto found = find(p);
      return found != records_.end() && found->second.held;
    });
  }
  place here() noexcept override {
    const auto stack = detail::stacks::here();
    place at = 0;
    (void)attempt([&] { at = stacks_.add(stack); });
    return at;
  }
  void print(const void* p, place borrowed) noexcept override {
    const place now = here();
    locked([&] {
      stacks_.print("the misuse was found here", now);
      stacks_.print("the pointer was borrowed here", borrowed);
      print_history(p);
    });
  }

  // ---- records

  template <class F>
  auto locked(F f) const -> decltype(f()) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return f();
  }
  /// False if there was no memory.
  template <class F>
  bool attempt(F f) noexcept {
#if defined(__cpp_exceptions)
    try {
      locked(f);
      return true;
    } catch (const std::bad_alloc&) {
      return false;
    }
#else
    locked(f);
    return true;
#endif
  }
  void note(const void* object, const char* type, bool is_retired) noexcept {
    const place now = here();
    (void)attempt([&] {
      record& r = records_[static_cast<address>(object)];
      if (r.held || (r.was_retired && !is_retired && r.type == type)) return;
      r.type = type;
      r.was_retired = is_retired;
      r.ended = now;
    });
  }
  records::const_iterator find(const void* p) const noexcept {
    auto found = records_.upper_bound(static_cast<address>(p));
    if (found == records_.begin()) return records_.end();
    --found;
    const auto offset = static_cast<std::size_t>(static_cast<address>(p) - found->first);
    const record& r = found->second;
    return offset == 0 || (r.held && offset < r.memory.size) ? found : records_.end();
  }

  // ---- the memory

  /// The next one behind @p at that was not reported yet.
  bool next_damaged(held_memory& at) noexcept {
    return locked([&] {
      const auto begin = records_.upper_bound(static_cast<address>(at.begin));
      for (auto i = begin; i != records_.end(); ++i) {
        record& r = i->second;
        if (!r.held || r.reported || detail::first_damage(r.memory) == r.memory.size) continue;
        r.reported = true;
        at = r.memory;
        return true;
      }
      return false;
    });
  }
  static void report_damage([[maybe_unused]] const held_memory& m) noexcept {
    SLAMGC_ASSERT(false, (misuse{"writes into an object that was reclaimed", m.type, m.begin, 0}));
  }
  void trim() noexcept {
    for (;;) {
      held_memory oldest{};
      bool damaged = false;
      locked([&] {
        if (order_.size() <= options_.objects && bytes_ <= options_.bytes) return;
        record& r = records_.find(order_.front())->second;
        order_.pop_front();
        oldest = r.memory;
        bytes_ -= oldest.size;
        damaged = !r.reported && detail::first_damage(oldest) != oldest.size;
        r.reported = true;
      });
      if (oldest.begin == nullptr) return;
      if (damaged) report_damage(oldest);  // finds its record still
      locked([&] { records_.erase(static_cast<address>(oldest.begin)); });
      detail::unpoison(oldest);
      oldest.free(oldest);
    }
  }

  // ---- reports

  void print_history(const void* p) const noexcept {
    const auto found = find(p);
    if (found == records_.end()) return;
    const record& r = found->second;
    const void* const at = found->first;
    std::fprintf(stderr, "slamgc: of the object of type %s at %p is known:\n", r.type, at);
    stacks_.print(r.was_retired ? "it was retired here" : "its last reference was dropped here",
                  r.ended);
    stacks_.print("it was reclaimed here", r.reclaimed);
    if (!r.held) return;
    const std::size_t damage = detail::first_damage(r.memory);
    if (damage != r.memory.size)
      std::fprintf(stderr, "slamgc: it was written to afterwards, first at byte %zu of %zu\n",
                   damage, r.memory.size);
  }
#if defined(SLAMGC_HAS_ASAN)
  static void after_asan(const char*) noexcept {
    if (auto* const q = static_cast<quarantine*>(runtime::watch))
      q->locked([q] { q->print_history(__asan_get_report_address()); });
  }
#endif

  quarantine_options options_;
  const bool works_;
  mutable std::mutex mutex_;
  records records_;
  std::deque<address> order_;  // of those that are held, the oldest first
  std::size_t bytes_ = 0;
  std::size_t not_held_ = 0;
  detail::stacks stacks_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
