/// @file
/// How the references in a counted member are read, dropped, and purged of stale ones.
#pragma once

#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "../assert.hpp"
#include "../dispositions.hpp"
#include "../fwd.hpp"
#include "element_ref.hpp"
#include "header.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

template <class T, class Std, class Reference, class Iterator>
class counted_container;
template <class Member>
struct edge_member;
template <class T, class Std, class Reference, class Iterator>
Reference reference_in(const counted_container<T, Std, Reference, Iterator>&);

struct element_mapped;

template <class How>
struct is_bypass : std::false_type {};
template <class Next>
struct is_bypass<on_retire::bypass_edge<Next>> : std::true_type {};

/// Whether elements are found by their number.
template <class Sequence, class = void>
struct has_index : std::false_type {};
template <class Sequence>
struct has_index<Sequence, std::void_t<decltype(std::declval<Sequence&>()[std::size_t{}])>>
    : std::true_type {};

/// Removes elements from a companion of a purged sequence, in step with it.
template <class Companion>
class companion_cursor {
  using iterator = typename Companion::iterator;
  static constexpr bool by_index = has_index<Companion>::value;

 public:
  explicit companion_cursor(Companion& c) : companion_(c), at_(c.begin()) {}

  void keep() {
    if constexpr (by_index) {
      if (kept_ != seen_) companion_[kept_] = std::move(companion_[seen_]);
      ++kept_;
      ++seen_;
    } else {
      ++at_;
    }
  }
  void remove() {
    if constexpr (by_index)
      ++seen_;
    else
      at_ = companion_.erase(at_);
  }
  void finish() {
    if constexpr (by_index)
      companion_.erase(companion_.begin() + static_cast<std::ptrdiff_t>(kept_), companion_.end());
  }

 private:
  Companion& companion_;
  iterator at_;
  std::size_t kept_ = 0;
  std::size_t seen_ = 0;
};

/// What bypass puts in the place of @p p. Chains of retired objects may be circles; in a retired object that is itself part of a
/// long one, what comes after so many steps is nothing: else a map that died but for one object would take quadratic time.
template <class T, class Next, class Stale>
T* bypassed(T* p, const Next& next, Stale& stale) {
  T* mark = p;
  std::size_t steps = 0;
  std::size_t next_mark = 1;
  do {
    p = next(*p);
    if (p == mark || steps == stale.patience()) return nullptr;
    if (++steps == next_mark) {  // Brent 1980: the mark moves at powers of two
      mark = p;
      next_mark *= 2;
    }
  } while (p != nullptr && stale(p));
  return p;
}

/// Tells @p f of each stale target that it finds; whoever asks drops it then.
template <class F, class Stale>
class announcing {
 public:
  announcing(const F& f, Stale& stale) noexcept : f_(f), stale_(stale) {}

  template <class T>
  bool operator()(T* p) const {
    if (!stale_(p)) return false;
    f_(*p);
    return true;
  }
  bool dropped(bool done) const noexcept { return stale_.dropped(done); }
  /// What is looked up need not be there, and would be announced.
  static bool few(std::size_t) noexcept { return false; }
  template <class T, class G>
  static void each(G) noexcept {}

 private:
  const F& f_;
  Stale& stale_;
};
template <class Member, class F, class How, class Stale>
void purge_announced(Member& member, const on_retire::announced_edge<F, How>& how, Stale& stale) {
  static_assert(!std::is_same<How, on_retire::hold_edge>::value && !is_bypass<How>::value,
                "slamgc: what can be announced is null, erase and erase_with");
  announcing<F, Stale> announced(how.f, stale);
  edge_member<Member>::purge(member, how.how, announced);
}

