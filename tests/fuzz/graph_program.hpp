// Interprets bytes as a program over a graph, on one thread, and lets the oracle judge.
//
// Each byte string is a program: an operation takes a byte that selects it (operations()), and operands as it needs them. To
// add an operation: a member function that does the same to the real graph and to the oracle, and a line in the table.
#pragma once

#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

// Misuse of the library is a fault of the interpreter, or of the library: reported with the program.
namespace fuzz {
template <class Misuse>
void misused(const Misuse& m) noexcept;
}  // namespace fuzz
#define SLAMGC_ASSERT(condition, found) ((condition) ? void() : ::fuzz::misused(found))

#include <array>
#include <chrono>
#include <limits>
#include <memory>
#include <optional>
#include <slamgc/slamgc.hpp>
#include <tuple>
#include <vector>

#include "graph_objects.hpp"
#include "graph_oracle.hpp"

namespace fuzz {

// The n-th allocation from now that may fail does; 0: none. See failing_allocation.cpp.
inline thread_local unsigned failing_allocation = 0;

class program final : public oracle {
 public:
  program(const std::uint8_t* bytes, std::size_t size, bool in_words)
      : program(std::make_unique<slamgc::domain>(), bytes, size, in_words) {}
  ~program() {
    running() = outer_;
    failing_allocation = 0;
  }
  program(const program&) = delete;
  program& operator=(const program&) = delete;

  // Returns the number of operations. Does not return if the oracle objects.
  std::size_t run() {
    begin();
    for (done_ = 0; at_ != end_; ++done_) {
      const operation& o = operations()[next() % operations().size()];
      (this->*o.run)();
    }
    finish();
    return done_;
  }

  static program*& running() {
    static thread_local program* now = nullptr;
    return now;
  }
  [[noreturn]] void fail(const char* what) {
    std::fprintf(stderr, "%sgraph program: %s, after %zu operations\n", in_words_ ? ">> " : "",
                 what, done_);
    explain();
  }

 private:
  struct operation {
    void (program::*run)();
  };
  struct handle {
    vertex* object = nullptr;
    std::size_t borrowed_by = 0;
  };
  struct anchor {
    using handle = slamgc::anchor<keyframe, keyframe_record>;
    handle to;
    unsigned id = 0;
  };
  static constexpr std::size_t boards = 3;
  static constexpr std::size_t most_objects = 80;

  program(std::unique_ptr<slamgc::domain> d, const std::uint8_t* bytes, std::size_t size,
          bool in_words)
      : oracle(*d),
        domain_(std::move(d)),
        begin_(bytes),
        at_(bytes),
        end_(bytes + size),
        in_words_(in_words),
        outer_(running()) {
    running() = this;
  }

  // What a byte stands for: operations that are to be frequent have several lines.
  static const std::vector<operation>& operations() {
    static const std::vector<operation> all = [] {
      std::vector<operation> list;
      const auto add = [&list](std::size_t weight, void (program::*run)()) {
        list.insert(list.end(), weight, {run});
      };
      add(24, &program::make);
      add(60, &program::link_one);
      add(24, &program::unlink_one);
      add(28, &program::borrow_one);
      add(16, &program::transfer_one);
      add(5, &program::reverse_one);
      add(14, &program::retire_one);
      add(5, &program::pin_one);
      add(5, &program::unpin_one);
      add(3, &program::borrow_pin);
      add(3, &program::retire_pin);
      add(9, &program::set_last_words);
      add(10, &program::pass_quiescent_state);
      add(3, &program::go_offline);
      add(4, &program::go_online);
      add(24, &program::collect_a_little);
      add(3, &program::collect_all);
      add(2, &program::collect_without_memory);
      add(2, &program::drop_registry);
      add(1, &program::drop_maps);
      add(3, &program::change_root);
      add(2, &program::suspect_board);
      add(1, &program::collect_cycles_of_board);
      add(1, &program::register_anew);
      add(1, &program::settle);
      add(2, &program::anchor_one);
      add(1, &program::borrow_anchored);
      return list;
    }();
    return all;
  }

