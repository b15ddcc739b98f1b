/// @file
/// A list of counted references.
#pragma once

#include <initializer_list>
#include <list>
#include <utility>

#include "../detail/counted_container.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::list<T*, Options...>` whose elements are counted references: `std::list<KeyFrame*>`
/// becomes `rc_list<KeyFrame>`. `T` may be incomplete where the member is declared.
///
/// Iterators are those of the standard list, so loops over `std::list<KeyFrame*>::iterator` stay as
/// they are. Such an iterator could write an element uncounted: **write with replace(), never
/// through the iterator**.
///
/// Each operation costs what it costs in the standard list, plus one change of a count per reference
/// that comes or goes; swap, move and splice count each element. If an allocation or a comparison
/// throws, every count still equals the references in the list.
///
/// Thread-safety: that of the standard list.
template <class T, class... Options>
class rc_list
    : public detail::counted_container<T, std::list<T*, Options...>, detail::element_itself> {
  using std_list = std::list<T*, Options...>;
  using base = detail::counted_container<T, std_list, detail::element_itself>;

 public:
  using reverse_iterator = typename std_list::reverse_iterator;              ///< As in Std.
  using const_reverse_iterator = typename std_list::const_reverse_iterator;  ///< As in Std.
  using typename base::allocator_type;
  using typename base::const_iterator;
  using typename base::const_reference;
  using typename base::iterator;
  using typename base::size_type;

  /// Empty.
  rc_list() = default;
  /// Empty, with an allocator.
  explicit rc_list(const allocator_type& allocator) : base(std_list(allocator)) {}
  /// The elements of @p content.
  rc_list(const std_list& content) : base(content) {}
  /// Takes @p content over.
  rc_list(std_list&& content) noexcept : base(std::move(content)) {}
  /// The elements listed.
  rc_list(std::initializer_list<T*> list) : base(std_list(list)) {}
  /// @p n times @p p.
  explicit rc_list(size_type n, T* p = nullptr) : base(std_list(n, p)) {}
  /// The elements of a range of pointers.
  template <class Input, class = detail::if_iterator<Input>>
  rc_list(Input first, Input last) : base(std_list(first, last)) {}
  /// Counts each element.
  rc_list(const rc_list&) = default;
  /// Leaves @p other empty. O(size): each reference changes its place.
  rc_list(rc_list&& other) noexcept = default;
  ~rc_list() = default;

  /// Counts what comes before it uncounts what goes. Strong guarantee.
  rc_list& operator=(const rc_list& other) = default;
  /// Leaves @p other empty. O(size): each reference changes its place.
  rc_list& operator=(rc_list&& other) = default;
  /// Counts what comes before it uncounts what goes. Strong guarantee.
  rc_list& operator=(const std_list& content) {
    if (&content != &std_) this->assign_content(std_list(content, std_.get_allocator()));
    return *this;
  }
  /// Counts what comes before it uncounts what goes.
  rc_list& operator=(std_list&& content) noexcept(base::nothrow_move) {
    this->assign_content(std::move(content));
    return *this;
  }
  /// Strong guarantee.
  rc_list& operator=(std::initializer_list<T*> list) {
    return *this = std_list(list, std_.get_allocator());
  }
  /// As in Std. Strong guarantee.
  void assign(size_type n, T* p) { *this = std_list(n, p, std_.get_allocator()); }
  /// As in Std. Strong guarantee.
  template <class Input, class = detail::if_iterator<Input>>
  void assign(Input first, Input last) {
    *this = std_list(first, last, std_.get_allocator());
  }
  /// As in Std. Strong guarantee.
  void assign(std::initializer_list<T*> list) { *this = list; }

  /// The first element.
  [[nodiscard]] const_reference front() const noexcept { return std_.front(); }
  /// The last element.
  [[nodiscard]] const_reference back() const noexcept { return std_.back(); }
  /// As in Std.
  [[nodiscard]] reverse_iterator rbegin() noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] reverse_iterator rend() noexcept { return std_.rend(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rbegin() const noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rend() const noexcept { return std_.rend(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator crbegin() const noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator crend() const noexcept { return std_.rend(); }

  /// The element at @p at refers to @p p: what `*at = p` is in the standard list.
  void replace(iterator at, T* p) noexcept {
    detail::add_reference(p);
    detail::drop_reference(std::exchange(*at, p));
  }
  /// As in Std.
  void push_back(T* p) { insert(std_.end(), p); }
  /// As in Std.
  void push_front(T* p) { insert(std_.begin(), p); }
  /// As in Std.
  const_reference emplace_back(T* p = nullptr) { return *insert(std_.end(), p); }
  /// As in Std.
  const_reference emplace_front(T* p = nullptr) { return *insert(std_.begin(), p); }
  /// As in Std.
  void pop_back() noexcept { erase(--std_.end()); }
  /// As in Std.
  void pop_front() noexcept { erase(std_.begin()); }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, T* p) {
    const iterator inserted = std_.insert(at, p);
    detail::add_reference(p);
    return inserted;
  }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, size_type n, T* p) {
    return insert_list(at, std_list(n, p, std_.get_allocator()));
  }
  /// As in Std. Strong guarantee.
  template <class Input, class = detail::if_iterator<Input>>
  iterator insert(const_iterator at, Input first, Input last) {
    return insert_list(at, std_list(first, last, std_.get_allocator()));
  }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, std::initializer_list<T*> list) {
    return insert(at, list.begin(), list.end());
  }
  /// As in Std.
  iterator emplace(const_iterator at, T* p) { return insert(at, p); }
  /// As in Std.
  iterator erase(const_iterator at) noexcept {
    const detail::counted_scope<T> until_final;
    T* const gone = *at;
    const iterator next = std_.erase(at);
    detail::drop_reference(gone);
    return next;
  }
  /// As in Std.
  iterator erase(const_iterator first, const_iterator last) noexcept {
    const detail::counted_scope<T> until_final;
    while (first != last) first = erase(first);
    return std_.erase(first, first);
  }
  /// As in Std.
  void resize(size_type n, T* p = nullptr) {
    const detail::counted_scope<T> until_final;
    while (std_.size() > n) pop_back();
    if (std_.size() < n) insert(std_.end(), n - std_.size(), p);
  }
  /// As in Std.
  void clear() noexcept { this->clear_content(); }
  /// Exchanges the elements of two lists: O(size), as each reference changes its place.
  void swap(rc_list& other) noexcept { this->swap_content(other); }
  /// Exchanges the elements of two lists: O(size), as each reference changes its place.
  friend void swap(rc_list& a, rc_list& b) noexcept { a.swap(b); }

  /// As in Std. O(other.size()): each reference changes its place. Into itself: nothing happens.
  void splice(const_iterator at, rc_list& other) noexcept {
    if (this == &other) return;
    other.move_all();
    std_.splice(at, other.std_);
  }
  /// As in Std.
  void splice(const_iterator at, rc_list& other, const_iterator element) noexcept {
    if (this != &other) detail::move_reference(*element);
    std_.splice(at, other.std_, element);
  }
  /// As in Std. O(distance): each reference changes its place.
  void splice(const_iterator at, rc_list& other, const_iterator first,
              const_iterator last) noexcept {
    if (this != &other)
      for (const_iterator i = first; i != last; ++i) detail::move_reference(*i);
    std_.splice(at, other.std_, first, last);
  }
  /// As in Std; returns how many were removed.
  size_type remove(T* p) noexcept {
    return remove_if([p](T* element) noexcept { return element == p; });
  }
  /// As in Std; returns how many were removed.
  template <class Predicate>
  size_type remove_if(Predicate predicate) {
    const detail::counted_scope<T> until_final;
    size_type removed = 0;
    for (const_iterator i = std_.begin(); i != std_.end();) {
      if (predicate(*i)) {
        i = erase(i);
        ++removed;
      } else {
        ++i;
      }
    }
    return removed;
  }
  /// As in Std; returns how many were removed.
  size_type unique() {
    return unique([](T* a, T* b) noexcept { return a == b; });
  }
  /// As in Std; returns how many were removed.
  template <class Same>
  size_type unique(Same same) {
    const detail::counted_scope<T> until_final;
    size_type removed = 0;
    for (const_iterator i = std_.begin(); i != std_.end();) {
      const_iterator next = i;
      ++next;
      if (next == std_.cend() || !same(*i, *next)) {
        i = next;
      } else {
        erase(next);
        ++removed;
      }
    }
    return removed;
  }
  /// As in Std. O(other.size()) counts: each reference changes its place.
  template <class... Compare>
  void merge(rc_list& other, Compare... compare) {
    if (this == &other) return;
    other.move_all();
    std_.merge(other.std_, compare...);
  }
  /// As in Std.
  template <class... Compare>
  void sort(Compare... compare) {
    std_.sort(compare...);
  }
  /// As in Std.
  void reverse() noexcept { std_.reverse(); }

 private:
  using base::std_;

  iterator insert_list(const_iterator at, std_list&& content) noexcept {
    base::add_all(content);
    const iterator first = content.empty() ? std_.erase(at, at) : content.begin();
    std_.splice(at, content);
    return first;
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