/// A member that is one reference: `compare_exchange` changes it while other threads may assign it.
template <class Slot>
struct edge_slot {
  template <class F>
  static void each(const Slot& member, F f) {
    if (auto* const p = member.get()) f(p);
  }
  template <class Stale>
  static void purge(Slot& member, on_retire::hold_edge, Stale& stale) {
    each(member, [&](auto* p) { stale.hold(p); });
  }
  template <class Stale>
  static void purge(Slot& member, on_retire::null_edge, Stale& stale) {
    auto* const p = member.get();
    if (p != nullptr && stale(p)) stale.dropped(replace(member, p, decltype(p)(nullptr)));
  }
  template <class Next, class Stale>
  static void purge(Slot& member, const on_retire::bypass_edge<Next>& how, Stale& stale) {
    auto* const p = member.get();
    if (p != nullptr && stale(p))
      stale.dropped(replace(member, p, detail::bypassed(p, how.next, stale)));
  }
  template <class F, class How, class Stale>
  static void purge(Slot& member, const on_retire::announced_edge<F, How>& how, Stale& stale) {
    detail::purge_announced(member, how, stale);
  }
  template <class Disposition, class Stale>
  static void purge(Slot&, const Disposition&, Stale&) {
    static_assert(false_for<Disposition>::value,
                  "slamgc: what can become of a slot is hold, null or bypass");
  }

 private:
  template <class T, class Env>
  static bool replace(rc_slot<T, Env>& slot, T* expected, T* p) {
    return slot.compare_exchange(expected, p);
  }
  template <class T, class Env>
  static bool replace(atomic_rc<T, Env>& slot, T* expected, T* p) {
    return slot.compare_exchange_strong(expected, intrusive_rc<T>(p));
  }
};

/// What all containers have in common.
template <class Container>
struct edge_container {
  using reference = decltype(detail::reference_in(std::declval<const Container&>()));

  template <class F>
  static void each(const Container& member, F f) {
    for (const auto& value : member.raw())
      if (auto* const p = reference()(value)) f(p);
  }
  static void sever(Container& member) noexcept { member.clear(); }
  template <class Stale>
  static void purge(Container& member, on_retire::hold_edge, Stale& stale) {
    each(member, [&](auto* p) { stale.hold(p); });
  }
  template <class F, class How, class Stale>
  static void purge(Container& member, const on_retire::announced_edge<F, How>& how, Stale& stale) {
    detail::purge_announced(member, how, stale);
  }
  template <class Disposition, class Stale>
  static void purge(Container&, const Disposition&, Stale&) {
    static_assert(
        false_for<Disposition>::value,
        "slamgc: this container cannot do that: null is for rc_vector and rc_value_map, bypass "
        "and erase_with for sequences");
  }

 protected:
  /// What `remove_if` asks.
  template <class Stale>
  static auto removes(Stale& stale) {
    return [&stale](auto* p) { return p != nullptr && stale(p) && stale.dropped(true); };
  }
};

/// rc_vector and rc_list.
template <class Container>
struct edge_sequence : edge_container<Container> {
  using edge_container<Container>::purge;

  template <class Stale>
  static void purge(Container& member, on_retire::erase_edge, Stale& stale) {
    member.remove_if(edge_container<Container>::removes(stale));
  }
  template <class... Companions, class Stale>
  static void purge(Container& member, const on_retire::erase_edge_with<Companions...>& how,
                    Stale& stale) {
    if (member.empty()) return;  // some clear the sequence and forget its companions
    const bool in_step = std::apply(
        [&](auto&... c) { return (... && (c.size() == member.size())); }, how.companions);
    SLAMGC_ASSERT(in_step, (misuse{"describes a companion of another length than its sequence",
                                   "companion", &member, 0}));
    if (!in_step) return purge(member, on_retire::hold, stale);
    auto cursors =
        std::apply([](auto&... c) { return std::make_tuple(cursor_of(c)...); }, how.companions);
    const auto gone = edge_container<Container>::removes(stale);
    member.remove_if([&](auto* p) {
      const bool remove = gone(p);
      std::apply([remove](auto&... c) { (..., (remove ? c.remove() : c.keep())); }, cursors);
      return remove;
    });
    std::apply([](auto&... c) { (..., c.finish()); }, cursors);
  }

 private:
  template <class Companion>
  static companion_cursor<Companion> cursor_of(Companion& c) {
    return companion_cursor<Companion>(c);
  }
};