  // ---- operands

  unsigned next() { return at_ == end_ ? 0 : *at_++; }
  template <class Condition>
  handle* find_handle(unsigned from, Condition condition) {
    for (std::size_t i = 0; i != handles_.size(); ++i) {
      handle& h = handles_[(from + i) % handles_.size()];
      if (h.object != nullptr && condition(*h.object)) return &h;
    }
    return nullptr;
  }
  // A vertex whose members are read or changed: one that is borrowed, or a board.
  vertex& any_owner() {
    const unsigned from = next();
    owner_borrowed_by_.reset();
    if (from % 4 != 0)
      if (handle* const h = find_handle(from / 4, [](vertex&) { return true; })) {
        owner_borrowed_by_ = h->borrowed_by;
        return *h->object;
      }
    return *boards_[from / 4 % boards];
  }
  vertex* any_object() {
    handle* const h = find_handle(next(), [](vertex&) { return true; });
    return h != nullptr ? h->object : nullptr;
  }
  vertex* any_object_of(kind k) {
    handle* const h = find_handle(next(), [k](vertex& v) { return v.type == k; });
    return h != nullptr ? h->object : nullptr;
  }
  std::size_t any_member(vertex& v) { return next() % members_of(v).size(); }
  std::size_t any_mutator() { return next() % mutators_.size(); }
  // An online one, or none.
  std::optional<std::size_t> any_borrower() {
    const std::size_t from = next();
    for (std::size_t i = 0; i != mutators_.size(); ++i) {
      const std::size_t m = (from + i) % mutators_.size();
      if (mutators_[m]->is_online()) return m;
    }
    return std::nullopt;
  }

  // ---- borrowed pointers

  void borrow(vertex& v, std::size_t by) {
    handle& h = handles_[last_handle_++ % handles_.size()];
    give_up(h);
    h = {&v, by};
    ++of(v).borrows;
  }
  void give_up(handle& h) {
    if (h.object != nullptr) --of(*h.object).borrows;
    h.object = nullptr;
  }
  void give_up_all(std::size_t mutator) {
    for (handle& h : handles_)
      if (h.object != nullptr && h.borrowed_by == mutator) give_up(h);
  }

  // ---- the same to both graphs

  template <class T>
  vertex& make_object() {
    auto* const object = new T(*this);
    made(*object);
    return *object;
  }
  void link(vertex& owner, std::size_t i, vertex& target, unsigned how) {
    const int tag = static_cast<int>(how) + 1;
    bool has_tags = false;
    with_member(owner, i, [&](auto& member, const auto& companions) {
      using member_type = std::decay_t<decltype(member)>;
      using target_type = typename traits<member_type>::target;
      has_tags = has_tags_of(member, companions);
      fuzz::link(member, companions, static_cast<target_type*>(&target), how, tag);
    });
    change(owner, i, [&](const plain_member& m) { fuzz::link(m, has_tags, &target, how, tag); });
  }
  template <class Member, class How>
  static bool has_tags_of(const Member&, const How& companions) {
    bool any = false;
    each_companion(companions, [&](auto&) { any = true; });
    if constexpr (shape_of<Member> == form::keyed)
      any = !std::is_pointer<typename Member::value_type>::value;
    return any;
  }
  void unlink(vertex& owner, std::size_t i, unsigned which) {
    const std::vector<reference>& content = of(owner).members[i];
    if (content.empty()) return;
    const bool all = which >= 240 && !members_of(owner)[i].is_registry;
    const std::size_t n = which % content.size();
    const reference r = content[n];
    with_member(owner, i, [&](auto& member, const auto& companions) {
      if (all)
        fuzz::clear(member, companions);
      else
        fuzz::unlink(member, companions, r, n);
    });
    change(owner, i, [&](const plain_member& m) {
      if (all)
        m.content.clear();
      else
        m.content.erase(place(m.content, n));
    });
  }
  void clear_registry(vertex& owner, std::size_t i) {
    drop(owner, i);
    with_member(owner, i,
                [&](auto& member, const auto& companions) { fuzz::clear(member, companions); });
  }
  void retire(vertex& v) {
    bool first = false;
    retires(v);
    with_object(v, [&](auto& object) { first = slamgc::retire(&object); });
    retired(v, first);
  }

