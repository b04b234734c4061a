// Build: 1. thickness, where it was not measured for edges as long (MeasureThickness), and the widths of patches (MeasureWidths);
// 2. curvature → ideal lengths, bounded by thickness and width, by the component's size and by the clamps (Samples); 3. the field
// and its predicted count.
// BuildForCount: 1. a field at the parameter that the curvature alone suggests (FirstGuess), without thickness (Sketch); 2. with its
// samples and a part of the faces a secant on (log parameter, log count), which the paper's scaling makes almost a line (FindNear);
// 3. a field there, and its count over the whole surface; 4. the secant goes on with fields near by, whose counts are compared on
// the part (BuildNear). Where the parameter's range ends with too many triangles, detail below a growing size is left out; where it
// ends with too few, as on flat parts, whose curvature asks for nothing, edges are kept below a falling length.
// Rejected: bisection, which builds ten fields for the same.
#include "core/field_builder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/features/boundary.h"
#include "core/geometry/triangle.h"
#include "core/guidance/count_search.h"
#include "core/guidance/prediction.h"
#include "core/guidance/sizing.h"

namespace meshfront {
namespace {

// Twice the fence height stays below the distance to the other sheet: h = 2ε, so ε is at most a quarter of it.
constexpr double kErrorPerSheetDistance = 0.25;
// … but an edge needs to be no shorter for it than this part of the input's: those keep the sheets apart as well, or they meet.
constexpr double kLeastPerInputEdge = 0.5;
// On a strip g is at most so many of its widths: triangles between two rows of points that far apart have 2r/R of 0.6 and more. At 1.7
// it is 0.75, with a quarter more triangles; at 2.5, 0.6 and up to a tenth fewer …
constexpr double kEdgePerWidth = 2.25;
// … where that is at least this part of what else is wanted there. Narrower strips matter the less the narrower they are: edges as short
// as their widths would be thousands, and somewhat longer ones make needles anyway.
constexpr double kLeastForWidth = 1.0 / 16;
// No edge is sized by a strip narrower than this part of its component's diagonal, nor by a wall thinner than this part of the whole:
// it is not seen, but would be the finest place of the mesh, as where a wedge ends.
constexpr double kNarrowestWidth = 2e-3;
constexpr double kCountTolerance = 0.004;  // an eighth of what is promised of the real count
constexpr double kReachable = 0.01;  // farther from the count than this the end of the range is tried otherwise …
constexpr double kRefusable = 0.03;  // … and than this it is refused: what is promised of a count
constexpr int kMaxSteps = 24;
constexpr int kMaxProbeSteps = 8;
constexpr double kProbeTolerance = 0.01;  // counts on a part of the faces are off by more
constexpr size_t kProbeFaces = 2048;
constexpr double kMostProbeRows = 8;  // of parts of a face
// Within a search, curvatures are not averaged again for a change of the parameter's logarithm up to this.
constexpr double kSameDisk = 0.2;
constexpr double kCertainlyLower = 1 - 1e-12;  // of a length: beyond rounding
constexpr double kSketchSamplesPerTriangle = 0.5;
constexpr double kMostStretch = 0.1;  // of the parameter's logarithm, of a field that is not sampled again for it
// Grading makes more triangles than the curvature alone asks for; on scans as many as if the parameter were so much smaller.
constexpr double kGradedError = 1.6;
constexpr double kNear = 0.15;  // of a count: so near, counts on a part of the faces tell how those on all change
constexpr double kErrorCountFactor = 1.01, kRefinedPerLeftOut = 0.1, kMostLeftOut = 0.1;
// For a count: of the triangles, what refinement adds where there are many beside the input's, from so many of them on.
constexpr double kCountedFactor = 1.001, kMostRefined = 0.016, kFirstRefined = 0.2, kAllRefined = 0.5;
constexpr double kTrianglesPerRimEdge = 0.35;
constexpr double kDetailPerEvenLength = 0.75;  // where a search for it begins
constexpr double kThicknessHeadroom = 1.2;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// How the count follows the parameter: as its power with this exponent, were there no grading. The grading makes it slower.
double ExponentOf(Sizing sizing) { return sizing == Sizing::kError ? -1 : -2; }
constexpr double kGradedPart = 0.75;

// The parameter's largest value; beyond, nothing changes.
double LargestParameter(const SizingLimits& limits) {
  switch (limits.sizing) {
    case Sizing::kAngle:
    case Sizing::kThickness:
      return 2 * std::numbers::pi / 3;
    case Sizing::kError:
      return limits.max_edge;  // far beyond what an edge of that length can be off
    case Sizing::kUniform:
      break;
  }
  return limits.max_edge;
}

// Calls visit(u, v) with the centroids of the rows² like parts of a triangle, as the weights of its second and third corner.
template <class Visit>
void VisitParts(int rows, Visit visit) {
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; i + j < rows; ++j) {
      visit((i + 1.0 / 3) / rows, (j + 1.0 / 3) / rows);
      if (i + j + 1 < rows) visit((i + 2.0 / 3) / rows, (j + 2.0 / 3) / rows);
    }
  }
}

