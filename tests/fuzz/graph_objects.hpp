// A graph in which each kind of member meets each disposition that it can have, and what a program can do with a member,
// whatever its kind.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <list>
#include <mutex>
#include <slamgc/slamgc.hpp>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace fuzz {

enum class kind : std::uint8_t { keyframe, point, map, frame, board };
inline constexpr std::size_t kinds = 5;
inline const char* name_of(kind k) {
  constexpr const char* names[kinds] = {"keyframe", "point", "map", "frame", "board"};
  return names[static_cast<std::size_t>(k)];
}

struct vertex;
// Learns when a vertex comes and goes.
struct observer {
  virtual void begins(vertex& v) = 0;
  // In its destructor, while its members are still there.
  virtual void ends(vertex& v) noexcept = 0;
  // It makes the record that is left of it.
  virtual void buries(vertex&) {}

 protected:
  ~observer() = default;
};

// An object, or a board, which is what stands outside of the graph and refers into it.
struct vertex {
  static constexpr std::uint32_t intact = 0x600df00d;

  vertex(observer& o, kind k) : watched_by(o), type(k) { watched_by.begins(*this); }
  vertex(const vertex&) = delete;
  vertex& operator=(const vertex&) = delete;
  ~vertex() { canary = 0; }

  observer& watched_by;
  const kind type;
  volatile std::uint32_t canary = intact;
  unsigned id = 0;
  std::mutex mutex;  // of its members
};

struct keyframe;
struct point;
struct map;
struct frame;

namespace on = slamgc::on_retire;

// What is retired, and stepped over, leads here.
inline constexpr auto next_of = [](auto& retired) { return retired.next.get(); };

// What is left of a keyframe.
struct keyframe_record {
  unsigned id = 0;
  unsigned parent = 0;
  slamgc::anchor<keyframe, keyframe_record> older_parent;  // else records could be a ring
};

struct keyframe : slamgc::rc_object<keyframe, slamgc::fetch_add_counter, slamgc::reclaim_retired>,
                  slamgc::enable_anchor<keyframe, keyframe_record>,
                  vertex {
  explicit keyframe(observer& o);
  ~keyframe();
  keyframe_record record();
  template <class F>
  void members(F f) {
    f("next", next, on::hold);  // the first one: see next_of
    f("parent", parent, on::hold);
    f("reference", reference, on::null);
    f("successor", successor, on::bypass(next_of));
    f("matched", matched, on::null);
    f("points", points, on::null);
    f("ordered", ordered, on::erase_with(weights));
    f("chain", chain, on::bypass(next_of));
    f("neighbours", neighbours, on::erase_with(ranks, ages));
    f("held", held, on::hold);
    f("children", children, on::erase);
    f("connected", connected, on::erase);
    f("numbered", numbered, on::null);
    f("loops", loops, on::erase);
    f("covisible", covisible, on::hold);
    f("seen", seen, on::erase);
  }
  template <class Visitor>
  void edges(Visitor& v);

  slamgc::rc_slot<keyframe> next, parent, reference, successor;
  slamgc::atomic_rc<keyframe> matched;
  slamgc::rc_vector<point> points;
  slamgc::rc_vector<keyframe> ordered;
  std::vector<int> weights;
  slamgc::rc_vector<keyframe> chain;
  slamgc::rc_list<keyframe> neighbours;
  std::list<int> ranks;
  std::vector<int> ages;
  slamgc::rc_list<point> held;
  slamgc::rc_set<keyframe> children;
  slamgc::rc_map<keyframe, int> connected;
  slamgc::rc_value_map<int, keyframe> numbered;
  slamgc::rc_unordered_set<keyframe> loops;
  slamgc::rc_unordered_map<keyframe, int> covisible;
  slamgc::rc_value_map<int, point> seen;
};

struct point : slamgc::rc_object<point, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
               vertex {
  explicit point(observer& o);
  ~point();
  template <class F>
  void members(F f) {
    f("next", next, on::bypass(next_of));
    f("observations", observations, on::erase);
    f("reference", reference, on::null);
    f("twins", twins, on::hold);
    f("near", near, on::erase);
  }
  template <class Visitor>
  void edges(Visitor& v);

  slamgc::rc_slot<point> next;
  slamgc::rc_map<keyframe, int> observations;
  slamgc::rc_slot<keyframe> reference;
  slamgc::rc_set<point> twins;
  slamgc::rc_list<point> near;
};

