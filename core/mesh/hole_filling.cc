// 1. PartAtPinches  holes that touch at a vertex are one boundary loop, which passes there twice, by copies of the vertex: each is one of
// its own    2. Fill  a patch for each that meets nothing    3. Finish  the patches are added, and the copies beside them are one vertex
#include "core/mesh/hole_filling.h"

#include <algorithm>
#include <array>
#include <limits>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "core/base/status_macros.h"
#include "core/geometry/bvh.h"
#include "core/geometry/intersection.h"
#include "core/mesh/hole_patch.h"
#include "core/mesh/mesh_edits.h"
#include "core/mesh/union_find.h"

namespace meshfront {
namespace {

struct Corners {
  std::array<Vec3, 3> at;
  Box3 box;
};

Corners CornersOf(const std::array<Vec3, 3>& at) {
  Corners corners{at, {}};
  for (const Vec3& x : at) corners.box.Extend(x);
  return corners;
}

bool Overlap(const Box3& a, const Box3& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
         b.min.z <= a.max.z;
}

// By their places: where parts of a mesh touch, their vertices differ.
bool Meet(const Corners& a, const Corners& b) {
  SharedCorners shared;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3 && shared.in_b[i] < 0; ++j) {
      if (a.at[i] == b.at[j]) shared.in_b[i] = j, ++shared.count;
    }
  }
  return TrianglesIntersect({a.at[0], a.at[1], a.at[2]}, {b.at[0], b.at[1], b.at[2]}, shared);
}

class HoleFiller {
 public:
  HoleFiller(TriangleMesh& mesh, const FaceAdjacency& adjacency)
      : mesh_(mesh), adjacency_(adjacency), bvh_(mesh.positions, mesh.triangles), copies_(mesh.positions.size()) {}

  using Loop = std::vector<uint32_t>;  // half-edges with the mesh on their left
  // The loops that a loop is made of, none of which passes a place twice.
  std::vector<Loop> PartAtPinches(const Loop& loop) const;
  bool Fill(const Loop& loop);
  // Adds all patches to the mesh.
  void Finish();

 private:
  struct Placed {
    std::vector<VertexId> rim;
    std::vector<uint32_t> rim_half_edges;  // that leave the rim's vertices
    HolePatch patch;
    std::vector<Corners> corners;
    Box3 box;
  };

  bool MayBeOne(VertexId v, VertexId copy) const;
  HoleRimVertex RimVertexAt(uint32_t before, uint32_t half_edge) const;
  std::vector<std::array<uint32_t, 2>> FindJoined(const Loop& loop) const;
  bool IsClear(const Placed& placed) const;
  void AddAttributes(const Placed& placed);

  TriangleMesh& mesh_;
  const FaceAdjacency& adjacency_;
  const TriangleBvh bvh_;
  std::vector<Placed> placed_;
  UnionFind copies_;  // of vertices at whose place a filled loop passes from one to another
};

// No edge would be one of more than two triangles.
bool HoleFiller::MayBeOne(VertexId v, VertexId copy) const {
  bool may = v != copy;
  VisitNeighbours(mesh_, adjacency_, v.index(), [&](VertexId a) {
    VisitNeighbours(mesh_, adjacency_, copy.index(), [&](VertexId b) { may = may && a != b; });
  });
  return may;
}

std::vector<HoleFiller::Loop> HoleFiller::PartAtPinches(const Loop& loop) const {
  std::vector<Loop> parts;
  Loop open;
  struct Passed {
    size_t index;                  // in `open`
    std::vector<VertexId> copies;  // there
  };
  absl::flat_hash_map<std::tuple<double, double, double>, Passed> passed;
  const auto key = [&](uint32_t h) {
    const Vec3& x = mesh_.PositionAt(OriginOf(mesh_, h));
    return std::tuple(x.x, x.y, x.z);
  };
  for (const uint32_t h : loop) {
    const VertexId v = OriginOf(mesh_, h);
    Passed& before = passed.try_emplace(key(h), Passed{open.size(), {}}).first->second;
    if (!std::all_of(before.copies.begin(), before.copies.end(), [&](VertexId copy) { return MayBeOne(v, copy); }))
      return {loop};
    before.copies.push_back(v);
    const size_t begin = before.index;
    if (begin < open.size()) {
      parts.emplace_back(open.begin() + static_cast<std::ptrdiff_t>(begin), open.end());
      for (size_t i = begin + 1; i < open.size(); ++i) passed.erase(key(open[i]));
      open.resize(begin);
    }
    open.push_back(h);
  }
  parts.push_back(std::move(open));
  return parts;
}

