// 1. CheckSize       a scale at which squares and fourth powers stay in the range of double
// 2. Mend            repair, or refuse what would need it
// 3. the surface     adjacency, normals, curvature
// 4. SizeSamples     curvature → ideal lengths, bounded by thickness, by the component's size and by the clamps
// 5. the field, the initial fronts, the predicted count
#include "core/preparation.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/features/boundary.h"
#include "core/guidance/prediction.h"
#include "core/guidance/sizing.h"

namespace meshfront {
namespace {

// Edges of a component are at most this part of its box's diagonal: a tetrahedron's worth.
constexpr double kMaxEdgePerComponent = 0.25;
// Edges are at least this part of the diagonal of the input and of that of its smallest component.
constexpr double kMinEdgePerDiagonal = 1e-5;
constexpr double kMinEdgePerComponent = 0.01;
// Twice the fence height stays below the distance to the other sheet: h = 2ε, so ε is at most a quarter of it.
constexpr double kErrorPerSheetDistance = 0.25;
// Outside this range of sizes the input is scaled by a power of two, which changes no significant bit.
constexpr double kMinDiagonal = 1e-30, kMaxDiagonal = 1e30;

class Stopwatch {
 public:
  double Lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

double ScaleFor(double diagonal) {
  if (!(diagonal > 0) || (diagonal >= kMinDiagonal && diagonal <= kMaxDiagonal)) return 1;
  return std::ldexp(1.0, -std::ilogb(diagonal));
}

absl::Status Mend(TriangleMesh& mesh, bool repair, InputReport& report, std::optional<FaceAdjacency>& adjacency,
                  const Context& context) {
  if (mesh.triangles.empty()) {
    return absl::FailedPreconditionError(
        absl::StrCat("the input is a point set (", mesh.positions.size(),
                     " points and no triangles); meshing point sets is not supported yet"));
  }
  if (!repair) return RequireManifold(mesh);
  MESHFRONT_ASSIGN_OR_RETURN(RepairResult repaired, RepairMesh(std::move(mesh), context));
  mesh = std::move(repaired.mesh);
  report.repairs = std::move(repaired.actions);
  adjacency = std::move(repaired.adjacency);
  return absl::OkStatus();
}

std::vector<double> ComponentDiagonals(const MeshSurface& surface) {
  std::vector<Box3> boxes(surface.component_count());
  const TriangleMesh& mesh = surface.mesh();
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    for (const VertexId v : mesh.triangles[f]) boxes[surface.ComponentOf(FaceId(f))].Extend(mesh.PositionAt(v));
  }
  std::vector<double> diagonals;
  for (const Box3& box : boxes) diagonals.push_back(box.Diagonal());
  return diagonals;
}

double Resolve(const std::optional<Length>& length, double diagonal, double scale, double otherwise) {
  if (!length) return otherwise;
  return length->relative ? length->value * diagonal : length->value * scale;
}

// The ideal length at a curvature before thickness and clamps.
double IdealLengthFor(const RemeshOptions& options, double edge_length, double max_curvature) {
  // Uniform means g ≡ L, and g is l/η at a sample (eq. 5).
  return options.sizing == Sizing::kUniform ? edge_length * options.eta : IdealLength(options.rho, max_curvature);
}

absl::Status SetClamps(const RemeshOptions& options, const std::vector<double>& component_diagonals, Preparation& p) {
  const double diagonal = p.input.diagonal * p.scale;
  const double smallest = *std::min_element(component_diagonals.begin(), component_diagonals.end());
  const double largest = *std::max_element(component_diagonals.begin(), component_diagonals.end());
  const double least = std::min(kMinEdgePerDiagonal * diagonal, kMinEdgePerComponent * smallest);
  p.parameters.min_edge = Resolve(options.min_edge, diagonal, p.scale, least);
  p.parameters.max_edge = Resolve(options.max_edge, diagonal, p.scale, kMaxEdgePerComponent * largest);
  if (options.min_edge && !options.max_edge)
    p.parameters.max_edge = std::max(p.parameters.max_edge, p.parameters.min_edge);
  if (p.parameters.min_edge > p.parameters.max_edge) {
    return absl::InvalidArgumentError(absl::StrCat("options.min_edge is ", p.parameters.min_edge / p.scale,
                                                   "; it must not exceed the longest edge, ",
                                                   p.parameters.max_edge / p.scale));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<SizingSample>> SizeSamples(const RemeshOptions& options, double edge_length,
                                                      const std::vector<double>& component_diagonals, Preparation& p,
                                                      const Context& context) {
  const MeshSurface& surface = *p.surface;
  const auto ideal_length = [&](double max_curvature) {
    return std::clamp(IdealLengthFor(options, edge_length, max_curvature), p.parameters.min_edge,
                      p.parameters.max_edge);
  };
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<CurvatureSample> places,
                             surface.CurvatureSamples(ideal_length, true, context));
  std::vector<double> longest(surface.mesh().positions.size(), 0);
  for (uint32_t f = 0; f < surface.mesh().triangles.size(); ++f) {
    for (const VertexId v : surface.mesh().triangles[f]) {
      longest[v.index()] = kMaxEdgePerComponent * component_diagonals[surface.ComponentOf(FaceId(f))];
    }
  }
  std::vector<SizingSample> samples;
  samples.reserve(places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    const CurvatureSample& place = places[i];
    const double wanted = IdealLengthFor(options, edge_length, place.max_curvature);
    double length =
        std::min(wanted, LengthForError(kErrorPerSheetDistance * place.sheet_distance, place.max_curvature));
    if (i < longest.size() && !options.max_edge && options.sizing != Sizing::kUniform)
      length = std::min(length, longest[i]);
    length = std::clamp(length, p.parameters.min_edge, p.parameters.max_edge);
    p.parameters.clamped_samples += std::isfinite(wanted) && length != wanted;
    samples.push_back({place.position, length});
  }
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<SizingSample> rim,
                             BoundarySizingSamples(surface, ideal_length, context));
  samples.insert(samples.end(), rim.begin(), rim.end());
  return samples;
}

}  // namespace

double ErrorBoundInForce(const ParametersInForce& parameters, double length, double max_curvature) {
  if (parameters.options.sizing == Sizing::kUniform) return ErrorBound(length, max_curvature);
  return length * ErrorPerLength(parameters.options.rho);
}

absl::StatusOr<Preparation> Prepare(Problem problem, const Context& context) {
  MESHFRONT_RETURN_IF_ERROR(ValidateOptions(problem.options));
  const RemeshOptions& options = problem.options;
  Preparation p;
  p.parameters.options = options;
  Stopwatch watch;
  p.input.is_point_set = problem.mesh.IsPointSet();
  context.Report({Stage::kRepair});
  std::optional<FaceAdjacency> adjacency;  // where the repair has it
  MESHFRONT_RETURN_IF_ERROR(Mend(problem.mesh, options.repair, p.input, adjacency, context));
  p.input.topology = adjacency ? MeasureTopology(problem.mesh, *adjacency) : MeasureTopology(problem.mesh);
  p.input.diagonal = BoundingBox(problem.mesh).Diagonal();
  p.scale = ScaleFor(p.input.diagonal);
  if (p.scale != 1) {
    for (Vec3& x : problem.mesh.positions) x *= p.scale;
  }
  p.seconds.repair = watch.Lap();

  context.Report({Stage::kIndex});
  MESHFRONT_ASSIGN_OR_RETURN(p.surface, MeshSurface::Create(std::move(problem.mesh), std::move(adjacency), context));
  const std::vector<double> component_diagonals = ComponentDiagonals(*p.surface);
  MESHFRONT_RETURN_IF_ERROR(SetClamps(options, component_diagonals, p));
  p.seconds.index = watch.Lap();

  context.Report({Stage::kCurvature});
  MESHFRONT_RETURN_IF_ERROR(p.surface->ComputeCurvature(context));
  p.seconds.curvature = watch.Lap();

  context.Report({Stage::kGuidance});
  const double edge_length = Resolve(options.edge_length, p.input.diagonal * p.scale, p.scale, 0);
  MESHFRONT_ASSIGN_OR_RETURN(std::vector<SizingSample> samples,
                             SizeSamples(options, edge_length, component_diagonals, p, context));
  const GuidanceOptions field_options{options.eta, p.parameters.min_edge, p.parameters.max_edge};
  MESHFRONT_ASSIGN_OR_RETURN(p.field, GuidanceField::Create(std::move(samples), field_options, context));
  const FaceSpans faces{p.surface->mesh().positions, p.surface->mesh().triangles};
  MESHFRONT_ASSIGN_OR_RETURN(p.predicted_triangles, PredictTriangles(faces, *p.field, context));
  p.seconds.guidance = watch.Lap();

  context.Report({Stage::kFeatures});
  MESHFRONT_ASSIGN_OR_RETURN(p.loops, BoundaryLoops(*p.surface, *p.field, context));
  p.seeds = p.surface->Seeds();
  p.seconds.features = watch.Lap();
  return p;
}

}  // namespace meshfront
