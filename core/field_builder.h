// From a surface with curvature to its guidance field, at any value of the sizing's one parameter; and the value that makes a
// number of triangles.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/features/patch_width.h"
#include "core/guidance/guidance_field.h"
#include "core/region_blend.h"
#include "core/remesh.h"
#include "core/surface/curvature_average.h"
#include "core/surface/mesh_surface.h"

namespace meshfront {

struct SizingLimits {
  Sizing sizing = Sizing::kAngle;
  double eta = 1.2;
  double min_edge = 0, max_edge = 0;   // clamp of g, absolute, 0 < min_edge ≤ max_edge
  bool max_edge_given = false;         // false: no edge is longer than a set part of its component either
  double diagonal = 0;                 // of the whole that the surface is a part of; 0: it is the whole
  const RegionBlend* blend = nullptr;  // towards the border of that part; outlives the builder
};

// Where the fewest that a field makes are up to so many, fewer come of them by taking some out again (thinning.h); else they are refused.
inline constexpr double kMostThinned = 50000;

struct SizedField {
  GuidanceField field;
  double parameter = 0;            // rho, max_error or edge_length, absolute
  double predicted_triangles = 0;  // ≥ 0
  uint64_t clamped_samples = 0;    // whose ideal length was changed by a clamp or by a thin part
  double detail = 0;               // no edge is shorter than about this for curvature's sake; 0 unless a count needs it
  double longest = 0;              // no edge is longer than about this, for a count alone; 0: as the limits have it
  double count_on_probe = -1;      // by a part of the faces; < 0: not counted
  bool is_least = false;           // no field makes fewer, though fewer are wanted
};

// A side of the surface's rim.
struct RimSide {
  Vec3 middle;
  double length;
};

// Uses: FieldBuilder builder(surface, limits); auto sized = builder.Build(0.8, context). What a parameter does not change is
// measured once, so that further fields cost their samples alone. Not thread-safe.
class FieldBuilder {
 public:
  // `surface` must have its curvature, and outlives the builder.
  FieldBuilder(const MeshSurface& surface, const SizingLimits& limits);
  // With the limits and the added samples of another one.
  FieldBuilder(const MeshSurface& surface, const FieldBuilder& other) : FieldBuilder(surface, other.limits_) {
    added_ = other.added_;
  }
  // The same with another eta.
  FieldBuilder(const MeshSurface& surface, const FieldBuilder& other, double eta)
      : FieldBuilder(surface, WithEta(other.limits_, eta)) {
    added_ = other.added_;
  }

  // `parameter`: rho in (0, 2π/3], the error bound, or the median edge, > 0. Fails when the context stops it.
  absl::StatusOr<SizedField> Build(double parameter, const Context& context);

  // Whether some part of the surface lies so close to another that it had to be asked about, in the last field.
  bool HasCloseSheets() const {
    return std::any_of(sheet_distances_.begin(), sheet_distances_.end(), [](double d) { return std::isfinite(d); });
  }
  // The part of the vertices, 0 … 1, whose other sheet, in the last field, lies closer than edges can be short for it: half of the
  // input's at least.
  double ShareTooClose() const { return share_too_close_; }
  // One more sample, in the surface's scale, for the fields that are built from now on; no shorter than the clamp of g.
  void AddSample(const SizingSample& sample) {
    added_.push_back({sample.position, std::max(sample.ideal_length, limits_.min_edge)});
  }

  void ClearAddedSamples() { added_.clear(); }

  // The field whose predicted count is within 0.3 % of `count`; mostly two of them are built. Where even the largest
  // parameter makes too many, because the surface is rough, detail is left out; where that still makes too many, the field of the
  // fewest (SizedField::is_least). InvalidArgument, with what the nearest makes, when so many can't be made, or so few only for a
  // longest edge that was asked for.
  absl::StatusOr<SizedField> BuildForCount(uint64_t count, const Context& context);

