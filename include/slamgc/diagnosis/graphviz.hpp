/// @file
/// Pictures of a map, for Graphviz.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "../detail/report_text.hpp"
#include "../fwd.hpp"
#include "heap_graph.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// What a picture shows.
struct picture_options {
  const void* centre = nullptr;  ///< Of the neighbourhood that is shown; null: everything.
  unsigned hops = 2;             ///< How many edges away from it, in both directions.
};

namespace detail {

class dot_text {
 public:
  dot_text(std::ostream& out, const heap_graph& graph, const picture_options& options)
      : out_(out), graph_(graph), shown_(graph.nodes.size(), options.centre == nullptr) {
    if (options.centre != nullptr) choose(options);
    for (std::size_t i = 0; i != shown_.size(); ++i)
      if (shown_[i]) order_.push_back(i);
    // Addresses say nothing from one run to the next.
    const auto key = [&](std::size_t i) { return std::make_tuple(rank(graph_.nodes[i]), i); };
    std::sort(order_.begin(), order_.end(),
              [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    number_.resize(shown_.size());
    for (std::size_t i = 0; i != order_.size(); ++i) number_[order_[i]] = i;
  }

  void write() {
    out_ << "digraph slamgc {\n  rankdir=LR;\n  node [fontname=\"sans-serif\" style=filled];\n"
            "  edge [fontname=\"sans-serif\" fontsize=10];\n";
    for (const std::size_t i : order_) write_node(i);
    for (const std::size_t i : order_) write_edges(i);
    out_ << "}\n";
  }

 private:
  using node = heap_graph::node;

  static std::tuple<bool, const std::string&, std::uint64_t> rank(const node& n) {
    return {!n.root, n.type, n.id};
  }

  void choose(const picture_options& options) {
    std::vector<std::size_t> met;
    const auto meet = [&](std::size_t i) {
      if (shown_[i]) return;
      shown_[i] = true;
      met.push_back(i);
    };
    for (std::size_t i = 0; i != graph_.nodes.size(); ++i)
      if (graph_.nodes[i].address == options.centre) meet(i);
    std::size_t at = 0;
    for (unsigned hop = 0; hop != options.hops; ++hop) {
      for (const std::size_t end = met.size(); at != end; ++at) {
        const node& n = graph_.nodes[met[at]];
        for (std::size_t e = n.first_out; e != n.last_out; ++e) meet(graph_.edges[e].to);
        for (std::size_t e = n.first_in; e != n.last_in; ++e)
          meet(graph_.edges[graph_.incoming[e]].from);
      }
    }
  }

  void write_node(std::size_t i) {
    // Colours: Okabe and Ito 2008, lightened: told apart by everybody.
    static constexpr const char* colours[] = {"#a6d3f2", "#f6d58a", "#8fd9c0", "#f2b89a",
                                              "#f0e98c", "#dcb6cf", "#9fb8d8"};
    static constexpr const char* shapes[] = {"box",     "ellipse",       "hexagon",  "octagon",
                                             "diamond", "parallelogram", "trapezium"};
    const node& n = graph_.nodes[i];
    out_ << "  n" << number_[i] << " [label=\"" << escaped(n.name());
    if (n.root) {
      out_ << "\" shape=cds fillcolor=\"#dddddd\"];\n";
      return;
    }
    const std::size_t type = type_of(n) % (sizeof shapes / sizeof *shapes);
    if (n.state.is_retired()) out_ << "\\nretired";
    out_ << "\" shape=" << shapes[type] << " fillcolor=\"" << colours[type] << '"';
    if (n.state.is_retired()) out_ << " style=\"filled,dashed\" color=\"#cc0000\" penwidth=2";
    out_ << "];\n";
    if (n.not_described() != 0 && !n.state.is_saturated())
      out_ << "  u" << number_[i] << " [label=\"" << n.not_described()
           << " not described\" shape=plaintext style=\"\"];\n  u" << number_[i] << " -> n"
           << number_[i] << " [style=dotted];\n";
  }
  void write_edges(std::size_t i) {
    struct line {
      std::size_t to;
      std::size_t label;
      bool stale;
    };
    std::vector<line> lines;
    const node& n = graph_.nodes[i];
    for (std::size_t e = n.first_out; e != n.last_out; ++e) {
      const auto& edge = graph_.edges[e];
      if (shown_[edge.to]) lines.push_back({number_[edge.to], edge.label, graph_.is_stale(edge)});
    }
    // Labels are numbered in the order of the walk, which follows addresses.
    const auto key = [&](const line& l) {
      const auto& label = graph_.labels[l.label];
      return std::tie(l.to, label.name, label.disposition);
    };
    std::sort(lines.begin(), lines.end(),
              [&](const line& a, const line& b) { return key(a) < key(b); });
    for (std::size_t at = 0; at != lines.size();) {
      const line& l = lines[at];
      std::size_t same = 0;
      while (at != lines.size() && key(lines[at]) == key(l)) ++at, ++same;
      const auto& label = graph_.labels[l.label];
      out_ << "  n" << number_[i] << " -> n" << l.to << " [label=\"" << escaped(label.name) << "\\n"
           << escaped(label.disposition);
      if (same != 1) out_ << ", " << same << " times";
      out_ << '"';
      if (l.stale) out_ << " color=\"#cc0000\" fontcolor=\"#cc0000\" penwidth=2";
      out_ << "];\n";
    }
  }
  std::size_t type_of(const node& n) {
    const auto found = std::find(types_.begin(), types_.end(), n.type);
    if (found != types_.end()) return static_cast<std::size_t>(found - types_.begin());
    types_.push_back(n.type);
    return types_.size() - 1;
  }

  std::ostream& out_;
  const heap_graph& graph_;
  std::vector<bool> shown_;
  std::vector<std::size_t> order_;
  std::vector<std::size_t> number_;  // in order_
  std::vector<std::string> types_;
};

}  // namespace detail

/// Writes a graph, or the neighbourhood of one object, in the language of Graphviz: `dot -Tsvg`.
///
/// Each type has a shape and a colour. An edge has its name and its disposition. Retired objects have dashed red outlines,
/// stale edges are red; references that are not described come out of nowhere, dotted. Two graphs with the same objects give the same
/// text where types have `report_id() const`. O(nodes log nodes + edges log edges).
inline void write_dot(std::ostream& out, const heap_graph& graph,
                      const picture_options& options = {}) {
  detail::dot_text(out, graph, options).write();
}

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
