/// @file
/// Where a tool that watches objects is told of them; diagnosis/quarantine.hpp is one.
///
/// In the checked flavour only: there it is one branch for each object that is retired, falls to zero or is destroyed.
#pragma once

#include <cstddef>
#include <cstdint>

#include "../flavour.hpp"

namespace slamgc {
namespace runtime SLAMGC_SHARED {

/// The memory of an object whose destructor has run.
struct held_memory {
  static constexpr unsigned char pattern = 0xdd;  // of all bytes but the header's

  void* begin;
  std::size_t size;
  const char* type;
  void* header;  // a new one: who counts a reference to the object is found out by it
  std::size_t header_size;
  bool (*header_is_new)(const void* header) noexcept;
  void (*free)(const held_memory&) noexcept;  // what `delete` does after the destructor
};

class object_watch {
 public:
  using place = std::uint32_t;  // in the program, by its stack; 0: not known

  /// The calling thread is about to drop the last reference to the object.
  virtual void falls_to_zero(const void* object, const char* type) noexcept = 0;
  virtual void retired(const void* object, const char* type) noexcept = 0;
  /// Whether to report that it was retired before.
  virtual bool reports_double_retire() const noexcept = 0;
  /// Memory to free, now or later.
  virtual void hold(const held_memory& memory) noexcept = 0;
  /// The object is destroyed as usual.
  virtual void let_go(const void* object) noexcept = 0;
  /// Whether @p p points into memory that is held.
  virtual bool holds(const void* p) noexcept = 0;
  virtual place here() noexcept = 0;
  /// Prints what is known of the object at @p p, to the standard error stream.
  virtual void print(const void* p, place borrowed) noexcept = 0;

 protected:
  ~object_watch() = default;
};

/// Changed only while no other thread uses objects.
inline object_watch* watch = nullptr;

}  // namespace SLAMGC_SHARED

inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Null, as the compiler knows, in the unchecked flavour. (Were it constexpr, g++ would warn of calls that are never made.)
inline runtime::object_watch* watch() noexcept {
#if SLAMGC_DEBUG
  return runtime::watch;
#else
  return nullptr;
#endif
}

/// Whether the object at @p p was reclaimed and somebody found out in time.
inline bool was_reclaimed(const void* p) noexcept {
  return watch() != nullptr && watch()->holds(p);
}

/// Whether a second retirement is to be reported.
inline bool reports_double_retire() noexcept {
  return watch() != nullptr && watch()->reports_double_retire();
}

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