  // ---- operations

  void make() {
    const auto by = any_borrower();
    const unsigned what = next() % 16;
    if (!by) return;
    if (existing().size() >= most_objects) tidy();
    if (!mutators_[*by]->is_online()) return;
    vertex& v = what < 8    ? make_object<keyframe>()
                : what < 13 ? make_object<point>()
                : what < 14 ? make_object<map>()
                            : make_object<frame>();
    say("mutator %zu makes %s", *by, words(v));
    borrow(v, *by);
  }
  void link_one() {
    vertex& owner = any_owner();
    const std::size_t i = any_member(owner);
    const auto& info = members_of(owner)[i];
    vertex* const target = any_object_of(info.target);
    const unsigned how = next();
    if (target == nullptr) return;
    say("%s.%s refers to %s (%u)", words(owner), info.name, words(*target), how);
    link(owner, i, *target, how);
  }
  void unlink_one() {
    vertex& owner = any_owner();
    const std::size_t i = any_member(owner);
    const unsigned which = next();
    say("%s.%s: number %u goes", words(owner), members_of(owner)[i].name, which);
    unlink(owner, i, which);
  }
  void borrow_one() {
    vertex& owner = any_owner();
    const std::size_t i = any_member(owner);
    const unsigned which = next();
    // Threads do not pass borrowed pointers on: who borrowed the object reads its members.
    const auto by = owner_borrowed_by_ ? owner_borrowed_by_ : any_borrower();
    if (!by) return;
    vertex* found = nullptr;
    // From the real member: whatever a collector did to it meanwhile.
    with_member(owner, i, [&](auto& member, const auto& how) {
      (void)read(member, how, content_);
      if (!content_.empty()) found = content_[which % content_.size()].target;
    });
    if (found == nullptr) return;
    say("mutator %zu borrows %s from %s.%s", *by, words(*found), words(owner),
        members_of(owner)[i].name);
    if (found->canary != vertex::intact || of(*found).object != found)
      fail(owner, "refers to an object that was destroyed");
    borrow(*found, *by);
  }
  void transfer_one() {
    vertex& from = any_owner();
    const auto what = static_cast<transfer>(next() % 4);
    vertex* to = nullptr;
    if (from.type == kind::board) {
      to = boards_[next() % boards].get();
    } else {
      to = any_object_of(from.type);
    }
    const std::size_t i = any_member(from);
    const auto& info = members_of(from)[i];
    if (to == nullptr || info.is_registry || (to == &from && what == transfer::append)) return;
    // What a collector has not been seen to do is seen now: sizes must be those of the real members.
    const std::size_t both = of(from).members[i].size() + of(*to).members[i].size();
    if (what == transfer::append && info.shape == form::sequence && both > longest_sequence) return;
    say("%s.%s %s to that of %s", words(from), info.name, name_of(what), words(*to));
    bool splices = false;
    void* other = nullptr;
    companions followers;
    companions other_followers;
    with_member(*to, i, [&](auto& member, const auto& how) {
      other = &member;
      each_companion(how, [&](auto& c) { other_followers.add(c); });
    });
    with_member(from, i, [&](auto& member, const auto& how) {
      using member_type = std::decay_t<decltype(member)>;
      splices = shape_of<member_type> == form::sequence && !is_vector(member);
      transfer_members(what, member, *static_cast<member_type*>(other));
      each_companion(how, [&](auto& c) { followers.add(c); });
    });
    if (to != &from) transfer_companions(what, followers, other_followers, splices);
    change(from, *to, i, [&](const plain_member& a, const plain_member& b) {
      transfer_members(what, a, b, splices);
    });
  }
  template <class Member>
  static constexpr bool is_vector(const Member&) {
    return std::is_same<typename Member::iterator, typename Member::const_iterator>::value;
  }
  template <class T, class E>
  static constexpr bool is_vector(const slamgc::rc_slot<T, E>&) {
    return false;
  }
  template <class T, class E>
  static constexpr bool is_vector(const slamgc::atomic_rc<T, E>&) {
    return false;
  }
  // Through edit(), where there is one.
  void reverse_one() {
    vertex& owner = any_owner();
    const std::size_t i = any_member(owner);
    const auto& info = members_of(owner)[i];
    if (info.shape != form::sequence) return;
    say("%s.%s is reversed", words(owner), info.name);
    with_member(owner, i, [](auto& member, const auto& companions) {
      using member_type = std::decay_t<decltype(member)>;
      if constexpr (shape_of<member_type> == form::sequence) {
        {
          auto edit = member.edit();
          std::reverse((*edit).begin(), (*edit).end());
        }
        each_companion(companions, [](auto& c) { std::reverse(c.begin(), c.end()); });
      }
    });
    change(owner, i,
           [](const plain_member& m) { std::reverse(m.content.begin(), m.content.end()); });
  }
  void retire_one() {
    vertex* const v = any_object();
    if (v == nullptr) return;
    say("%s is retired", words(*v));
    retire(*v);
  }
  template <class F>
  void with_pin(kind k, unsigned which, F f) {
    switch (k) {
      case kind::keyframe:
        return f(std::get<0>(pins_)[which % pins_each]);
      case kind::point:
        return f(std::get<1>(pins_)[which % pins_each]);
      case kind::map:
        return f(std::get<2>(pins_)[which % pins_each]);
      default:
        return f(std::get<3>(pins_)[which % pins_each]);
    }
  }
  void pin_one() {
    vertex* const v = any_object();
    const unsigned which = next();
    if (v == nullptr) return;
    say("%s is pinned", words(*v));
    with_pin(v->type, which, [&](auto& pin) {
      using target = typename std::decay_t<decltype(pin)>::element_type;
      if (pin) --of(*pin).pins;
      pin = static_cast<target*>(v);
      ++of(*v).pins;
      of(*v).was_counted = true;
    });
  }
  void unpin_one() {
    const auto k = static_cast<kind>(next() % 4);
    with_pin(k, next(), [&](auto& pin) {
      if (!pin) return;
      say("%s is unpinned", words(*pin));
      --of(*pin).pins;
      pin.reset();
    });
  }
  void borrow_pin() {
    const auto by = any_borrower();
    const auto k = static_cast<kind>(next() % 4);
    with_pin(k, next(), [&](auto& pin) {
      if (!pin || !by) return;
      say("mutator %zu borrows %s, which is pinned", *by, words(*pin));
      borrow(*pin, *by);
    });
  }
  void retire_pin() {
    const auto k = static_cast<kind>(next() % 4);
    with_pin(k, next(), [&](auto& pin) {
      if (!pin) return;
      say("%s, which is pinned, is retired", words(*pin));
      retire(*pin);
    });
  }
  void anchor_one() {
    const unsigned which = next();
    vertex* const v = any_object_of(kind::keyframe);
    if (v == nullptr) return;
    say("%s is anchored", words(*v));
    anchors_[which % anchors_.size()] = {anchor::handle(static_cast<keyframe*>(v)), v->id};
  }
  void borrow_anchored() {
    const auto by = any_borrower();
    if (!by) return;
    for (const anchor& a : anchors_) {
      const slamgc::intrusive_rc<keyframe> object = a.to.lock();
      if (object == nullptr) continue;
      say("mutator %zu borrows %s, which is anchored", *by, words(*object));
      if (object->canary != vertex::intact || of(*object).object != object.get())
        fail(*object, "is destroyed, and an anchor refers to it");
      of(*object).was_counted = true;
      borrow(*object, *by);
    }
  }
  // An anchor gives the object, or the record that it left, and those of its parents.
  void check_anchors() {
    for (const anchor& a : anchors_) {
      if (!a.to) continue;
      check_anchor(a.to, a.id);
    }
  }
  void check_anchor(const anchor::handle& to, unsigned id) {
    const keyframe_record* const r = to.record();
    if (r == nullptr) {
      if (of(id).object == nullptr) fail("an anchor of a destroyed object has no record");
      return;
    }
    if (of(id).object != nullptr && !of(id).retired)
      fail(*of(id).object, "is not retired, and left a record");
    if (r->id != id || r->parent != of(id).recorded_parent)
      fail("a record is not what the object left");
    if (bool(r->older_parent) != (r->parent != 0 && r->parent < id))
      fail("a record has lost its parent");
    if (r->older_parent) check_anchor(r->older_parent, r->parent);
  }
  void set_last_words() {
    vertex* const v = any_object();
    const unsigned what = next();
    if (v == nullptr) return;
    say("%s gets last words %u", words(*v), what);
    of(*v).last_words = static_cast<std::uint8_t>(what);
  }
  void pass_quiescent_state() {
    const std::size_t m = any_mutator();
    if (!mutators_[m]->is_online()) return;
    say("mutator %zu is quiescent", m);
    give_up_all(m);
    mutators_[m]->quiescent();
    look_at_roots_of(m);
    check_counts();
  }
  void go_offline() {
    const std::size_t m = any_mutator();
    if (!mutators_[m]->is_online()) return;
    say("mutator %zu goes offline", m);
    give_up_all(m);
    online_[m].reset();
    look_at_roots_of(m);
    check_counts();
  }
  void go_online() {
    const std::size_t m = any_mutator();
    if (mutators_[m]->is_online()) return;
    say("mutator %zu goes online", m);
    online_[m].emplace(*mutators_[m]);
    look_at_roots_of(m);
    check_counts();
  }
  void collect(slamgc::budget limit) {
    allow_suspicion();
    const slamgc::collected done = domain_->collect(limit);
    failing_allocation = 0;
    say("  ended as %d, reclaimed %zu", static_cast<int>(done.result), done.reclaimed);
    if (done.result == slamgc::collected::outcome::busy ||
        done.result == slamgc::collected::outcome::refused)
      fail("collect() did nothing");
    allow_suspicion();
    sync_if_purged();
  }
  void collect_a_little() {
    const unsigned how = next();
    slamgc::budget limit;
    if (how == 255)
      limit.time = std::chrono::nanoseconds(0);
    else
      limit.objects = how < 128 ? 1 : 2 + how % 16;
    say("collect(%zu)", limit.objects);
    collect(limit);
  }
  void collect_all() {
    say("collect()");
    collect({});
  }
  void collect_without_memory() {
    const unsigned how = next();
    failing_allocation = 1 + how % 4;
    say("collect() without memory");
    slamgc::budget limit;
    if (how < 128) limit.objects = 1 + how / 4;
    collect(limit);
  }
  void drop_registry() {
    vertex& owner = any_owner();
    const bool without_memory = next() % 4 == 0;
    const auto& info = members_of(owner);
    for (std::size_t i = 0; i != info.size(); ++i) {
      if (!info[i].is_registry) continue;
      say("%s.%s is dropped%s", words(owner), info[i].name,
          without_memory ? " without memory" : "");
      failing_allocation = without_memory;
      clear_registry(owner, i);
      failing_allocation = 0;
    }
  }
  // A whole map, with what a board lists.
  void drop_maps() {
    vertex* const v = any_object_of(kind::map);
    board& b = *boards_[next() % boards];
    if (v == nullptr) return;
    say("%s and %s are dropped", words(*v), words(b));
    drop(*v, 0);
    drop(*v, 1);
    drop(b, 0);
    drop(b, 1);
    auto& m = static_cast<map&>(*v);
    slamgc::drop_map(m.keyframes, m.points, b.keyframes, b.points);
  }
  void change_root() {
    const std::size_t b = next() % boards;
    const unsigned how = next();
    set_root(b, how);
  }
  void set_root(std::size_t b, unsigned how) {
    record& r = of(*boards_[b]);
    if (r.has_root) {
      say("the root of %s ends", words(*boards_[b]));
      roots_[b].reset();
      r.has_root = false;
      return;
    }
    const std::size_t m = how / 4 % mutators_.size();
    r.has_root = r.is_purged = true;
    r.is_owned = how % 4 == 3;
    if (r.is_owned) {
      say("%s becomes a root of mutator %zu", words(*boards_[b]), m);
      roots_[b].emplace(*mutators_[m], "board", *boards_[b]);
      owner_of_root_[b] = m;
    } else {
      say("%s becomes a root", words(*boards_[b]));
      roots_[b].emplace(*domain_, "board", *boards_[b]);
    }
  }
  void look_at_roots_of(std::size_t mutator) {
    for (std::size_t b = 0; b != boards; ++b) {
      const record& r = of(*boards_[b]);
      if (r.has_root && r.is_owned && owner_of_root_[b] == mutator) sync(*boards_[b]);
    }
  }
  void suspect_board() {
    const std::size_t b = next() % boards;
    if (!roots_[b]) return;
    say("collect_cycles() of %s", words(*boards_[b]));
    if (!of(*boards_[b]).is_owned) suspect(*boards_[b]);
    roots_[b]->collect_cycles();
  }
  // While nothing else is to be done: exactly what is out of reach is found.
  void collect_cycles_of_board() {
    const std::size_t b = next() % boards;
    if (!roots_[b] || of(*boards_[b]).is_owned) return;
    settle();
    say("collect_cycles() of %s, and drain()", words(*boards_[b]));
    const std::vector<unsigned> expected = suspect_exactly(*boards_[b]);
    roots_[b]->collect_cycles();
    settle();
    for (const unsigned id : expected)
      if (of(id).object != nullptr && !of(id).retired)
        fail(*of(id).object, "is out of reach but for a board, and collect_cycles() missed it");
  }
  void register_anew() {
    const std::size_t m = any_mutator();
    say("mutator %zu ends, and another one begins", m);
    give_up_all(m);
    online_[m].reset();
    mutators_[m].reset();
    for (std::size_t b = 0; b != boards; ++b)
      if (of(*boards_[b]).is_owned && owner_of_root_[b] == m) {
        sync(*boards_[b]);
        of(*boards_[b]).is_purged = false;
      }
    register_mutator(m);
  }
  void register_mutator(std::size_t m) {
    mutators_[m] = std::make_unique<slamgc::mutator>(*domain_, "mutator",
                                                     slamgc::mutator_options{false, false});
    online_[m].emplace(*mutators_[m]);
  }
  // Nobody borrows, and all that can be reclaimed is.
  void settle() {
    say("settle");
    std::array<bool, 3> were_online{};
    std::uint64_t before = 0;
    for (int rounds = 0; rounds < 2 || before != changes(); ++rounds) {
      before = changes();
      for (std::size_t m = 0; m != mutators_.size(); ++m) {
        if (rounds == 0) were_online[m] = mutators_[m]->is_online();
        give_up_all(m);
        if (!mutators_[m]->is_online()) online_[m].emplace(*mutators_[m]);
        mutators_[m]->quiescent();
        online_[m].reset();
        look_at_roots_of(m);
      }
      allow_suspicion();
      if (domain_->drain() != slamgc::waited::done) fail("drain() did not end");
      allow_suspicion();
      sync();
      if (rounds > 10000) fail("collections find no end");
    }
    end_suspicions();
    check_settled();
    check_anchors();
    for (std::size_t m = 0; m != mutators_.size(); ++m)
      if (were_online[m]) online_[m].emplace(*mutators_[m]);
  }
  // Too many objects: what the program lost is retired, and one board forgets everything.
  void tidy() {
    settle();
    for (const unsigned id : existing_copy())
      if (of(id).type != kind::board && of(id).pins == 0) give_up_on(*of(id).object);
    board& b = *boards_[next() % boards];
    for (std::size_t i = 0; i != members_of(b).size(); ++i) {
      if (members_of(b)[i].is_registry)
        clear_registry(b, i);
      else
        unlink(b, i, 255);
    }
    settle();
    if (existing().size() >= most_objects) {
      for (auto& one : boards_)
        for (std::size_t i = 0; i != members_of(*one).size(); ++i)
          if (!members_of(*one)[i].is_registry) unlink(*one, i, 255);
      for (unsigned k = 0; k != 4; ++k)
        for (unsigned i = 0; i != pins_each; ++i)
          with_pin(static_cast<kind>(k), i, [&](auto& pin) {
            if (pin) --of(*pin).pins;
            pin.reset();
          });
      settle();
    }
  }
  std::vector<unsigned> existing_copy() const { return existing(); }
  void give_up_on(vertex& v) {
    if (v.type == kind::frame) unlink(v, frame_previous, 0);
    retires(v);
    if (of(v).retired) return;
    const slamgc::mutator::online_scope online(*mutators_[0]);
    retire(v);
  }

