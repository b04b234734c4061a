// MeshSurface::CurvatureSamples: 1. every vertex; 2. points inside long edges and in faces whose sides are all long, with the
// curvature interpolated (input triangles longer than the ideal length under-sample the field, Fig. 3); 3. the distance to the
// other sheet at each vertex.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"
#include "core/surface/curvature_fit.h"
#include "core/surface/mesh_surface.h"
#include "core/surface/sheet_distance.h"

namespace meshfront {
namespace {

constexpr int kMaxPerEdge = 8;
constexpr size_t kCheckEvery = 4096;

// Samples lie at most this many ideal lengths apart. Halfway between two of them g has risen by 1.5 (η − 1) of what it is at
// both. At 1 the samples of a fine remesh outnumber the vertices (igea at rho 0.05: 100 MB) and say nothing that the input does not.
constexpr double kSpacing = 3.0;
// Edges of up to this many ideal lengths, almost all of a scan's, are seen without a root to be one piece.
constexpr double kWhole = 0.999 * kSpacing;

// How many equal pieces an edge is cut into so that each is at most kSpacing ideal lengths.
int Pieces(double length, double ideal_length) {
  if (!(ideal_length > 0)) return kMaxPerEdge + 1;
  return static_cast<int>(std::clamp(std::ceil(length / (kSpacing * ideal_length)), 1.0, kMaxPerEdge + 1.0));
}

// Adds what lies between a mesh's vertices, up to a limit.
class Densifier {
 public:
  Densifier(const TriangleMesh& mesh, absl::Span<const double> curvatures, absl::Span<const double> ideal_lengths,
            absl::Span<const double> sheet_distances, std::vector<CurvatureSample>& samples)
      : mesh_(mesh),
        curvatures_(curvatures),
        ideal_lengths_(ideal_lengths),
        sheet_distances_(sheet_distances),
        samples_(samples),
        limit_(5 * mesh.positions.size() + 200000) {}

  int PiecesOf(VertexId a, VertexId b) const {
    const double ideal_length = std::min(ideal_lengths_[a.index()], ideal_lengths_[b.index()]);
    const double length2 = SquaredDistance(mesh_.PositionAt(a), mesh_.PositionAt(b)), whole = kWhole * ideal_length;
    return length2 <= whole * whole ? 1 : Pieces(std::sqrt(length2), ideal_length);
  }
  void AddEdge(VertexId a, VertexId b, int pieces) {
    for (int i = 1; i < pieces; ++i) Add({a, b, b}, static_cast<double>(i) / pieces, 0);
  }
  // Whether no side of a face is cut, seen at once: true of almost all of a scan's.
  bool IsWhole(const Triangle& t) const {
    const double longest2 = SquaredLongestSide(mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1]), mesh_.PositionAt(t[2]));
    const double whole =
        kWhole * std::min({ideal_lengths_[t[0].index()], ideal_lengths_[t[1].index()], ideal_lengths_[t[2].index()]});
    return longest2 <= whole * whole;
  }
  // Points on a barycentric grid as fine as the least cut of the face's sides, without those on the sides.
  void AddFace(const Triangle& t, int pieces) {
    for (int i = 1; i < pieces; ++i) {
      for (int j = 1; i + j < pieces; ++j) Add(t, static_cast<double>(i) / pieces, static_cast<double>(j) / pieces);
    }
  }

 private:
  void Add(const Triangle& t, double u, double v) {
    if (samples_.size() >= limit_) return;
    const double w = 1 - u - v;
    const uint32_t a = t[0].index(), b = t[1].index(), c = t[2].index();
    samples_.push_back({w * mesh_.positions[a] + u * mesh_.positions[b] + v * mesh_.positions[c],
                        w * curvatures_[a] + u * curvatures_[b] + v * curvatures_[c], SheetDistance(t, u, v), 0});
  }
  double SheetDistance(const Triangle& t, double u, double v) const {
    if (sheet_distances_.empty()) return INFINITY;
    const double a = sheet_distances_[t[0].index()], b = sheet_distances_[t[1].index()],
                 c = sheet_distances_[t[2].index()];
    return std::isfinite(a) && std::isfinite(b) && std::isfinite(c) ? (1 - u - v) * a + u * b + v * c : INFINITY;
  }

  const TriangleMesh& mesh_;
  absl::Span<const double> curvatures_;
  absl::Span<const double> ideal_lengths_;
  absl::Span<const double> sheet_distances_;
  std::vector<CurvatureSample>& samples_;
  size_t limit_;
};

// Over the edges that leave v along its faces.
double MeanEdgeAt(const TriangleMesh& mesh, const FaceAdjacency& adjacency, uint32_t v) {
  double sum = 0;
  int count = 0;
  VisitOutgoing(adjacency, v, [&](uint32_t h) {
    sum += Distance(mesh.positions[v], mesh.PositionAt(TargetOf(mesh, h)));
    ++count;
  });
  return sum / count;
}

}  // namespace

