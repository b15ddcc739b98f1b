/// @file
/// Takes a heap_graph.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "../diagnosis/heap_graph.hpp"
#include "../fwd.hpp"
#include "clock.hpp"
#include "domain_state.hpp"
#include "heap_walk.hpp"
#include "participant.hpp"
#include "root_list.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

template <class Env>
class heap_capture final : runtime::edge_sink<Env> {
  using target = runtime::edge_target<Env>;
  using domain_state = runtime::domain_state<Env>;
  using participants = runtime::participants<Env>;
  using root_place = runtime::root_place<Env>;
  using clock = runtime::clock_of<Env>;

 public:
  /// @p also, if not null, is an object that shall be in it, whatever leads to it.
  static heap_graph take(domain_state& of, const walk_options& options, const target* also) {
    heap_graph graph;
    const auto begin = clock::now();
    const bool collecting = participants::any_in(of, [](const auto& p) { return !p.record; });
    for (;;) {
      const bool taken = !collecting && of.collection.take_turn(of, [&](const auto&) {
        heap_capture capture(graph, of, options.threads_stand_still);
        graph.result = heap_graph::outcome::done;
        if (attempt([&] { capture.run(also); }) && !capture.failed_) return;
        graph = heap_graph();
        graph.result = heap_graph::outcome::out_of_memory;
      });
      if (taken || collecting || clock::now() - begin >= options.patience) return graph;
      clock::pause(std::chrono::microseconds(100));
    }
  }

 private:
  struct known {
    const void* key;
    std::size_t node;
  };
  struct to_visit {
    void* object;
    const runtime::described_operations<Env>* operations;
  };

  heap_capture(heap_graph& graph, domain_state& of, bool stand_still) noexcept
      : graph_(graph), of_(of), stand_still_(stand_still) {}

  /// Whether it could be done: no exception may pass through edges() or a list of roots.
  template <class F>
  static bool attempt(F f) noexcept {
#if defined(__cpp_exceptions)
    try {
      f();
      return true;
    } catch (...) {
      return false;
    }
#else
    f();
    return true;
#endif
  }

  void run(const target* also) {
    auto& collection = of_.collection;
    graph_.delayed = collection.delayed(of_);
    graph_.cleared_registries = collection.dropped().waiting();
    for (auto* t = of_.tables(); t != nullptr; t = t->next) count(t->type_name).live += t->live();

    if (also != nullptr) node_of(*also);
    collection.roots().visit(
        [this](const root_place& root) {
          if (!attempt([&] { visit_root(root); })) failed_ = true;
        },
        true);
    for (auto* t = of_.tables(); t != nullptr; t = t->next) t->report_waiting(*this, stand_still_);
    const auto now = clock::now().time_since_epoch();
    collection.trial().each([&](const auto& c) {
      c.table->report(c.object, *this);
      if (failed_) return;
      auto& node = graph_.nodes[nodes_.find(c.object)->node];
      node.stuck = node.state.is_retired();
      node.stuck_for = now - c.since;
    });
    // Those that are met meanwhile follow.
    for (std::size_t i = 0; i != graph_.nodes.size() && !failed_; ++i)
      if (!graph_.nodes[i].root) visit(i, visits_[i]);
    index();
  }

  void visit_root(const root_place& root) {
    if (root.owned && !stand_still_ && !is_mine(root)) {
      graph_.roots_left_out.push_back(root.name);
      return;
    }
    heap_graph::node node;
    node.address = root.described;
    node.type = root.name;
    node.root = true;
    graph_.nodes.push_back(std::move(node));
    visits_.push_back({root.described, root.operations});
    visit(graph_.nodes.size() - 1, visits_.back());
  }
  void visit(std::size_t index, to_visit what) {
    from_ = static_cast<std::uint32_t>(index);
    const std::size_t first = graph_.edges.size();
    const bool finished = what.operations == nullptr || what.operations->report(what.object, *this);
    auto& node = graph_.nodes[index];
    node.first_out = first;
    node.last_out = graph_.edges.size();
    node.described = what.operations != nullptr;
    node.unfinished = !finished;
  }

  void edge(const char* name, const char* disposition, const target& to) override {
    const auto add = [&] {
      graph_.edges.push_back({from_, node_of(to), label_of(name, disposition)});
    };
    if (failed_ || !attempt(add)) failed_ = true;
  }
  void waiting(const target& object) override {
    if (failed_ || !attempt([&] { node_of(object); })) failed_ = true;
  }

  std::uint32_t node_of(const target& to) {
    bool added = false;
    auto* const entry = nodes_.add({to.object, graph_.nodes.size()}, added);
    if (entry == nullptr) {
      failed_ = true;
      return 0;
    }
    if (added) {
      heap_graph::node node;
      node.address = to.object;
      node.type = to.type;
      node.state.bits = to.word;
      node.has_id = to.id != nullptr && attempt([&] { node.id = to.id(to.object); });
      visits_.push_back({to.object, to.described});
      graph_.nodes.push_back(std::move(node));
      ++count(to.type).found;
    }
    return static_cast<std::uint32_t>(entry->node);
  }
  std::uint32_t label_of(const char* name, const char* disposition) {
    const auto is_it = [&](const heap_graph::label& l) {
      return l.name == name && l.disposition == disposition;
    };
    auto& all = graph_.labels;
    // Mostly the same as the last time.
    if (last_label_ >= all.size() || !is_it(all[last_label_]))
      last_label_ =
          static_cast<std::size_t>(std::find_if(all.begin(), all.end(), is_it) - all.begin());
    if (last_label_ == all.size()) all.push_back({name, disposition});
    return static_cast<std::uint32_t>(last_label_);
  }
  heap_graph::type_count& count(const char* type) {
    auto& all = graph_.types;
    const auto is_it = [&](const heap_graph::type_count& t) { return t.type == type; };
    auto found = std::find_if(all.begin(), all.end(), is_it);
    if (found == all.end()) found = all.insert(found, {type, 0, 0});
    return *found;
  }
  /// The owner's thread may visit it.
  bool is_mine(const root_place& root) const noexcept {
    return participants::any_in(of_, [&](const auto& p) {
      for (const auto* r = p.roots; r != nullptr; r = r->next_of_owner)
        if (r == &root) return true;
      return false;
    });
  }
  /// Sorts the edges by their targets: a counting sort.
  void index() {
    for (const auto& e : graph_.edges) ++graph_.nodes[e.to].last_in;
    std::size_t end = 0;
    for (auto& n : graph_.nodes) {
      n.first_in = end;
      end += n.last_in;
      n.last_in = n.first_in;
    }
    graph_.incoming.resize(graph_.edges.size());
    for (std::size_t i = 0; i != graph_.edges.size(); ++i)
      graph_.incoming[graph_.nodes[graph_.edges[i].to].last_in++] = i;
  }

  heap_graph& graph_;
  domain_state& of_;
  const bool stand_still_;
  bool failed_ = false;
  std::uint32_t from_ = 0;
  std::size_t last_label_ = 0;
  runtime::address_table<known> nodes_;
  std::vector<to_visit> visits_;  // for each node
};

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
