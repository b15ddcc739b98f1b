/// @file
/// A vector of counted references.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <utility>
#include <vector>

#include "../detail/counted_container.hpp"
#include "../detail/element_ref.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::vector<T*, Options...>` whose elements are counted references: `std::vector<MapPoint*>`
/// becomes `rc_vector<MapPoint>`. `T` may be incomplete where the member is declared.
///
/// Reading costs what it costs in the standard vector. Iterators are the const iterators of the
/// standard vector, since the others could write an element uncounted; `v[i] = p` writes and counts,
/// and `edit()` hands out the plain vector for the rest.
///
/// Each operation costs what it costs in the standard vector, plus one change of a count per
/// reference that comes or goes; swap and move count each element. Strong guarantee: if an
/// allocation throws, nothing has changed. What is assigned may not be a member of an object that this vector alone keeps, unless
/// the thread is a mutator of the object's domain.
///
/// Thread-safety: that of the standard vector. Moreover several threads may assign elements, `v[i] = p`,
/// and read them by `v.load(i)` at once, without a lock, while none changes the vector as a whole.
template <class T, class... Options>
class rc_vector
    : public detail::counted_container<T, std::vector<T*, Options...>, detail::element_itself,
                                       typename std::vector<T*, Options...>::const_iterator> {
  using std_vector = std::vector<T*, Options...>;
  using base = detail::counted_container<T, std_vector, detail::element_itself,
                                         typename std_vector::const_iterator>;

 public:
  using reference = detail::element_ref<T>;  ///< Reads like a `T*`, counts when assigned.
  using const_reverse_iterator = typename std_vector::const_reverse_iterator;  ///< As in Std.
  using reverse_iterator = const_reverse_iterator;  ///< Cannot change a reference.
  using typename base::allocator_type;
  using typename base::const_iterator;
  using typename base::const_reference;
  using typename base::iterator;
  using typename base::size_type;

  /// Empty.
  rc_vector() = default;
  /// Empty, with an allocator.
  explicit rc_vector(const allocator_type& allocator) : base(std_vector(allocator)) {}
  /// The elements of @p content.
  rc_vector(const std_vector& content) : base(content) {}
  /// Takes @p content over.
  rc_vector(std_vector&& content) noexcept : base(std::move(content)) {}
  /// The elements listed.
  rc_vector(std::initializer_list<T*> list) : base(std_vector(list)) {}
  /// @p n times @p p.
  explicit rc_vector(size_type n, T* p = nullptr) : base(std_vector(n, p)) {}
  /// The elements of a range of pointers.
  template <class Input, class = detail::if_iterator<Input>>
  rc_vector(Input first, Input last) : base(std_vector(first, last)) {}
  /// Counts each element.
  rc_vector(const rc_vector&) = default;
  /// Leaves @p other empty. O(size): each reference changes its place.
  rc_vector(rc_vector&& other) noexcept = default;
  ~rc_vector() = default;

  /// Strong guarantee. Elements that stay the same are not counted anew.
  rc_vector& operator=(const rc_vector& other) { return *this = other.std_; }
  /// Leaves @p other empty. O(size): each reference changes its place.
  rc_vector& operator=(rc_vector&& other) noexcept(base::nothrow_move) {
    this->assign_moved(other);
    return *this;
  }
  /// Strong guarantee. Elements that stay the same are not counted anew.
  rc_vector& operator=(const std_vector& content) {
    assign_pointers(content);
    return *this;
  }
  /// Strong guarantee. Elements that stay the same are not counted anew.
  rc_vector& operator=(std_vector&& content) {
    if (content.capacity() > std_.capacity())
      this->assign_content(std::move(content));
    else
      assign_pointers(content);
    return *this;
  }
  /// Strong guarantee.
  rc_vector& operator=(std::initializer_list<T*> list) {
    return *this = std_vector(list, std_.get_allocator());
  }
  /// As in Std. Strong guarantee.
  void assign(size_type n, T* p) { *this = std_vector(n, p, std_.get_allocator()); }
  /// As in Std. Strong guarantee.
  template <class Input, class = detail::if_iterator<Input>>
  void assign(Input first, Input last) {
    *this = std_vector(first, last, std_.get_allocator());
  }
  /// As in Std. Strong guarantee.
  void assign(std::initializer_list<T*> list) { *this = list; }

  /// The element, to read or to assign.
  [[nodiscard]] reference operator[](size_type i) noexcept { return reference(std_[i]); }
  /// The element.
  [[nodiscard]] const_reference operator[](size_type i) const noexcept { return std_[i]; }
  /// The element, for a reader that does not hold the lock under which others assign elements.
  [[nodiscard]] T* load(size_type i) const noexcept {
    return detail::policy_of<T>::env::load(std_[i]);
  }
  /// The element, to read or to assign. Throws std::out_of_range.
  [[nodiscard]] reference at(size_type i) { return reference(std_.at(i)); }
  /// The element. Throws std::out_of_range.
  [[nodiscard]] const_reference at(size_type i) const { return std_.at(i); }
  /// The first element, to read or to assign.
  [[nodiscard]] reference front() noexcept { return reference(std_.front()); }
  /// The first element.
  [[nodiscard]] const_reference front() const noexcept { return std_.front(); }
  /// The last element, to read or to assign.
  [[nodiscard]] reference back() noexcept { return reference(std_.back()); }
  /// The last element.
  [[nodiscard]] const_reference back() const noexcept { return std_.back(); }
  /// The elements, for reading.
  [[nodiscard]] T* const* data() const noexcept { return std_.data(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rbegin() const noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rend() const noexcept { return std_.rend(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator crbegin() const noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator crend() const noexcept { return std_.rend(); }

  /// As in Std.
  [[nodiscard]] size_type capacity() const noexcept { return std_.capacity(); }
  /// As in Std.
  void reserve(size_type n) { std_.reserve(n); }
  /// As in Std.
  void shrink_to_fit() { std_.shrink_to_fit(); }
  /// As in Std: new elements are @p p.
  void resize(size_type n, T* p = nullptr) {
    if (n < std_.size()) {
      erase(std_.begin() + static_cast<std::ptrdiff_t>(n), std_.end());
    } else {
      const size_type old = std_.size();
      std_.resize(n, p);
      add_from(old, n - old);
    }
  }
  /// As in Std.
  void push_back(T* p) {
    std_.push_back(p);
    detail::add_reference(p);
  }
  /// As in Std.
  reference emplace_back(T* p = nullptr) {
    push_back(p);
    return back();
  }
  /// As in Std.
  void pop_back() noexcept {
    T* const gone = std_.back();
    std_.pop_back();
    detail::drop_reference(gone);
  }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, T* p) {
    const iterator inserted = std_.insert(at, p);
    detail::add_reference(p);
    return inserted;
  }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, size_type n, T* p) {
    const iterator inserted = std_.insert(at, n, p);
    add_from(index_of(inserted), n);
    return inserted;
  }
  /// As in Std. Strong guarantee: the range is read before anything changes.
  template <class Input, class = detail::if_iterator<Input>>
  iterator insert(const_iterator at, Input first, Input last) {
    const std_vector content(first, last, std_.get_allocator());
    const iterator inserted = std_.insert(at, content.begin(), content.end());
    add_from(index_of(inserted), content.size());
    return inserted;
  }
  /// As in Std. Strong guarantee.
  iterator insert(const_iterator at, std::initializer_list<T*> list) {
    return insert(at, list.begin(), list.end());
  }
  /// As in Std.
  iterator emplace(const_iterator at, T* p) { return insert(at, p); }
  /// As in Std.
  iterator erase(const_iterator at) noexcept {
    T* const gone = *at;
    const size_type index = index_of(at);
    const detail::counted_scope<T> until_final;
    std_.erase(at);
    detail::drop_reference(gone);
    return std_.begin() + static_cast<std::ptrdiff_t>(index);
  }
  /// As in Std.
  iterator erase(const_iterator first, const_iterator last) noexcept {
    const detail::counted_scope<T> until_final;
    const auto n = last - first;
    const auto from = std_.begin() + (first - std_.cbegin());
    // Unlink before uncounting: what goes moves to the end, what stays keeps its order.
    for (auto to = from, stays = from + n; stays != std_.end(); ++to, ++stays)
      std::swap(*to, *stays);
    for (auto i = n; i != 0; --i) pop_back();
    return from;
  }
  /// Removes the elements for which @p gone(p) holds; the others keep their order. Calls it once for each element, in
  /// order. Returns how many were removed. O(size).
  template <class Predicate>
  size_type remove_if(Predicate gone) {
    const detail::counted_scope<T> until_final;
    size_type kept = 0;
    for (size_type i = 0; i != std_.size(); ++i) {
      if (gone(std_[i])) continue;
      if (kept != i) std::swap(std_[kept], std_[i]);
      ++kept;
    }
    const size_type removed = std_.size() - kept;
    while (std_.size() != kept) pop_back();
    return removed;
  }
  /// As in Std: keeps the capacity.
  void clear() noexcept { this->clear_content(); }
  /// Exchanges the elements of two vectors: O(size), as each reference changes its place.
  void swap(rc_vector& other) noexcept { this->swap_content(other); }
  /// Exchanges the elements of two vectors: O(size), as each reference changes its place.
  friend void swap(rc_vector& a, rc_vector& b) noexcept { a.swap(b); }

 private:
  using base::std_;

  size_type index_of(const_iterator at) const noexcept {
    return static_cast<size_type>(at - std_.cbegin());
  }
  void add_from(size_type index, size_type n) noexcept {
    for (size_type i = index; i != index + n; ++i) detail::add_reference(std_[i]);
  }
  /// Calls @p f with each of the first @p n places that is to change, and with what comes there.
  template <class F>
  void for_each_change(size_type n, const std_vector& content, F f) noexcept {
    constexpr size_type block = 32;
    T** const to = std_.data();
    T* const* const from = content.data();
    for (size_type i = 0; i != n;) {
      const size_type end = n - i < block ? n : i + block;
      // As most of a local map from one frame to the next.
      if (std::equal(to + i, to + end, from + i)) {
        i = end;
        continue;
      }
      for (; i != end; ++i)
        if (to[i] != from[i]) f(to[i], from[i]);
    }
  }
  /// In place where the capacity suffices: no allocation, and no count for what stays. What comes is
  /// counted before anything is uncounted: the same object may go here and come there.
  void assign_pointers(const std_vector& content) {
    if (&content == &std_) return;
    std_.reserve(content.size());
    // Not read again once references go: unless the thread is a mutator, that may be the end of who owns the content.
    const size_type size = content.size(), common = std_.size() < size ? std_.size() : size;
    // What goes waits here, so that one pass finds all changes; of more than these a second one finds the rest.
    constexpr size_type room = 256;
    T* gone[room];
    size_type n = 0;
    for_each_change(common, content, [&](T*& place, T* comes) {
      detail::add_reference(comes);
      if (n != room) gone[n++] = std::exchange(place, comes);
    });
    std_.insert(std_.end(), content.begin() + static_cast<std::ptrdiff_t>(common), content.end());
    add_from(common, size - common);
    const detail::counted_scope<T> until_final;
    for (size_type i = 0; i != n; ++i) detail::drop_reference(gone[i]);
    if (n == room)
      for_each_change(common, content, [](T*& place, T* comes) {
        detail::drop_reference(std::exchange(place, comes));
      });
    erase(std_.begin() + static_cast<std::ptrdiff_t>(size), std_.end());
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
