#include "core/thinned_attempt.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/base/status_macros.h"
#include "core/mesh/thinning.h"

namespace meshfront {
namespace {

// What lies on the surface is no farther from a triangle, whose corners do, than its longest edge over √3, and what the fit moved them.
constexpr double kFarthestPerEdge = 0.73;

HeldPiece Joined(const std::vector<HeldPiece>& pieces) {
  HeldPiece whole(MeshPiece{});
  const auto append = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
  for (const HeldPiece& piece : pieces) {
    append(piece.vertices, whole.vertices);
    append(piece.triangles, whole.triangles);
    append(piece.kinds, whole.kinds);
    append(piece.wedges, whole.wedges);
    append(piece.corners, whole.corners);
    append(piece.faces, whole.faces);
  }
  return whole;
}

void DescribeThinned(const HeldPiece& piece, Attempt& attempt) {
  const TriangleMesh mesh = MeshOf(attempt.pieces);
  QualityAccumulator quality;
  double longest2 = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
    quality.Add(a, b, c);
    longest2 = std::max({longest2, SquaredDistance(a, b), SquaredDistance(b, c), SquaredDistance(c, a)});
  }
  uint64_t by_kind[3] = {0, 0, 0};
  for (const TriangleKind kind : piece.kinds) ++by_kind[static_cast<int>(kind)];
  Describe(MeasureTopology(mesh), quality.Report(), by_kind, attempt.front);
  attempt.front.longest_edge = std::sqrt(longest2);
  attempt.front.largest_deviation =
      std::max(attempt.front.largest_deviation, kFarthestPerEdge * attempt.front.longest_edge);
}

}  // namespace

TriangleMesh MeshOf(const std::vector<HeldPiece>& pieces) {
  TriangleMesh mesh;
  for (const HeldPiece& piece : pieces) {
    for (const OutputVertex& v : piece.vertices) mesh.positions.push_back(v.position);
    mesh.triangles.insert(mesh.triangles.end(), piece.triangles.begin(), piece.triangles.end());
  }
  return mesh;
}

void Describe(const TopologyReport& topology, const QualityReport& quality, const uint64_t (&by_kind)[3],
              FrontReport& front) {
  front.vertices = topology.vertices;
  front.triangles = topology.triangles;
  front.free_triangles = by_kind[0];
  front.connection_triangles = by_kind[1];
  front.closing_triangles = by_kind[2];
  front.components = topology.components;
  front.boundary_edges = topology.boundary_edges;
  front.boundary_loops = topology.boundary_loops;
  front.pinched_vertices = 0;
  front.quality = quality;
}

double CountErrorOf(const Attempt& attempt, uint64_t wanted) {
  if (wanted == 0) return 0;
  return std::abs(static_cast<double>(attempt.front.triangles) / static_cast<double>(wanted) - 1);
}

bool HasTooMany(const Attempt& attempt, uint64_t wanted) {
  return wanted > 0 && attempt.front.triangles > wanted && CountErrorOf(attempt, wanted) > kCountPromise;
}

absl::Status ThinToCount(uint64_t wanted, Attempt& attempt, const Context& context) {
  if (attempt.fault_count() > 0) return absl::OkStatus();
  attempt.thinned_from = attempt.front.triangles;
  HeldPiece whole = Joined(attempt.pieces);
  attempt.pieces.clear();
  MESHFRONT_RETURN_IF_ERROR(ThinOut(wanted, whole, context).status());
  attempt.pieces.push_back(std::move(whole));
  DescribeThinned(attempt.pieces[0], attempt);
  return absl::OkStatus();
}

}  // namespace meshfront
