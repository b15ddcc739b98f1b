/// @file
/// The thesis's way to count what a function uses.
#pragma once

#include <type_traits>
#include <utility>

#include "detail/counted_container.hpp"
#include "fwd.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Counts, while it exists, what a container of raw pointers holds: the scheme of the thesis (chapter
/// 4.3, figure 12) for a function that works on a copy of a container.
///
/// ```
/// std::unique_lock<std::mutex> lock(mMutexConnections);
/// const slamgc::scoped_count neighbours(mvpOrderedConnectedKeyFrames.raw());
/// lock.unlock();
/// for (KeyFrame* pKF : neighbours) use(pKF);  // each is kept until the scope ends
/// ```
///
/// **The copy has to be made under the lock of the container it is read from.** Otherwise the last
/// reference may go between reading a pointer and counting it, and the count would come too late.
///
/// Holds sequences and sets of `T*`, and maps with `T*` keys; the content is constant. O(size) counts
/// at both ends. Throws, at the beginning, what copying the container throws. Thread-safety: that of
/// the container.
template <class Container>
class scoped_count {
 public:
  using value_type = typename Container::value_type;          ///< As in Container.
  using const_iterator = typename Container::const_iterator;  ///< As in Container.

  /// Counts what @p content refers to.
  explicit scoped_count(Container content) : content_(std::move(content)) {
    for (const value_type& value : content_) detail::add_reference(reference_of(value));
  }
  /// Uncounts it.
  ~scoped_count() {
    for (const value_type& value : content_) detail::drop_reference(reference_of(value));
  }
  scoped_count(const scoped_count&) = delete;
  scoped_count& operator=(const scoped_count&) = delete;

  /// The container.
  [[nodiscard]] const Container& operator*() const noexcept { return content_; }
  /// The container's members.
  [[nodiscard]] const Container* operator->() const noexcept { return &content_; }
  /// As in Container.
  [[nodiscard]] const_iterator begin() const noexcept { return content_.begin(); }
  /// As in Container.
  [[nodiscard]] const_iterator end() const noexcept { return content_.end(); }

 private:
  template <class T>
  static T* reference_of(T* const& element) noexcept {
    return element;
  }
  template <class T, class Mapped>
  static T* reference_of(const std::pair<T* const, Mapped>& element) noexcept {
    return element.first;
  }

  Container content_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
