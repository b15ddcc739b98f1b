/// @file
/// What counted sets and maps share: everything that inserts and erases.
#pragma once

#include <initializer_list>
#include <type_traits>
#include <utility>

#include "counted_container.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// A set or map whose references are counted. `Derived` is the public container.
///
/// Each operation costs what it costs in the standard container, plus one change of a count per
/// reference that comes or goes; assignment, swap and move count each element. If an allocation, a
/// comparison or a hash throws, every count still equals the references in the container.
template <class Derived, class T, class Std, class Reference,
          class Iterator = typename Std::iterator>
class counted_associative : public counted_container<T, Std, Reference, Iterator> {
  using base = counted_container<T, Std, Reference, Iterator>;

 public:
  using key_type = typename Std::key_type;  ///< As in Std.
  using typename base::const_iterator;
  using typename base::iterator;
  using typename base::size_type;
  using typename base::value_type;

  /// Empty.
  counted_associative() = default;
  /// Empty, with an allocator.
  explicit counted_associative(const typename base::allocator_type& allocator)
      : base(Std(allocator)) {}
  /// The elements of @p content.
  counted_associative(const Std& content) : base(content) {}
  /// Takes @p content over, with its comparator, hash and allocator.
  counted_associative(Std&& content) noexcept : base(std::move(content)) {}
  /// The elements listed.
  counted_associative(std::initializer_list<value_type> list) : base(Std(list)) {}
  /// The elements of a range of pointers, or of pairs.
  template <class Input, class = if_iterator<Input>>
  counted_associative(Input first, Input last) : base(Std(first, last)) {}
  /// Counts each element.
  counted_associative(const counted_associative&) = default;
  /// Leaves @p other empty. O(size): each reference changes its place.
  counted_associative(counted_associative&& other) noexcept = default;
  ~counted_associative() = default;

  /// Counts what comes before it uncounts what goes. Strong guarantee.
  counted_associative& operator=(const counted_associative& other) = default;
  /// Leaves @p other empty. O(size): each reference changes its place.
  counted_associative& operator=(counted_associative&& other) = default;
  /// Counts what comes before it uncounts what goes. Strong guarantee.
  counted_associative& operator=(const Std& content) {
    if (&content != &std_) this->assign_content(Std(content, std_.get_allocator()));
    return *this;
  }
  /// Counts what comes before it uncounts what goes.
  counted_associative& operator=(Std&& content) noexcept(base::nothrow_move) {
    this->assign_content(std::move(content));
    return *this;
  }
  /// Counts what comes before it uncounts what goes. Strong guarantee.
  counted_associative& operator=(std::initializer_list<value_type> list) {
    Std content(std_, std_.get_allocator());  // with this comparator or hash
    content = list;
    this->assign_content(std::move(content));
    return *this;
  }

  /// As in Std.
  std::pair<iterator, bool> insert(const value_type& value) { return counted(std_.insert(value)); }
  /// As in Std.
  std::pair<iterator, bool> insert(value_type&& value) {
    return counted(std_.insert(std::move(value)));
  }
  /// As in Std; so `std::inserter` works.
  iterator insert(const_iterator hint, const value_type& value) {
    const size_type before = std_.size();
    return counted(std_.insert(hint, value), before);
  }
  /// As in Std; so `std::inserter` works.
  iterator insert(const_iterator hint, value_type&& value) {
    const size_type before = std_.size();
    return counted(std_.insert(hint, std::move(value)), before);
  }
  /// As in Std. If it throws, the elements before are in.
  template <class Input, class = if_iterator<Input>>
  void insert(Input first, Input last) {
    for (; first != last; ++first) insert(*first);
  }
  /// As in Std. If it throws, the elements before are in.
  void insert(std::initializer_list<value_type> list) { insert(list.begin(), list.end()); }
  /// As in Std.
  template <class... Args>
  std::pair<iterator, bool> emplace(Args&&... args) {
    return counted(std_.emplace(std::forward<Args>(args)...));
  }
  /// As in Std.
  template <class... Args>
  iterator emplace_hint(const_iterator hint, Args&&... args) {
    const size_type before = std_.size();
    return counted(std_.emplace_hint(hint, std::forward<Args>(args)...), before);
  }

