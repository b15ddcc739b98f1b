/// @file
/// A domain's objects and their edges as plain data: what reports, audits and pictures are made from.
///
/// **How it is taken.** A walk (detail/heap_walk.hpp) from the roots, from what waits in the zero-count tables, and from the
/// candidates of trial deletion, along described edges. It takes the collector's turn: nothing is destroyed meanwhile, so what it
/// has met exists until it is through; and edges() are called as a collector would, one object's at a time. So the calling
/// thread must hold no lock that an edges() takes.
///
/// **What it is worth.** Exact while no thread changes anything. Otherwise each edge and each count was there at some moment of the
/// walk, not all of them at one.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "../counter.hpp"
#include "../detail/report_text.hpp"
#include "../domain.hpp"
#include "../fwd.hpp"
#include "../stats.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {
namespace detail {

template <class Env>
class heap_capture;

}  // namespace detail

/// How a walk over a domain is made.
struct walk_options {
  /// The caller knows that no mutator's thread runs into the domain until the walk is over, and that what these threads did
  /// comes before it (they are joined, or wait at a barrier). Then the roots that mutators own are visited, too, and what they
  /// have not published yet. Else only those of the calling thread.
  bool threads_stand_still = false;
  /// How long it is tried while another thread is at work in collect().
  std::chrono::nanoseconds patience = std::chrono::seconds(1);
};

/// The objects of a domain that described edges lead to, and these edges.
///
/// Plain data: addresses in it are for comparison, their objects may be gone. Taken with capture().
struct heap_graph {
  /// Whether it could be taken.
  enum class outcome {
    done,  ///< It is complete.
    busy,  ///< Another thread was collecting all the time, or the calling one is: it is empty.
    out_of_memory  ///< There was not enough memory: it is empty.
  };
  /// An object or a root.
  struct node {
    const void* address = nullptr;  ///< Of the object, or of what the root describes.
    std::string type;               ///< Its type, as the compiler spells it; of a root, its name.
    bool root = false;              ///< Whether it is a root.
    bool has_id = false;            ///< Whether its type has `report_id() const`.
    std::uint64_t id = 0;           ///< What that returned.
    state_word state;               ///< Count and flags.
    bool described = false;         ///< Whether its type describes edges.
    bool unfinished = false;        ///< edges() threw: some of its edges are missing.
    bool stuck = false;  ///< Retired, described, and referred to when it was last looked at.
    std::chrono::nanoseconds stuck_for{0};  ///< If so: since a collector has seen that first.
    std::size_t first_out = 0;              ///< Its edges: a range of `edges`.
    std::size_t last_out = 0;               ///< Past its last edge.
    std::size_t first_in = 0;               ///< The edges to it: a range of `incoming`.
    std::size_t last_in = 0;                ///< Past the last edge to it.

    /// References that edges describe. The count may be another one.
    [[nodiscard]] std::uint64_t described_references() const noexcept { return last_in - first_in; }
    /// References that are counted, and that no edge describes.
    [[nodiscard]] std::uint64_t not_described() const noexcept {
      return state.count() > described_references() ? state.count() - described_references() : 0;
    }
    /// `KeyFrame 812`, or with its address where the type has no `report_id() const`; `root Tracking`.
    [[nodiscard]] std::string name() const {
      if (root) return "root " + type;
      return detail::short_name(type.c_str()) + ' ' +
             (has_id ? std::to_string(id) : detail::text_of(address));
    }
  };
  /// A reference.
  struct edge {
    std::uint32_t from = 0;   ///< Index of a node.
    std::uint32_t to = 0;     ///< Index of a node.
    std::uint32_t label = 0;  ///< Index of a label.
  };
  /// What a description says of an edge.
  struct label {
    std::string name;         ///< Of the member.
    std::string disposition;  ///< What becomes of it when its target is retired.
  };
  /// The objects of one type.
  struct type_count {
    std::string type;  ///< As the compiler spells it.
    std::uint64_t live =
        0;  ///< Objects that exist; 0 for a type that does not defer, of which nobody knows.
    std::uint64_t found = 0;  ///< Those that the walk has met.
  };

  outcome result = outcome::busy;           ///< Whether it could be taken.
  std::vector<node> nodes;                  ///< In the order in which they were met.
  std::vector<edge> edges;                  ///< Those of one node side by side.
  std::vector<label> labels;                ///< Each once.
  std::vector<std::size_t> incoming;        ///< Indices of edges, by their targets.
  std::vector<type_count> types;            ///< One for each type.
  std::vector<std::string> roots_left_out;  ///< Roots of mutators whose threads may be at work.
  std::size_t cleared_registries = 0;       ///< Whose references no collector has dropped yet.
  delay delayed;                            ///< Whom reclamation waits for.

  /// Whether an edge is stale: it refers to a retired object from one that is not.
  [[nodiscard]] bool is_stale(const edge& e) const noexcept {
    return nodes[e.to].state.is_retired() && !nodes[e.from].state.is_retired();
  }
  /// The node of an object, or null. O(nodes).
  [[nodiscard]] const node* find(const void* object) const noexcept {
    for (const node& n : nodes)
      if (!n.root && n.address == object) return &n;
    return nullptr;
  }
};

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc

#include "../detail/heap_capture.hpp"

namespace slamgc {
inline namespace SLAMGC_FLAVOUR {

/// Takes the graph of a domain. O(objects + edges) time, and memory: some 250 bytes for each object, 40 for each edge.
///
/// By any thread, online or not, without a lock that an edges() takes. Destroys nothing, and changes nothing.
/// Does not throw: result says whether there was memory.
template <class Env>
[[nodiscard]] heap_graph capture(basic_domain<Env>& of, const walk_options& options = {}) {
  return detail::heap_capture<Env>::take(detail::domain_access::state_of(of), options, nullptr);
}

}  // namespace SLAMGC_FLAVOUR
}  // namespace slamgc
