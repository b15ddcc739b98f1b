/// @file
/// What collectors do by means of edges(): find references, sever, purge, report.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "../dispositions.hpp"
#include "../fwd.hpp"
#include "edge_member.hpp"
#include "header.hpp"
#include "purge.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// A visitor that does nothing: whether a type has edges().
struct edge_probe {
  template <class Member, class Disposition = on_retire::hold_edge>
  void edge(const char*, Member&, const Disposition& = {}) {}
};
template <class T, class = void>
struct has_edges : std::false_type {};
template <class T>
struct has_edges<T, std::void_t<decltype(std::declval<T&>().edges(std::declval<edge_probe&>()))>>
    : std::true_type {};

/// Stands for a type that describes none.
struct no_edges {
  template <class Visitor>
  void edges(Visitor&) {}
};

template <class T>
class zero_count_table;

/// Whether collectors walk through objects of this type.
template <class T>
struct is_described : std::bool_constant<is_deferred<T>::value && has_edges<T>::value> {};

/// Visits the edges. False if edges() threw.
template <class T, class Visitor>
bool visit_edges(T& described, Visitor& visitor) noexcept {
#if defined(__cpp_exceptions)
  try {
    described.edges(visitor);
    return true;
  } catch (...) {
    return false;
  }
#else
  described.edges(visitor);
  return true;
#endif
}

/// A visitor that calls f(p) for each reference.
template <class F>
struct reference_visitor {
  F f;

  template <class Member, class Disposition = on_retire::hold_edge>
  void edge(const char*, Member& member, const Disposition& = {}) {
    edge_member<std::remove_const_t<Member>>::each(member, f);
  }
};
/// A visitor that drops all references.
struct severing_visitor {
  template <class Member, class Disposition = on_retire::hold_edge>
  void edge(const char*, Member& member, const Disposition& = {}) {
    edge_member<Member>::sever(member);
  }
};

/// What is stale to a purge: what it found stuck when it began.
template <class Env>
class stale_to_collector {
 public:
  stale_to_collector(runtime::purge<Env>& p, bool holder_is_stuck) noexcept
      : purge_(p), holder_is_stuck_(holder_is_stuck) {}

  template <class T>
  bool operator()(T* p) const noexcept {
    return find(p) != nullptr;
  }
  /// A reference to p stays.
  template <class T>
  void hold(T* p) const noexcept {
    if (const auto* const s = find(p)) ++s->entry->held;
  }
  /// A stale reference was dropped, if it was @p done.
  bool dropped(bool done) const noexcept {
    if (done) purge_.dropped();
    return done;
  }
  /// How many retired objects to step over.
  std::size_t patience() const noexcept {
    return holder_is_stuck_ ? 64 : static_cast<std::size_t>(-1);
  }
  /// Whether it is better to look up what is stuck than to walk n elements.
  bool few(std::size_t n) const noexcept { return purge_.stuck_objects() * 8 < n; }
  /// Calls f(p) for each stuck T; f returns whether it dropped it.
  template <class T, class F>
  void each(F f) const {
    purge_.each_stuck([&](const auto& s) {
      if (s.entry->table->type == &type_key<T>) dropped(f(static_cast<T*>(s.entry->object)));
    });
  }

 private:
  template <class T>
  auto find(T* p) const noexcept {
    return purge_.find(static_cast<const object_of<T>*>(p));
  }
  runtime::purge<Env>& purge_;
  const bool holder_is_stuck_;
};

/// What is stale to the owner of a root, who knows nothing of purges: what is retired.
struct stale_to_owner {
  template <class T>
  bool operator()(T* p) const noexcept {
    return transitions<policy_of<T>>::load(access::header_of(*p).state).is_retired();
  }
  template <class T>
  void hold(T*) const noexcept {}
  bool dropped(bool done) const noexcept { return done; }
  std::size_t patience() const noexcept { return static_cast<std::size_t>(-1); }
  bool few(std::size_t) const noexcept { return false; }
  template <class T, class F>
  void each(F) const noexcept {}
};

/// Whether a type says by which number reports call its objects.
template <class T, class = void>
struct has_report_id : std::false_type {};
template <class T>
struct has_report_id<
    T, std::void_t<decltype(static_cast<std::uint64_t>(std::declval<const T&>().report_id()))>>
    : std::true_type {};
