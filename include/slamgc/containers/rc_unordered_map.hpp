/// @file
/// A hashed map whose keys are counted references.
#pragma once

#include <unordered_map>

#include "../detail/counted_associative.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// A `std::unordered_map<T*, Mapped, Options...>` whose keys are counted references. `T` may be
/// incomplete where the member is declared. Iterators are those of the standard map.
///
/// Thread-safety: that of the standard map. See detail::counted_associative for costs and errors.
template <class T, class Mapped, class... Options>
class rc_unordered_map
    : public detail::counted_key_map<
          detail::counted_hashed<rc_unordered_map<T, Mapped, Options...>, T,
                                 std::unordered_map<T*, Mapped, Options...>, detail::element_key>> {
  using base = detail::counted_key_map<
      detail::counted_hashed<rc_unordered_map<T, Mapped, Options...>, T,
                             std::unordered_map<T*, Mapped, Options...>, detail::element_key>>;

 public:
  using base::base;
  using base::operator=;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
