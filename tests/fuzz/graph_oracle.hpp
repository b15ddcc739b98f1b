// The oracle: a plain graph that follows what the program does to the real one, and judges what collectors do to it.
//
// What collectors may do on their own: null, erase or bypass a stale edge as its disposition says; retire what a registry
// dropped, and what collect_cycles() was asked for; sever and destroy what is out of reach. sync() compares the
// real members with the plain ones, and takes over a difference if it is one of these.
#pragma once

#include <cstdint>
#include <deque>
#include <slamgc/slamgc.hpp>
#include <string>
#include <vector>

#include "graph_objects.hpp"

namespace fuzz {

class oracle : public observer {
 public:
  struct record {
    vertex* object = nullptr;  // null: destroyed
    kind type{};
    vertex* next_before = nullptr;  // the member `next`, before the last sync()
    bool retired = false;
    bool may_be_retired = false;  // by a collector
    bool was_counted = false;     // else it is nobody's, and stays
    unsigned edges = 0;           // that refer to it
    unsigned pins = 0;
    unsigned borrows = 0;
    unsigned dropped = 0;  // by registries; a collector may still count so many references
    std::vector<std::vector<reference>> members;
    std::uint8_t last_words = 0;  // what its destructor does
    unsigned recorded_parent = 0;
    // Boards:
    bool has_root = false;
    bool is_owned = false;  // the root, by a mutator
    bool is_purged = true;  // false: its owner has ended
    bool is_suspected = false;
  };

  oracle(slamgc::domain& d) : domain_(d), records_(1) {}
  virtual ~oracle() = default;

  record& of(const vertex& v) { return records_[v.id]; }
  record& of(unsigned id) { return records_[id]; }
  const std::vector<unsigned>& existing() const { return existing_; }
  // Grows with each object that comes or goes, and each difference that sync() takes over.
  std::uint64_t changes() const { return changes_; }

  // ---- what the program does

  void begins(vertex& v) final {
    v.id = static_cast<unsigned>(records_.size());
    records_.emplace_back();
    records_.back().object = &v;
    records_.back().type = v.type;
    existing_.push_back(v.id);
    ++changes_;
  }
  // It has its members now.
  void made(vertex& v) { of(v).members.resize(members_of(v).size()); }

  // Members are as they were, or severing has not begun.
  void buries(vertex& v) final {
    const std::vector<reference>& parent = of(v).members[keyframe_parent];
    of(v).recorded_parent = parent.empty() ? 0 : parent[0].target->id;
  }

  template <class Change>
  void change(vertex& v, std::size_t index, Change f) {
    std::vector<reference>& content = of(v).members[index];
    count(content, -1);
    f(plain_member{members_of(v)[index].shape, content});
    count(content, 1);
  }
  template <class Change>
  void change(vertex& v, vertex& w, std::size_t index, Change f) {
    if (&v == &w) return change(v, index, [&](const plain_member& m) { f(m, m); });
    change(v, index, [&](const plain_member& a) {
      change(w, index, [&](const plain_member& b) { f(a, b); });
    });
  }
  // A registry is cleared: a collector will retire and uncount.
  void drop(vertex& v, std::size_t index) {
    for (const reference& r : of(v).members[index]) {
      record& target = of(*r.target);
      ++target.dropped;
      target.may_be_retired = true;
    }
    change(v, index, [](const plain_member& m) { m.content.clear(); });
  }
  // Around a call of retire(), which returned `first`.
  void retires(vertex& v) { learn_retired(of(v)); }
  void retired(vertex& v, bool first) {
    if (first == of(v).retired)
      fail(v, first ? "was retired twice" : "was refused by retire(), although it was not retired");
    of(v).retired = true;
  }

  // ---- what must be true at any time

  // Counts are edges, pins, and what registries have dropped.
  void check_counts() {
    if (!counts_agree()) {
      sync();
      if (!counts_agree()) fail(*disagrees_, "has a count that is not its number of edges");
    }
  }
  // Takes over what collectors did, if they were allowed to.
  void sync() {
    begin_sync();
    stale_edges_ = stale_edges();
    severed_.clear();
    for (const unsigned id : existing_) compare(*of(id).object);
    if (severed_.empty()) return;
    const std::vector<bool> reached = in_reach();
    for (const auto& [v, index] : severed_)
      if (reached[v->id]) fail(*v, "lost the content of a member, although it is in reach");
    for (const auto& [v, index] : severed_)
      change(*v, index, [](const plain_member& m) { m.content.clear(); });
  }
  void sync_if_purged() {
    if (stale_edges() != stale_edges_) sync();
  }
  // Only the members of one vertex: its root's owner may have purged it.
  void sync(vertex& v) {
    begin_sync();
    compare(v);
  }