// The surface behind a vertex lies across from the hole, at a right angle to the rim.
HoleRimVertex HoleFiller::RimVertexAt(uint32_t before, uint32_t half_edge) const {
  const VertexId v = OriginOf(mesh_, half_edge), arrived = TargetOf(mesh_, before);
  const Vec3& x = mesh_.PositionAt(v);
  const Vec3 &from = mesh_.PositionAt(OriginOf(mesh_, before)), &to = mesh_.PositionAt(TargetOf(mesh_, half_edge));
  Vec3 normal, inside;
  const auto add = [&](uint32_t h) {
    const Vec3 a = mesh_.PositionAt(TargetOf(mesh_, h)) - x,
               b = mesh_.PositionAt(OriginOf(mesh_, PreviousHalfEdge(h))) - x;
    normal += Cross(a, b);
    inside += Norm(Cross(a, b)) * Normalized(a + b);
  };
  VisitOutgoing(adjacency_, v.index(), add);
  if (arrived != v) VisitOutgoing(adjacency_, arrived.index(), add);
  normal = Normalized(normal);
  const Vec3 along = Normalized(to - from);
  inside = Normalized(inside - Dot(inside, along) * along);
  if (!(SquaredNorm(inside) > 0)) inside = Cross(normal, along);
  return {x, normal, x + 0.5 * (Distance(x, from) + Distance(x, to)) * inside};
}

// Pairs of places of the rim, not next to each other on it, that the mesh joins.
std::vector<std::array<uint32_t, 2>> HoleFiller::FindJoined(const Loop& loop) const {
  absl::flat_hash_map<uint32_t, uint32_t> places;
  const auto n = static_cast<uint32_t>(loop.size());
  for (uint32_t i = 0; i < n; ++i) {
    places[OriginOf(mesh_, loop[i]).index()] = i;
    places[TargetOf(mesh_, loop[(i + n - 1) % n]).index()] = i;
  }
  std::vector<std::array<uint32_t, 2>> joined;
  for (uint32_t i = 0; i < n; ++i) {
    const auto note = [&](VertexId other) {
      const auto found = places.find(other.index());
      if (found == places.end() || found->second <= i) return;
      const uint32_t j = found->second;
      if (j != i + 1 && !(i == 0 && j == n - 1)) joined.push_back({i, j});
    };
    const VertexId v = OriginOf(mesh_, loop[i]), arrived = TargetOf(mesh_, loop[(i + n - 1) % n]);
    VisitNeighbours(mesh_, adjacency_, v.index(), note);
    if (arrived != v) VisitNeighbours(mesh_, adjacency_, arrived.index(), note);
  }
  return joined;
}

bool HoleFiller::IsClear(const Placed& placed) const {
  for (const Corners& own : placed.corners) {
    bool meets = false;
    bvh_.VisitOverlaps(own.box, [&](FaceId f) {
      const Triangle& t = mesh_.triangles[f.index()];
      meets = Meet(own, CornersOf({mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1]), mesh_.PositionAt(t[2])}));
      return !meets;
    });
    for (const Placed& other : placed_) {
      if (meets || !Overlap(other.box, own.box)) continue;
      meets = std::any_of(other.corners.begin(), other.corners.end(),
                          [&](const Corners& c) { return Overlap(c.box, own.box) && Meet(own, c); });
    }
    if (meets) return false;
  }
  return true;
}

