/// @file
/// A test that fails when an edges() does not name each counted member once.
///
/// ```
/// TEST(KeyFrame, Description) {
///   const auto check = slamgc::check_description<KeyFrame>([] { return new KeyFrame(frame); });
///   EXPECT_TRUE(check.ok()) << check.words();
/// }
/// ```
///
/// **How.** Each counted member has an empty base class, which in the checked flavour tells a watcher of the calling thread where
/// it begins and ends. So while an object is made, its counted members are known, whether they are empty or not: those that edges()
/// then does not name are missing. In the unchecked flavour the base class does nothing, and this does not compile.
///
/// **Not seen**: an intrusive_rc, which is for locals and no edge (audit() shows what it counts); members that another thread makes, or
/// that are made later, such as elements that a `std::vector<rc_set<T>>` gets when the object is in use.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "../detail/counted_member.hpp"
#include "../detail/described.hpp"
#include "../detail/header.hpp"
#include "../detail/report_text.hpp"
#include "../dispositions.hpp"
#include "../edges.hpp"
#include "../fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// What check_description() has found.
struct description_check {
  /// A counted member.
  struct member {
    const void* address = nullptr;  ///< Where it is; where it was, when the check is over.
    std::string type;               ///< Its type; of a container, the standard one inside.
    std::string name;               ///< What edges() calls it; empty: nothing.
    bool inside = false;     ///< Whether it is within the object itself, and not on the heap.
    std::size_t offset = 0;  ///< If so: its distance from the object's address, in bytes.
  };
  std::string type;  ///< The type that was checked.
  std::vector<member>
      missing;  ///< Members that were made with the object, and that edges() does not name.
  std::vector<member> repeated;  ///< Those that it names again.
  std::vector<member> foreign;   ///< What it names, and what was not made with the object.
  bool threw = false;            ///< Whether edges() threw.

  /// Whether edges() names each counted member once.
  [[nodiscard]] bool ok() const noexcept {
    return missing.empty() && repeated.empty() && foreign.empty() && !threw;
  }
  /// Lines of text; none if it is right.
  [[nodiscard]] std::string words() const {
    std::string out;
    for (const member& m : missing)
      write(out, m, "has a counted member that edges() does not name");
    for (const member& m : repeated) write(out, m, "edges() names a member more than once");
    for (const member& m : foreign) write(out, m, "edges() names a member of another object");
    if (threw) out += type + ": edges() threw\n";
    return out;
  }

 private:
  void write(std::string& out, const member& m, const char* what) const {
    out += type + ": " + what + ": " + (m.name.empty() ? "" : "\"" + m.name + "\", ") + m.type;
    out +=
        m.inside ? ", at offset " + std::to_string(m.offset) + '\n' : ", outside of the object\n";
  }
};

namespace detail {

/// Knows the members that one thread has made while it exists, and that still are.
class member_list final : public member_watcher {
 public:
  using member = description_check::member;

  member_list() noexcept : outer_(std::exchange(current(), this)) {}
  ~member_list() { stop(); }
  member_list(const member_list&) = delete;
  member_list& operator=(const member_list&) = delete;

  void stop() noexcept {
    if (current() == this) current() = outer_;
  }
  void made(void* address, const char* type) noexcept override {
    ended(address);
    member m;
    m.address = address;
    m.type = type;
    members.push_back(std::move(m));
  }
  void ended(const void* address) noexcept override {
    const auto is_it = [=](const member& m) { return m.address == address; };
    members.erase(std::remove_if(members.begin(), members.end(), is_it), members.end());
  }

  std::vector<member> members;

 private:
  member_watcher* outer_;
};

/// Compares edges() with what is known.
struct naming_visitor {
  description_check& check;
  std::vector<description_check::member>& members;

  template <class Member, class Disposition = on_retire::hold_edge>
  void edge(const char* name, Member& named, const Disposition& = {}) {
    using counted = std::remove_const_t<Member>;
    static_assert(sizeof(edge_member<counted>) != 0, "says what is wrong with it");
    const void* const address = member_access::of(named);
    for (auto& m : members) {
      if (m.address != address) continue;
      if (m.name.empty())
        m.name = name;
      else
        add(check.repeated, m, m.name + "\" and \"" + name);
      return;
    }
    description_check::member unknown;
    unknown.address = address;
    unknown.type = type_name<counted>::get();
    add(check.foreign, std::move(unknown), name);
  }

 private:
  static void add(std::vector<description_check::member>& to, description_check::member m,
                  std::string name) {
    m.name = std::move(name);
    to.push_back(std::move(m));
  }
};

template <class T, class = void>
struct is_counted : std::false_type {};
template <class T>
struct is_counted<T, std::void_t<decltype(std::declval<const T&>().state().is_queued())>>
    : std::true_type {};

}  // namespace detail

/// Whether the edges() of T names each of its counted members once. @p make returns a new T, made with `new` on the calling
/// thread, and nothing else that has counted members and stays; what T needs, it makes before. The object is deleted, unless
/// somebody refers to it. T may be an object or what a root describes.
///
/// Only in the checked flavour. Throws what @p make throws. O(counted members squared).
template <class T, class Make>
[[nodiscard]] description_check check_description(Make make) {
  static_assert(
      detail::has_edges<T>::value,
      "slamgc: check_description() is for types with `template <class V> void edges(V& v)`");
  static_assert(SLAMGC_DEBUG != 0 || detail::false_for<T>::value,
                "slamgc: check_description() needs the checked flavour: compile this test with "
                "-DSLAMGC_DEBUG=1");
  description_check check;
  check.type = detail::short_name(detail::type_name<T>::get());
  detail::member_list list;
  T* const object = make();
  list.stop();
  detail::naming_visitor visitor{check, list.members};
  check.threw = !detail::visit_edges(*object, visitor);
  for (const auto& m : list.members)
    if (m.name.empty()) check.missing.push_back(m);

  const auto* const begin = reinterpret_cast<const char*>(object);
  for (auto* found : {&check.missing, &check.repeated, &check.foreign})
    for (auto& m : *found) {
      const auto distance =
          reinterpret_cast<std::uintptr_t>(m.address) - reinterpret_cast<std::uintptr_t>(begin);
      m.inside = distance < sizeof(T);
      if (m.inside) m.offset = static_cast<std::size_t>(distance);
    }
  bool unused = true;
  if constexpr (detail::is_counted<T>::value)
    unused = object->state().count() == 0 && !object->state().is_queued();
  if (unused) delete object;
  return check;
}
/// The same for a T that is made without arguments.
template <class T>
[[nodiscard]] description_check check_description() {
  return check_description<T>([] { return new T; });
}

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