  void begin() {
    const unsigned how = next();
    mutators_.resize(1 + how % 3);
    for (std::size_t m = 0; m != mutators_.size(); ++m) register_mutator(m);
    for (std::size_t b = 0; b != boards; ++b) {
      boards_[b] = std::make_unique<board>(*this);
      made(*boards_[b]);
      if ((how >> (2 + 2 * b)) % 4 != 0) set_root(b, how >> (2 + 2 * b));
    }
  }
  void finish() {
    say("the end");
    settle();
    for (std::size_t b = 0; b != boards; ++b) {
      roots_[b].reset();
      of(*boards_[b]).has_root = false;
      for (std::size_t i = 0; i != members_of(*boards_[b]).size(); ++i) {
        if (members_of(*boards_[b])[i].is_registry)
          clear_registry(*boards_[b], i);
        else
          unlink(*boards_[b], i, 255);
      }
    }
    for (unsigned k = 0; k != 4; ++k)
      for (unsigned i = 0; i != pins_each; ++i)
        with_pin(static_cast<kind>(k), i, [&](auto& pin) {
          if (pin) --of(*pin).pins;
          pin.reset();
        });
    ending_ = true;
    settle();
    for (const unsigned id : existing_copy())
      if (of(id).object != nullptr && of(id).type != kind::board) give_up_on(*of(id).object);
    settle();
    for (const unsigned id : existing())
      if (of(id).type != kind::board) fail(*of(id).object, "is left at the end");
  }