  // A destructor begins.
  void judge_end(vertex& v) {
    record& r = of(v);
    if (v.canary != vertex::intact || r.object != &v) fail(v, "is destroyed a second time");
    learn_retired(r);
    sync_if_purged();
    if (r.edges != 0) sync();
    if (r.edges != 0) fail(v, "is destroyed, although something refers to it");
    if (count_of(v) != 0) fail(v, "is destroyed with a count");
    if (r.pins != 0) fail(v, "is destroyed, although it is pinned");
    if (r.borrows != 0) fail(v, "is destroyed, although it is borrowed");
    if (!r.retired && !goes_at_zero(r)) fail(v, "is destroyed, although it was never retired");
  }
  // A destructor of v ends.
  void forget(vertex& v) {
    record& r = of(v);
    const auto& info = members_of(v);
    for (std::size_t i = 0; i != info.size(); ++i) {
      if (info[i].is_registry)
        drop(v, i);
      else
        change(v, i, [](const plain_member& m) { m.content.clear(); });
    }
    r.members.clear();
    r.object = nullptr;
    existing_.erase(std::find(existing_.begin(), existing_.end(), v.id));
    ++changes_;
  }

  // ---- collect_cycles()

  // What would be found among what these boards list, or all that are suspected.
  std::vector<unsigned> out_of_reach_but_for_suspected_boards() {
    std::vector<bool> suspects(records_.size());
    for (const unsigned id : existing_) {
      const record& r = of(id);
      if (!r.is_suspected || !r.has_root || r.is_owned) continue;
      for (const auto& content : r.members)
        for (const reference& e : content)
          if (e.target != nullptr && is_described(e.target->type) && !of(*e.target).retired)
            suspects[e.target->id] = true;
    }
    const auto is_candidate = [&](unsigned id) {
      return suspects[id] || (of(id).retired && is_described(of(id).type));
    };
    std::vector<unsigned> inner(records_.size());
    for (const unsigned id : existing_) {
      const record& r = of(id);
      if (!is_candidate(id) && !(r.is_suspected && r.has_root && !r.is_owned)) continue;
      for (const auto& content : r.members)
        for (const reference& e : content)
          if (e.target != nullptr) ++inner[e.target->id];
    }
    std::vector<bool> held(records_.size());
    std::vector<unsigned> pending;
    for (const unsigned id : existing_)
      if (is_candidate(id) && inner[id] != of(id).edges + of(id).pins) pending.push_back(id);
    follow(pending, held);
    std::vector<unsigned> found;
    for (const unsigned id : existing_)
      if (suspects[id] && !held[id]) found.push_back(id);
    return found;
  }
  // What suspected boards list now may be found from now on, or until now: purges in the same call may have made it so.
  void allow_suspicion() {
    if (!suspects_ || only_what_is_out_of_reach_) return;
    for (const unsigned id : existing_) {
      const record& r = of(id);
      if (!r.is_suspected || !r.has_root || r.is_owned) continue;
      for (const auto& content : r.members)
        for (const reference& e : content)
          if (e.target != nullptr && is_described(e.target->type))
            of(*e.target).may_be_retired = true;
    }
  }
  void suspect(vertex& v) {
    suspects_ = true;
    of(v).is_suspected = true;
    allow_suspicion();
  }
  // While nothing else is to be done: exactly these are found.
  std::vector<unsigned> suspect_exactly(vertex& v) {
    suspects_ = only_what_is_out_of_reach_ = true;
    of(v).is_suspected = true;
    for (const unsigned id : existing_) of(id).may_be_retired = false;
    std::vector<unsigned> found = out_of_reach_but_for_suspected_boards();
    for (const unsigned id : found) of(id).may_be_retired = true;
    return found;
  }
  void end_suspicions() {
    if (!suspects_) return;
    for (const unsigned id : existing_) of(id).is_suspected = false;
    suspects_ = only_what_is_out_of_reach_ = false;
  }

  // ---- what must be true when nothing is left to do: all that has to go is gone

  void check_settled() {
    sync();
    check_counts();
    const std::vector<bool> reached = in_reach(true);
    for (const unsigned id : existing_) {
      const record& r = of(id);
      if (r.dropped != 0) fail(*r.object, "was dropped by a registry and is still counted");
      if (r.type == kind::board) continue;
      if (r.retired && !reached[id]) fail(*r.object, "was retired, is out of reach, and exists");
      if (!r.retired && goes_at_zero(r) && r.edges == 0 && r.pins == 0 && r.borrows == 0)
        fail(*r.object, "is unreferenced and exists");
    }
    check_purged();
    check_stats();
  }

 protected:
  static constexpr std::size_t frame_previous = 2;   // the member of that name
  static constexpr std::size_t keyframe_parent = 1;  // the member of that name, which nobody purges