absl::Status Unreachable(uint64_t count, double nearest) {
  return absl::InvalidArgumentError(
      absl::StrCat("options.target_triangles is ", count, "; with the other options as they are this surface takes at ",
                   nearest > static_cast<double>(count) ? "least " : "most ", std::llround(nearest)));
}

std::vector<RimSide> RimOf(const MeshSurface& surface) {
  std::vector<RimSide> rim;
  const TriangleMesh& mesh = surface.mesh();
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    const bool is_rim = surface.adjacency().OppositeOf(h) == kNoHalfEdge && surface.AcrossCrease(h) == kNoHalfEdge;
    if (!is_rim) continue;
    const Vec3 &a = mesh.PositionAt(OriginOf(mesh, h)), &b = mesh.PositionAt(TargetOf(mesh, h));
    rim.push_back({0.5 * (a + b), Distance(a, b)});
  }
  return rim;
}

}  // namespace

FieldBuilder::FieldBuilder(const MeshSurface& surface, const SizingLimits& limits)
    : surface_(surface),
      limits_(limits),
      diagonal_(limits.diagonal > 0 ? limits.diagonal : BoundingBox(surface.mesh(), surface.adjacency()).Diagonal()),
      area_(std::accumulate(surface.vertex_areas().begin(), surface.vertex_areas().end(), 0.0)),
      longest_(surface.mesh().positions.size(), kInfinity) {
  if (limits.max_edge_given || limits.sizing == Sizing::kUniform) return;
  const absl::Span<const double> diagonals = surface.whole_diagonals();
  for (size_t v = 0; v < longest_.size(); ++v) {
    const uint32_t h = surface.adjacency().outgoing[v];
    if (h != kNoHalfEdge)
      longest_[v] = kMaxEdgePerComponent * diagonals[surface.ComponentOf(FaceId(FaceOfHalfEdge(h)))];
  }
}

// g where nothing else makes it smaller.
double FieldBuilder::LongestGuidance() const {
  if (limits_.sizing != Sizing::kUniform)
    return longest_edge_ > 0 ? std::clamp(longest_edge_, limits_.min_edge, limits_.max_edge) : limits_.max_edge;
  return std::clamp(parameter_ / kMedianEdgePerGuidance, limits_.min_edge, limits_.max_edge);
}

// What of a curvature edges follow. For a count at constant error none of a radius below that error: l stays at √3 ε, so that every
// count has its error. With √3/κ instead, few triangles would take an error as large as the whole, and still follow each wrinkle.
double FieldBuilder::SeenCurvature(double max_curvature) const {
  if (detail_ > 0) max_curvature = std::min(max_curvature, std::sqrt(3.0) / detail_);
  if (limits_.sizing == Sizing::kError && is_counting_) max_curvature = std::min(max_curvature, 1 / parameter_);
  return max_curvature;
}

// Before thickness and clamps.
double FieldBuilder::WantedLengthAt(double max_curvature) const {
  switch (limits_.sizing) {
    case Sizing::kAngle:
    case Sizing::kThickness:  // before the thickness
      return IdealLength(parameter_, max_curvature);
    case Sizing::kError:
      return LengthForError(parameter_, SeenCurvature(max_curvature));
    case Sizing::kUniform:
      break;
  }
  return limits_.eta * LongestGuidance();  // g is l/η at a sample (eq. 5)
}

// … with detail that is smaller than what the count leaves room for taken for as large as that.
double FieldBuilder::LengthAt(double max_curvature) const { return std::max(WantedLengthAt(max_curvature), detail_); }

// Where half the distance to the other sheet is the local feature size: the same angle on a circle of that radius.
double FieldBuilder::LengthForThickness(double sheet_distance) const {
  const double distance = std::max(sheet_distance, kNarrowestWidth * diagonal_);
  return std::max(IdealLength(parameter_, 2 / distance), limits_.min_edge);
}