// Retires what it holds when it goes.
struct map : slamgc::rc_object<map, slamgc::cas_counter, slamgc::reclaim_retired>, vertex {
  explicit map(observer& o);
  ~map();
  template <class F>
  void members(F f) {
    f("keyframes", keyframes, on::erase);
    f("points", points, on::erase);
    f("initial", initial, on::hold);
    f("merged", merged, on::null);
    f("last", last, on::null);
  }
  template <class Visitor>
  void edges(Visitor& v);

  slamgc::registry<slamgc::rc_set<keyframe>> keyframes;
  slamgc::registry<slamgc::rc_vector<point>> points;
  slamgc::rc_slot<keyframe> initial;
  slamgc::rc_slot<map> merged;
  slamgc::atomic_rc<frame> last;
};

// Describes nothing: what it refers to is referred to from outside.
struct frame : slamgc::rc_object<frame, slamgc::fetch_add_counter, slamgc::reclaim_deferred>,
               vertex {
  explicit frame(observer& o);
  ~frame();
  template <class F>
  void members(F f) {
    f("reference", reference, on::hold);
    f("points", points, on::hold);
    f("previous", previous, on::hold);
  }

  slamgc::rc_slot<keyframe> reference;
  slamgc::rc_vector<point> points;
  slamgc::rc_slot<frame> previous;
};

// Lives as long as the program; it may have a root.
struct board : vertex {
  explicit board(observer& o) : vertex(o, kind::board) {}
  template <class F>
  void members(F f) {
    f("keyframes", keyframes, on::erase);
    f("points", points, on::erase);
    f("maps", maps, on::null);
    f("origins", origins, on::hold);
    f("last", last, on::bypass(next_of));
    f("current", current, on::null);
    f("queue", queue, on::erase);
    f("tracked", tracked, on::null);
    f("local", local, on::bypass(next_of));
  }
  template <class Visitor>
  void edges(Visitor& v);

  slamgc::registry<slamgc::rc_unordered_set<keyframe>> keyframes;
  slamgc::registry<slamgc::rc_set<point>> points;
  slamgc::rc_value_map<int, map> maps;
  slamgc::rc_vector<keyframe> origins;
  slamgc::rc_slot<keyframe> last;
  slamgc::rc_slot<frame> current;
  slamgc::rc_list<keyframe> queue;
  slamgc::rc_vector<point> tracked;
  slamgc::rc_vector<point> local;
};

// ---- one member, whatever it is

enum class form { slot, sequence, keyed, numbered };
enum class disposition { hold, null, erase, bypass };

template <class Member>
struct traits;
template <class T, form F>
struct traits_of {
  using target = T;
  static constexpr form shape = F;
  static constexpr bool is_registry = false;
};
template <class T, class E>
struct traits<slamgc::rc_slot<T, E>> : traits_of<T, form::slot> {};
template <class T, class E>
struct traits<slamgc::atomic_rc<T, E>> : traits_of<T, form::slot> {};
template <class T, class... O>
struct traits<slamgc::rc_vector<T, O...>> : traits_of<T, form::sequence> {};
template <class T, class... O>
struct traits<slamgc::rc_list<T, O...>> : traits_of<T, form::sequence> {};
template <class T, class... O>
struct traits<slamgc::rc_set<T, O...>> : traits_of<T, form::keyed> {};
template <class T, class M, class... O>
struct traits<slamgc::rc_map<T, M, O...>> : traits_of<T, form::keyed> {};
template <class T, class... O>
struct traits<slamgc::rc_unordered_set<T, O...>> : traits_of<T, form::keyed> {};
template <class T, class M, class... O>
struct traits<slamgc::rc_unordered_map<T, M, O...>> : traits_of<T, form::keyed> {};
template <class K, class T, class... O>
struct traits<slamgc::rc_value_map<K, T, O...>> : traits_of<T, form::numbered> {};
template <class C, class E>
struct traits<slamgc::registry<C, E>> : traits<C> {
  static constexpr bool is_registry = true;
};
template <class Member>
inline constexpr form shape_of = traits<Member>::shape;

constexpr disposition disposition_of(const on::hold_edge&) { return disposition::hold; }
constexpr disposition disposition_of(const on::null_edge&) { return disposition::null; }
constexpr disposition disposition_of(const on::erase_edge&) { return disposition::erase; }
template <class... C>
constexpr disposition disposition_of(const on::erase_edge_with<C...>&) {
  return disposition::erase;
}
template <class N>
constexpr disposition disposition_of(const on::bypass_edge<N>&) {
  return disposition::bypass;
}