  [[noreturn]] virtual void fail(const vertex& v, const char* what) = 0;

  // Without having been retired.
  static bool goes_at_zero(const record& r) {
    return (r.type == kind::point || r.type == kind::frame) && r.was_counted;
  }
  static bool is_described(kind k) { return k != kind::frame && k != kind::board; }
  static std::uint32_t count_of(vertex& v) {
    std::uint32_t n = 0;
    with_object(v, [&](auto& object) { n = object.use_count(); });
    return n;
  }

 private:
  void count(const std::vector<reference>& content, int change) {
    for (const reference& r : content)
      if (r.target != nullptr) {
        record& target = of(*r.target);
        target.edges += static_cast<unsigned>(change);
        target.was_counted = true;
      }
  }
  std::uint64_t stale_edges() const {
    return slamgc::detail::domain_access::state_of(domain_).collection.purging().stale_edges();
  }
  void begin_sync() {
    for (const unsigned id : existing_) {
      record& r = of(id);
      learn_retired(r);
      const bool has_next = !r.members.empty() && !r.members[0].empty();
      r.next_before = has_next ? r.members[0][0].target : nullptr;
    }
  }
  void learn_retired(record& r) {
    if (r.retired) return;
    with_object(*r.object, [&](auto& object) {
      if (!object.state().is_retired()) return;
      // A purge in the same call may have put it in the place of what a suspected board listed.
      const bool may_be_suspect = suspects_ && !only_what_is_out_of_reach_ && is_described(r.type);
      if (!r.may_be_retired && !may_be_suspect && !was_severed_from_registry(r))
        fail(*r.object, "was retired by nobody");
      r.retired = true;
      ++changes_;
    });
  }
  // What a map lists is retired when the map is severed.
  bool was_severed_from_registry(const record& r) {
    for (const unsigned id : existing_) {
      record& owner = of(id);
      bool retired = owner.retired;
      if (owner.type != kind::board)  // perhaps nobody has learned it yet
        with_object(*owner.object, [&](auto& object) { retired = object.state().is_retired(); });
      if (!retired) continue;
      for (std::size_t i = 0; i != owner.members.size(); ++i)
        for (const reference& e : owner.members[i])
          if (e.target == r.object && members_of(*owner.object)[i].is_registry) return true;
    }
    return false;
  }
  bool counts_agree() {
    for (const unsigned id : existing_) {
      record& r = of(id);
      if (r.type == kind::board) continue;
      const std::uint32_t found = count_of(*r.object);
      const unsigned known = r.edges + r.pins;
      disagrees_ = r.object;
      if (found < known || found > known + r.dropped) return false;
      r.dropped = found - known;
    }
    return true;
  }

  // Marks what can be reached from these.
  void follow(std::vector<unsigned>& pending, std::vector<bool>& reached) {
    for (const unsigned id : pending) reached[id] = true;
    while (!pending.empty()) {
      const record& r = of(pending.back());
      pending.pop_back();
      for (const auto& content : r.members)
        for (const reference& e : content)
          if (e.target != nullptr && !reached[e.target->id]) {
            reached[e.target->id] = true;
            pending.push_back(e.target->id);
          }
    }
  }
  // From boards, pins, what is borrowed, and what lives unretired; and from rings that nobody describes.
  std::vector<bool> in_reach(bool with_rings = false) {
    std::vector<bool> reached(records_.size());
    std::vector<unsigned> sources;
    for (const unsigned id : existing_) {
      const record& r = of(id);
      const bool lives = !r.retired && (!goes_at_zero(r) || r.edges != 0);
      if (lives || (with_rings && is_in_ring(id)) || r.pins != 0 || r.borrows != 0)
        sources.push_back(id);
    }
    follow(sources, reached);
    return reached;
  }

  // Of frames.
  bool is_in_ring(unsigned id) {
    unsigned at = id;
    for (std::size_t steps = 0; steps != existing_.size() && of(at).type == kind::frame; ++steps) {
      const auto& previous = of(at).members[frame_previous];
      if (previous.empty()) return false;
      at = previous[0].target->id;
      if (at == id) return true;
    }
    return false;
  }