 private:
  static SizingLimits WithEta(SizingLimits limits, double eta) {
    limits.eta = eta;
    return limits;
  }
  double LongestGuidance() const;
  double SeenCurvature(double max_curvature) const;
  double WantedLengthAt(double max_curvature) const;
  double LengthAt(double max_curvature) const;
  double LengthForThickness(double sheet_distance) const;
  double LengthForSheet(const CurvatureSample& place) const;
  double IdealLengthAt(double max_curvature) const;
  absl::Status SetCurvatures(const Context& context);
  double SheetReachPerLength() const;
  double LongestSheetReach() const;
  absl::Status MeasureThickness(const Context& context);
  absl::Status MeasureWidths(const Context& context);
  double LengthForWidth(const WidthSample& place) const;
  double CountFactor(double by_area) const;
  double CountAtRims(const GuidanceField& field);
  absl::StatusOr<SizedField> BuildField(double parameter, const Context& context);
  absl::StatusOr<SizedField> Sketch(double parameter, double count, const Context& context);
  absl::StatusOr<SizedField> BuildNear(SizedField& other, double parameter, const Context& context);
  absl::StatusOr<GuidanceField> FieldOf(std::vector<SizingSample> samples, const Context& context) const;
  absl::StatusOr<std::vector<SizingSample>> Samples(uint64_t& clamped, const Context& context);
  void DropDominatedByNeighbours(std::vector<SizingSample>& samples) const;
  absl::StatusOr<std::vector<SizingSample>> SamplesOfRuns(size_t run, const Context& context);
  absl::Status AddSamplesBesideVertices(std::vector<SizingSample>& samples, const Context& context);
  // Places that stand for the whole surface, each with a part of its area.
  struct Probe {
    std::vector<Vec3> places;
    std::vector<double> areas, curvatures;
  };
  // A line to search for a count: fields by one growing value, the parameter or, at one parameter, the detail or the longest edge.
  enum class Along { kParameter, kDetail, kLongest };
  struct Line {
    double first, largest;
    double exponent, slope;  // of the count: were there no grading, and about
    Along along = Along::kParameter;
    double parameter = 0;  // of the others
  };
  double FirstGuess(double count) const;
  double EvenLength(double count) const;
  Probe MakeProbe(double count) const;
  double CurvatureOf(double length, double parameter) const;
  GuidanceField Stretched(const SizedField& sized, double parameter);
  bool IsStretchable(const SizedField& sized, double parameter) const;
  absl::StatusOr<double> CountOnProbe(const GuidanceField& field, const Context& context);
  absl::Status CountOnProbeOnce(SizedField& sized, const Context& context);
  absl::StatusOr<double> ProbeCount(const SizedField& sized, double parameter, const Context& context);
  absl::StatusOr<Line> FindNear(const SizedField& sized, double target, const Context& context);
  absl::StatusOr<SizedField> Approach(uint64_t count, const Line& line, const Context& context);
  absl::StatusOr<SizedField> BuildOn(const Line& line, double value, SizedField* near, const Context& context);

  const MeshSurface& surface_;
  const SizingLimits limits_;
  const double diagonal_;
  const double area_;
  std::vector<double> longest_;  // ideal length of each vertex, by its component's size
  double parameter_ = 0;         // in force
  double detail_ = 0;            // in force
  double share_too_close_ = 0;
  double longest_edge_ = 0;                           // in force; 0: max_edge
  double headroom_ = 1;                               // thickness is measured for a parameter that much larger
  double measured_ = 0;                               // the parameter that thickness was measured for; 0: not yet
  double measured_detail_ = 0;                        // … and the detail
  bool is_counting_ = false;                          // a number of triangles is wanted
  std::optional<CurvatureAverage> average_;           // none: not needed yet
  std::vector<double> curvatures_;                    // of the vertices, in force
  std::pair<double, double> averaged_at_ = {-1, -1};  // at a parameter and a detail
  double left_out_ = 0;                               // of the sum of curvatures, by averaging
  std::vector<double> sheet_distances_;
  std::vector<SizingSample> added_;
  std::optional<std::vector<WidthSample>> widths_;  // none: not measured yet
  std::optional<std::vector<RimSide>> rim_;         // likewise
  std::optional<Probe> probe_;                      // likewise
};

// How far another sheet matters where the thickness itself is what sizes edges.
inline constexpr double kLongestThicknessPerDiagonal = 0.5;

// The largest part of its component's diagonal that an edge may have where max_edge is not given.
inline constexpr double kMaxEdgePerComponent = 0.25;

}  // namespace meshfront
