/// @file
/// A map whose keys are counted references.
#pragma once

#include <map>

#include "../detail/counted_associative.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::map<T*, Mapped, Options...>` whose keys are counted references:
/// `std::map<KeyFrame*, int>` becomes `rc_map<KeyFrame, int>`. `T` may be incomplete where the member
/// is declared. Iterators are those of the standard map, so loops over
/// `std::map<KeyFrame*, int>::iterator` stay as they are.
///
/// Thread-safety: that of the standard map. See detail::counted_associative for costs and errors.
template <class T, class Mapped, class... Options>
class rc_map : public detail::counted_key_map<
                   detail::counted_ordered<rc_map<T, Mapped, Options...>, T,
                                           std::map<T*, Mapped, Options...>, detail::element_key>> {
  using base = detail::counted_key_map<detail::counted_ordered<
      rc_map<T, Mapped, Options...>, T, std::map<T*, Mapped, Options...>, detail::element_key>>;

 public:
  using base::base;
  using base::operator=;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