template <class T>
constexpr kind kind_of() {
  if constexpr (std::is_same<T, keyframe>::value) return kind::keyframe;
  if constexpr (std::is_same<T, point>::value) return kind::point;
  if constexpr (std::is_same<T, map>::value) return kind::map;
  if constexpr (std::is_same<T, frame>::value) return kind::frame;
  return kind::board;
}

// Calls f with the vertex as what it is.
template <class F>
void with_type(vertex& v, F f) {
  switch (v.type) {
    case kind::keyframe:
      return f(static_cast<keyframe&>(v));
    case kind::point:
      return f(static_cast<point&>(v));
    case kind::map:
      return f(static_cast<map&>(v));
    case kind::frame:
      return f(static_cast<frame&>(v));
    case kind::board:
      return f(static_cast<board&>(v));
  }
}
template <class F>
void with_object(vertex& v, F f) {
  with_type(v, [&](auto& object) {
    if constexpr (!std::is_same<std::decay_t<decltype(object)>, board>::value) f(object);
  });
}
// Calls f(member, how) with one of its members, under its lock.
template <class F>
void with_member(vertex& v, std::size_t index, F f) {
  const std::lock_guard<std::mutex> lock(v.mutex);
  with_type(v, [&](auto& object) {
    std::size_t i = 0;
    object.members([&](const char*, auto& member, const auto& how) {
      if (i++ == index) f(member, how);
    });
  });
}

// What describes a member to the oracle.
struct member_info {
  const char* name;
  form shape;
  disposition how;
  kind target;
  bool is_registry;
};
inline const std::vector<member_info>& members_of(vertex& v) {
  const std::vector<member_info>* all = nullptr;
  with_type(v, [&](auto& object) {
    static const std::vector<member_info> list = [&object] {
      std::vector<member_info> found;
      object.members([&](const char* name, auto& member, const auto& how) {
        using member_traits = traits<std::decay_t<decltype(member)>>;
        found.push_back({name, member_traits::shape, disposition_of(how),
                         kind_of<typename member_traits::target>(), member_traits::is_registry});
      });
      return found;
    }();
    all = &list;
  });
  return *all;
}

// A reference, with what the member keeps along with it: a number of its own, the value of a map, the companions.
struct reference {
  vertex* target;
  int tag;
};
inline bool operator==(const reference& a, const reference& b) {
  return a.target == b.target && a.tag == b.tag;
}
inline bool operator!=(const reference& a, const reference& b) { return !(a == b); }

// Companions, if there are any: f(companion) for each.
template <class How, class F>
void each_companion(const How&, F) {}
template <class... C, class F>
void each_companion(const on::erase_edge_with<C...>& how, F f) {
  std::apply([&](auto&... c) { (..., f(c)); }, how.companions);
}
template <class Sequence>
auto place(Sequence& s, std::size_t i) {
  return std::next(s.begin(), static_cast<std::ptrdiff_t>(i));
}

// Keyed members have no order of their own: that of the addresses here.
inline void normalise(form shape, std::vector<reference>& content) {
  if (shape == form::keyed)
    std::sort(content.begin(), content.end(), [](const reference& a, const reference& b) {
      return std::less<vertex*>()(a.target, b.target);
    });
}

// False if companions are out of step.
template <class Member, class How>
bool read(Member& member, const How& how, std::vector<reference>& to) {
  to.clear();
  bool in_step = true;
  if constexpr (shape_of<Member> == form::slot) {
    if (auto* const p = member.get()) to.push_back({p, 0});
  } else if constexpr (shape_of<Member> == form::sequence) {
    for (auto* p : member.raw()) to.push_back({p, 0});
    each_companion(how, [&](auto& companion) {
      in_step = in_step && companion.size() == to.size();
      std::size_t i = 0;
      for (const int tag : companion) {
        if (i == to.size()) break;
        in_step = in_step && (to[i].tag == 0 || to[i].tag == tag);
        to[i++].tag = tag;
      }
    });
  } else if constexpr (shape_of<Member> == form::numbered) {
    for (const auto& [number, p] : member.raw()) to.push_back({p, number});
  } else {
    for (const auto& element : member.raw()) {
      if constexpr (std::is_pointer<std::decay_t<decltype(element)>>::value)
        to.push_back({element, 0});
      else
        to.push_back({element.first, element.second});
    }
    normalise(form::keyed, to);
  }
  return in_step;
}