  // ---- destructors

  void ends(vertex& v) noexcept override {
    const unsigned failing = std::exchange(failing_allocation, 0U);
    judge_end(v);
    say("  %s is destroyed", words(v));
    speak(v, of(v).last_words);
    forget(v);
    allow_suspicion();
    failing_allocation = failing;
  }
  // What a destructor does.
  void speak(vertex& v, unsigned what) {
    if (what == 0 || ending_) return;
    board& b = *boards_[what / 8 % boards];
    // The queue, or any other member.
    const std::size_t to = what % 64 < 32 ? 6 : what / 8 % members_of(b).size();
    switch (what % 8) {
      case 0:
      case 1:
        say("    and retires what it refers to");
        for_own_references(v, [&](vertex& target) { retire(target); });
        break;
      case 2:
        say("    and lists what it refers to at %s", words(b));
        for_own_references(v, [&](vertex& target) {
          if (members_of(b)[to].target == target.type) link(b, to, target, what);
        });
        break;
      case 3: {
        vertex& heir = make_object<keyframe>();
        say("    and makes %s", words(heir));
        link(b, 6, heir, what);
        for_own_references(v, [&](vertex& target) {
          if (target.type == kind::keyframe) link(heir, what / 8 % 5, target, what);
        });
        break;
      }
      case 4:
        say("    and collects");
        if (domain_->collect().result != slamgc::collected::outcome::busy)
          fail(v, "could collect in its destructor");
        break;
      case 5:
        say("    and %s.%s forgets", words(b), members_of(b)[to].name);
        if (members_of(b)[to].is_registry)
          clear_registry(b, to);
        else
          unlink(b, to, what);
        break;
      case 6: {
        vertex& child = make_object<point>();
        say("    and makes %s, retired", words(child));
        retire(child);
        break;
      }
      default:
        say("    and retires what %s refers to", words(b));
        (void)read_real(b, to);
        for (const reference& r : std::vector<reference>(content_))
          if (r.target != nullptr) retire(*r.target);
    }
  }
  bool read_real(vertex& v, std::size_t i) {
    bool in_step = false;
    with_member(v, i,
                [&](auto& member, const auto& how) { in_step = read(member, how, content_); });
    return in_step;
  }
  // From the real members: those of a set that dies together are empty.
  template <class F>
  void for_own_references(vertex& v, F f) {
    for (std::size_t i = 0; i != members_of(v).size(); ++i) {
      (void)read_real(v, i);
      for (const reference& r : std::vector<reference>(content_))
        if (r.target != nullptr) f(*r.target);
    }
  }

