// 1. CheckSize       a scale at which squares and fourth powers stay in the range of double
// 2. Mend            repair, or refuse what would need it
// 3. the surface     adjacency, creases, normals, curvature
// 4. MakeField       curvature → the guidance field, at the parameter given or the one that makes the count wanted
// 5. the initial fronts
#include "core/preparation.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/exceptions.h"
#include "core/base/status_macros.h"
#include "core/features/attribute_seams.h"
#include "core/features/boundary.h"
#include "core/features/creases.h"
#include "core/features/line_clipping.h"
#include "core/features/line_insertion.h"
#include "core/features/seams.h"
#include "core/field_builder.h"
#include "core/guidance/sizing.h"
#include "core/mesh/hole_filling.h"
#include "core/mesh/repair_slivers.h"
#include "core/point_preparation.h"
#include "core/preparation_steps.h"
#include "core/prepared_input.h"
#include "core/region_selection.h"

namespace meshfront {
namespace {

// Edges are at least this part of the diagonal of the input and of that of its smallest component.
constexpr double kMinEdgePerDiagonal = 1e-5;
constexpr double kMinEdgePerComponent = 0.01;
// The error bound where it is held constant and not given: 0.1 %.
constexpr double kMaxErrorPerDiagonal = 1e-3;
// Mending slivers moves the surface by at most this part of the diagonal, and of the error bound where one is given.
constexpr double kSliverReachPerDiagonal = 2e-4;
constexpr double kSliverReachPerError = 0.25;
// Outside this range of sizes the input is scaled by a power of two, which changes no significant bit.
constexpr double kMinDiagonal = 1e-30, kMaxDiagonal = 1e30;

// Edges of rims and creases lie within this part of the error bound of the curve: nothing moves or divides them later, and the triangles
// beside them need some of it.
constexpr double kSagittaPerMaxError = 0.9;
// Where a count is wanted the error is what comes of it; but new vertices mend what is far off everywhere but there.
constexpr double kSagittaPerErrorForCount = 3;

// g where the mesh is made again, in parts of what it was.
constexpr double kFinerPerGuidance = 0.5;

}  // namespace

double ScaleFor(double diagonal) {
  if (!(diagonal > 0) || (diagonal >= kMinDiagonal && diagonal <= kMaxDiagonal)) return 1;
  return std::ldexp(1.0, -std::ilogb(diagonal));
}

namespace {

// `components`: set where repair counted them.
absl::Status Mend(TriangleMesh& mesh, const RemeshOptions& options, InputReport& report,
                  std::optional<FaceAdjacency>& adjacency, uint64_t& components, const Context& context) {
  if (!options.repair) return RequireManifold(mesh);
  MESHFRONT_ASSIGN_OR_RETURN(RepairResult repaired, RepairMesh(std::move(mesh), context));
  mesh = std::move(repaired.mesh);
  report.repairs = std::move(repaired.actions);
  adjacency = std::move(repaired.adjacency);
  components = repaired.components;
  return absl::OkStatus();
}

// Closes the holes of a mesh up to the size that is in force from here on.
absl::StatusOr<GapReport> FillGaps(RemeshOptions& options, TriangleMesh& mesh, std::optional<FaceAdjacency>& adjacency,
                                   const Context& context) {
  if (!options.fill_gaps) return GapReport();
  if (!adjacency) adjacency = CreateAdjacency(mesh);
  Length& size = *options.fill_gaps;
  if (size.relative) size = {size.value * BoundingBox(mesh, *adjacency).Diagonal(), false};
  MESHFRONT_ASSIGN_OR_RETURN(FilledHoles holes, FillHoles(size.value, mesh, *adjacency, context));
  return GapReport{holes.filled, std::move(holes.left_open)};
}

double Resolve(const std::optional<Length>& length, double diagonal, double scale, double otherwise) {
  if (!length) return otherwise;
  return length->relative ? length->value * diagonal : length->value * scale;
}

// How far mending slivers may move the surface, scaled like the diagonal.
double SliverReach(const RemeshOptions& options, double diagonal, double scale) {
  const double reach = kSliverReachPerDiagonal * diagonal;
  if (options.sizing != Sizing::kError || !options.max_error) return reach;
  return std::min(reach, kSliverReachPerError * Resolve(options.max_error, diagonal, scale, 0));
}

// The creases; where the input may be repaired, of a mesh whose slivers are mended if they have sides among them, but for `kept` faces.
absl::StatusOr<std::vector<bool>> MendAndFindCreases(TriangleMesh& mesh, FaceAdjacency& adjacency,
                                                     const RemeshOptions& options, double reach,
                                                     const std::vector<bool>& kept, std::vector<RepairAction>& repairs,
                                                     const Context& context) {
  const double angle = *options.crease_angle * std::numbers::pi / 180;
  MESHFRONT_ASSIGN_OR_RETURN(std::vector<bool> creases, FindCreases(mesh, adjacency, angle, context));
  if (!options.repair) return creases;
  const SliverChanges changes = MendSlivers(mesh, adjacency, creases, reach, kept);
  if (changes.flipped_caps > 0) repairs.push_back({"flipped_caps", changes.flipped_caps});
  if (changes.collapsed_needles > 0) repairs.push_back({"collapsed_needles", changes.collapsed_needles});
  if (!changes.any()) return creases;
  return FindCreases(mesh, adjacency, angle, context);
}

// Where only a region is meshed: its part of the lines. Says which of them are not in force.
LineLimits ClipToRegion(const TriangleMesh& around, const std::vector<bool>& beside, Polylines& features,
                        Preparation& p) {
  LineLimits limits{p.input.diagonal * p.scale, beside, {}};
  std::vector<bool> chosen = beside;
  chosen.flip();
  ClippedLines clipped = ClipPolylines(features, around, chosen, limits.diagonal);
  p.parameters.feature_segments = 0;
  for (size_t i = 0; i < clipped.origins.size(); ++i)
    p.parameters.feature_segments += i == 0 || clipped.origins[i] != clipped.origins[i - 1];
  if (!clipped.cut.empty()) {
    const Vec3 first = features.points[features.segments[clipped.cut.front()][0]] / p.scale;
    p.warnings.push_back(absl::StrCat(clipped.cut.size(), " of ", features.segments.size(),
                                      " segments of options.features lie, wholly or in part, outside of "
                                      "options.region or on faces at its border, and are not in force there; the "
                                      "first, segments[",
                                      clipped.cut.front(), "], begins at ", first.x, ", ", first.y, ", ", first.z));
  }
  features = std::move(clipped.lines);
  limits.origins = std::move(clipped.origins);
  return limits;
}

// Behind the mending of slivers, which would turn the edges of lines. `beside`: faces outside of the region.
absl::Status InsertFeatures(Polylines features, const std::vector<bool>& beside, TriangleMesh& mesh,
                            FaceAdjacency& adjacency, std::vector<bool>& creases, Preparation& p,
                            const Context& context) {
  if (features.segments.empty()) return absl::OkStatus();
  p.parameters.feature_segments = features.segments.size();
  for (Vec3& point : features.points) point *= p.scale;
  const LineLimits limits = p.region ? ClipToRegion(mesh, beside, features, p) : LineLimits();
  MESHFRONT_ASSIGN_OR_RETURN(const InsertedLines inserted,
                             InsertPolylines(features, mesh, adjacency, creases, context, limits));
  if (inserted.split_faces > 0) p.input.repairs.push_back({"split_faces_along_features", inserted.split_faces});
  if (inserted.moved_points > 0) p.input.repairs.push_back({"moved_feature_points", inserted.moved_points});
  return absl::OkStatus();
}

// Repair leaves seams where it took faces apart or moved them; not where it only dropped what no face has, or turned components.
bool MayHaveSeams(const std::vector<RepairAction>& repairs) {
  return std::any_of(repairs.begin(), repairs.end(), [](const RepairAction& action) {
    return action.what != "unreferenced_vertices" && action.what != "reversed_components";
  });
}

// Mends the scaled input and finds its creases; the surface is cut open along them.
absl::StatusOr<std::unique_ptr<MeshSurface>> MakeSurface(TriangleMesh mesh, std::optional<FaceAdjacency> adjacency,
                                                         Polylines features, Preparation& p, const Context& context) {
  const RemeshOptions options = p.parameters.options;
  if (!options.crease_angle && mesh.attributes.empty() && features.segments.empty() && !p.region)
    return MeshSurface::Create(std::move(mesh), std::move(adjacency), context);
  if (!adjacency) adjacency = FindOrientedAdjacency(mesh);
  if (!adjacency) return absl::InvalidArgumentError("the mesh is not an oriented manifold; repair it first");
  const double reach = SliverReach(options, p.input.diagonal * p.scale, p.scale);
  std::vector<bool> kept = p.region ? FacesBesideRegion(mesh, *p.region) : std::vector<bool>();
  const size_t repairs = p.input.repairs.size();
  std::vector<bool> creases(3 * mesh.triangles.size());
  if (options.crease_angle) {
    MESHFRONT_ASSIGN_OR_RETURN(creases,
                               MendAndFindCreases(mesh, *adjacency, options, reach, kept, p.input.repairs, context));
  }
  if (p.region) kept = FacesBesideRegion(mesh, *p.region);  // mending drops faces
  MESHFRONT_RETURN_IF_ERROR(InsertFeatures(std::move(features), kept, mesh, *adjacency, creases, p, context));
  if (!mesh.attributes.empty()) p.has_flat_normals = MarkAttributeSeams(mesh, *adjacency, creases);
  if (MayHaveSeams(p.input.repairs)) MarkSeams(mesh, *adjacency, creases);
  const bool is_mended = p.input.repairs.size() > repairs;
  if (p.region) NameSurroundings(mesh, p.scale, *p.region);
  if (is_mended && !p.region) p.input.topology = MeasureTopology(mesh, *adjacency);
  p.attributes = std::exchange(mesh.attributes, {});
  return MeshSurface::Create(std::move(mesh), *std::move(adjacency), creases, context);
}

}  // namespace

absl::Status SetClamps(const RemeshOptions& options, absl::Span<const double> component_diagonals, Preparation& p) {
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

namespace {

// The sizing's one parameter, absolute and in the surface's scale.
double ParameterOf(const RemeshOptions& options, const Preparation& p) {
  const double diagonal = p.input.diagonal * p.scale;
  switch (options.sizing) {
    case Sizing::kError:
      return Resolve(options.max_error, diagonal, p.scale, kMaxErrorPerDiagonal * diagonal);
    case Sizing::kUniform:
      return Resolve(options.edge_length, diagonal, p.scale, 0);
    case Sizing::kAngle:
    case Sizing::kThickness:
      break;
  }
  return options.rho;
}

// Says in the options in force what the parameter is, in the input's scale.
void SetParameter(double parameter, const Preparation& p, RemeshOptions& options) {
  if (options.sizing == Sizing::kAngle || options.sizing == Sizing::kThickness) options.rho = parameter;
  if (options.sizing == Sizing::kError) options.max_error = Length{parameter / p.scale, false};
  if (options.sizing == Sizing::kUniform) options.edge_length = Length{parameter / p.scale, false};
}

// The field at the parameter that is in force, or for a number of triangles.
absl::Status SetField(const std::optional<uint64_t>& count, Preparation& p, const Context& context) {
  const auto build = [&](auto& builder) {
    return count ? builder.BuildForCount(*count, context) : builder.Build(p.parameter, context);
  };
  absl::StatusOr<SizedField> sized = p.point_builder ? build(*p.point_builder) : build(*p.builder);
  if (!sized.ok()) return sized.status();
  p.parameter = sized->parameter;
  p.predicted_triangles = sized->predicted_triangles;
  p.is_least_count = sized->is_least;
  p.parameters.clamped_samples = sized->clamped_samples;
  p.parameters.detail = sized->detail / p.scale;
  if (sized->longest > 0) p.parameters.max_edge = std::min(p.parameters.max_edge, sized->longest);
  SetParameter(p.parameter, p, p.parameters.options);
  p.field = std::move(sized->field);
  return absl::OkStatus();
}

}  // namespace

absl::Status MakeField(Preparation& p, const Context& context) {
  RemeshOptions& options = p.parameters.options;
  const SizingLimits limits{options.sizing,
                            options.eta,
                            p.parameters.min_edge,
                            p.parameters.max_edge,
                            options.max_edge.has_value(),
                            p.region ? p.input.diagonal * p.scale : 0,
                            p.region ? &*p.region->blend : nullptr};
  if (p.points)
    p.point_builder = std::make_unique<PointFieldBuilder>(*p.points, p.rims, limits);
  else
    p.builder = std::make_shared<FieldBuilder>(*p.surface, limits);
  const std::optional<uint64_t> count = std::exchange(options.target_triangles, std::nullopt);
  p.parameters.target_triangles = count.value_or(0);
  if (!count) p.parameter = ParameterOf(options, p);
  return SetField(count, p, context);
}

namespace {

// How far from a region another sheet matters.
double ReachAround(const RemeshOptions& options, double diagonal) {
  return diagonal *
         (options.sizing == Sizing::kThickness ? kLongestThicknessPerDiagonal : kLongestSheetReachPerDiagonal);
}

RegionReport ReportEverything(const Region& region, const PreparedInput& input) {
  RegionReport report;
  report.replaced_triangles = input.mesh().triangles.size();
  if (region.patch_only) report.removed_faces.resize(input.input_triangles());
  std::iota(report.removed_faces.begin(), report.removed_faces.end(), 0u);
  return report;
}

// The mesh is what surrounds the region from here on. Not where that is all of the mesh: p.everything is set then.
absl::Status ChooseRegion(const Region& region, const std::vector<bool>& left,
                          std::shared_ptr<const PreparedInput> input, TriangleMesh& mesh,
                          std::optional<FaceAdjacency>& adjacency, Preparation& p) {
  p.input.topology = input->topology();
  p.input.repairs = input->repairs();
  p.input.diagonal = input->diagonal();
  p.scale = ScaleFor(p.input.diagonal);
  auto parts = std::make_unique<RegionParts>();
  MESHFRONT_ASSIGN_OR_RETURN(parts->chosen_faces, SelectFaces(input->mesh(), region, input->input_triangles()));
  std::erase_if(parts->chosen_faces, [&](uint32_t f) { return f < left.size() && left[f]; });
  parts->report.replaced_triangles = parts->chosen_faces.size();
  parts->report.kept_triangles = input->mesh().triangles.size() - parts->chosen_faces.size();
  if (parts->report.kept_triangles == 0) {
    p.everything = ReportEverything(region, *input);
    return absl::OkStatus();
  }
  parts->keeps_attributes = p.parameters.options.attributes && !input->mesh().attributes.empty();
  parts->patch_only = region.patch_only;
  parts->chosen.resize(input->mesh().triangles.size());
  for (const uint32_t f : parts->chosen_faces) parts->chosen[f] = true;
  parts->input = std::move(input);
  CompareWithInput(*parts);
  mesh = CutOutSurroundings(ReachAround(p.parameters.options, p.input.diagonal), *parts);
  adjacency = CreateAdjacency(mesh);
  p.region = std::move(parts);
  return absl::OkStatus();
}

// `components`: 0 where they are not counted yet.
void MeasureInput(const TriangleMesh& mesh, const std::optional<FaceAdjacency>& adjacency, uint64_t components,
                  Preparation& p) {
  p.input.topology = !adjacency       ? MeasureTopology(mesh)
                     : components > 0 ? MeasureTopology(mesh, *adjacency, components)
                                      : MeasureTopology(mesh, *adjacency);
  p.input.diagonal = (adjacency ? BoundingBox(mesh, *adjacency) : BoundingBox(mesh)).Diagonal();
  p.scale = ScaleFor(p.input.diagonal);
}

// What the region begins with: made before, unless by another rule, or now.
absl::StatusOr<std::shared_ptr<const PreparedInput>> PreparedInputOf(Problem& problem, const Context& context) {
  const bool repair = problem.options.repair;
  if (!problem.prepared) return PreparedInput::Create(std::move(problem.mesh), repair, context);
  if (problem.prepared->repair() == repair) return problem.prepared;
  return PreparedInput::Create(problem.prepared->Input(), repair, context);
}

// Repairs the problem's mesh, measures and scales it, or the part of it that the region needs.
absl::Status MendAndChoose(Problem& problem, const std::vector<bool>& left, Preparation& p,
                           std::optional<FaceAdjacency>& adjacency, const Context& context) {
  TriangleMesh& mesh = problem.mesh;
  if (problem.region) {
    MESHFRONT_RETURN_IF_ERROR(ValidateRegion(*problem.region));
    MESHFRONT_ASSIGN_OR_RETURN(problem.prepared, PreparedInputOf(problem, context));
    MESHFRONT_RETURN_IF_ERROR(ChooseRegion(*problem.region, left, problem.prepared, mesh, adjacency, p));
  }
  if (!p.region) {  // also where all of the mesh was asked for
    if (problem.prepared) mesh = problem.prepared->Input();
    if (!p.parameters.options.attributes) mesh.attributes = {};
    uint64_t components = 0;
    MESHFRONT_RETURN_IF_ERROR(Mend(mesh, p.parameters.options, p.input, adjacency, components, context));
    MESHFRONT_ASSIGN_OR_RETURN(p.gaps, FillGaps(p.parameters.options, mesh, adjacency, context));
    if (p.gaps.filled > 0) components = 0;
    MeasureInput(mesh, adjacency, components, p);
  }
  if (p.scale != 1) {
    for (Vec3& x : mesh.positions) x *= p.scale;
  }
  return absl::OkStatus();
}

// … of what surrounds the region, where there is one; its surface takes its place.
absl::Status MeasureCurvature(Preparation& p, const Context& context) {
  if (!p.region) return p.surface->ComputeCurvature(context);
  RegionParts& parts = *p.region;
  p.surface->SetWholeDiagonals([&](FaceId f) { return p.scale * parts.diagonals[f.index()]; });
  MESHFRONT_RETURN_IF_ERROR(p.surface->ComputeCurvatureOf(parts.around_chosen, context));
  parts.around = std::move(p.surface);
  p.surface = CutOutRegion(parts);
  p.attributes = AttributesOfRegion(parts, std::move(p.attributes));
  const RemeshOptions& options = p.parameters.options;
  MESHFRONT_ASSIGN_OR_RETURN(parts.blend, RegionBlend::Create(*p.surface, options.blend, options.eta, context));
  return absl::OkStatus();
}

// The largest g at some thousand vertices, evenly spread: about the longest edge.
double LongestIdealLength(const Preparation& p) {
  constexpr size_t samples = 1024;
  const std::vector<Vec3>& positions = p.surface->mesh().positions;
  const size_t stride = std::max<size_t>(1, positions.size() / samples);
  double longest = 0;
  for (size_t v = 0; v < positions.size(); v += stride) longest = std::max(longest, p.field->At(positions[v]));
  return longest;
}

// Rims keep eq. 7, the bound that is reported of the surface.
SagittaLimits SagittaLimitsOf(const Preparation& p) {
  SagittaLimits limits;
  const Sizing sizing = p.parameters.options.sizing;
  if (sizing == Sizing::kError)
    limits.any = (p.parameters.target_triangles == 0 ? kSagittaPerMaxError : kSagittaPerErrorForCount) * p.parameter;
  const bool by_angle = sizing == Sizing::kAngle || sizing == Sizing::kThickness;
  if (by_angle && p.input.topology.boundary_loops > 0) limits.rim = ErrorPerLength(p.parameter) * LongestIdealLength(p);
  return limits;
}

}  // namespace

void AddGaps(const GapReport& gaps, std::vector<RepairAction>& repairs) {
  for (const auto& [what, count] :
       {std::pair{"filled_gaps", gaps.filled}, {"gaps_left_open", uint64_t{gaps.left_open.size()}}}) {
    if (count > 0) repairs.push_back({what, count});
  }
}

double Preparation::PeakCurvature() const {
  if (points) return point_builder->peak_curvature();
  const auto curvatures = surface->vertex_curvatures();
  return curvatures.empty() ? 0 : *std::max_element(curvatures.begin(), curvatures.end());
}

Box3 Preparation::Box() const {
  return points ? points->samples().box() : BoundingBox(surface->mesh(), surface->adjacency());
}

double ErrorBoundInForce(const Preparation& p, double length, double max_curvature) {
  switch (p.parameters.options.sizing) {
    case Sizing::kError:  // unless edges may not be so short
      return std::max(p.parameter, ErrorBound(std::min(length, p.parameters.min_edge), max_curvature));
    case Sizing::kUniform:
      return ErrorBound(length, max_curvature);
    case Sizing::kAngle:
    case Sizing::kThickness:
      break;
  }
  return length * ErrorPerLength(p.parameters.options.rho);
}

absl::StatusOr<RepairResult> RepairInput(TriangleMesh mesh, const RemeshOptions& options, const Context& context) try {
  MESHFRONT_ASSIGN_OR_RETURN(RepairResult result, RepairMesh(std::move(mesh), context));
  std::optional<FaceAdjacency> adjacency = std::move(result.adjacency);
  RemeshOptions in_force = options;
  MESHFRONT_ASSIGN_OR_RETURN(const GapReport gaps, FillGaps(in_force, result.mesh, adjacency, context));
  AddGaps(gaps, result.actions);
  result.adjacency = *std::move(adjacency);
  if (!options.repair || !options.crease_angle) return result;
  const double diagonal = BoundingBox(result.mesh).Diagonal(), scale = ScaleFor(diagonal);
  const auto multiply = [&](double factor) {
    for (Vec3& x : result.mesh.positions) x *= factor;
  };
  if (scale != 1) multiply(scale);
  MESHFRONT_RETURN_IF_ERROR(MendAndFindCreases(result.mesh, result.adjacency, options,
                                               SliverReach(options, diagonal * scale, scale), {}, result.actions,
                                               context)
                                .status());
  if (scale != 1) multiply(1 / scale);
  return result;
} catch (const std::exception&) {
  return StatusOfException();
}

absl::StatusOr<RepairResult> RepairInputOfRegion(TriangleMesh mesh, const Context& context) try {
  return RepairMeshAsOriented(std::move(mesh), context);
} catch (const std::exception&) {
  return StatusOfException();
}

namespace {

absl::Status SetLoops(Preparation& p, const Context& context) {
  if (p.points) {
    SetPointFronts(p);
    return absl::OkStatus();
  }
  MESHFRONT_ASSIGN_OR_RETURN(p.loops, BoundaryLoops(*p.surface, *p.field, SagittaLimitsOf(p), context));
  return absl::OkStatus();
}

absl::Status CheckFeatures(const Problem& problem) {
  if (problem.features.segments.empty()) return absl::OkStatus();
  if (!problem.prepared && !problem.mesh.IsPointSet() && IsMeshedAsPoints(problem)) {
    return absl::InvalidArgumentError(
        "options.features is set beside options.surface, which makes samples of the mesh; leave options.surface out to "
        "keep "
        "lines");
  }
  return ValidatePolylines(problem.features);
}

}  // namespace

absl::StatusOr<Preparation> Prepare(Problem problem, const Context& context, const std::vector<bool>& left) {
  MESHFRONT_RETURN_IF_ERROR(ValidateOptions(problem.options));
  const bool needs_mesh =
      !problem.region || problem.options.surface == SurfaceKind::kMls || problem.options.surface == SurfaceKind::kImls;
  if (problem.prepared && needs_mesh) problem.mesh = std::exchange(problem.prepared, nullptr)->Input();
  if (!problem.options.lod_rhos.empty()) {
    if (problem.region) {
      return absl::InvalidArgumentError("options.region is set beside options.lod_rhos; they exclude one another");
    }
    problem.options.rho = std::exchange(problem.options.lod_rhos, {}).front();
  }
  MESHFRONT_RETURN_IF_ERROR(CheckFeatures(problem));
  if (problem.region && problem.options.fill_gaps)
    return absl::InvalidArgumentError("options.fill_gaps is set beside options.region; they exclude one another");
  if (!problem.prepared && IsMeshedAsPoints(problem)) return PreparePoints(std::move(problem), context);
  const RemeshOptions options = problem.options;
  Preparation p;
  p.parameters.options = options;
  Stopwatch watch;
  if (options.mls_radius != RemeshOptions().mls_radius)
    p.warnings.push_back("mls_radius does nothing on a mesh, unless surface is imls or mls");
  if (!options.attributes) problem.mesh.attributes = {};
  MESHFRONT_RETURN_IF_ERROR(ValidateAttributes(problem.mesh.attributes, problem.mesh.triangles.size()));
  context.Report({Stage::kRepair});
  std::optional<FaceAdjacency> adjacency;  // where the repair has it
  MESHFRONT_RETURN_IF_ERROR(MendAndChoose(problem, left, p, adjacency, context));
  p.seconds.repair = watch.Lap();

  context.Report({Stage::kIndex});
  MESHFRONT_ASSIGN_OR_RETURN(
      p.surface, MakeSurface(std::move(problem.mesh), std::move(adjacency), std::move(problem.features), p, context));
  p.seconds.index = watch.Lap();

  context.Report({Stage::kCurvature});
  MESHFRONT_RETURN_IF_ERROR(MeasureCurvature(p, context));
  MESHFRONT_RETURN_IF_ERROR(SetClamps(options, p.surface->whole_diagonals(), p));
  p.seconds.curvature = watch.Lap();

  context.Report({Stage::kGuidance});
  MESHFRONT_RETURN_IF_ERROR(MakeField(p, context));
  p.seconds.guidance = watch.Lap();

  context.Report({Stage::kFeatures});
  MESHFRONT_RETURN_IF_ERROR(SetLoops(p, context));
  p.seeds = p.surface->Seeds();
  p.seconds.features = watch.Lap();
  return p;
}

absl::Status PrepareAgain(absl::Span<const Vec3> finer_at, std::optional<uint64_t> count, Preparation& p,
                          const Context& context) {
  for (const Vec3& place : finer_at) {
    const SizingSample sample{place, kFinerPerGuidance * p.parameters.options.eta * p.field->At(place)};
    p.points ? p.point_builder->AddSample(sample) : p.builder->AddSample(sample);
  }
  MESHFRONT_RETURN_IF_ERROR(SetField(count, p, context));
  return SetLoops(p, context);
}

absl::Status LevelStart::Prepare(double rho, Preparation& p, const Context& context) const {
  Stopwatch watch;
  p.input = input_, p.parameters = parameters_;
  p.surface = surface_, p.builder = builder_, p.seeds = seeds_;
  p.lost_rims = lost_rims_, p.lost_places = lost_places_, p.gaps = gaps_, p.widened = 1;
  p.more_seeds.clear();
  if (points_) {
    const SizingLimits limits = p.point_builder->limits();
    p.point_builder.reset();  // it refers to what goes now
    p.points = points_, p.rims = rims_;
    p.point_builder = std::make_unique<PointFieldBuilder>(*p.points, p.rims, limits);
  } else {
    p.builder->ClearAddedSamples();
  }
  p.parameter = p.parameters.options.rho = rho;
  p.seconds = {};
  context.Report({Stage::kGuidance});
  MESHFRONT_RETURN_IF_ERROR(SetField(std::nullopt, p, context));
  p.seconds.guidance = watch.Lap();
  context.Report({Stage::kFeatures});
  MESHFRONT_RETURN_IF_ERROR(SetLoops(p, context));
  p.seconds.features = watch.Lap();
  return absl::OkStatus();
}

}  // namespace meshfront