inline constexpr std::size_t longest_sequence = 8;
inline constexpr std::size_t largest_set = 40;  // so large that a purge looks up instead of walking

// What link() and others do to a member, they do to a list of references: the oracle's.
struct plain_member {
  form shape;
  std::vector<reference>& content;
};

// Where in a sequence of n elements link() puts a reference: an element to assign, or a place to insert.
struct position {
  bool assigns;
  std::size_t at;
};
inline position position_for(std::size_t n, unsigned how) {
  switch (how % 4) {
    case 0:
      return {false, 0};
    case 1:
      return {n != 0, n == 0 ? 0 : how / 4 % n};
    default:
      return {n == longest_sequence, n == longest_sequence ? n - 1 : n};
  }
}
// One more reference, to p, in a way that `how` selects; tag is never 0.
template <class Member, class How, class T>
void link(Member& member, const How& companions, T* p, unsigned how, int tag) {
  if constexpr (shape_of<Member> == form::slot) {
    if constexpr (std::is_same<Member, slamgc::atomic_rc<T>>::value)
      member = slamgc::intrusive_rc<T>(p);
    else
      member = p;
  } else if constexpr (shape_of<Member> == form::sequence) {
    const position to = position_for(member.size(), how);
    if (!to.assigns)
      member.insert(place(member, to.at), p);
    else if constexpr (std::is_same<typename Member::iterator,
                                    typename Member::const_iterator>::value)
      member[to.at] = p;
    else
      member.replace(place(member, to.at), p);
    each_companion(companions, [&](auto& c) {
      if (to.assigns)
        *place(c, to.at) = tag;
      else
        c.insert(place(c, to.at), tag);
    });
  } else if constexpr (shape_of<Member> == form::numbered) {
    member.insert_or_assign(static_cast<int>(how % longest_sequence), p);
  } else if (member.size() < largest_set) {
    if constexpr (std::is_pointer<typename Member::value_type>::value)
      member.insert(p);
    else
      member.emplace(p, tag);
  }
}
inline void link(const plain_member& member, bool has_tags, vertex* p, unsigned how, int tag) {
  std::vector<reference>& content = member.content;
  const reference added{p, has_tags ? tag : 0};
  const auto same_target = [p](const reference& r) { return r.target == p; };
  if (member.shape == form::slot) {
    content.assign(1, added);
  } else if (member.shape == form::sequence) {
    const position to = position_for(content.size(), how);
    if (to.assigns)
      content[to.at] = added;
    else
      content.insert(place(content, to.at), added);
  } else if (member.shape == form::numbered) {
    const int number = static_cast<int>(how % longest_sequence);
    auto at = std::find_if(content.begin(), content.end(),
                           [&](const reference& r) { return r.tag >= number; });
    if (at == content.end() || at->tag != number) at = content.insert(at, {p, number});
    at->target = p;
  } else if (content.size() < largest_set &&
             std::none_of(content.begin(), content.end(), same_target)) {
    content.push_back(added);
    normalise(form::keyed, content);
  }
}

// Removes the i-th reference.
template <class Member, class How>
void unlink(Member& member, const How& companions, const reference& which, std::size_t i) {
  if constexpr (shape_of<Member> == form::slot) {
    member = nullptr;
  } else if constexpr (shape_of<Member> == form::sequence) {
    member.erase(place(member, i));
    each_companion(companions, [&](auto& c) { c.erase(place(c, i)); });
  } else if constexpr (shape_of<Member> == form::numbered) {
    member.erase(which.tag);
  } else {
    member.erase(static_cast<typename traits<Member>::target*>(which.target));
  }
}
// Removes all references, by which a registry retires them.
template <class Member, class How>
void clear(Member& member, const How& companions) {
  if constexpr (shape_of<Member> == form::slot)
    member = nullptr;
  else
    member.clear();
  each_companion(companions, [](auto& c) { c.clear(); });
}

// ---- two members of one type

enum class transfer { copy, move, swap, append };
inline constexpr const char* name_of(transfer t) {
  constexpr const char* names[] = {"copies", "moves", "swaps", "appends"};
  return names[static_cast<int>(t)];
}