bool HoleFiller::Fill(const Loop& loop) {
  Placed placed;
  const Loop reversed(loop.rbegin(), loop.rend());  // the hole on the left
  std::vector<HoleRimVertex> rim;
  for (size_t i = 0; i < loop.size(); ++i) {
    rim.push_back(RimVertexAt(reversed[(i + 1) % loop.size()], reversed[i]));
    placed.rim.push_back(OriginOf(mesh_, reversed[i]));
    placed.rim_half_edges.push_back(reversed[i]);
  }
  std::vector<std::array<uint32_t, 2>> joined = FindJoined(loop);
  const auto last = static_cast<uint32_t>(loop.size() - 1);
  for (auto& [i, j] : joined) i = last - i, j = last - j;
  for (const PatchShape shape : {PatchShape::kFair, PatchShape::kTaut}) {
    std::optional<HolePatch> patch = MakeHolePatch(rim, joined, shape);
    if (!patch) continue;
    placed.patch = *std::move(patch);
    placed.corners.clear(), placed.box = {};
    for (const Triangle& t : placed.patch.triangles) {
      const std::vector<Vec3>& at = placed.patch.positions;
      placed.corners.push_back(CornersOf({at[t[0].index()], at[t[1].index()], at[t[2].index()]}));
      placed.box.Extend(placed.corners.back().box);
    }
    if (!IsClear(placed)) continue;
    placed_.push_back(std::move(placed));
    for (size_t i = 0; i < loop.size(); ++i)
      copies_.Unite(OriginOf(mesh_, loop[i]).index(),
                    TargetOf(mesh_, loop[(i + loop.size() - 1) % loop.size()]).index());
    return true;
  }
  return false;
}

// The wedges of the rim are those of the faces there; a vertex on an edge between two has one between theirs.
void HoleFiller::AddAttributes(const Placed& placed) {
  MeshAttributes& attributes = mesh_.attributes;
  if (attributes.empty()) return;
  if (!attributes.groups.empty())
    attributes.groups.resize(attributes.groups.size() + placed.patch.triangles.size(),
                             attributes.GroupOf(placed.rim_half_edges[0] / 3));
  if (attributes.channels.empty()) return;
  attributes.values.reserve(attributes.values.size() + placed.patch.parents.size() * attributes.Stride());
  std::vector<uint32_t> wedges;
  for (const uint32_t h : placed.rim_half_edges) wedges.push_back(attributes.corners[h / 3][h % 3]);
  for (const auto& [a, b] : placed.patch.parents)
    wedges.push_back(AddWedgeBetween(attributes, wedges[a.index()], wedges[b.index()], 0.5));
  for (const Triangle& t : placed.patch.triangles)
    attributes.corners.push_back({wedges[t[0].index()], wedges[t[1].index()], wedges[t[2].index()]});
}

void HoleFiller::Finish() {
  const auto kept = [this](VertexId v) { return VertexId(copies_.Find(v.index())); };
  for (Triangle& t : mesh_.triangles) t = {kept(t[0]), kept(t[1]), kept(t[2])};
  for (const Placed& placed : placed_) {
    AddAttributes(placed);
    std::vector<VertexId> names;
    for (const VertexId v : placed.rim) names.push_back(kept(v));
    for (size_t v = placed.rim.size(); v < placed.patch.positions.size(); ++v) {
      names.push_back(VertexId(static_cast<uint32_t>(mesh_.positions.size())));
      mesh_.positions.push_back(placed.patch.positions[v]);
    }
    for (const Triangle& t : placed.patch.triangles)
      mesh_.triangles.push_back({names[t[0].index()], names[t[1].index()], names[t[2].index()]});
  }
}

}  // namespace

absl::StatusOr<FilledHoles> FillHoles(double size, TriangleMesh& mesh, FaceAdjacency& adjacency,
                                      const Context& context) {
  FilledHoles result;
  const std::vector<std::vector<uint32_t>> loops = FindBoundaryLoops(adjacency);
  if (loops.empty()) return result;
  HoleFiller filler(mesh, adjacency);
  std::vector<std::vector<uint32_t>> holes;
  for (const std::vector<uint32_t>& loop : loops) {
    for (std::vector<uint32_t>& part : filler.PartAtPinches(loop)) holes.push_back(std::move(part));
  }
  for (const std::vector<uint32_t>& loop : holes) {
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    std::vector<Vec3> places;
    for (const uint32_t h : loop) places.push_back(mesh.PositionAt(OriginOf(mesh, h)));
    if (IsWiderThan(places, size)) continue;
    if (filler.Fill(loop))
      ++result.filled;
    else
      result.left_open.push_back(places[0]);
  }
  if (result.filled == 0) return result;
  filler.Finish();
  adjacency = CreateAdjacency(mesh);
  DropUnreferencedVertices(mesh, adjacency);
  return result;
}

}  // namespace meshfront