// What the other sheet allows: a quarter of the distance to it as the error.
double FieldBuilder::LengthForSheet(const CurvatureSample& place) const {
  if (!std::isfinite(place.sheet_distance)) return kInfinity;
  if (limits_.sizing == Sizing::kThickness) return LengthForThickness(place.sheet_distance);
  if (!place.is_vertex()) return kInfinity;
  const double length =
      LengthForError(kErrorPerSheetDistance * place.sheet_distance, SeenCurvature(place.max_curvature));
  return std::max(length, kLeastPerInputEdge * place.input_edge);
}

double FieldBuilder::IdealLengthAt(double max_curvature) const {
  const double longest = limits_.sizing == Sizing::kUniform ? kInfinity : limits_.max_edge;
  return std::clamp(LengthAt(max_curvature), limits_.min_edge, longest);
}

// For a count at constant error detail narrower than the edges is left to what refinement may add. Where a bound is given it has to keep
// that anyway, and predicts no vertices of its own; an angle is the surface's own.
absl::Status FieldBuilder::SetCurvatures(const Context& context) {
  const absl::Span<const double> own = surface_.vertex_curvatures();
  if (limits_.sizing != Sizing::kError || !is_counting_) {
    if (curvatures_.empty()) curvatures_.assign(own.begin(), own.end());
    return absl::OkStatus();
  }
  const double change = averaged_at_.first > 0 ? std::log(parameter_ / averaged_at_.first) : kInfinity;
  if (std::abs(change) <= kSameDisk && detail_ == averaged_at_.second) return absl::OkStatus();
  if (!average_) {
    MESHFRONT_ASSIGN_OR_RETURN(average_, CurvatureAverage::Create(surface_, context));
  }
  const auto length = [&](double curvature) { return IdealLengthAt(curvature); };
  MESHFRONT_ASSIGN_OR_RETURN(curvatures_, average_->ForEdges(length, limits_.eta, context));
  double whole = 0, left = 0;
  for (size_t v = 0; v < own.size(); ++v) whole += own[v], left += curvatures_[v];
  left_out_ = whole > 0 ? 1 - left / whole : 0;
  averaged_at_ = {parameter_, detail_};
  return absl::OkStatus();
}

// Where the distance is held constant fields have wider plateaus, and the front makes more of their slopes than the prediction
// tells; and up to three in a hundred come from refinement: of the turns at the input's edges, where the output is about as fine, and
// of detail that was left out. Fitted like the rest of it.
double FieldBuilder::CountFactor(double by_area) const {
  if (limits_.sizing != Sizing::kError) return 1;
  if (!is_counting_) return kErrorCountFactor;
  const double fineness = by_area / static_cast<double>(surface_.mesh().triangles.size());
  const double refined = std::clamp((fineness - kFirstRefined) / (kAllRefined - kFirstRefined), 0.0, 1.0);
  return kCountedFactor + kMostRefined * refined + kRefinedPerLeftOut * std::min(left_out_, kMostLeftOut);
}

// How far from a vertex the other sheet matters, in parts of the length that its curvature asks for.
double FieldBuilder::SheetReachPerLength() const {
  if (limits_.sizing != Sizing::kThickness) return kSheetReachPerLength;
  return 1 / std::sin(0.5 * parameter_);  // where half the distance is the radius of curvature
}
double FieldBuilder::LongestSheetReach() const {
  const double per_diagonal =
      limits_.sizing == Sizing::kThickness ? kLongestThicknessPerDiagonal : kLongestSheetReachPerDiagonal;
  return per_diagonal * diagonal_;
}

absl::Status FieldBuilder::MeasureThickness(const Context& context) {
  if (parameter_ <= measured_ && detail_ <= measured_detail_) return absl::OkStatus();
  const double wanted = parameter_, wanted_detail = detail_;
  parameter_ = std::min(headroom_ * wanted, LargestParameter(limits_));
  detail_ *= headroom_;
  std::vector<double> limits(curvatures_.size());
  const double per_length = SheetReachPerLength(), longest = LongestSheetReach();
  for (size_t v = 0; v < limits.size(); ++v) limits[v] = std::min(per_length * IdealLengthAt(curvatures_[v]), longest);
  auto distances = surface_.SheetDistances(limits, context);
  measured_ = std::exchange(parameter_, wanted);
  measured_detail_ = std::exchange(detail_, wanted_detail);
  MESHFRONT_ASSIGN_OR_RETURN(sheet_distances_, std::move(distances));
  return absl::OkStatus();
}

