/// @file
/// A hashed set of counted references.
#pragma once

#include <unordered_set>

#include "../detail/counted_associative.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::unordered_set<T*, Options...>` whose elements are counted references. `T` may be
/// incomplete where the member is declared. Iterators are those of the standard set.
///
/// Thread-safety: that of the standard set. See detail::counted_associative for costs and errors.
template <class T, class... Options>
class rc_unordered_set
    : public detail::counted_hashed<rc_unordered_set<T, Options...>, T,
                                    std::unordered_set<T*, Options...>, detail::element_itself> {
  using base = detail::counted_hashed<rc_unordered_set<T, Options...>, T,
                                      std::unordered_set<T*, Options...>, detail::element_itself>;

 public:
  using base::base;
  using base::operator=;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
