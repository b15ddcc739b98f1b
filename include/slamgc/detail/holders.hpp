/// @file
/// Who refers to an object, in words and JSON.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "../diagnosis/heap_graph.hpp"
#include "../fwd.hpp"
#include "report_text.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

/// The described references to one object, or to several, by the holder's type and edge.
class holder_list {
 public:
  static constexpr std::size_t most_names = 8;

  void add(const heap_graph& graph, const heap_graph::node& object) {
    for (std::size_t i = object.first_in; i != object.last_in; ++i) {
      const std::size_t index = graph.incoming[i];
      const auto& edge = graph.edges[index];
      const auto& from = graph.nodes[edge.from];
      group& g = group_of(from, graph.labels[edge.label]);
      ++g.references;
      if (g.holders.insert(&from).second && g.names.size() < most_names) g.names.push_back(&from);
    }
  }
  /// Lines like `held by KeyFrame 5 .mpParent (hold)`.
  void write(std::string& out, const char* indent) const {
    for (const group& g : groups_) {
      out += indent;
      out += "held by ";
      if (g.holders.size() == 1) {
        out += g.names[0]->name();
      } else {
        out += std::to_string(g.holders.size()) + ' ' + short_name(g.names[0]->type.c_str());
      }
      out += " ." + g.label->name + " (" + g.label->disposition + ')';
      if (g.retired) out += ", retired";
      if (g.references != g.holders.size()) out += ", " + text_of(g.references, "reference");
      if (g.holders.size() != 1) {
        out += ':';
        for (std::size_t i = 0; i != g.names.size(); ++i) {
          out += i == 0 ? " " : ", ";
          out += g.names[i]->has_id ? std::to_string(g.names[i]->id) : text_of(g.names[i]->address);
        }
        if (g.holders.size() > g.names.size())
          out += " and " + std::to_string(g.holders.size() - g.names.size()) + " more";
      }
      out += '\n';
    }
  }
  void write(json_text& json) const {
    json.begin('[');
    for (const group& g : groups_) {
      json.begin('{').field("type", g.names[0]->type).field("root", g.names[0]->root);
      json.field("retired", g.retired).field("edge", g.label->name);
      json.field("disposition", g.label->disposition).field("references", g.references);
      json.field("holders", std::uint64_t{g.holders.size()}).key("first").begin('[');
      for (const auto* n : g.names) write(json, *n);
      json.end(']').end('}');
    }
    json.end(']');
  }
  static void write(json_text& json, const heap_graph::node& n) {
    json.begin('{').field("name", n.name()).field("type", n.type);
    json.field("address", text_of(n.address));
    if (n.has_id) json.field("id", n.id);
    json.end('}');
  }

 private:
  struct group {
    const heap_graph::label* label;
    bool retired;
    std::uint64_t references;
    std::set<const heap_graph::node*> holders;
    std::vector<const heap_graph::node*> names;  // the first few
  };

  group& group_of(const heap_graph::node& from, const heap_graph::label& label) {
    const bool retired = from.state.is_retired();
    const auto is_it = [&](const group& g) {
      const auto& first = *g.names[0];
      return g.label == &label && g.retired == retired && first.root == from.root &&
             first.type == from.type;
    };
    auto found = std::find_if(groups_.begin(), groups_.end(), is_it);
    if (found != groups_.end()) return *found;
    groups_.push_back({&label, retired, 0, {&from}, {&from}});
    return groups_.back();
  }

  std::vector<group> groups_;
};

/// What can be behind references that no edge describes.
inline constexpr const char* not_described_hint =
    "a pin, an intrusive_rc, a member that edges() does not name, a root that nobody told the "
    "domain of";

/// What a walk could not see, and whom reclamation waits for.
inline void write_circumstances(std::string& out, const heap_graph& graph) {
  if (graph.result == heap_graph::outcome::busy)
    out += "nothing is known: a collection was at work all the time\n";
  if (graph.result == heap_graph::outcome::out_of_memory)
    out += "nothing is known: there was not enough memory\n";
  for (const std::string& name : graph.roots_left_out)
    out += "not visited: root " + name + " of another thread, which may be at work\n";
  if (graph.cleared_registries != 0)
    out += "not visited: what " + text_of(graph.cleared_registries, "cleared container") +
           " held, until a collector has dropped it\n";
  if (graph.delayed.oldest != nullptr)
    out += "the open grace period waits for " + std::string(graph.delayed.oldest) + " (" +
           text_of(graph.delayed.age) + ")\n";
}
inline void write_circumstances(json_text& json, const heap_graph& graph) {
  json.field("result", graph.result == heap_graph::outcome::done   ? "done"
                       : graph.result == heap_graph::outcome::busy ? "busy"
                                                                   : "out of memory");
  json.key("roots_left_out").begin('[');
  for (const std::string& name : graph.roots_left_out) json.value(name);
  json.end(']').field("cleared_registries", std::uint64_t{graph.cleared_registries});
  if (graph.delayed.oldest != nullptr) {
    json.key("delayed_by").begin('{').field("mutator", graph.delayed.oldest);
    json.field("ns", static_cast<std::uint64_t>(graph.delayed.age.count())).end('}');
  }
}

}  // namespace detail
}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
