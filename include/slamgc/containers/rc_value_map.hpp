/// @file
/// A map whose mapped values are counted references.
#pragma once

#include <map>

#include "../detail/counted_associative.hpp"
#include "../detail/element_ref.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::map<Key, T*, Options...>` whose mapped values are counted references:
/// `std::map<long, MapPoint*>` becomes `rc_value_map<long, MapPoint>`. `T` may be incomplete where
/// the member is declared.
///
/// Iterators are the standard map's const iterators, since the others could write a value uncounted;
/// `m[key] = p` writes and counts.
///
/// Thread-safety: that of the standard map. See detail::counted_associative for costs and errors.
template <class Key, class T, class... Options>
class rc_value_map
    : public detail::counted_ordered<rc_value_map<Key, T, Options...>, T,
                                     std::map<Key, T*, Options...>, detail::element_mapped,
                                     typename std::map<Key, T*, Options...>::const_iterator> {
  using base = detail::counted_ordered<rc_value_map<Key, T, Options...>, T,
                                       std::map<Key, T*, Options...>, detail::element_mapped,
                                       typename std::map<Key, T*, Options...>::const_iterator>;

 public:
  using mapped_type = T*;  ///< As in the standard map.
  using typename base::iterator;
  using typename base::key_type;

  using base::base;
  using base::operator=;

  /// The value at @p key, to read or to assign; makes a null one if there is none.
  detail::element_ref<T> operator[](const key_type& key) {
    return detail::element_ref<T>(this->std_[key]);
  }
  /// The value at @p key, to read or to assign. Throws std::out_of_range.
  [[nodiscard]] detail::element_ref<T> at(const key_type& key) {
    return detail::element_ref<T>(this->std_.at(key));
  }
  /// The value at @p key. Throws std::out_of_range.
  [[nodiscard]] T* at(const key_type& key) const { return this->std_.at(key); }
  /// As in the standard map.
  std::pair<iterator, bool> try_emplace(const key_type& key, T* p = nullptr) {
    return this->counted(this->std_.try_emplace(key, p));
  }
  /// As in the standard map.
  std::pair<iterator, bool> insert_or_assign(const key_type& key, T* p) {
    const std::pair<typename base::std_type::iterator, bool> done = this->std_.try_emplace(key, p);
    if (!done.second) detail::element_ref<T>(done.first->second) = p;
    return this->counted(done);
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
