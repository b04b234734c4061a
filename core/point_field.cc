// Build: 1. thickness, from one sample of each patch    2. curvature → ideal lengths    3. the field and its predicted
// count, over one triangle of the right area for each of a part of the samples. BuildForCount: a secant on (log
// parameter, log count) from what the curvatures alone suggest.
#include "core/point_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/guidance/prediction.h"
#include "core/guidance/sizing.h"
#include "core/surface/opposed_samples.h"

namespace meshfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// As for meshes (field_builder.cc): the error in parts of the distance to the other side, how far that matters in parts
// of an edge, and the shortest edge for its sake in parts of the spacing.
constexpr double kErrorPerSheetDistance = 0.25, kLeastPerSpacing = 0.5;
constexpr double kSheetReach = 0.75, kLongestSheetReachPerBox = 0.1;
constexpr size_t kCountedSamples = 16384;
constexpr double kCountTolerance = 0.004, kReachable = 0.01;
constexpr int kMaxSteps = 24;
constexpr size_t kGrain = 64;
constexpr double kFewestRimEdges = 8;

double LargestParameter(const SizingLimits& limits) {
  return limits.sizing == Sizing::kAngle || limits.sizing == Sizing::kThickness ? 2 * std::numbers::pi / 3
                                                                                : limits.max_edge;
}

}  // namespace

PointFieldBuilder::PointFieldBuilder(const PointSurface& surface, absl::Span<const RimCurve> rims,
                                     const SizingLimits& limits)
    : surface_(surface), rims_(rims), limits_(limits), longest_(surface.samples().component_count(), kInfinity) {
  for (const double area : surface.samples().areas()) area_ += area;
  for (const double curvature : surface.curvatures()) peak_curvature_ = std::max(peak_curvature_, curvature);
  if (limits.max_edge_given || limits.sizing == Sizing::kUniform) return;
  std::vector<Box3> boxes(longest_.size());
  for (uint32_t i = 0; i < surface.samples().samples().size(); ++i) {
    const uint32_t component = surface.samples().ComponentOf(i);
    if (component != MlsSamples::kStray) boxes[component].Extend(surface.samples().samples()[i].position);
  }
  for (size_t c = 0; c < boxes.size(); ++c) longest_[c] = kMaxEdgePerComponent * boxes[c].Diagonal();
}

void PointFieldBuilder::AddSample(const SizingSample& sample) {
  added_.push_back({sample.position, std::max(sample.ideal_length, limits_.min_edge)});
}

double PointFieldBuilder::LongestGuidance(double parameter) const {
  if (limits_.sizing != Sizing::kUniform) return limits_.max_edge;
  return std::clamp(parameter / kMedianEdgePerGuidance, limits_.min_edge, limits_.max_edge);
}

double PointFieldBuilder::LengthAt(double curvature, double parameter) const {
  switch (limits_.sizing) {
    case Sizing::kAngle:
    case Sizing::kThickness:
      return IdealLength(parameter, curvature);
    case Sizing::kError:  // for a count as FieldBuilder::SeenCurvature
      return LengthForError(parameter, is_counting_ ? std::min(curvature, 1 / parameter) : curvature);
    case Sizing::kUniform:
      break;
  }
  return limits_.eta * LongestGuidance(parameter);
}

absl::Status PointFieldBuilder::MeasureThickness(double parameter, const Context& context) {
  if (parameter <= measured_) return absl::OkStatus();
  const MlsSamples& samples = surface_.samples();
  sheet_distances_.assign(samples.patch_count(), kInfinity);
  measured_ = parameter;
  const OpposedSamples opposed(samples);
  const double longest = kLongestSheetReachPerBox * samples.box().Diagonal();
  return ParallelFor(sheet_distances_.size(), kGrain, context, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      const uint32_t sample = samples.MembersOf(static_cast<uint32_t>(p))[0];
      const double length = std::min(LengthAt(surface_.curvatures()[sample], parameter), limits_.max_edge);
      sheet_distances_[p] = opposed.DistanceFrom(sample, std::min(kSheetReach * length, longest));
    }
  });
}

