/// @file
/// Why is it still alive?
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "../deferred.hpp"
#include "../detail/holders.hpp"
#include "../domain.hpp"
#include "../fwd.hpp"
#include "heap_graph.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Says what keeps one object, or all retired objects of a type.
///
/// ```
/// std::puts(slamgc::retention_report(domain, pKF).words().c_str());
/// // KeyFrame 812 (0x55d0c8) is retired; 4 references are counted
/// //   held by MapPoint 55 .mpRefKF (hold)
/// //   held by 2 KeyFrame .mConnectedKeyFrameWeights (hold): 810, 811
/// //   held by root Tracking .mlpReferences (hold)
/// //   a collector has seen it stuck 3.2 s ago
/// //   root Map .mspKeyFrames > KeyFrame 810 .mConnectedKeyFrameWeights > KeyFrame 812
/// // the open grace period waits for LoopClosing (3.2 s)
/// ```
///
/// A type that has `report_id() const`, a number that never changes, is called by it; it is called under the locks of edges()
/// and takes none.
///
/// Thread-safety, costs and worth: those of capture(). The object must exist until the constructor is through: it is
/// borrowed, or counted.
class retention_report {
 public:
  /// Of one object of the domain.
  template <class Env, class T>
  retention_report(basic_domain<Env>& of, const T* object, const walk_options& options = {}) {
    using object_type = detail::object_of<T>;
    const object_type* const p = object;
    const auto target = detail::operations_on<object_type, Env>::target(*p);
    graph_ = detail::heap_capture<Env>::take(detail::domain_access::state_of(of), options, &target);
    if (graph_.result == heap_graph::outcome::done) objects_.push_back(graph_.find(p));
  }
  /// Of the retired objects of type T.
  template <class T, class Env>
  [[nodiscard]] static retention_report of_type(basic_domain<Env>& of,
                                                const walk_options& options = {}) {
    retention_report report(capture(of, options));
    for (const auto& n : report.graph_.nodes)
      if (!n.root && n.state.is_retired() && n.type == detail::type_name<T>::get())
        report.objects_.push_back(&n);
    report.type_ = detail::short_name(detail::type_name<T>::get());
    return report;
  }
  retention_report(retention_report&&) = default;             ///< Moves it.
  retention_report& operator=(retention_report&&) = default;  ///< Moves it.

  /// The objects that it is about: one, or all retired ones of the type that the walk has met.
  [[nodiscard]] const std::vector<const heap_graph::node*>& objects() const noexcept {
    return objects_;
  }
  /// What it was made from.
  [[nodiscard]] const heap_graph& graph() const noexcept { return graph_; }

  /// Lines of text. Of a type: who holds its objects, together, and the first few of them, one by one.
  [[nodiscard]] std::string words() const {
    std::string out;
    if (!type_.empty()) {
      out += detail::text_of(objects_.size(), "retired object") + " of type " + type_ + '\n';
      detail::holder_list all;
      for (const auto* n : objects_) all.add(graph_, *n);
      all.write(out, "  ");
    }
    const std::size_t shown = std::min(objects_.size(), detail::holder_list::most_names);
    for (std::size_t i = 0; i != shown; ++i) write(out, *objects_[i]);
    if (shown != objects_.size())
      out += "and " + std::to_string(objects_.size() - shown) + " more\n";
    detail::write_circumstances(out, graph_);
    return out;
  }
  /// An object of JSON. All objects are in it.
  [[nodiscard]] std::string json() const {
    detail::json_text json;
    json.begin('{');
    detail::write_circumstances(json, graph_);
    json.key("objects").begin('[');
    for (const auto* n : objects_) write(json, *n);
    json.end(']').end('}');
    return json.text();
  }

 private:
  using node = heap_graph::node;
  struct step {
    const node* from;
    const heap_graph::label* label;
  };

  explicit retention_report(heap_graph&& graph) : graph_(std::move(graph)) {}

  void write(std::string& out, const node& n) const {
    out += n.name();
    if (n.has_id) out += " (" + detail::text_of(n.address) + ')';
    out += n.state.is_retired() ? " is retired" : " is not retired";
    if (n.state.is_saturated())
      out += "; its count has overflowed: it stays for ever\n";
    else if (n.state.count() == 0)
      out += n.state.is_queued() ? "; it waits for a grace period\n" : "; nobody counts on it\n";
    else
      out += "; " + detail::text_of(n.state.count(), "reference") +
             (n.state.count() == 1 ? " is counted\n" : " are counted\n");
    detail::holder_list holders;
    holders.add(graph_, n);
    holders.write(out, "  ");
    if (n.not_described() != 0 && !n.state.is_saturated())
      out += "  " + detail::text_of(n.not_described(), "reference") +
             (n.not_described() == 1 ? " is" : " are") +
             " not described: " + detail::not_described_hint + '\n';
    if (n.stuck)
      out += "  a collector has seen it stuck " + detail::text_of(n.stuck_for) + " ago\n";
    const auto path = path_to(n);
    if (path.size() > 1) {
      out += "  ";
      for (const step& s : path) out += s.from->name() + " ." + s.label->name + " > ";
      out += n.name() + '\n';
    }
    if (path.empty() && n.described_references() != 0 && n.not_described() == 0)
      out += "  nothing else leads to it: the next collections will see that\n";
  }
  void write(detail::json_text& json, const node& n) const {
    json.begin('{').key("object");
    detail::holder_list::write(json, n);
    json.field("retired", n.state.is_retired()).field("queued", n.state.is_queued());
    json.field("count", std::uint64_t{n.state.count()}).key("held_by");
    detail::holder_list holders;
    holders.add(graph_, n);
    holders.write(json);
    json.field("not_described", n.not_described());
    if (n.stuck) json.field("stuck_ns", static_cast<std::uint64_t>(n.stuck_for.count()));
    json.key("path").begin('[');
    for (const step& s : path_to(n)) {
      json.begin('{').key("from");
      detail::holder_list::write(json, *s.from);
      json.field("edge", s.label->name).end('}');
    }
    json.end(']').end('}');
  }

  /// The shortest way to @p object from what keeps it: a root, or an object with references that are not described. By
  /// breadth, against the edges.
  std::vector<step> path_to(const node& object) const {
    const std::size_t none = graph_.edges.size();
    std::vector<std::size_t> via(graph_.nodes.size(), none);  // the edge that leads on
    std::vector<std::size_t> met{static_cast<std::size_t>(&object - graph_.nodes.data())};
    std::vector<step> path;
    for (std::size_t i = 0; i != met.size(); ++i) {
      const node& at = graph_.nodes[met[i]];
      if (i != 0 && (at.root || at.not_described() != 0)) {
        for (std::size_t n = met[i]; n != met[0]; n = graph_.edges[via[n]].to)
          path.push_back({&graph_.nodes[n], &graph_.labels[graph_.edges[via[n]].label]});
        break;
      }
      for (std::size_t k = at.first_in; k != at.last_in; ++k) {
        const std::size_t edge = graph_.incoming[k];
        const std::size_t from = graph_.edges[edge].from;
        if (via[from] != none || from == met[0]) continue;
        via[from] = edge;
        met.push_back(from);
      }
    }
    return path;
  }

  heap_graph graph_;
  std::string type_;
  std::vector<const node*> objects_;  // of graph_, whose nodes stay where they are when it is moved
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