template <class T>
std::uint64_t report_id_of(const void* object) {
  return static_cast<std::uint64_t>(static_cast<const T*>(object)->report_id());
}

template <class Described, class Env>
struct operations_on {
  static const runtime::described_operations<Env> table;

  static bool purge_by_collector(void* described, runtime::purge<Env>& with) {
    purging_visitor visitor{with, with.find(described) != nullptr};
    return detail::visit_edges(*static_cast<Described*>(described), visitor);
  }
  static bool purge_by_owner(void* described) {
    owner_visitor visitor;
    return detail::visit_edges(*static_cast<Described*>(described), visitor);
  }
  static bool report(void* described, runtime::edge_sink<Env>& to) {
    reporting_visitor visitor{to};
    return detail::visit_edges(*static_cast<Described*>(described), visitor);
  }
  static bool suspect(void* described, runtime::trial_deletion<Env>& trial) {
    const auto make = [&trial](auto* p) {
      using target = object_of<std::remove_pointer_t<decltype(p)>>;
      if constexpr (is_described<target>::value)
        zero_count_table<target>::suspect(const_cast<target&>(static_cast<const target&>(*p)));
      (void)trial;
    };
    reference_visitor<decltype(make)> visitor{make};
    return detail::visit_edges(*static_cast<Described*>(described), visitor);
  }
  static bool record(void* described, runtime::trial_deletion<Env>& trial) {
    const auto record_one = [&trial](auto* p) {
      using target = object_of<std::remove_pointer_t<decltype(p)>>;
      if constexpr (is_described<target>::value) {
        // (11) only the collector stores what names a candidate.
        void* const link = access::header_of(*p).link.load(std::memory_order_relaxed);
        if (auto* const c = runtime::candidate<Env>::of_link(link)) trial.record(*c);
      }
      (void)trial;
    };
    reference_visitor<decltype(record_one)> visitor{record_one};
    return detail::visit_edges(*static_cast<Described*>(described), visitor);
  }
  static const runtime::described_operations<Env>* if_described() noexcept {
    if constexpr (is_described<Described>::value) return &table;
    return nullptr;
  }
  /// What reports say of an object.
  static runtime::edge_target<Env> target(const Described& object) noexcept {
    std::uint64_t (*id)(const void*) = nullptr;
    if constexpr (has_report_id<Described>::value) id = &report_id_of<Described>;
    return {const_cast<Described*>(&object), type_name<Described>::get(),
            transitions<policy_of<Described>>::load(access::header_of(object).state).bits,
            if_described(), id};
  }

 private:
  struct purging_visitor {
    runtime::purge<Env>& with;
    const bool is_stuck;

    template <class Member, class Disposition = on_retire::hold_edge>
    void edge(const char*, Member& member, const Disposition& how = {}) {
      using ops = edge_member<Member>;
      stale_to_collector<Env> stale(with, is_stuck);
      ops::purge(member, how, stale);
      ops::each(member, [this](auto* p) {
        using target = object_of<std::remove_pointer_t<decltype(p)>>;
        if constexpr (is_described<target>::value)
          with.meet(const_cast<target*>(static_cast<const target*>(p)),
                    operations_on<target, Env>::table);
      });
    }
  };
  struct owner_visitor {
    template <class Member, class Disposition = on_retire::hold_edge>
    void edge(const char*, Member& member, const Disposition& how = {}) {
      stale_to_owner stale;
      edge_member<Member>::purge(member, how, stale);
    }
  };
  struct reporting_visitor {
    runtime::edge_sink<Env>& to;

    template <class Member, class Disposition = on_retire::hold_edge>
    void edge(const char* name, Member& member, const Disposition& = {}) {
      edge_member<std::remove_const_t<Member>>::each(member, [&](auto* p) {
        using target = object_of<std::remove_pointer_t<decltype(p)>>;
        to.edge(name, on_retire::name_of(static_cast<Disposition*>(nullptr)),
                operations_on<target, Env>::target(*p));
      });
    }
  };
};
template <class Described, class Env>
const runtime::described_operations<Env> operations_on<Described, Env>::table = {
    &purge_by_collector, &purge_by_owner, &report, &suspect, &record};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
