/// @file
/// What all counted containers share: reading, and the ways in which counts follow a change.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

#include "../fwd.hpp"
#include "counted_member.hpp"
#include "edit_scope.hpp"
#include "header.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

template <class Std, class = void>
struct ends_with_pop_back : std::false_type {};
template <class Std>
struct ends_with_pop_back<Std, std::void_t<decltype(std::declval<Std&>().pop_back())>>
    : std::true_type {};

template <class Std, class = void>
struct is_contiguous : std::false_type {};
template <class Std>
struct is_contiguous<Std, std::void_t<decltype(std::declval<Std&>().data())>> : std::true_type {};

/// A standard container of raw pointers whose references are counted.
///
/// Invariant, outside of member functions and of an edit scope: each occurrence of a pointer in
/// `std_` is one counted reference. Member functions keep it in this order, so that it survives every
/// exception: change the container as far as it can throw; count what came; unlink what goes; uncount
/// it, with a Reclaimer::scope open until the container has its final state.
///
/// @tparam T         Counted object.
/// @tparam Std       `std::vector<T*>` or another standard container.
/// @tparam Reference Stateless function object: the `T*` of a `Std::value_type`.
/// @tparam Iterator  What begin() and the like return: `Std::iterator` where it cannot write a counted
///                   pointer, `Std::const_iterator` where it could.
template <class T, class Std, class Reference, class Iterator = typename Std::iterator>
class counted_container : private counted_member<Std> {
  static_assert(
      !std::is_pointer<T>::value,
      "slamgc: name the object, not the pointer: rc_vector<KeyFrame>, rc_map<KeyFrame, int>");

 public:
  using std_type = Std;                                   ///< Container inside.
  using value_type = typename Std::value_type;            ///< As in Std.
  using allocator_type = typename Std::allocator_type;    ///< As in Std.
  using size_type = typename Std::size_type;              ///< As in Std.
  using difference_type = typename Std::difference_type;  ///< As in Std.
  using const_reference = typename Std::const_reference;  ///< As in Std.
  using const_pointer = typename Std::const_pointer;      ///< As in Std.
  using iterator = Iterator;                              ///< Cannot change a reference.
  using const_iterator = typename Std::const_iterator;    ///< As in Std.

  /// Whether moving cannot throw. It can with allocators that may differ, also with those that a
  /// standard container would hand over: a counted container keeps its own.
  static constexpr bool nothrow_move =
      std::allocator_traits<allocator_type>::is_always_equal::value &&
      std::is_nothrow_move_assignable<Std>::value;

  /// The container of raw pointers, for reading: costs nothing and counts nothing.
  [[nodiscard]] const Std& raw() const noexcept { return std_; }
  /// The container of raw pointers, for reading, without being asked.
  [[nodiscard]] operator const Std&() const noexcept { return std_; }

  /// As in Std.
  [[nodiscard]] iterator begin() noexcept { return std_.begin(); }
  /// As in Std.
  [[nodiscard]] iterator end() noexcept { return std_.end(); }
  /// As in Std.
  [[nodiscard]] const_iterator begin() const noexcept { return std_.begin(); }
  /// As in Std.
  [[nodiscard]] const_iterator end() const noexcept { return std_.end(); }
  /// As in Std.
  [[nodiscard]] const_iterator cbegin() const noexcept { return std_.begin(); }
  /// As in Std.
  [[nodiscard]] const_iterator cend() const noexcept { return std_.end(); }
  /// As in Std.
  [[nodiscard]] bool empty() const noexcept { return std_.empty(); }
  /// As in Std.
  [[nodiscard]] size_type size() const noexcept { return std_.size(); }
  /// As in Std.
  [[nodiscard]] size_type max_size() const noexcept { return std_.max_size(); }
  /// As in Std.
  [[nodiscard]] allocator_type get_allocator() const noexcept { return std_.get_allocator(); }

  /// A scope that hands out the plain container to code that insists on `std::vector<T*>&`, and
  /// counts what that changed when it ends; see edit_scope. O(size), and one allocation at its begin.
  [[nodiscard]] edit_scope<T, Std, Reference> edit() & {
    return edit_scope<T, Std, Reference>(std_);
  }

