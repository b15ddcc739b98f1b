/// @file
/// Do the descriptions say what the counts say?
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "../detail/holders.hpp"
#include "../domain.hpp"
#include "../fwd.hpp"
#include "heap_graph.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Compares the count of each object with the references to it that edges describe.
///
/// - A count that is *larger*: somebody counts on the object whom no description names. A pin or an intrusive_rc, which is right;
///   a member that an edges() leaves out, or a part of the program that is no root, which lets objects live on for ever.
/// - A count that is *smaller*: one reference is described twice; or a pointer stands in a counted container that was written past
///   its interface. The object is never destroyed too early by trial deletion, but in the second case by its count.
/// - Objects that exist and to which no described edge leads.
///
/// Raw pointers that are neither counted nor described are nobody's business.
///
/// Exact while no thread changes anything, with walk_options::threads_stand_still if mutators own roots; in a running system
/// differences come and go. Thread-safety and costs: those of capture().
class audit {
 public:
  /// Of a domain.
  template <class Env>
  explicit audit(basic_domain<Env>& of, const walk_options& options = {})
      : audit(capture(of, options)) {}
  /// Of a graph.
  explicit audit(heap_graph graph) : graph_(std::move(graph)) {
    for (const auto& n : graph_.nodes) {
      if (n.root) continue;
      if (n.state.is_saturated() || n.state.count() == n.described_references()) continue;
      (n.not_described() != 0 ? more_counted_ : more_described_).push_back(&n);
    }
  }
  audit(audit&&) = default;             ///< Moves it.
  audit& operator=(audit&&) = default;  ///< Moves it.

  /// Whether the walk was complete, and all counts are those that edges describe.
  [[nodiscard]] bool agrees() const noexcept {
    return graph_.result == heap_graph::outcome::done && more_counted_.empty() &&
           more_described_.empty() && unfinished() == 0;
  }
  /// Objects with references that no edge describes.
  [[nodiscard]] const std::vector<const heap_graph::node*>& more_counted() const noexcept {
    return more_counted_;
  }
  /// Objects with described references that nobody has counted.
  [[nodiscard]] const std::vector<const heap_graph::node*>& more_described() const noexcept {
    return more_described_;
  }
  /// Objects that exist and to which no described edge leads.
  [[nodiscard]] std::uint64_t not_found() const noexcept {
    std::uint64_t n = 0;
    for (const auto& t : graph_.types)
      if (t.live > t.found) n += t.live - t.found;
    return n;
  }
  /// Objects and roots whose edges() threw.
  [[nodiscard]] std::size_t unfinished() const noexcept {
    std::size_t n = 0;
    for (const auto& node : graph_.nodes)
      if (node.unfinished) ++n;
    return n;
  }
  /// What it was made from.
  [[nodiscard]] const heap_graph& graph() const noexcept { return graph_; }

  /// Lines of text.
  [[nodiscard]] std::string words() const {
    std::uint64_t objects = 0;
    for (const auto& n : graph_.nodes) objects += n.root ? 0 : 1;
    const std::size_t differ = more_counted_.size() + more_described_.size();
    std::string out =
        detail::text_of(objects, "object") + ", " +
        detail::text_of(graph_.edges.size(), "described reference") + "; " +
        (differ == 0 ? "all counts agree"
                     : detail::text_of(differ, "count") + (differ == 1 ? " differs" : " differ")) +
        '\n';
    for (const auto* n : more_counted_) {
      write(out, *n);
      out += "  " + detail::text_of(n->not_described(), "reference") +
             (n->not_described() == 1 ? " is" : " are") +
             " not described: " + detail::not_described_hint + '\n';
    }
    for (const auto* n : more_described_) {
      write(out, *n);
      out += "  " +
             detail::text_of(n->described_references() - n->state.count(), "described reference") +
             " too many: a member that edges() names twice, or a container written past its "
             "interface\n";
    }
    for (const auto& n : graph_.nodes)
      if (n.unfinished) out += n.name() + ": its edges() threw\n";
    for (const auto& t : graph_.types)
      if (t.live > t.found)
        out += detail::text_of(t.live - t.found, "object") + " of type " +
               detail::short_name(t.type.c_str()) + " to which no described reference leads\n";
    detail::write_circumstances(out, graph_);
    return out;
  }
  /// An object of JSON.
  [[nodiscard]] std::string json() const {
    detail::json_text json;
    json.begin('{').field("agrees", agrees());
    detail::write_circumstances(json, graph_);
    json.field("references", std::uint64_t{graph_.edges.size()});
    write(json.key("more_counted"), more_counted_);
    write(json.key("more_described"), more_described_);
    json.key("unfinished").begin('[');
    for (const auto& n : graph_.nodes)
      if (n.unfinished) detail::holder_list::write(json, n);
    json.end(']').key("types").begin('[');
    for (const auto& t : graph_.types)
      json.begin('{').field("type", t.type).field("live", t.live).field("found", t.found).end('}');
    json.end(']').end('}');
    return json.text();
  }

 private:
  using nodes = std::vector<const heap_graph::node*>;

  void write(std::string& out, const heap_graph::node& n) const {
    out += n.name() + ": " + detail::text_of(n.state.count(), "reference") + " counted, " +
           std::to_string(n.described_references()) + " described\n";
    detail::holder_list holders;
    holders.add(graph_, n);
    holders.write(out, "  ");
  }
  void write(detail::json_text& json, const nodes& all) const {
    json.begin('[');
    for (const auto* n : all) {
      json.begin('{').key("object");
      detail::holder_list::write(json, *n);
      json.field("count", std::uint64_t{n->state.count()});
      json.field("described", n->described_references()).key("held_by");
      detail::holder_list holders;
      holders.add(graph_, *n);
      holders.write(json);
      json.end('}');
    }
    json.end(']');
  }

  heap_graph graph_;
  nodes more_counted_;  // of graph_, whose nodes stay where they are when it is moved
  nodes more_described_;
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
