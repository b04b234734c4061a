// From the samples of a point set to their guidance field, and the parameter of the sizing that makes a number of
// triangles: what FieldBuilder is for meshes.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/field_builder.h"
#include "core/guidance/guidance_field.h"
#include "core/surface/mls_rims.h"
#include "core/surface/point_surface.h"

namespace meshfront {

// Not thread-safe. `surface` must have its curvatures, and both outlive the builder.
class PointFieldBuilder {
 public:
  PointFieldBuilder(const PointSurface& surface, absl::Span<const RimCurve> rims, const SizingLimits& limits);

  const SizingLimits& limits() const { return limits_; }

  // As FieldBuilder's, with the same errors.
  absl::StatusOr<SizedField> Build(double parameter, const Context& context);
  absl::StatusOr<SizedField> BuildForCount(uint64_t count, const Context& context);
  void AddSample(const SizingSample& sample);

  double area() const { return area_; }
  double peak_curvature() const { return peak_curvature_; }
  // Lengths of the predicted edges, g at the samples, and how many triangles each stands for.
  std::vector<std::pair<double, double>> Lengths(const GuidanceField& field) const;

 private:
  double LengthAt(double curvature, double parameter) const;
  void AddRims(double parameter, std::vector<SizingSample>& sizes) const;
  double LongestGuidance(double parameter) const;
  double FirstGuess(double count) const;
  absl::Status MeasureThickness(double parameter, const Context& context);
  absl::StatusOr<double> Count(const GuidanceField& field, const Context& context) const;

  const PointSurface& surface_;
  const absl::Span<const RimCurve> rims_;
  const SizingLimits limits_;
  std::vector<double> longest_;          // of each component
  std::vector<double> sheet_distances_;  // of each patch; +infinity: none within what matters
  double measured_ = 0;                  // the parameter that they were measured for
  bool is_counting_ = false;             // a number of triangles is wanted
  std::vector<SizingSample> added_;
  double area_ = 0, peak_curvature_ = 0;
};

}  // namespace meshfront