/// Containers whose elements can be replaced one by one.
template <class Stale, class Element>
void purge_element(Element element, on_retire::null_edge, Stale& stale) {
  auto* const p = element.get();
  if (p != nullptr && stale(p)) stale.dropped(element.compare_exchange(p, nullptr));
}
template <class Stale, class Next, class Element>
void purge_element(Element element, const on_retire::bypass_edge<Next>& how, Stale& stale) {
  auto* const p = element.get();
  if (p != nullptr && stale(p))
    stale.dropped(element.compare_exchange(p, detail::bypassed(p, how.next, stale)));
}

/// Sets and maps.
template <class Container>
struct edge_keyed : edge_container<Container> {
  using edge_container<Container>::purge;
  using typename edge_container<Container>::reference;

  template <class Stale>
  static void purge(Container& member, on_retire::erase_edge, Stale& stale) {
    using pointer = decltype(reference()(*member.raw().begin()));
    using target = std::remove_cv_t<std::remove_pointer_t<pointer>>;
    // By look-up, where that is less work than a walk. What a purge knows are objects, not derived ones.
    if constexpr (!std::is_same<reference, element_mapped>::value &&
                  std::is_same<target, object_of<target>>::value) {
      if (stale.few(member.size())) {
        stale.template each<target>([&](target* p) {
          const auto at = member.find(p);
          if (at == member.end() || reference()(*at) != p)
            return false;  // or just an equivalent one
          member.erase(at);
          return true;
        });
        return;
      }
    }
    const auto gone = edge_container<Container>::removes(stale);
    for (auto i = member.raw().begin(); i != member.raw().end();) {
      if (gone(reference()(*i)))
        i = member.erase(i);
      else
        ++i;
    }
  }
};

template <class Member>
struct edge_member {
  static_assert(
      false_for<Member>::value,
      "slamgc: an edge is an rc_slot, an atomic_rc or a counted container; an intrusive_rc is "
      "none, since moving it tells nobody, and a raw pointer is not counted");
};
template <class T, class Env>
struct edge_member<rc_slot<T, Env>> : edge_slot<rc_slot<T, Env>> {
  static void sever(rc_slot<T, Env>& member) noexcept { member = nullptr; }
};
template <class T, class Env>
struct edge_member<atomic_rc<T, Env>> : edge_slot<atomic_rc<T, Env>> {
  static void sever(atomic_rc<T, Env>& member) noexcept { member = nullptr; }
};
template <class T, class... Options>
struct edge_member<rc_vector<T, Options...>> : edge_sequence<rc_vector<T, Options...>> {
  using edge_sequence<rc_vector<T, Options...>>::purge;

  template <class Stale>
  static void purge(rc_vector<T, Options...>& member, on_retire::null_edge how, Stale& stale) {
    for (std::size_t i = 0; i != member.size(); ++i) detail::purge_element(member[i], how, stale);
  }
  template <class Next, class Stale>
  static void purge(rc_vector<T, Options...>& member, const on_retire::bypass_edge<Next>& how,
                    Stale& stale) {
    for (std::size_t i = 0; i != member.size(); ++i) detail::purge_element(member[i], how, stale);
  }
};
template <class T, class... Options>
struct edge_member<rc_list<T, Options...>> : edge_sequence<rc_list<T, Options...>> {};
template <class T, class... Options>
struct edge_member<rc_set<T, Options...>> : edge_keyed<rc_set<T, Options...>> {};
template <class T, class M, class... Options>
struct edge_member<rc_map<T, M, Options...>> : edge_keyed<rc_map<T, M, Options...>> {};
template <class K, class T, class... Options>
struct edge_member<rc_value_map<K, T, Options...>> : edge_keyed<rc_value_map<K, T, Options...>> {
  using edge_keyed<rc_value_map<K, T, Options...>>::purge;

  template <class Stale>
  static void purge(rc_value_map<K, T, Options...>& member, on_retire::null_edge how,
                    Stale& stale) {
    for (const auto& value : member.raw())
      if (value.second != nullptr && stale(value.second))
        detail::purge_element(member.at(value.first), how, stale);
  }
};
template <class T, class... Options>
struct edge_member<rc_unordered_set<T, Options...>> : edge_keyed<rc_unordered_set<T, Options...>> {
};
template <class T, class M, class... Options>
struct edge_member<rc_unordered_map<T, M, Options...>>
    : edge_keyed<rc_unordered_map<T, M, Options...>> {};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
