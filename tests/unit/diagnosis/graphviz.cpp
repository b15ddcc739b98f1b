// Pictures: the whole text of a small one.
#include <gtest/gtest.h>

#include <slamgc/diagnosis/graphviz.hpp>
#include <slamgc/slamgc.hpp>
#include <sstream>
#include <string>

#include "unit/diagnosis/map.hpp"

namespace {

using namespace diagnosis_map;

std::string dot(const slamgc::heap_graph& graph, const slamgc::picture_options& options = {}) {
  std::ostringstream out;
  write_dot(out, graph, options);
  return out.str();
}
std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; ++at) ++n;
  return n;
}

TEST(Graphviz, StaleEdgesAreRedAndRetiredObjectsMarked) {
  world w;
  Map map(w.domain);
  KeyFrame* const a = w.key_frame(1);
  KeyFrame* const b = w.key_frame(2);
  map.mspKeyFrames.insert(a);
  b->mpParent = a;
  a->mpParent = b;
  slamgc::retire(b);
  const slamgc::intrusive_rc<KeyFrame> hidden(a);
  EXPECT_EQ(dot(capture(w.domain)),
            "digraph slamgc {\n"
            "  rankdir=LR;\n"
            "  node [fontname=\"sans-serif\" style=filled];\n"
            "  edge [fontname=\"sans-serif\" fontsize=10];\n"
            "  n0 [label=\"root Map\" shape=cds fillcolor=\"#dddddd\"];\n"
            "  n1 [label=\"KeyFrame 1\" shape=box fillcolor=\"#a6d3f2\"];\n"
            "  u1 [label=\"1 not described\" shape=plaintext style=\"\"];\n"
            "  u1 -> n1 [style=dotted];\n"
            "  n2 [label=\"KeyFrame 2\\nretired\" shape=box fillcolor=\"#a6d3f2\" "
            "style=\"filled,dashed\" color=\"#cc0000\" penwidth=2];\n"
            "  n0 -> n1 [label=\"mspKeyFrames\\nhold\"];\n"
            "  n1 -> n2 [label=\"mpParent\\nhold\" color=\"#cc0000\" fontcolor=\"#cc0000\" "
            "penwidth=2];\n"
            "  n2 -> n1 [label=\"mpParent\\nhold\"];\n"
            "}\n");
  w.clear(map.mspKeyFrames);
}

TEST(Graphviz, ANeighbourhoodGoesBothWays) {
  world w;
  Map map(w.domain);
  KeyFrame* chain[7];
  for (unsigned long i = 0; i != 7; ++i) {
    chain[i] = w.key_frame(i);
    if (i != 0) chain[i]->mpParent = chain[i - 1];
  }
  map.mspKeyFrames.insert(chain[6]);
  const auto graph = capture(w.domain);
  EXPECT_EQ(count(dot(graph), "label=\"KeyFrame "), 7u);
  for (unsigned hops = 0; hops != 3; ++hops) {
    const std::string text = dot(graph, {chain[3], hops});
    EXPECT_EQ(count(text, "label=\"KeyFrame "), 2 * hops + 1) << text;
    EXPECT_EQ(count(text, "mpParent"), 2 * hops) << text;
  }
  EXPECT_EQ(count(dot(graph, {chain[6], 1}), "root Map"), 1u);
  EXPECT_EQ(count(dot(graph, {&w, 5}), "label="), 0u);
  for (KeyFrame* kf : chain) slamgc::retire(kf);
  w.clear(map.mspKeyFrames);
  EXPECT_EQ(w.live(), 0u);
}

TEST(Graphviz, ParallelEdgesAreOne) {
  world w;
  Map map(w.domain);
  KeyFrame* const kf = w.key_frame(1);
  map.mspKeyFrames.insert(kf);
  MapPoint* const point = new MapPoint;
  kf->mvpMapPoints = {point, point, nullptr, point};
  const std::string text = dot(capture(w.domain));
  EXPECT_EQ(count(text, "label=\"mvpMapPoints\\nnull, 3 times\""), 1u) << text;
  EXPECT_EQ(count(text, "shape=ellipse"), 1u) << text;
  slamgc::retire(point);
  w.clear(map.mspKeyFrames);
}

}  // namespace
