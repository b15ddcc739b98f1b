/// @file
/// What all counted members have in common: in the checked flavour, a watcher of the thread hears of each.
#pragma once

#include "../assert.hpp"
#include "../env.hpp"
#include "../fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// Hears where counted members begin and end on one thread: see diagnosis/check_description.hpp.
class member_watcher {
 public:
  virtual void made(void* member, const char* type) noexcept = 0;
  virtual void ended(const void* member) noexcept = 0;

  /// The calling thread's, or null.
  static member_watcher*& current() noexcept { return std_env::thread_record<place>().watcher; }

 protected:
  ~member_watcher() = default;

 private:
  struct place {
    member_watcher* watcher;
  };
};

/// Base class of counted members, without any size. @p Name is what reports call its type. In the unchecked flavour there is
/// nothing to it.
template <class Name>
class counted_member {
#if SLAMGC_DEBUG
 protected:
  constexpr counted_member() noexcept {
    if (__builtin_is_constant_evaluated()) return;  // a static object
    if (auto* const watcher = member_watcher::current())
      watcher->made(this, type_name<Name>::get());
  }
  ~counted_member() {
    if (auto* const watcher = member_watcher::current()) watcher->ended(this);
  }
  counted_member(const counted_member&) = delete;
  counted_member& operator=(const counted_member&) = delete;
#endif
};

/// Finds that base.
struct member_access {
  template <class Name>
  static const void* address(const counted_member<Name>& member) noexcept {
    return &member;
  }
  template <class Member>
  static const void* of(const Member& member) noexcept {
    return address(member);
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