// Once, as far as an edge could be too long anywhere. Where one length is asked for it is not shortened for strips.
absl::Status FieldBuilder::MeasureWidths(const Context& context) {
  if (widths_) return absl::OkStatus();
  widths_.emplace();
  if (limits_.sizing == Sizing::kUniform) return absl::OkStatus();
  std::vector<WidthRange> ranges;
  for (const double diagonal : surface_.whole_diagonals()) {
    const double longest = limits_.max_edge_given ? kInfinity : kMaxEdgePerComponent * diagonal;
    ranges.push_back({kNarrowestWidth * diagonal, std::min(longest, limits_.max_edge) / (limits_.eta * kEdgePerWidth)});
  }
  MESHFRONT_ASSIGN_OR_RETURN(widths_, MeasurePatchWidths(surface_, ranges, context));
  return absl::OkStatus();
}

// +infinity where the patch is wide enough.
double FieldBuilder::LengthForWidth(const WidthSample& place) const {
  const VertexId a = OriginOf(surface_.mesh(), place.half_edge), b = TargetOf(surface_.mesh(), place.half_edge);
  const double curvature = std::max(curvatures_[a.index()], curvatures_[b.index()]);
  const double wanted = std::min({LengthAt(curvature), longest_[a.index()], limits_.max_edge});
  const double least = kLeastForWidth * wanted;
  double length = limits_.eta * kEdgePerWidth * place.width;
  if (length < least) length = least * (least / length);
  length = std::max(length, detail_);
  return length < wanted ? std::max(length, limits_.min_edge) : kInfinity;
}

// What rims take beyond what their area tells: strips of one row of triangles one for each edge along either of their rims, and the rim of
// an open surface without strips about a third of one for each edge.
double FieldBuilder::CountAtRims(const GuidanceField& field) {
  double count = 0;
  for (const WidthSample& place : *widths_) {
    const double g = field.At(place.position),
                 by_area = kTrianglesPerIdealTriangle * 2 / std::sqrt(3.0) * place.width / g;
    count += place.stretch / g * std::max(1 - by_area, 0.0);
  }
  if (!widths_->empty()) return count;
  if (!rim_) rim_ = RimOf(surface_);
  for (const RimSide& side : *rim_) count += kTrianglesPerRimEdge * side.length / field.At(side.middle);
  return count;
}

absl::StatusOr<std::vector<SizingSample>> FieldBuilder::Samples(uint64_t& clamped, const Context& context) {
  std::vector<double> lengths(curvatures_.size());
  for (size_t v = 0; v < lengths.size(); ++v) lengths[v] = IdealLengthAt(curvatures_[v]);
  for (size_t v = 0; v < sheet_distances_.size() && limits_.sizing == Sizing::kThickness; ++v)
    lengths[v] = std::min(lengths[v], LengthForThickness(sheet_distances_[v]));
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<CurvatureSample> places,
                             surface_.CurvatureSamples(curvatures_, lengths, sheet_distances_, context));
  const bool uniform = limits_.sizing == Sizing::kUniform;
  std::vector<SizingSample> samples;
  samples.reserve(uniform ? 0
                          : places.size() + added_.size() + widths_->size());  // most are dominated: room for the rims'
  size_t too_close = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    const CurvatureSample& place = places[i];
    const double wanted = LengthAt(place.max_curvature);
    const double for_sheet = LengthForSheet(place);
    too_close += std::isfinite(for_sheet) && for_sheet <= kLeastPerInputEdge * place.input_edge;
    double length = std::min(wanted, for_sheet);
    if (i < longest_.size()) length = std::min(length, longest_[i]);
    length = std::clamp(length, limits_.min_edge, uniform ? kInfinity : limits_.max_edge);
    clamped += std::isfinite(wanted) && length != wanted;
    if (!uniform || length < wanted) samples.push_back({place.position, length});
  }
  if (samples.size() == places.size()) DropDominatedByNeighbours(samples);
  share_too_close_ =
      static_cast<double>(too_close) / static_cast<double>(std::max<size_t>(surface_.mesh().positions.size(), 1));
  MESHFRONT_RETURN_IF_ERROR(AddSamplesBesideVertices(samples, context));
  return samples;
}