  void compare(vertex& v) {
    const auto& info = members_of(v);
    std::size_t i = 0;
    const std::lock_guard<std::mutex> lock(v.mutex);
    with_type(v, [&](auto& object) {
      object.members([&](const char*, auto& member, const auto& how) {
        const std::vector<reference>& known = of(v).members[i];
        // Severing leaves companions as they are.
        const bool in_step = read(member, how, found_) || (found_.empty() && of(v).retired);
        if (!in_step) fail(v, "has a companion that is out of step");
        for (const reference& r : found_) check_intact(v, r);
        if (found_ != known) {
          if (may_become(info[i], known, found_)) {
            change(v, i, [&](const plain_member& m) { m.content = found_; });
            ++changes_;
          } else if (found_.empty() && of(v).retired) {
            severed_.emplace_back(&v, i);
          } else {
            failing_member_ = info[i].name;
            fail(v, "has a member with other content than it should have");
          }
        }
        ++i;
      });
    });
  }
  void check_intact(const vertex& v, const reference& r) {
    if (r.target == nullptr) return;
    if (r.target->canary != vertex::intact || r.target->id >= records_.size() ||
        of(*r.target).object != r.target)
      fail(v, "refers to an object that was destroyed");
  }
  // Whether a purge may have made `after` of `before`.
  bool may_become(const member_info& info, const std::vector<reference>& before,
                  const std::vector<reference>& after) {
    if (info.how == disposition::hold || after.size() > before.size()) return false;
    if (info.how == disposition::erase) {
      auto at = after.begin();
      for (const reference& r : before) {
        if (at != after.end() && *at == r)
          ++at;
        else if (r.target == nullptr || !of(*r.target).retired)
          return false;
      }
      return at == after.end();
    }
    if (info.shape == form::slot && after.empty() && !before.empty())
      return may_replace(info.how, before[0].target, nullptr);
    if (after.size() != before.size()) return false;
    for (std::size_t i = 0; i != after.size(); ++i) {
      if (after[i].tag != before[i].tag) return false;
      if (after[i].target != before[i].target &&
          !may_replace(info.how, before[i].target, after[i].target))
        return false;
    }
    return true;
  }
  bool may_replace(disposition how, const vertex* stale, const vertex* by) {
    if (stale == nullptr || !of(*stale).retired) return false;
    if (how == disposition::null) return by == nullptr;
    // The chain may have been bypassed itself in the same purge, before or after.
    std::vector<const vertex*> chain{stale};
    for (std::size_t i = 0; i != chain.size(); ++i) {
      const record& r = of(*chain[i]);
      const vertex* const now = r.members[0].empty() ? nullptr : r.members[0][0].target;
      for (const vertex* next : {now, static_cast<const vertex*>(r.next_before)}) {
        if (next == by) return true;
        if (next == nullptr || !of(*next).retired) continue;
        if (std::find(chain.begin(), chain.end(), next) == chain.end())
          chain.push_back(next);
        else if (by == nullptr)
          return true;  // a circle
      }
    }
    return false;
  }

  // No stale edge is left where a purge comes by.
  void check_purged() {
    std::vector<bool> met(records_.size());
    std::vector<unsigned> pending;
    for (const unsigned id : existing_)
      if (of(id).type == kind::board && of(id).has_root && of(id).is_purged) {
        met[id] = true;
        pending.push_back(id);
      }
    while (!pending.empty()) {
      record& r = of(pending.back());
      pending.pop_back();
      const auto& info = members_of(*r.object);
      for (std::size_t i = 0; i != info.size(); ++i)
        for (const reference& e : r.members[i]) {
          if (e.target == nullptr || !is_described(e.target->type)) continue;
          if (of(*e.target).retired) {
            if (info[i].how == disposition::hold) continue;
            failing_member_ = info[i].name;
            fail(*r.object, "has a stale edge after all purges");
          }
          if (r.is_owned || met[e.target->id]) continue;
          met[e.target->id] = true;
          pending.push_back(e.target->id);
        }
    }
  }
  void check_stats() {
    std::uint64_t objects = 0;
    std::uint64_t stuck = 0;
    for (const unsigned id : existing_) {
      const record& r = of(id);
      objects += r.type != kind::board;
      stuck += r.retired && is_described(r.type);
    }
    const slamgc::domain_stats stats = domain_.stats();
    const vertex& any = *of(existing_.front()).object;
    if (stats.total(&slamgc::type_stats::live) != objects) fail(any, "stats().live is wrong");
    if (stats.total(&slamgc::type_stats::backlog) != 0) fail(any, "stats().backlog is wrong");
    if (stats.total(&slamgc::type_stats::stuck) != stuck) fail(any, "stats().stuck is wrong");
  }

 protected:
  const char* failing_member_ = "";

 private:
  slamgc::domain& domain_;
  std::deque<record> records_;
  std::vector<unsigned> existing_;
  std::vector<std::pair<vertex*, std::size_t>> severed_;
  std::vector<reference> found_;
  vertex* disagrees_ = nullptr;
  std::uint64_t stale_edges_ = 0;
  std::uint64_t changes_ = 0;
  bool suspects_ = false;
  bool only_what_is_out_of_reach_ = false;
};

}  // namespace fuzz