  /// As in Std.
  iterator erase(const_iterator at) {
    const counted_scope<T> until_final;
    return unlink(at);
  }
  /// As in Std.
  iterator erase(const_iterator first, const_iterator last) {
    const counted_scope<T> until_final;
    while (first != last) first = unlink(first);
    return std_.erase(first, first);
  }
  /// As in Std.
  size_type erase(const key_type& key) {
    const auto at = std_.find(key);
    if (at == std_.end()) return 0;
    erase(const_iterator(at));
    return 1;
  }
  /// As in Std.
  void clear() noexcept { this->clear_content(); }
  /// Exchanges the elements of two containers: O(size), as each reference changes its place.
  void swap(Derived& other) noexcept { this->swap_content(other); }
  /// Exchanges the elements of two containers: O(size), as each reference changes its place.
  friend void swap(Derived& a, Derived& b) noexcept { a.swap(b); }

  /// As in Std: takes over the elements whose keys are not here. O(other.size()) counts: a reference
  /// may change its place. If a comparison throws in here, libstdc++ terminates, and before version
  /// 12 also if a hash does.
  void merge(Derived& other) {
    counted_associative& from = other;
    if (this == &from) return;
    from.move_all();
    std_.merge(from.std_);
  }

  /// As in Std.
  [[nodiscard]] iterator find(const key_type& key) { return std_.find(key); }
  /// As in Std.
  [[nodiscard]] const_iterator find(const key_type& key) const { return std_.find(key); }
  /// As in Std.
  [[nodiscard]] size_type count(const key_type& key) const { return std_.count(key); }
  /// Whether there is such a key.
  [[nodiscard]] bool contains(const key_type& key) const { return std_.find(key) != std_.end(); }
  /// As in Std.
  [[nodiscard]] std::pair<iterator, iterator> equal_range(const key_type& key) {
    return std_.equal_range(key);
  }
  /// As in Std.
  [[nodiscard]] std::pair<const_iterator, const_iterator> equal_range(const key_type& key) const {
    return std_.equal_range(key);
  }

 protected:
  using base::std_;

  /// Counts the element if it is new.
  std::pair<iterator, bool> counted(std::pair<typename Std::iterator, bool> inserted) noexcept {
    if (inserted.second) base::add(*inserted.first);
    return inserted;
  }

 private:
  iterator counted(typename Std::iterator inserted, size_type size_before) noexcept {
    if (std_.size() != size_before) base::add(*inserted);
    return inserted;
  }
  iterator unlink(const_iterator at) {
    T* const gone = base::reference_of(*at);
    const iterator next = std_.erase(at);
    detail::drop_reference(gone);
    return next;
  }
};

/// What only ordered sets and maps have.
template <class Derived, class T, class Std, class Reference,
          class Iterator = typename Std::iterator>
class counted_ordered : public counted_associative<Derived, T, Std, Reference, Iterator> {
  using base = counted_associative<Derived, T, Std, Reference, Iterator>;

 public:
  using key_compare = typename Std::key_compare;                        ///< As in Std.
  using value_compare = typename Std::value_compare;                    ///< As in Std.
  using const_reverse_iterator = typename Std::const_reverse_iterator;  ///< As in Std.
  using reverse_iterator =
      std::conditional_t<std::is_same<Iterator, typename Std::iterator>::value,
                         typename Std::reverse_iterator,
                         const_reverse_iterator>;  ///< Cannot change a reference.
  using typename base::const_iterator;
  using typename base::iterator;
  using typename base::key_type;

  using base::base;
  using base::operator=;

  /// Empty.
  counted_ordered() = default;
  /// Empty, with a comparator.
  explicit counted_ordered(const key_compare& compare) : base(Std(compare)) {}