// Of samples that begin with one at each vertex, those at which the cone of one next to it lies lower for certain: most, at a small part
// of what GuidanceField::Create takes to find that out.
void FieldBuilder::DropDominatedByNeighbours(std::vector<SizingSample>& samples) const {
  const auto rings = surface_.vertex_rings();
  const std::vector<uint32_t>& outgoing = surface_.adjacency().outgoing;
  if (!rings || std::find(outgoing.begin(), outgoing.end(), kNoHalfEdge) != outgoing.end()) return;
  const double rise = limits_.eta - 1;  // of l along a cone
  std::vector<bool> is_dominated(samples.size());
  for (uint32_t v = 0; v < outgoing.size(); ++v) {
    bool any = false;
    for (const uint32_t u : rings->Of(v)) {
      const double room = (samples[v].ideal_length * kCertainlyLower - samples[u].ideal_length) / rise;
      any |= room > 0 && SquaredDistance(samples[u].position, samples[v].position) < room * room;
    }
    is_dominated[v] = any;
  }
  size_t kept = 0;
  for (size_t i = 0; i < samples.size(); ++i) {
    if (!is_dominated[i]) samples[kept++] = samples[i];
  }
  samples.resize(kept);
}

// Of each run of vertices, which lie near each other mostly, the one where the surface bends most.
absl::StatusOr<std::vector<SizingSample>> FieldBuilder::SamplesOfRuns(size_t run, const Context& context) {
  std::vector<SizingSample> samples;
  samples.reserve(curvatures_.size() / run + 1 + added_.size() + widths_->size());
  for (size_t begin = 0; begin < curvatures_.size(); begin += run) {
    size_t most = begin;
    for (size_t v = begin; v < std::min(begin + run, curvatures_.size()); ++v)
      most = curvatures_[v] > curvatures_[most] ? v : most;
    const double length = std::min(LengthAt(curvatures_[most]), longest_[most]);
    samples.push_back({surface_.mesh().positions[most], std::clamp(length, limits_.min_edge, limits_.max_edge)});
  }
  MESHFRONT_RETURN_IF_ERROR(AddSamplesBesideVertices(samples, context));
  return samples;
}

// Of rims, of strips, and what a caller added.
absl::Status FieldBuilder::AddSamplesBesideVertices(std::vector<SizingSample>& samples, const Context& context) {
  const auto ideal_length = [&](double max_curvature) { return IdealLengthAt(max_curvature); };
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<SizingSample> rim,
                             BoundarySizingSamples(surface_, ideal_length, context));
  samples.insert(samples.end(), rim.begin(), rim.end());
  if (limits_.blend == nullptr) samples.insert(samples.end(), added_.begin(), added_.end());
  for (const WidthSample& place : *widths_) {
    const double length = LengthForWidth(place);
    if (std::isfinite(length)) samples.push_back({place.position, length});
  }
  return absl::OkStatus();
}

absl::StatusOr<GuidanceField> FieldBuilder::FieldOf(std::vector<SizingSample> samples, const Context& context) const {
  const GuidanceOptions options{limits_.eta, limits_.min_edge, LongestGuidance()};
  MESHFRONT_ASSIGN_OR_RETURN(GuidanceField field, GuidanceField::Create(std::move(samples), options, context));
  if (limits_.blend == nullptr) return field;
  return limits_.blend->Apply(field, added_, context);
}

// Without its count.
absl::StatusOr<SizedField> FieldBuilder::BuildField(double parameter, const Context& context) {
  parameter_ = parameter;
  MESHFRONT_RETURN_IF_ERROR(MeasureWidths(context));
  MESHFRONT_RETURN_IF_ERROR(SetCurvatures(context));
  uint64_t clamped = 0;
  MESHFRONT_ASSIGN_OR_RETURN(std::vector<SizingSample> samples, Samples(clamped, context));
  MESHFRONT_ASSIGN_OR_RETURN(GuidanceField field, FieldOf(std::move(samples), context));
  return SizedField{std::move(field), parameter, 0, clamped, detail_, longest_edge_};
}

absl::StatusOr<SizedField> FieldBuilder::Build(double parameter, const Context& context) {
  parameter_ = parameter;
  MESHFRONT_RETURN_IF_ERROR(SetCurvatures(context));
  MESHFRONT_RETURN_IF_ERROR(MeasureThickness(context));
  MESHFRONT_ASSIGN_OR_RETURN(SizedField sized, BuildField(parameter, context));
  const FaceSpans faces{surface_.mesh().positions, surface_.mesh().triangles, curvatures_};
  MESHFRONT_ASSIGN_OR_RETURN(const double by_area, PredictTriangles(faces, sized.field, context));
  sized.predicted_triangles = CountFactor(by_area) * by_area + CountAtRims(sized.field);
  return sized;
}

