// 1. CheckKind; a mesh is sampled    2. repair: what is no sample goes, and normals that are missing are estimated 3. the surface,
// scaled as meshes are 4. the field    5. a seed in each connected part
#include "core/point_preparation.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/features/rim_loops.h"
#include "core/gap_filling.h"
#include "core/mesh/point_repair.h"
#include "core/preparation_steps.h"
#include "core/sampled_mesh.h"
#include "core/sharp_points.h"
#include "core/surface/implicit_mls_surface.h"
#include "core/surface/mls_surface.h"

namespace meshfront {
namespace {

constexpr int kLeastOfASurface = 12;
// Supports are widened to at most so many spacings.
constexpr double kMostWidened = 16;
// Radius in parts of how far the points lie off the surface: below, its bumps are those of the noise.
constexpr double kRadiusPerNoise = 5;
constexpr int kMostFillings = 3;

absl::Status CheckKind(const Problem& problem) {
  const SurfaceKind kind = problem.options.surface;
  if (kind == SurfaceKind::kMesh) {
    return absl::InvalidArgumentError(absl::StrCat("options.surface is mesh; the input is a point set of ",
                                                   problem.mesh.positions.size(), " points and no triangles"));
  }
  if (problem.region && !problem.mesh.IsPointSet()) {
    return absl::InvalidArgumentError(absl::StrCat("options.region is set and options.surface is ",
                                                   kind == SurfaceKind::kMls ? "mls" : "imls",
                                                   "; a part of a mesh can not yet be remeshed as a point set"));
  }
  if (problem.region) {
    return absl::InvalidArgumentError(
        "options.region is set and the input is a point set; only a part of a mesh can be remeshed alone");
  }
  return absl::OkStatus();
}

std::vector<double> ComponentDiagonals(const MlsSamples& samples) {
  std::vector<Box3> boxes(samples.component_count());
  for (uint32_t i = 0; i < samples.samples().size(); ++i) {
    if (samples.ComponentOf(i) != MlsSamples::kStray)
      boxes[samples.ComponentOf(i)].Extend(samples.samples()[i].position);
  }
  std::vector<double> diagonals;
  for (const Box3& box : boxes) diagonals.push_back(box.Diagonal());
  return diagonals;
}

// The default sees past the noise.
void SetRadius(const PointNoise& noise, Preparation& p) {
  double& radius = p.parameters.options.mls_radius;
  const double wanted = std::min(kMostWidened, kRadiusPerNoise * noise.deviation / noise.spacing);
  if (radius != RemeshOptions().mls_radius || !(wanted > radius)) return;
  p.warnings.push_back(absl::StrCat("the points lie off their surface by about ", noise.deviation, ", ",
                                    noise.deviation / noise.spacing, " spacings: mls_radius is ", wanted,
                                    " instead of ", radius, "; a value other than that is kept"));
  radius = wanted;
}

// Samples of a mesh are as dense as its result wants them, and a mesh that is but a means to sharp edges needs no edges of its own.
MlsWeights WeightsFor(const Preparation& p) {
  const bool is_means = p.most_attempts < Problem().most_attempts;
  return p.input.is_point_set && !is_means ? MlsWeights::kNarrowAtEdges : MlsWeights::kWide;
}

std::shared_ptr<PointSurface> MakeSurface(std::unique_ptr<MlsSamples> samples, SurfaceKind kind) {
  if (kind == SurfaceKind::kMls) return std::make_shared<MlsSurface>(std::move(samples));
  return std::make_shared<ImplicitMlsSurface>(std::move(samples));
}

// Adds samples where gaps are, until there are none but those that stay open. A patch may leave a smaller one.
absl::StatusOr<RimCurves> TraceAndFill(Preparation& p, const Context& context) {
  const SurfaceKind kind = p.parameters.options.surface;
  MESHFRONT_ASSIGN_OR_RETURN(RimCurves rims, TraceRims(*p.points, context));
  if (!p.parameters.options.fill_gaps) return rims;
  const double size = p.parameters.options.fill_gaps->value * p.scale;
  for (int round = 1;; ++round) {
    MESHFRONT_ASSIGN_OR_RETURN(GapSamples gaps, FillGaps(*p.points, rims.curves, size, context));
    p.gaps.left_open = std::move(gaps.left_open);
    if (round > kMostFillings) p.gaps.left_open.insert(p.gaps.left_open.end(), gaps.places.begin(), gaps.places.end());
    if (round > kMostFillings || gaps.places.empty()) return rims;
    MESHFRONT_ASSIGN_OR_RETURN(std::unique_ptr<MlsSamples> samples,
                               p.points->samples().With(gaps.positions, gaps.normals, context));
    p.gaps.filled += gaps.places.size();
    p.points = MakeSurface(std::move(samples), kind);
    MESHFRONT_ASSIGN_OR_RETURN(rims, TraceRims(*p.points, context));
  }
}

absl::Status SetPointSurface(std::unique_ptr<MlsSamples> samples, Preparation& p, const Context& context) {
  p.points = MakeSurface(std::move(samples), p.parameters.options.surface);
  // Rims need the asymmetries that come with the curvatures; but where samples are added, those of the last surface only.
  const bool may_fill = p.parameters.options.fill_gaps.has_value();
  if (!may_fill) MESHFRONT_RETURN_IF_ERROR(p.points->ComputeCurvature(context));
  MESHFRONT_ASSIGN_OR_RETURN(RimCurves rims, TraceAndFill(p, context));
  if (may_fill) MESHFRONT_RETURN_IF_ERROR(p.points->ComputeCurvature(context));
  if (p.input.is_point_set) p.input.topology.components = p.points->samples().component_count();
  p.rims = std::move(rims.curves);
  p.lost_rims = rims.lost;
  p.lost_places = std::move(rims.lost_places);
  if (p.input.is_point_set) p.input.topology.boundary_loops = p.rims.size();
  return absl::OkStatus();
}

void WarnOfMesh(const SharpMesh& sharp, uint64_t triangles, Preparation& p) {
  const std::string what = sharp.curves > 0 ? absl::StrCat("creases were found on the point set: ", sharp.curves,
                                                           " curves that meet at ", sharp.corners, " corners")
                                            : "lines are to be kept on the point set";
  p.warnings.push_back(
      absl::StrCat(what, "; the surface is a mesh of ", triangles, " triangles that was made of the points"));
  if (sharp.blunt_places == 0) return;
  p.warnings.push_back(absl::StrCat("at ", sharp.blunt_places, " places of the creases the pieces of the point ",
                                    "set do not meet; they stay round there"));
}

// Where the points have sharp edges, or lines are to be kept, from a mesh that has them too everything is as for a mesh.
absl::StatusOr<std::optional<Preparation>> PrepareSharpPoints(const TriangleMesh& points, Polylines features,
                                                              Preparation& p, const Context& context) {
  Stopwatch watch;
  const RemeshOptions& options = p.parameters.options;
  const auto is_estimate = [](const RepairAction& action) {
    return action.what == "estimated_normals" || action.what == "replaced_normals";
  };
  const bool are_estimated = std::any_of(p.input.repairs.begin(), p.input.repairs.end(), is_estimate);
  MESHFRONT_ASSIGN_OR_RETURN(
      std::optional<SharpMesh> sharp,
      MeshSharpPoints({points, are_estimated, !features.segments.empty()}, options, p.warnings, context));
  if (!sharp) return std::nullopt;
  const uint64_t triangles = sharp->mesh.triangles.size();
  Problem problem{std::move(sharp->mesh), options};
  problem.features = std::move(features);
  problem.options.surface = SurfaceKind::kMesh;
  problem.options.mls_radius = RemeshOptions().mls_radius;
  problem.options.repair = true;
  if (sharp->curves == 0) problem.options.crease_angle = std::nullopt;  // round edges are none
  const double seconds = watch.Lap();
  MESHFRONT_ASSIGN_OR_RETURN(Preparation made, Prepare(std::move(problem), context));
  made.warnings.insert(made.warnings.begin(), p.warnings.begin(), p.warnings.end());
  WarnOfMesh(*sharp, triangles, made);
  made.input.is_point_set = true;
  made.input.repairs = std::move(p.input.repairs);
  made.input.topology.vertices = points.positions.size();
  made.input.topology.triangles = 0;
  made.parameters.options.surface = options.surface;
  made.parameters.options.mls_radius = options.mls_radius;
  made.parameters.options.repair = options.repair;
  made.seconds.repair += p.seconds.repair + seconds;
  return made;
}

void WarnOfReplacedNormals(const PointRepair& repaired, Preparation& p) {
  const NormalNoise& noise = repaired.normal_noise;
  if (!noise.AreWorseThanPlanes()) return;
  p.warnings.push_back(absl::StrCat("the normals given differ from the planes through the neighbours by ",
                                    noise.from_planes, " degrees (the median), and from their neighbours' by ",
                                    noise.between_given, ", the planes by ", noise.between_planes,
                                    ": only their sides are used; repair = false keeps them"));
}

// Normals that are wrong in the file are turned; those of a plate as thin as its points lie apart are turned as well, and wrongly.
void WarnOfTurnedNormals(const PointRepair& repaired, Preparation& p) {
  for (const RepairAction& action : repaired.actions) {
    if (action.what != "turned_normals") continue;
    p.warnings.push_back(
        absl::StrCat(action.count, " of ", repaired.points.positions.size(),
                     " normals were turned to the side of their neighbours'; where sheets lie as close "
                     "as the points they may be right, and repair = false leaves them"));
  }
}

}  // namespace

bool IsMeshedAsPoints(const Problem& problem) {
  return problem.mesh.IsPointSet() || problem.options.surface == SurfaceKind::kMls ||
         problem.options.surface == SurfaceKind::kImls;
}

absl::StatusOr<Preparation> PreparePoints(Problem problem, const Context& context) {
  MESHFRONT_RETURN_IF_ERROR(CheckKind(problem));
  const RemeshOptions options = problem.options;
  Preparation p;
  p.parameters.options = options;
  p.most_attempts = problem.most_attempts;
  if (options.surface != SurfaceKind::kMls) p.parameters.options.surface = SurfaceKind::kImls;
  p.input.is_point_set = problem.mesh.IsPointSet();
  Stopwatch watch;
  context.Report({Stage::kRepair});
  if (!p.input.is_point_set) {
    MESHFRONT_ASSIGN_OR_RETURN(SampledMesh sampled, SampleAsPoints(std::move(problem), context));
    problem.mesh = std::move(sampled.points);
    p.input = std::move(sampled.input);
    p.warnings = std::move(sampled.warnings);
  }
  const bool may_change = options.repair || !p.input.is_point_set;
  MESHFRONT_ASSIGN_OR_RETURN(PointRepair repaired, RepairPoints(std::move(problem.mesh), may_change, context));
  p.input.repairs.insert(p.input.repairs.end(), repaired.actions.begin(), repaired.actions.end());
  WarnOfReplacedNormals(repaired, p);
  WarnOfTurnedNormals(repaired, p);
  if (repaired.undecided_pairs > 0) {
    p.warnings.push_back(absl::StrCat("normals were estimated or turned; at ", repaired.undecided_pairs,
                                      " pairs of neighbours it is not clear which side of the surface is outside"));
  }
  if (!p.input.is_point_set) {
    if (options.crease_angle != RemeshOptions().crease_angle)
      p.warnings.push_back("crease_angle does nothing where a mesh is meshed as a point set: edges are rounded");
    p.parameters.options.crease_angle = std::nullopt;
  }
  p.parameters.options.attributes = false;
  SetRadius(repaired.noise, p);
  TriangleMesh& points = repaired.points;
  if (p.parameters.options.crease_angle || !problem.features.segments.empty()) {
    MESHFRONT_ASSIGN_OR_RETURN(std::optional<Preparation> sharp,
                               PrepareSharpPoints(points, std::move(problem.features), p, context));
    if (sharp) return *std::move(sharp);
  }
  p.input.diagonal = BoundingBox(points).Diagonal();
  std::optional<Length>& gaps = p.parameters.options.fill_gaps;
  if (gaps && gaps->relative) gaps = Length{gaps->value * p.input.diagonal, false};
  p.scale = ScaleFor(p.input.diagonal);
  if (p.scale != 1) {
    for (Vec3& x : points.positions) x *= p.scale;
  }
  p.seconds.repair = watch.Lap();

  context.Report({Stage::kIndex});
  MESHFRONT_ASSIGN_OR_RETURN(std::unique_ptr<MlsSamples> samples,
                             MlsSamples::Create(points.positions, points.normals, p.parameters.options.mls_radius,
                                                context, repaired.noise.neighbours, WeightsFor(p)));
  if (samples->component_count() == 0) {
    return absl::FailedPreconditionError(absl::StrCat("the ", points.positions.size(),
                                                      " points are no samples of a surface: no ", kLeastOfASurface,
                                                      " of them lie beside each other with normals that agree"));
  }
  if (samples->stray_count() > 0) p.input.repairs.push_back({"ignored_stray_points", samples->stray_count()});
  if (p.input.is_point_set) p.input.topology.vertices = points.positions.size() - samples->stray_count();
  points = {};
  MESHFRONT_RETURN_IF_ERROR(SetClamps(options, ComponentDiagonals(*samples), p));
  p.seconds.index = watch.Lap();

  context.Report({Stage::kCurvature});
  MESHFRONT_RETURN_IF_ERROR(SetPointSurface(std::move(samples), p, context));
  p.seconds.curvature = watch.Lap();

  context.Report({Stage::kGuidance});
  MESHFRONT_RETURN_IF_ERROR(MakeField(p, context));
  p.seconds.guidance = watch.Lap();

  context.Report({Stage::kFeatures});
  SetPointFronts(p);
  p.seconds.features = watch.Lap();
  return p;
}

void SetPointFronts(Preparation& p) {
  p.loops = RimLoops(*p.points, p.rims, *p.field);
  p.seeds.clear();
  const std::vector<SourcePoint> seeds = p.points->Seeds();
  for (uint32_t c = 0; c < seeds.size(); ++c) {
    if (std::none_of(p.rims.begin(), p.rims.end(), [&](const RimCurve& rim) { return rim.component == c; }))
      p.seeds.push_back(seeds[c]);
  }
  p.seeds.insert(p.seeds.end(), p.more_seeds.begin(), p.more_seeds.end());
}

namespace {

// Another surface, with its field and initial fronts.
absl::StatusOr<bool> ReplaceSamples(std::unique_ptr<MlsSamples> samples, std::optional<uint64_t> count, Preparation& p,
                                    const Context& context) {
  p.more_seeds.clear();
  const SizingLimits limits = p.point_builder->limits();
  p.point_builder.reset();
  MESHFRONT_RETURN_IF_ERROR(SetPointSurface(std::move(samples), p, context));
  p.point_builder = std::make_unique<PointFieldBuilder>(*p.points, p.rims, limits);
  MESHFRONT_RETURN_IF_ERROR(PrepareAgain({}, count, p, context));
  return true;
}

}  // namespace

absl::StatusOr<bool> WidenSupports(absl::Span<const Vec3> places, double factor, std::optional<uint64_t> count,
                                   Preparation& p, const Context& context) {
  const MlsSamples& before = p.points->samples();
  factor = std::min(factor, kMostWidened / (p.widened * before.radius()));
  if (factor <= 1) return false;
  MESHFRONT_ASSIGN_OR_RETURN(std::unique_ptr<MlsSamples> samples,
                             before.Widened(places, factor, kMostWidened, context));
  if (samples->component_count() == 0) return false;
  p.widened *= factor;
  return ReplaceSamples(std::move(samples), count, p, context);
}

absl::StatusOr<bool> RoundEdges(absl::Span<const Vec3> places, std::optional<uint64_t> count, Preparation& p,
                                const Context& context) {
  MESHFRONT_ASSIGN_OR_RETURN(std::unique_ptr<MlsSamples> samples, p.points->samples().Rounded(places, context));
  if (!samples || samples->component_count() == 0) return false;
  return ReplaceSamples(std::move(samples), count, p, context);
}

}  // namespace meshfront