  // ---- words

#if defined(__GNUC__)
  __attribute__((format(printf, 2, 3)))
#endif
  void
  say(const char* format, ...) {
    if (!in_words_) return;
    va_list arguments;
    va_start(arguments, format);
    std::fprintf(stderr, "%5zu  ", done_);
    std::vfprintf(stderr, format, arguments);
    std::fputc('\n', stderr);
    va_end(arguments);
  }
  // Valid for the next three calls.
  const char* words(const vertex& v) {
    if (!in_words_) return "";
    std::array<char, 32>& text = texts_[next_text_++ % texts_.size()];
    std::snprintf(text.data(), text.size(), "%s %u", name_of(v.type), v.id);
    return text.data();
  }
  [[noreturn]] void fail(const vertex& v, const char* what) override {
    std::fprintf(stderr, "%sgraph program: %s %u %s%s%s%s, after %zu operations\n",
                 in_words_ ? ">> " : "", name_of(v.type), v.id, what,
                 *failing_member_ != '\0' ? " (" : "", failing_member_,
                 *failing_member_ != '\0' ? ")" : "", done_);
    explain();
  }
  // The program once more, in words.
  [[noreturn]] void explain() {
    if (!in_words_) {
      std::fprintf(stderr, "its bytes:");
      for (const std::uint8_t* p = begin_; p != end_; ++p) std::fprintf(stderr, " %02x", *p);
      std::fprintf(stderr, "\nits words:\n");
      failing_allocation = 0;
      program again(begin_, static_cast<std::size_t>(end_ - begin_), true);
      (void)again.run();
      std::fprintf(stderr, "the second time the program went well\n");
    }
    std::abort();
  }