// Without thickness where it was not measured yet, of a part of the vertices where there are many for each triangle wanted, and with
// the count that a part of the surface tells.
absl::StatusOr<SizedField> FieldBuilder::Sketch(double parameter, double count, const Context& context) {
  parameter_ = parameter;
  MESHFRONT_RETURN_IF_ERROR(SetCurvatures(context));
  if (limits_.sizing == Sizing::kThickness) MESHFRONT_RETURN_IF_ERROR(MeasureThickness(context));
  const double run = static_cast<double>(curvatures_.size()) / (kSketchSamplesPerTriangle * count);
  std::optional<SizedField> sized;
  if (run >= 2 && limits_.sizing != Sizing::kThickness) {
    MESHFRONT_RETURN_IF_ERROR(MeasureWidths(context));
    MESHFRONT_ASSIGN_OR_RETURN(std::vector<SizingSample> samples, SamplesOfRuns(static_cast<size_t>(run), context));
    MESHFRONT_ASSIGN_OR_RETURN(GuidanceField field, FieldOf(std::move(samples), context));
    sized = SizedField{std::move(field), parameter, 0, 0, detail_, longest_edge_};
  } else {
    MESHFRONT_ASSIGN_OR_RETURN(sized, BuildField(parameter, context));
  }
  MESHFRONT_RETURN_IF_ERROR(CountOnProbeOnce(*sized, context));
  sized->predicted_triangles = CountFactor(sized->count_on_probe) * sized->count_on_probe + CountAtRims(sized->field);
  return *std::move(sized);
}

// Whether the samples that the field kept are those of another parameter but for their lengths, and these follow the parameter.
bool FieldBuilder::IsStretchable(const SizedField& sized, double parameter) const {
  return limits_.sizing == Sizing::kError && limits_.blend == nullptr && detail_ == sized.detail &&
         longest_edge_ == sized.longest && std::abs(std::log(parameter / sized.parameter)) <= kMostStretch;
}

// The field of a parameter near that of another, whose count is known.
absl::StatusOr<SizedField> FieldBuilder::BuildNear(SizedField& other, double parameter, const Context& context) {
  std::optional<SizedField> sized;
  if (IsStretchable(other, parameter)) {
    sized = SizedField{Stretched(other, parameter), parameter, 0, other.clamped_samples, detail_, longest_edge_};
  } else {
    parameter_ = parameter;
    MESHFRONT_RETURN_IF_ERROR(SetCurvatures(context));
    MESHFRONT_RETURN_IF_ERROR(MeasureThickness(context));
    MESHFRONT_ASSIGN_OR_RETURN(sized, BuildField(parameter, context));
  }
  MESHFRONT_RETURN_IF_ERROR(CountOnProbeOnce(other, context));
  MESHFRONT_RETURN_IF_ERROR(CountOnProbeOnce(*sized, context));
  const double before = other.count_on_probe, after = sized->count_on_probe;
  const double by_area = other.predicted_triangles - CountAtRims(other.field);
  sized->predicted_triangles = by_area * (before > 0 ? after / before : 1) + CountAtRims(sized->field);
  return *std::move(sized);
}

absl::StatusOr<double> FieldBuilder::CountOnProbe(const GuidanceField& field, const Context& context) {
  return CountOnPlaces({probe_->places, probe_->areas, probe_->curvatures}, field, context);
}

absl::Status FieldBuilder::CountOnProbeOnce(SizedField& sized, const Context& context) {
  if (sized.count_on_probe >= 0) return absl::OkStatus();
  MESHFRONT_ASSIGN_OR_RETURN(sized.count_on_probe, CountOnProbe(sized.field, context));
  return absl::OkStatus();
}

// Where every place had the edges that its own curvature asks for, g = l/η, the count would be a power of the parameter.
double FieldBuilder::FirstGuess(double count) const {
  double area = 0, bent = 0, bent_twice = 0;  // ∫ dA κ^n for n = 0, 1, 2
  const absl::Span<const double> areas = surface_.vertex_areas(), curvatures = surface_.vertex_curvatures();
  for (size_t v = 0; v < areas.size(); ++v) {
    const double curvature = curvatures[v];
    area += areas[v], bent += areas[v] * curvature, bent_twice += areas[v] * curvature * curvature;
  }
  const double per_area = 4 / std::sqrt(3.0) * kTrianglesPerIdealTriangle / count, eta2 = limits_.eta * limits_.eta;
  const double largest = LargestParameter(limits_);
  double guess = 0;
  switch (limits_.sizing) {
    case Sizing::kAngle:  // l = 2 sin(ρ/2) / κ
    case Sizing::kThickness:
      guess = 2 * std::asin(std::min(1.0, 0.5 * std::sqrt(per_area * eta2 * bent_twice)));
      break;
    case Sizing::kError:  // l² = 6ε / κ for small ε
      guess = kGradedError * per_area * eta2 * bent / 6;
      break;
    case Sizing::kUniform:
      guess = kMedianEdgePerGuidance * std::sqrt(per_area * area);
      break;
  }
  return std::clamp(guess, 1e-12 * largest, largest);
}

