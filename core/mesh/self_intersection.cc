#include "core/mesh/self_intersection.h"

#include <algorithm>
#include <tuple>

#include "core/base/status_macros.h"
#include "core/geometry/bvh.h"
#include "core/geometry/intersection.h"
#include "core/geometry/predicates.h"
#include "core/mesh/repair_survey.h"

namespace meshfront {
namespace {

constexpr size_t kBlock = 256;

// For each vertex the smallest one at the same position. Vertices that are not finite stand for themselves.
std::vector<VertexId> FirstAtPosition(const std::vector<Vec3>& positions) {
  std::vector<uint32_t> order;
  std::vector<VertexId> first(positions.size());
  for (uint32_t v = 0; v < positions.size(); ++v) {
    first[v] = VertexId(v);
    if (IsFinite(positions[v])) order.push_back(v);
  }
  const auto key = [&](uint32_t v) { return std::tie(positions[v].x, positions[v].y, positions[v].z); };
  std::sort(order.begin(), order.end(),
            [&](uint32_t a, uint32_t b) { return key(a) != key(b) ? key(a) < key(b) : a < b; });
  for (size_t i = 1; i < order.size(); ++i) {
    if (positions[order[i]] == positions[order[i - 1]]) first[order[i]] = first[order[i - 1]];
  }
  return first;
}

// The triangles that can meet others, with corners at equal positions made one; `face` tells which they were.
struct Welded {
  std::vector<Triangle> triangles;
  std::vector<uint32_t> face;
};

Welded WeldedTriangles(const TriangleMesh& mesh) {
  const std::vector<VertexId> first = FirstAtPosition(mesh.positions);
  Welded out;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    Triangle t = mesh.triangles[f];
    for (VertexId& v : t) v = first[v.index()];
    const FaceState state = StateOf(mesh, t);
    if (state != FaceState::kSound && state != FaceState::kZeroArea) continue;
    if (AreCollinear(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]))) continue;
    out.triangles.push_back(t);
    out.face.push_back(f);
  }
  return out;
}

struct BlockPairs {
  uint64_t count = 0;
  std::vector<std::pair<FaceId, FaceId>> listed;
};

}  // namespace

absl::StatusOr<SelfIntersections> FindSelfIntersections(const TriangleMesh& mesh, size_t listed_pairs,
                                                        const Context& context) {
  MESHFRONT_RETURN_IF_ERROR(ValidateIndices(mesh));
  const Welded welded = WeldedTriangles(mesh);
  const TriangleBvh bvh(mesh.positions, welded.triangles);
  const auto look = [&](uint32_t f, BlockPairs& out) {
    const Triangle& t = welded.triangles[f];
    const Vec3 a[3] = {mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])};
    std::vector<uint32_t> others;
    bvh.VisitOverlaps(bvh.BoxOf(FaceId(f)), [&](FaceId g) {
      if (g.index() <= f) return true;
      const Triangle& s = welded.triangles[g.index()];
      const Vec3 b[3] = {mesh.PositionAt(s[0]), mesh.PositionAt(s[1]), mesh.PositionAt(s[2])};
      if (TrianglesIntersect(a, b, SharedCornersOf(t, s))) others.push_back(g.index());
      return true;
    });
    out.count += others.size();
    std::sort(others.begin(), others.end());
    for (const uint32_t g : others) {
      if (out.listed.size() >= listed_pairs) break;
      out.listed.push_back({FaceId(welded.face[f]), FaceId(welded.face[g])});
    }
  };
  std::vector<BlockPairs> blocks((welded.triangles.size() + kBlock - 1) / kBlock);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(welded.triangles.size(), kBlock, context, [&](size_t begin, size_t end) {
    for (size_t f = begin; f < end; ++f) look(static_cast<uint32_t>(f), blocks[begin / kBlock]);
  }));
  SelfIntersections out;
  out.skipped_faces = mesh.triangles.size() - welded.triangles.size();
  for (const BlockPairs& block : blocks) {
    out.pairs += block.count;
    for (const auto& pair : block.listed) {
      if (out.first_pairs.size() < listed_pairs) out.first_pairs.push_back(pair);
    }
  }
  return out;
}

}  // namespace meshfront