  static constexpr unsigned pins_each = 3;
  template <class T>
  using pins_of = std::array<slamgc::pin<T>, pins_each>;

  // Destroyed from the last to the first: boards refer to objects, which refer to the domain.
  std::unique_ptr<slamgc::domain> domain_;
  const std::uint8_t* const begin_;
  const std::uint8_t* at_;
  const std::uint8_t* const end_;
  const bool in_words_;
  program* const outer_;
  std::vector<std::unique_ptr<slamgc::mutator>> mutators_;
  std::array<std::optional<slamgc::mutator::online_scope>, 3> online_;
  std::array<std::unique_ptr<board>, boards> boards_;
  std::array<std::optional<slamgc::root>, boards> roots_;
  std::array<std::size_t, boards> owner_of_root_{};
  std::array<handle, 16> handles_;
  std::tuple<pins_of<keyframe>, pins_of<point>, pins_of<map>, pins_of<frame>> pins_;
  std::array<anchor, 4> anchors_;
  std::optional<std::size_t> owner_borrowed_by_;  // of the last operand
  std::size_t last_handle_ = 0;
  std::size_t done_ = 0;
  bool ending_ = false;
  std::vector<reference> content_;
  std::array<std::array<char, 32>, 4> texts_{};
  std::size_t next_text_ = 0;
};

template <class Misuse>
void misused(const Misuse& m) noexcept {
  if (program* const p = program::running()) {
    std::fprintf(stderr, "slamgc: %s (%s)\n", m.what, m.type);
    p->fail("misuses the library");
  }
  std::fprintf(stderr, "slamgc: %s (%s)\n", m.what, m.type);
  std::abort();
}

}  // namespace fuzz