template <class Member>
void transfer_members(transfer what, Member& from, Member& to) {
  if constexpr (traits<Member>::is_registry) {
    // Is not moved as a whole.
  } else if constexpr (std::is_same<Member,
                                    slamgc::atomic_rc<typename traits<Member>::target>>::value) {
    if (what == transfer::copy || what == transfer::append)
      to.store(from.load());
    else if (what == transfer::move)
      to.store(from.exchange(nullptr));
    else if (&from != &to)
      from.store(to.exchange(from.exchange(nullptr)));
  } else if (what == transfer::copy) {
    to = from;
  } else if (what == transfer::move) {
    to = std::move(from);
  } else if (what == transfer::swap) {
    to.swap(from);
  } else if constexpr (shape_of<Member> == form::slot) {
    to = (void(to.exchange(from.get())), from.get());
  } else if constexpr (shape_of<Member> != form::sequence) {
    to.merge(from);
  } else if constexpr (std::is_same<typename Member::iterator,
                                    typename Member::const_iterator>::value) {
    to.insert(to.end(), from.begin(), from.end());
  } else {
    to.splice(to.end(), from);
  }
}
// As the member would do it; `moves` says whether append() takes the elements out, as a list's splice does.
inline void transfer_members(transfer what, const plain_member& from, const plain_member& to,
                             bool moves) {
  std::vector<reference>& a = from.content;
  std::vector<reference>& b = to.content;
  if (what == transfer::copy || (what == transfer::append && from.shape == form::slot)) {
    b = a;
  } else if (what == transfer::move) {
    b = std::exchange(a, {});
  } else if (what == transfer::swap) {
    b.swap(a);
  } else if (from.shape == form::sequence) {
    b.insert(b.end(), a.begin(), a.end());
    if (moves) a.clear();
  } else {
    std::vector<reference> left;
    for (const reference& r : a) {
      const bool known = std::any_of(b.begin(), b.end(), [&](const reference& s) {
        return from.shape == form::numbered ? s.tag == r.tag : s.target == r.target;
      });
      (known ? left : b).push_back(r);
    }
    a.swap(left);
    if (from.shape == form::numbered)
      std::sort(b.begin(), b.end(),
                [](const reference& r, const reference& s) { return r.tag < s.tag; });
    normalise(from.shape, b);
  }
}
// The companions do what their sequences do.
struct companions {
  std::vector<std::vector<int>*> vectors;
  std::vector<std::list<int>*> lists;

  void add(std::vector<int>& c) { vectors.push_back(&c); }
  void add(std::list<int>& c) { lists.push_back(&c); }
};
template <class Sequence>
void transfer_companion(transfer what, Sequence& from, Sequence& to, bool moves) {
  if (what == transfer::swap) return to.swap(from);
  if (what != transfer::append) to.clear();
  to.insert(to.end(), from.begin(), from.end());
  if (what == transfer::move || (what == transfer::append && moves)) from.clear();
}
inline void transfer_companions(transfer what, const companions& from, const companions& to,
                                bool moves) {
  for (std::size_t i = 0; i != from.vectors.size(); ++i)
    transfer_companion(what, *from.vectors[i], *to.vectors[i], moves);
  for (std::size_t i = 0; i != from.lists.size(); ++i)
    transfer_companion(what, *from.lists[i], *to.lists[i], moves);
}

// ---- definitions that need all types

template <class Described, class Visitor>
void visit(Described& described, Visitor& v) {
  const std::lock_guard<std::mutex> lock(described.mutex);
  described.members(
      [&v](const char* name, auto& member, const auto& how) { v.edge(name, member, how); });
}
template <class Visitor>
void keyframe::edges(Visitor& v) {
  visit(*this, v);
}
template <class Visitor>
void point::edges(Visitor& v) {
  visit(*this, v);
}
template <class Visitor>
void map::edges(Visitor& v) {
  visit(*this, v);
}
template <class Visitor>
void board::edges(Visitor& v) {
  visit(*this, v);
}

inline keyframe::keyframe(observer& o) : vertex(o, kind::keyframe) {}
inline keyframe::~keyframe() { watched_by.ends(*this); }
inline keyframe_record keyframe::record() {
  const std::lock_guard<std::mutex> lock(mutex);
  watched_by.buries(*this);
  keyframe* const p = parent.get();
  if (p == nullptr) return {id, 0, nullptr};
  return {id, p->id, slamgc::anchor<keyframe, keyframe_record>(p->id < id ? p : nullptr)};
}
inline point::point(observer& o) : vertex(o, kind::point) {}
inline point::~point() { watched_by.ends(*this); }
inline map::map(observer& o) : vertex(o, kind::map) {}
inline map::~map() { watched_by.ends(*this); }
inline frame::frame(observer& o) : vertex(o, kind::frame) {}
inline frame::~frame() { watched_by.ends(*this); }

}  // namespace fuzz