absl::Status MeshSurface::ComputeCurvature(const Context& context) { return ComputeCurvatureOf({}, context); }

absl::Status MeshSurface::ComputeCurvatureOf(const std::vector<bool>& faces, const Context& context) {
  std::vector<bool> wanted(faces.empty() ? 0 : mesh_.positions.size(), false);
  for (size_t f = 0; f < faces.size(); ++f) {
    if (!faces[f]) continue;
    for (const VertexId v : mesh_.triangles[f]) wanted[v.index()] = true;
  }
  std::vector<double> least_lengths;
  for (const double diagonal : whole_diagonals()) least_lengths.push_back(kLeastOfDiagonal * diagonal);
  MESHFRONT_ASSIGN_OR_RETURN(VertexRings rings, CreateVertexRings(mesh_, adjacency_, context));
  rings_ = std::make_shared<const VertexRings>(std::move(rings));
  MESHFRONT_ASSIGN_OR_RETURN(curvatures_, FitMaxCurvatures(mesh_, adjacency_, *rings_, normals_, areas_, context,
                                                           {least_lengths, components_.label}, wanted));
  has_curvature_ = true;
  return absl::OkStatus();
}

absl::StatusOr<std::vector<double>> MeshSurface::SheetDistances(absl::Span<const double> limits,
                                                                const Context& context) const {
  if (whole_) return SheetDistancesInWhole(limits, context);
  return MeasureSheetDistances(mesh_, adjacency_, normals_, limits, context, {whole_opposite_, originals_});
}

absl::StatusOr<std::vector<CurvatureSample>> MeshSurface::CurvatureSamples(
    absl::FunctionRef<double(double max_curvature)> ideal_length, bool with_thickness, const Context& context) const {
  if (!has_curvature_) return absl::FailedPreconditionError("the curvature must be computed before it is sampled");
  std::vector<double> ideal_lengths, limits, distances;
  const double longest = kLongestSheetReachPerDiagonal * BoundingBox(mesh_, adjacency_).Diagonal();
  for (const double curvature : curvatures_) {
    ideal_lengths.push_back(ideal_length(curvature));
    limits.push_back(std::min(kSheetReachPerLength * ideal_lengths.back(), longest));
  }
  if (with_thickness) {
    MESHFRONT_ASSIGN_OR_RETURN(distances, SheetDistances(limits, context));
  }
  return CurvatureSamples(curvatures_, ideal_lengths, distances, context);
}

absl::StatusOr<std::vector<CurvatureSample>> MeshSurface::CurvatureSamples(absl::Span<const double> curvatures,
                                                                           absl::Span<const double> ideal_lengths,
                                                                           absl::Span<const double> sheet_distances,
                                                                           const Context& context) const {
  std::vector<CurvatureSample> samples;
  samples.reserve(mesh_.positions.size() + mesh_.positions.size() / 4);  // with those inside long edges, of a scan
  for (size_t v = 0; v < mesh_.positions.size(); ++v) {
    if (adjacency_.outgoing[v] == kNoHalfEdge) continue;
    const double distance = sheet_distances.empty() ? INFINITY : sheet_distances[v];
    const double edge = std::isfinite(distance) ? MeanEdgeAt(mesh_, adjacency_, static_cast<uint32_t>(v)) : 0;
    samples.push_back({mesh_.positions[v], curvatures[v], distance, edge});
  }
  Densifier densifier(mesh_, curvatures, ideal_lengths, sheet_distances, samples);
  for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
    if (f % kCheckEvery == 0) MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    const Triangle& t = mesh_.triangles[f];
    if (densifier.IsWhole(t)) continue;
    std::array<int, 3> pieces = {0, 0, 0};  // 0: the edge is another face's
    for (int i = 0; i < 3; ++i) {
      const uint32_t across = adjacency_.opposite[f][i];
      if (across != kNoHalfEdge && across <= 3 * f + i) continue;
      const VertexId from = t[i], to = t[i == 2 ? 0 : i + 1];
      pieces[i] = densifier.PiecesOf(from, to);
      densifier.AddEdge(from, to, pieces[i]);
    }
    if (std::find(pieces.begin(), pieces.end(), 1) != pieces.end()) continue;
    for (int i = 0; i < 3; ++i) {
      if (pieces[i] == 0) pieces[i] = densifier.PiecesOf(t[i], t[i == 2 ? 0 : i + 1]);
    }
    densifier.AddFace(t, *std::min_element(pieces.begin(), pieces.end()));
  }
  return samples;
}

}  // namespace meshfront