// Of edges of one length everywhere, for a count.
double FieldBuilder::EvenLength(double count) const { return std::sqrt(4 / std::sqrt(3.0) * area_ / count); }

// A part of the faces, evenly spread, on which counts are compared quickly: their centroids, and those of parts of faces that are
// longer than an even edge.
FieldBuilder::Probe FieldBuilder::MakeProbe(double count) const {
  const TriangleMesh& mesh = surface_.mesh();
  Probe probe;
  const size_t stride = mesh.triangles.size() / kProbeFaces | 1;
  const double even = EvenLength(count);
  double part = 0;
  for (size_t f = 0; f < mesh.triangles.size(); f += stride) {
    const Triangle& t = mesh.triangles[f];
    const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
    const double area = TriangleArea(a, b, c);
    part += area;
    double curvature = 0;
    for (const VertexId v : t) curvature += surface_.vertex_curvatures()[v.index()] / 3;
    const double longest = std::sqrt(SquaredLongestSide(a, b, c));
    const int rows = static_cast<int>(std::clamp(std::ceil(longest / even), 1.0, kMostProbeRows));
    VisitParts(rows, [&](double u, double v) {
      probe.places.push_back((1 - u - v) * a + u * b + v * c);
      probe.areas.push_back(area / (rows * rows));
      probe.curvatures.push_back(curvature);
    });
  }
  for (double& area : probe.areas) area *= part > 0 ? area_ / part : 1;
  return probe;
}

// The samples that a field kept, their lengths changed as the formula has it from one parameter to the other.
GuidanceField FieldBuilder::Stretched(const SizedField& sized, double parameter) {
  const auto kept = sized.field.kept_samples();
  std::vector<double> lengths(kept.size());
  parameter_ = parameter;
  const bool by_error = limits_.sizing == Sizing::kError;
  for (size_t i = 0; i < kept.size(); ++i) {
    const double length = kept[i].ideal_length, curvature = CurvatureOf(length, sized.parameter);
    const bool has_other_reason = by_error && curvature * sized.parameter >= 1;  // a thin part, not its bends
    lengths[i] = has_other_reason ? length : std::clamp(WantedLengthAt(curvature), limits_.min_edge, limits_.max_edge);
  }
  return sized.field.WithLengths(lengths, LongestGuidance());
}

// The count at another parameter, about: of the samples that `sized` kept, and on the probe alone.
absl::StatusOr<double> FieldBuilder::ProbeCount(const SizedField& sized, double parameter, const Context& context) {
  return CountOnProbe(Stretched(sized, parameter), context);
}

// The curvature whose ideal length this is at a parameter.
double FieldBuilder::CurvatureOf(double length, double parameter) const {
  if (limits_.sizing != Sizing::kError) return IdealLength(parameter, length);  // l κ is the same either way
  return std::min(6 * parameter / (length * length + 3 * parameter * parameter), std::sqrt(3.0) / length);
}

// From a field that has another count, where on the line of parameters that of the target is near, and how the count falls there,
// without building a whole field again.
absl::StatusOr<FieldBuilder::Line> FieldBuilder::FindNear(const SizedField& sized, double target,
                                                          const Context& context) {
  const double exponent = ExponentOf(limits_.sizing);
  Line line{sized.parameter, LargestParameter(limits_), exponent, kGradedPart * exponent};
  MESHFRONT_ASSIGN_OR_RETURN(double count, ProbeCount(sized, sized.parameter, context));
  if (!(count > 0)) return line;
  const double wanted = target * count / sized.predicted_triangles;
  CountSearch search(std::log(wanted), exponent, line.slope, std::log(line.largest));
  for (int step = 0; step < kMaxProbeSteps && std::abs(count / wanted - 1) > kProbeTolerance; ++step) {
    line.first = std::min(std::exp(search.Next(std::log(line.first), std::log(count))), line.largest);
    if (step > 0) line.slope = search.slope();
    if (search.IsExhausted()) break;
    MESHFRONT_ASSIGN_OR_RETURN(count, ProbeCount(sized, line.first, context));
  }
  return line;
}

