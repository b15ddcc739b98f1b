/// @file
/// Which slots hold a point, from its observations and the few exceptions from them.
///
/// As a rule a keyframe that observes a point names the slot that holds it. Then the observation itself says where the
/// point is, and nothing has to be kept. A *loose end* is one of the exceptions:
///
/// - a loose slot holds the point, and no observation names it: it was set before the observation, or the keyframe has
///   the point in two slots, or the observation was erased first;
/// - a loose observation names a slot that does not hold the point: it was made before the slot was set, or the slot
///   was given to another point.
///
/// So a point needs one pointer, null when nothing is loose. A point is in the slots that its observations name, less the loose
/// observations, and in its loose slots. Eligible slots only: others never count.
///
/// Everything here runs under the lock of the point's observations.
#pragma once

#include <new>
#include <utility>

#include "../redundancy/rule.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// One loose end.
template <class Keyframe>
struct loose_end {
  loose_end* next;
  Keyframe keyframe;
  int slot;
  bool holds;  // A loose slot; otherwise a loose observation.
};

/// What became of one side.
enum class tie_result {
  tied,       ///< A loose end is gone.
  loose,      ///< A loose end was made.
  no_memory,  ///< Nothing was done.
};

/// A list of loose ends that owns them.
template <class Keyframe>
class loose_ends {
 public:
  using node = loose_end<Keyframe>;

  loose_ends() noexcept = default;
  loose_ends(const loose_ends&) = delete;
  loose_ends& operator=(const loose_ends&) = delete;
  ~loose_ends() { clear(); }

  [[nodiscard]] const node* first() const noexcept { return first_; }
  [[nodiscard]] bool has(const Keyframe& k, int slot, bool holds) const noexcept {
    for (const node* n = first_; n != nullptr; n = n->next)
      if (is(*n, k, slot, holds)) return true;
    return false;
  }
  void clear() noexcept {
    while (first_ != nullptr) delete std::exchange(first_, first_->next);
  }
  /// Moves this loose end to the spare ones; false if there is none.
  bool take(const Keyframe& k, int slot, bool holds, loose_ends& spare) noexcept {
    for (node** at = &first_; *at != nullptr; at = &(*at)->next) {
      if (!is(**at, k, slot, holds)) continue;
      spare.push(std::exchange(*at, (*at)->next));
      return true;
    }
    return false;
  }
  /// Adds a loose end, in memory of a spare one if there is one; false if there is no memory.
  [[nodiscard]] bool put(const Keyframe& k, int slot, bool holds, loose_ends& spare) {
    node* n = spare.first_;
    if (n != nullptr)
      spare.first_ = n->next;
    else if ((n = new (std::nothrow) node{}) == nullptr)
      return false;
    n->keyframe = k;
    n->slot = slot;
    n->holds = holds;
    push(n);
    return true;
  }
  /// One side (the slot that holds the point if @p holds, else the observation that names the slot) comes or goes. What
  /// comes ties up with the other side or is loose; what goes was loose or leaves the other side so.
  [[nodiscard]] tie_result tie(const Keyframe& k, int slot, bool holds, bool comes,
                               loose_ends& spare) {
    if (take(k, slot, holds != comes, spare)) return tie_result::tied;
    return put(k, slot, holds == comes, spare) ? tie_result::loose : tie_result::no_memory;
  }

 private:
  static bool is(const node& n, const Keyframe& k, int slot, bool holds) noexcept {
    return n.holds == holds && n.slot == slot && n.keyframe == k;
  }
  void push(node* n) noexcept {
    n->next = first_;
    first_ = n;
  }
  node* first_ = nullptr;
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
