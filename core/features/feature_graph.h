// The curves along which a surface is cut or ends: rims and creases, from one node to the next (sec. 3.3).
#pragma once

#include <cstdint>
#include <vector>

#include "core/features/curve.h"
#include "core/surface/mesh_surface.h"

namespace meshfront {

// A chain of edges between two nodes, or a closed one without any. Segment i runs from its vertex i to the next.
struct FeatureCurve {
  std::vector<uint32_t> forward;   // of each segment, the half-edge of the surface that runs its way, or kNoHalfEdge
  std::vector<uint32_t> backward;  // … and the one that runs against it
  std::vector<uint32_t> vertices;  // MeshSurface::OriginalOf, one for each segment and, when it is open, its end
  bool closed = false;
  bool is_crease = false;  // else a rim of the surface: one of the half-edges is missing
  bool is_border = false;  // of a region: one edge, which stays as it is

  uint32_t start() const { return vertices.front(); }
  uint32_t end() const { return vertices.back(); }
};

// Where on the graph a rim half-edge of the (cut) surface lies.
struct CurveSegment {
  uint32_t curve = 0, segment = 0;
  bool forward = true;
};

// Nodes are the vertices at which other than two feature edges meet, those at the same places, and all on the border of
// a region. Curves are in the order of their smallest half-edge, open ones first; a closed one starts there. O(faces).
class FeatureGraph {
 public:
  explicit FeatureGraph(const MeshSurface& surface);

  const std::vector<FeatureCurve>& curves() const { return curves_; }
  bool IsNode(uint32_t original_vertex) const { return degrees_[original_vertex] != 2; }
  // `half_edge`: one without a neighbour in the surface's adjacency.
  CurveSegment SegmentOf(uint32_t half_edge) const;
  Curve CurveOf(const FeatureCurve& curve) const;

 private:
  // An edge of the graph, by the smaller of its half-edges.
  uint32_t NameOf(uint32_t half_edge) const;
  uint32_t OriginOfEdge(uint32_t half_edge) const;
  uint32_t TargetOfEdge(uint32_t half_edge) const;
  void CollectEdges();
  void MakeNodesAlike();
  void MakeNodesOfBorder();
  void Trace(uint32_t name, uint32_t from);
  uint32_t NextEdge(uint32_t vertex, uint32_t name) const;

  const MeshSurface& surface_;
  std::vector<uint32_t> names_;      // of all edges, increasing
  std::vector<uint8_t> degrees_;     // of each original vertex, at most 255
  std::vector<uint32_t> begin_;      // of each original vertex in at_
  std::vector<uint32_t> at_;         // the edges at each vertex, by their index in names_
  std::vector<CurveSegment> place_;  // of each edge, by its index in names_; curve kNoHalfEdge: none yet
  std::vector<FeatureCurve> curves_;
};

}  // namespace meshfront