  /// Same elements.
  [[nodiscard]] friend bool operator==(const counted_container& a, const counted_container& b) {
    return a.std_ == b.std_;
  }
  /// Same elements.
  [[nodiscard]] friend bool operator==(const counted_container& a, const Std& b) {
    return a.std_ == b;
  }
  /// Same elements.
  [[nodiscard]] friend bool operator==(const Std& a, const counted_container& b) {
    return a == b.std_;
  }
  /// Other elements.
  [[nodiscard]] friend bool operator!=(const counted_container& a, const counted_container& b) {
    return a.std_ != b.std_;
  }
  /// Other elements.
  [[nodiscard]] friend bool operator!=(const counted_container& a, const Std& b) {
    return a.std_ != b;
  }
  /// Other elements.
  [[nodiscard]] friend bool operator!=(const Std& a, const counted_container& b) {
    return a != b.std_;
  }

 protected:
  counted_container() = default;
  explicit counted_container(const Std& content) : std_(content) { add_all(); }
  explicit counted_container(Std&& content) noexcept : std_(std::move(content)) { add_all(); }
  counted_container(const counted_container& other) : counted_member<Std>(), std_(other.std_) {
    add_all();
  }
  counted_container(counted_container&& other) noexcept
      : std_((other.move_all(), std::move(other.std_))) {
    other.std_.clear();
  }
  counted_container& operator=(const counted_container& other) {
    if (this != &other) assign_content(Std(other.std_, std_.get_allocator()));
    return *this;
  }
  counted_container& operator=(counted_container&& other) noexcept(nothrow_move) {
    assign_moved(other);
    return *this;
  }
  ~counted_container() { clear_content(); }

  /// The references of @p content replace those of this container, which keeps its allocator.
  void assign_content(Std&& content) {
    const counted_scope<T> until_final;
    Std next(std::move(content), std_.get_allocator());
    std_.swap(next);
    add_all();
    drop_all(next);
  }
  /// Moves the references of @p other here; it becomes empty.
  void assign_moved(counted_container& other) {
    if (this == &other) return;
    const counted_scope<T> until_final;
    other.move_all();
    Std next(std::move(other.std_), std_.get_allocator());
    other.std_.clear();
    std_.swap(next);
    drop_all(next);
  }
  /// Exchanges the references of two containers: O(size), as each of them changes its place.
  void swap_content(counted_container& other) noexcept {
    if (this == &other) return;
    move_all();
    other.move_all();
    std_.swap(other.std_);
  }
  /// Removes all references, a sequence's last one first, and keeps the capacity. One by one, since moving the whole away would copy
  /// a comparator, which may throw. A vector's places become null first: pop_back() would write its end for each.
  void clear_content() noexcept {
    if (std_.empty()) return;
    const counted_scope<T> until_final;
    if constexpr (is_contiguous<Std>::value) {
      for (auto at = std_.rbegin(); at != std_.rend(); ++at)
        detail::drop_reference(std::exchange(*at, nullptr));
      std_.clear();
    } else {
      do {
        T* gone;
        if constexpr (ends_with_pop_back<Std>::value) {
          gone = reference_of(std_.back());
          std_.pop_back();
        } else {
          gone = reference_of(*std_.begin());
          std_.erase(std_.begin());
        }
        detail::drop_reference(gone);
      } while (!std_.empty());
    }
  }

  static T* reference_of(const value_type& value) noexcept { return Reference()(value); }
  static void add(const value_type& value) noexcept { detail::add_reference(reference_of(value)); }
  static void add_all(const Std& content) noexcept {
    for (const value_type& value : content) add(value);
  }
  void add_all() const noexcept { add_all(std_); }
  void move_all() const noexcept {
    for (const value_type& value : std_) detail::move_reference(reference_of(value));
  }
  static void drop_all(const Std& content) noexcept {
    for (const value_type& value : content) detail::drop_reference(reference_of(value));
  }

  friend struct container_access;
  friend struct member_access;
  Std std_;
};

/// For registries, which take the content out without touching each reference.
struct container_access {
  template <class T, class Std, class Reference, class Iterator>
  static Std& content_of(counted_container<T, Std, Reference, Iterator>& c) noexcept {
    return c.std_;
  }
};

/// Only for iterators: what can be read and advanced.
template <class Input>
using if_iterator = decltype(*std::declval<Input&>(), ++std::declval<Input&>());

/// Reference of a container whose elements are pointers.
struct element_itself {
  template <class T>
  T* operator()(T* const& element) const noexcept {
    return element;
  }
};
/// Reference of a map whose keys are counted.
struct element_key {
  template <class T, class Mapped>
  T* operator()(const std::pair<T* const, Mapped>& element) const noexcept {
    return element.first;
  }
};
/// Reference of a map whose mapped values are counted.
struct element_mapped {
  template <class Key, class T>
  T* operator()(const std::pair<const Key, T*>& element) const noexcept {
    return element.second;
  }
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
