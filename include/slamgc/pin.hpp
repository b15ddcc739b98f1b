/// @file
/// Counting what a slow reader needs, so that it can go offline.
#pragma once

#include "containers/rc_vector.hpp"
#include "fwd.hpp"
#include "intrusive_rc.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Keeps one object. A mutator that needs few objects for a long time pins them, goes offline, and delays
/// nobody.
template <class T>
using pin = intrusive_rc<T>;

/// Keeps a set of objects:
///
/// ```
/// const slamgc::pin_set<KeyFrame> keyframes = pMap->GetAllKeyFrames();
/// const slamgc::mutator::offline_scope offline(mutator);
/// optimise(keyframes);  // ten seconds; whatever is culled meanwhile is reclaimed, but for these
/// ```
template <class T>
using pin_set = rc_vector<T>;

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