// By the bend of the curve, but no shorter than the samples are apart; and small holes get enough edges to be round.
void PointFieldBuilder::AddRims(double parameter, std::vector<SizingSample>& sizes) const {
  for (const RimCurve& rim : rims_) {
    for (size_t i = 0; i < rim.places.size(); ++i) {
      const MlsSamples& samples = surface_.samples();
      const double spacing = samples.SpacingAt(samples.MembersOf(rim.places[i].patch)[0]);
      const double length =
          std::min(LengthAt(rim.curvatures[i], parameter), limits_.eta * rim.length / kFewestRimEdges);
      sizes.push_back({rim.places[i].position, std::clamp(std::max(length, spacing), limits_.min_edge, kInfinity)});
    }
  }
}

absl::StatusOr<SizedField> PointFieldBuilder::Build(double parameter, const Context& context) {
  MESHFRONT_RETURN_IF_ERROR(MeasureThickness(parameter, context));
  const MlsSamples& samples = surface_.samples();
  const bool uniform = limits_.sizing == Sizing::kUniform;
  std::vector<SizingSample> sizes;
  uint64_t clamped = 0;
  for (uint32_t i = 0; i < samples.samples().size(); ++i) {
    if (samples.ComponentOf(i) == MlsSamples::kStray) continue;
    const double wanted = LengthAt(surface_.curvatures()[i], parameter);
    double length = std::min(wanted, longest_[samples.ComponentOf(i)]);
    const double sheet = sheet_distances_[samples.PatchOf(i)];
    if (std::isfinite(sheet)) {
      const double thin = LengthForError(kErrorPerSheetDistance * sheet, surface_.curvatures()[i]);
      length = std::min(length, std::max(thin, kLeastPerSpacing * samples.SpacingAt(i)));
    }
    length = std::clamp(length, limits_.min_edge, uniform ? kInfinity : limits_.max_edge);
    clamped += std::isfinite(wanted) && length != wanted;
    if (!uniform || length < wanted) sizes.push_back({samples.samples()[i].position, length});
  }
  AddRims(parameter, sizes);
  sizes.insert(sizes.end(), added_.begin(), added_.end());
  const GuidanceOptions options{limits_.eta, limits_.min_edge, LongestGuidance(parameter)};
  MESHFRONT_ASSIGN_OR_RETURN(GuidanceField field, GuidanceField::Create(std::move(sizes), options, context));
  SizedField sized{std::move(field), parameter, 0, clamped, 0};
  MESHFRONT_ASSIGN_OR_RETURN(sized.predicted_triangles, Count(sized.field, context));
  return sized;
}

// An equilateral triangle in the tangent plane for every so-many-th sample, as large as its part of the area.
absl::StatusOr<double> PointFieldBuilder::Count(const GuidanceField& field, const Context& context) const {
  const MlsSamples& samples = surface_.samples();
  std::vector<Vec3> positions;
  std::vector<std::array<VertexId, 3>> triangles;
  std::vector<double> curvatures;
  double part = 0;
  const size_t stride = samples.samples().size() / kCountedSamples + 1;
  for (size_t i = 0; i < samples.samples().size(); i += stride) {
    const MlsSample& s = samples.samples()[i];
    if (samples.ComponentOf(static_cast<uint32_t>(i)) == MlsSamples::kStray) continue;
    const double radius = std::sqrt(4 * samples.areas()[i] / (3 * std::sqrt(3.0)));  // of the circle around it
    const Vec3 u = Normalized(Cross(s.normal, std::abs(s.normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}));
    const Vec3 v = Cross(s.normal, u);
    std::array<VertexId, 3> triangle;
    for (int corner = 0; corner < 3; ++corner) {
      static constexpr std::array<std::array<double, 2>, 3> kCorners = {
          {{1, 0}, {-0.5, 0.86602540378443864676}, {-0.5, -0.86602540378443864676}}};
      triangle[corner] = VertexId(static_cast<uint32_t>(positions.size()));
      positions.push_back(s.position + radius * (kCorners[corner][0] * u + kCorners[corner][1] * v));
      curvatures.push_back(surface_.curvatures()[i]);
    }
    triangles.push_back(triangle);
    part += samples.areas()[i];
  }
  MESHFRONT_ASSIGN_OR_RETURN(const double count, PredictTriangles({positions, triangles, curvatures}, field, context));
  return part > 0 ? count * area_ / part : 0;
}

