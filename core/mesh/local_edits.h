// A mesh a few of whose triangles are replaced by others at a time, where nothing that is right becomes wrong by it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "core/geometry/bvh.h"
#include "core/mesh/holding_sink.h"

namespace meshfront {

// What is asked of triangles that are made. The first two, unless it was worse before.
struct TriangleShape {
  double least_ratio;  // radius ratio, 0 to 1
  double least_fold;   // cosine between the normals of neighbours
  double gain = 0;     // the least radius ratio after an edit, in parts of that before
};

// Edits of one piece that is a whole, oriented manifold, perhaps with boundary. An edit is proposed (ProposeMove, ProposeFlip), which
// says whether it is allowed, and applied (Apply) before the next one is proposed, or left. Allowed is what keeps the topology and the
// wedges of corners, and makes no triangle that meets another one where it did not before, turns by more than 90° against the one in
// whose place it is, or has a worse shape than is asked, unless one in its place had.
//
// Feature edges are the piece's rims and, where it has corners' wedges, those on whose sides a wedge differs. Deterministic.
class LocalEdits {
 public:
  using Corners = std::array<VertexId, 3>;
  struct Between {
    uint32_t triangles[2] = {};
    int count = 0;
  };

  // `mesh` outlives the edits and is theirs until Compact.
  explicit LocalEdits(HeldPiece& mesh);

  uint64_t triangles() const { return alive_; }  // that are left
  size_t triangle_slots() const { return is_alive_.size(); }
  bool is_alive(uint32_t t) const { return is_alive_[t]; }
  size_t vertices() const { return positions_.size(); }
  const Vec3& position(uint32_t v) const { return positions_[v]; }
  const Corners& corners(uint32_t t) const { return mesh_.triangles[t]; }
  const std::vector<uint32_t>& around(uint32_t v) const { return around_[v]; }  // its triangles; none where it is gone
  Vec3 AreaOf(const Corners& c) const;                                          // twice the area, along the normal
  double RatioOf(const Corners& c) const;                                       // radius ratio

  static int CornerOf(const Corners& c, uint32_t v);  // -1: none
  Between TrianglesBetween(uint32_t u, uint32_t v) const;
  bool IsFeature(uint32_t u, uint32_t v) const;  // of an edge
  std::vector<uint32_t> NeighboursOf(uint32_t v) const;
  Corners Moved(uint32_t t, uint32_t u, uint32_t v) const;  // triangle t with v for u

  // Vertex u onto v: a neighbour, so that the triangles between the two vanish, or one that is gone, and was on no feature and on u's
  // side of all features.
  bool ProposeMove(uint32_t u, uint32_t v, const TriangleShape& shape);
  // The edge uv, which is no feature, to lie between the other corners of its two triangles.
  bool ProposeFlip(uint32_t u, uint32_t v, const TriangleShape& shape);
  // Makes the edit that was proposed.
  void Apply();

  // What is left, numbered in the order that it had.
  void Compact();

 private:
  struct Made {
    uint32_t triangle;  // in whose place it is
    Corners corners;
    std::array<uint32_t, 3> wedges;
  };

  bool IsRim(uint32_t v) const;
  bool KeepsLinks(uint32_t u, uint32_t v) const;
  bool KeepsWedges(uint32_t u, uint32_t v) const;
  std::array<std::pair<uint32_t, uint32_t>, 2> WedgesBeside(uint32_t u, uint32_t v) const;
  void GiveWedges(uint32_t u, uint32_t v);
  bool KeepsShapes(const TriangleShape& shape) const;
  bool KeepsFolds(const TriangleShape& shape) const;
  double LeastFold(uint32_t t, const Corners& c, bool is_made) const;
  bool IsReplaced(uint32_t t) const;
  bool Meet(const Corners& a, const Corners& b) const;
  bool MeetsNothing() const;
  bool MeetsAny(const Corners& c) const;
  bool IsNear(const Corners& c, const Box3& box) const;
  void BuildTree();
  void NamePatches();

  HeldPiece& mesh_;
  uint64_t alive_;
  std::vector<bool> is_alive_;
  std::vector<Vec3> positions_;
  std::vector<std::vector<uint32_t>> around_;
  // Where corners have wedges: the patch between feature edges that each triangle is in; of each vertex as it came, its patch and its
  // wedge, if it had one only.
  std::vector<uint32_t> patch_;
  std::vector<std::pair<uint32_t, uint32_t>> origin_;
  // The edit that was proposed.
  std::vector<uint32_t> replaced_;
  std::vector<Made> made_;
  // A tree of the triangles as they were, and those that changed since.
  std::vector<Corners> was_;
  std::unique_ptr<TriangleBvh> tree_;
  std::vector<uint8_t> is_changed_;
  std::vector<uint32_t> changed_;
};

}  // namespace meshfront