// The field of the count that is nearest to `count` among those of the line's values.
absl::StatusOr<SizedField> FieldBuilder::Approach(uint64_t count, const Line& line, const Context& context) {
  const double target = static_cast<double>(count);
  const auto begin = [&] { return CountSearch(std::log(target), line.exponent, line.slope, std::log(line.largest)); };
  CountSearch search = begin();
  const auto error_of = [&](const SizedField& sized) { return std::abs(sized.predicted_triangles / target - 1); };
  double value = line.first, nearest = value, least_error = kInfinity;
  MESHFRONT_ASSIGN_OR_RETURN(SizedField whole, BuildOn(line, value, nullptr, context));
  std::optional<SizedField> near;  // counted from that
  for (int step = 0; step < kMaxSteps; ++step) {
    SizedField& last = near ? *near : whole;
    const double error = error_of(last);
    if (error < least_error) least_error = error, nearest = value;
    if (error <= kCountTolerance && (!near || error_of(whole) <= kNear)) return std::move(last);
    if (error <= kCountTolerance) {
      const double told = last.predicted_triangles;
      MESHFRONT_ASSIGN_OR_RETURN(whole, BuildOn(line, value, nullptr, context));
      near.reset();
      // Counted from a field so far off that nothing it told since holds.
      if (std::abs(whole.predicted_triangles / told - 1) > kNear) search = begin(), least_error = kInfinity;
      continue;
    }
    const double next = search.Next(std::log(value), std::log(last.predicted_triangles));
    if (search.IsExhausted() && (!near || error_of(whole) <= kNear)) return std::move(last);
    if (search.IsExhausted()) {  // by counts told from a field so far off
      MESHFRONT_ASSIGN_OR_RETURN(whole, BuildOn(line, value, nullptr, context));
      near.reset();
      search = begin(), least_error = kInfinity;
      continue;
    }
    if (search.IsAtAJump()) break;
    value = std::min(std::exp(next), line.largest);
    MESHFRONT_ASSIGN_OR_RETURN(near, BuildOn(line, value, &whole, context));
  }
  return BuildOn(line, nearest, nullptr, context);
}

absl::StatusOr<SizedField> FieldBuilder::BuildOn(const Line& line, double value, SizedField* near,
                                                 const Context& context) {
  if (line.along == Along::kDetail) detail_ = value;
  if (line.along == Along::kLongest) longest_edge_ = value;
  const double parameter = line.along == Along::kParameter ? value : line.parameter;
  return near ? BuildNear(*near, parameter, context) : Build(parameter, context);
}

absl::StatusOr<SizedField> FieldBuilder::BuildForCount(uint64_t count, const Context& context) {
  headroom_ = kThicknessHeadroom;
  is_counting_ = true;
  probe_ = MakeProbe(static_cast<double>(count));
  detail_ = longest_edge_ = 0;
  averaged_at_ = {-1, -1};
  const double target = static_cast<double>(count);
  const auto is_reached = [&](const SizedField& sized, double tolerance = kReachable) {
    return std::abs(sized.predicted_triangles / target - 1) <= tolerance;
  };
  const bool uniform = limits_.sizing == Sizing::kUniform;
  const double exponent = ExponentOf(Sizing::kUniform);
  Line line{FirstGuess(target), LargestParameter(limits_), exponent, exponent};
  if (!uniform) {
    MESHFRONT_ASSIGN_OR_RETURN(const SizedField sketch, Sketch(line.first, target, context));
    MESHFRONT_ASSIGN_OR_RETURN(line, FindNear(sketch, target, context));
  }
  MESHFRONT_ASSIGN_OR_RETURN(SizedField sized, Approach(count, line, context));
  if (!is_reached(sized) && sized.predicted_triangles > target && !uniform) {
    const double first = std::min(kDetailPerEvenLength * EvenLength(target), limits_.max_edge);
    const Line detail{first, limits_.max_edge, exponent, kGradedPart * exponent, Along::kDetail, sized.parameter};
    MESHFRONT_ASSIGN_OR_RETURN(sized, Approach(count, detail, context));
  } else if (!is_reached(sized) && !uniform) {
    const double first = std::min(EvenLength(target), limits_.max_edge);
    const Line longest{first, limits_.max_edge, exponent, kGradedPart * exponent, Along::kLongest, sized.parameter};
    MESHFRONT_ASSIGN_OR_RETURN(sized, Approach(count, longest, context));
  }
  sized.is_least = !is_reached(sized) && sized.predicted_triangles > target && !limits_.max_edge_given &&
                   sized.predicted_triangles <= kMostThinned;
  if (!is_reached(sized, kRefusable) && !sized.is_least) return Unreachable(count, sized.predicted_triangles);
  detail_ = sized.detail, longest_edge_ = sized.longest;
  return sized;
}

}  // namespace meshfront