  /// As in Std.
  [[nodiscard]] reverse_iterator rbegin() noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] reverse_iterator rend() noexcept { return std_.rend(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rbegin() const noexcept { return std_.rbegin(); }
  /// As in Std.
  [[nodiscard]] const_reverse_iterator rend() const noexcept { return std_.rend(); }
  /// As in Std.
  [[nodiscard]] iterator lower_bound(const key_type& key) { return std_.lower_bound(key); }
  /// As in Std.
  [[nodiscard]] const_iterator lower_bound(const key_type& key) const {
    return std_.lower_bound(key);
  }
  /// As in Std.
  [[nodiscard]] iterator upper_bound(const key_type& key) { return std_.upper_bound(key); }
  /// As in Std.
  [[nodiscard]] const_iterator upper_bound(const key_type& key) const {
    return std_.upper_bound(key);
  }
  /// As in Std.
  [[nodiscard]] key_compare key_comp() const { return std_.key_comp(); }
  /// As in Std.
  [[nodiscard]] value_compare value_comp() const { return std_.value_comp(); }

 protected:
  using base::std_;
};

/// What only hashed sets and maps have.
template <class Derived, class T, class Std, class Reference,
          class Iterator = typename Std::iterator>
class counted_hashed : public counted_associative<Derived, T, Std, Reference, Iterator> {
  using base = counted_associative<Derived, T, Std, Reference, Iterator>;

 public:
  using hasher = typename Std::hasher;        ///< As in Std.
  using key_equal = typename Std::key_equal;  ///< As in Std.
  using typename base::size_type;

  using base::base;
  using base::operator=;

  /// Empty.
  counted_hashed() = default;
  /// Empty, with at least @p buckets buckets.
  explicit counted_hashed(size_type buckets) : base(Std(buckets)) {}

  /// As in Std.
  [[nodiscard]] size_type bucket_count() const noexcept { return std_.bucket_count(); }
  /// As in Std.
  [[nodiscard]] float load_factor() const noexcept { return std_.load_factor(); }
  /// As in Std.
  [[nodiscard]] float max_load_factor() const noexcept { return std_.max_load_factor(); }
  /// As in Std.
  void max_load_factor(float factor) { std_.max_load_factor(factor); }
  /// As in Std.
  void rehash(size_type buckets) { std_.rehash(buckets); }
  /// As in Std.
  void reserve(size_type elements) { std_.reserve(elements); }
  /// As in Std: takes over the elements whose keys are not here. O(other.size()) counts: a reference
  /// may change its place.
  void merge(Derived& other) {
    // A standard merge that has to grow the table may lose the element in hand.
    std_.reserve(std_.size() + other.size());
    base::merge(other);
  }
  /// As in Std.
  [[nodiscard]] hasher hash_function() const { return std_.hash_function(); }
  /// As in Std.
  [[nodiscard]] key_equal key_eq() const { return std_.key_eq(); }

 protected:
  using base::std_;
};

/// Access by key to a map whose keys are counted: the mapped values are plain.
template <class Base>
class counted_key_map : public Base {
 public:
  using mapped_type = typename Base::std_type::mapped_type;  ///< As in Std.
  using typename Base::const_iterator;
  using typename Base::iterator;
  using typename Base::key_type;
  using typename Base::size_type;

  using Base::Base;
  using Base::operator=;

  /// As in Std: makes the element if there is none.
  mapped_type& operator[](const key_type& key) { return this->try_emplace(key).first->second; }
  /// As in Std. Throws std::out_of_range.
  [[nodiscard]] mapped_type& at(const key_type& key) { return std_.at(key); }
  /// As in Std. Throws std::out_of_range.
  [[nodiscard]] const mapped_type& at(const key_type& key) const { return std_.at(key); }
  /// As in Std.
  template <class... Args>
  std::pair<iterator, bool> try_emplace(const key_type& key, Args&&... args) {
    return this->counted(std_.try_emplace(key, std::forward<Args>(args)...));
  }
  /// As in Std.
  template <class Value>
  std::pair<iterator, bool> insert_or_assign(const key_type& key, Value&& value) {
    return this->counted(std_.insert_or_assign(key, std::forward<Value>(value)));
  }

 protected:
  using Base::std_;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