std::vector<std::pair<double, double>> PointFieldBuilder::Lengths(const GuidanceField& field) const {
  std::vector<std::pair<double, double>> lengths;
  for (size_t i = 0; i < surface_.samples().samples().size(); ++i) {
    if (surface_.samples().ComponentOf(static_cast<uint32_t>(i)) == MlsSamples::kStray) continue;
    const double g = field.At(surface_.samples().samples()[i].position);
    lengths.push_back({g, surface_.samples().areas()[i] / (g * g)});
  }
  return lengths;
}

// Where every place had the edges that its own curvature asks for, g = l/η.
double PointFieldBuilder::FirstGuess(double count) const {
  double bent = 0, bent_twice = 0;
  for (size_t i = 0; i < surface_.curvatures().size(); ++i) {
    const double curvature = surface_.curvatures()[i], area = surface_.samples().areas()[i];
    bent += area * curvature, bent_twice += area * curvature * curvature;
  }
  const double per_area = 4 / std::sqrt(3.0) * kTrianglesPerIdealTriangle / count, eta2 = limits_.eta * limits_.eta;
  double guess = kMedianEdgePerGuidance * std::sqrt(per_area * area_);
  if (limits_.sizing == Sizing::kError) guess = per_area * eta2 * bent / 6;
  if (limits_.sizing == Sizing::kAngle)
    guess = 2 * std::asin(std::min(1.0, 0.5 * std::sqrt(per_area * eta2 * bent_twice)));
  const double largest = LargestParameter(limits_);
  return std::clamp(guess, 1e-12 * largest, largest);
}

absl::StatusOr<SizedField> PointFieldBuilder::BuildForCount(uint64_t count, const Context& context) {
  is_counting_ = true;
  const double target = std::log(static_cast<double>(count)), last = std::log(LargestParameter(limits_));
  double exponent = limits_.sizing == Sizing::kError ? -0.75 : -1.5;
  double at = std::log(FirstGuess(static_cast<double>(count))), left = -kInfinity, right = kInfinity;
  MESHFRONT_ASSIGN_OR_RETURN(SizedField sized, Build(std::exp(at), context));
  for (int step = 0; step < kMaxSteps; ++step) {
    const double have = std::log(sized.predicted_triangles);
    if (std::abs(std::expm1(have - target)) <= kCountTolerance || (at >= last && have > target)) break;
    (have > target ? left : right) = at;
    double next = std::min(last, at + std::clamp((target - have) / exponent, -1.5, 1.5));
    if (!(next > left && next < right)) next = 0.5 * (left + right);
    if (next == at) break;
    MESHFRONT_ASSIGN_OR_RETURN(sized, Build(std::exp(next), context));
    const double changed = (std::log(sized.predicted_triangles) - have) / (next - at);
    exponent = std::clamp(changed, 3 * exponent, 0.3 * exponent);
    at = next;
  }
  const bool is_more = sized.predicted_triangles > static_cast<double>(count);
  sized.is_least = std::abs(sized.predicted_triangles / static_cast<double>(count) - 1) > kReachable && is_more &&
                   !limits_.max_edge_given && sized.predicted_triangles <= kMostThinned;
  if (sized.is_least || std::abs(sized.predicted_triangles / static_cast<double>(count) - 1) <= kReachable)
    return sized;
  return absl::InvalidArgumentError(
      absl::StrCat("options.target_triangles is ", count, "; with the other options as they are this surface takes at ",
                   is_more ? "least " : "most ", std::llround(sized.predicted_triangles)));
}

}  // namespace meshfront
