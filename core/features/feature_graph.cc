//   1. CollectEdges: every edge without a neighbour in the cut surface, once, by the smaller of its half-edges;
//   2. Trace from every node along its edges to the next node; what is left is closed, and traced from its smallest edge.
#include "core/features/feature_graph.h"

#include <algorithm>
#include <array>
#include <utility>

#include "absl/container/flat_hash_map.h"

namespace meshfront {
namespace {

constexpr uint8_t kNodeByPlace = 255;  // instead of the degree 2, as for nodes on the border of a region

}  // namespace

FeatureGraph::FeatureGraph(const MeshSurface& surface) : surface_(surface) {
  CollectEdges();
  MakeNodesAlike();
  MakeNodesOfBorder();
  place_.assign(names_.size(), {kNoHalfEdge, 0, true});
  for (const bool from_nodes : {true, false}) {
    for (uint32_t i = 0; i < names_.size(); ++i) {
      const uint32_t origin = OriginOfEdge(names_[i]), target = TargetOfEdge(names_[i]);
      if (place_[i].curve != kNoHalfEdge) continue;
      if (!from_nodes || IsNode(origin))
        Trace(i, origin);
      else if (IsNode(target))
        Trace(i, target);
    }
  }
}

uint32_t FeatureGraph::NameOf(uint32_t h) const { return std::min(h, surface_.AcrossCrease(h)); }
uint32_t FeatureGraph::OriginOfEdge(uint32_t h) const { return surface_.OriginalOf(OriginOf(surface_.mesh(), h)); }
uint32_t FeatureGraph::TargetOfEdge(uint32_t h) const { return surface_.OriginalOf(TargetOf(surface_.mesh(), h)); }

void FeatureGraph::CollectEdges() {
  const auto half_edges = static_cast<uint32_t>(3 * surface_.mesh().triangles.size());
  for (uint32_t h = 0; h < half_edges; ++h) {
    if (surface_.adjacency().OppositeOf(h) == kNoHalfEdge && NameOf(h) == h) names_.push_back(h);
  }
  std::vector<uint32_t> counts(surface_.mesh().positions.size() + 1, 0);
  for (const uint32_t h : names_) ++counts[OriginOfEdge(h) + 1], ++counts[TargetOfEdge(h) + 1];
  degrees_.resize(counts.size() - 1);
  for (size_t v = 0; v < degrees_.size(); ++v) degrees_[v] = static_cast<uint8_t>(std::min(counts[v + 1], 255u));
  for (size_t v = 1; v < counts.size(); ++v) counts[v] += counts[v - 1];
  begin_ = counts;
  at_.resize(2 * names_.size());
  for (uint32_t i = 0; i < names_.size(); ++i) {
    at_[counts[OriginOfEdge(names_[i])]++] = i;
    at_[counts[TargetOfEdge(names_[i])]++] = i;
  }
}

// Where curves touch, each is divided at the nodes of the other, too.
void FeatureGraph::MakeNodesAlike() {
  absl::flat_hash_map<std::array<double, 3>, bool> is_node_at;
  const auto key = [&](uint32_t v) -> std::array<double, 3> {
    const Vec3& p = surface_.mesh().positions[v];
    return {p.x + 0.0, p.y + 0.0, p.z + 0.0};
  };
  for (uint32_t v = 0; v < degrees_.size(); ++v) {
    if (degrees_[v] > 0) is_node_at[key(v)] |= degrees_[v] != 2;
  }
  for (uint32_t v = 0; v < degrees_.size(); ++v) {
    if (degrees_[v] == 2 && is_node_at.at(key(v))) degrees_[v] = kNodeByPlace;
  }
}

void FeatureGraph::MakeNodesOfBorder() {
  for (const uint32_t v : surface_.border_vertices()) degrees_[v] = kNodeByPlace;
}

// The other one of the two edges at a vertex that is no node.
uint32_t FeatureGraph::NextEdge(uint32_t vertex, uint32_t edge) const {
  const uint32_t first = at_[begin_[vertex]];
  return first == edge ? at_[begin_[vertex] + 1] : first;
}

void FeatureGraph::Trace(uint32_t edge, uint32_t from) {
  const auto number = static_cast<uint32_t>(curves_.size());
  FeatureCurve curve;
  curve.is_crease = surface_.AcrossCrease(names_[edge]) != kNoHalfEdge;
  curve.is_border = surface_.IsBorder(names_[edge]);
  for (;;) {
    const uint32_t h = names_[edge], across = surface_.AcrossCrease(h);
    const bool along = OriginOfEdge(h) == from;
    place_[edge] = {number, static_cast<uint32_t>(curve.forward.size()), along};
    curve.vertices.push_back(from);
    curve.forward.push_back(along ? h : across);
    curve.backward.push_back(along ? across : h);
    from = along ? TargetOfEdge(h) : OriginOfEdge(h);
    if (IsNode(from)) break;
    edge = NextEdge(from, edge);
    if (place_[edge].curve != kNoHalfEdge) break;
  }
  curve.closed = !IsNode(from);
  if (!curve.closed) curve.vertices.push_back(from);
  curves_.push_back(std::move(curve));
}

CurveSegment FeatureGraph::SegmentOf(uint32_t h) const {
  const uint32_t name = NameOf(h);
  CurveSegment place = place_[std::lower_bound(names_.begin(), names_.end(), name) - names_.begin()];
  if (name != h) place.forward = !place.forward;
  return place;
}

Curve FeatureGraph::CurveOf(const FeatureCurve& curve) const {
  std::vector<Vec3> points;
  points.reserve(curve.vertices.size());
  // Copies of a vertex keep its place, and the first keeps its number.
  for (const uint32_t v : curve.vertices) points.push_back(surface_.mesh().positions[v]);
  return Curve(std::move(points), curve.closed);
}

}  // namespace meshfront
