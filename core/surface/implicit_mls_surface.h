// The surface of a point set with oriented normals as the zero set of a function (sec. 3.2, "Linear MLS Surfaces").
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/geometry/jet.h"
#include "core/surface/mls_samples.h"
#include "core/surface/point_surface.h"

namespace meshfront {

// f(x) = Σ w_i ½ (n(x) + n_i)·(x − p_i) / Σ w_i, w_i = (1 − |x − p_i|²/r_i²)⁴ with r_i the radius of a sample's weight and n(x) the direction of Σ w_i n_i: the
// half with n(x) is the paper's n(x)·(x − a(x)), which lies inside of a sphere by about h²/12r, the other lies outside
// by as much. Where weights are narrow, at sharp dents, which the first half fills and the other does not, it has less than half of the say.
class ImplicitMlsSurface final : public PointSurface {
 public:
  explicit ImplicitMlsSurface(std::unique_ptr<MlsSamples> samples);

  // 3 µs a sample and core. Curvatures are those of the surface that all weights would make if they were as wide as the supports: what
  // bends more is a line between samples, along which shorter edges are of no use.
  absl::Status ComputeCurvature(const Context& context) override;

  const MlsSamples& samples() const override { return *samples_; }
  absl::Span<const double> curvatures() const override { return curvatures_; }
  double AsymmetryAt(uint32_t sample) const override;
  SourcePoint AtSample(uint32_t sample) const override;
  MlsValue<1> ValueAt(const Vec3& x, uint32_t patch) const override { return Evaluate<1>(x, patch); }

  // `kWide`: with weights as wide as the supports.
  template <int kOrder, bool kWide = false>
  MlsValue<kOrder> Evaluate(const Vec3& x, uint32_t patch) const;

  std::optional<SourcePoint> FindApex(const SourcePoint& a, const SourcePoint& b, double radius_a,
                                      double radius_b) const override;
  SourcePoint Snap(const SourcePoint& start, const Vec3& target) const override;
  double MaxCurvatureAt(const SourcePoint& p) const override;

 private:
  SourcePoint FootOf(const SourcePoint& start, const Vec3& x) const override;
  struct Circle;
  std::optional<double> FindAngle(const Circle& circle, const Vec3& normal, double angle, SourcePoint& at) const;
  SourcePoint Descend(Vec3 x, const Vec3& normal, uint32_t patch) const;

  std::unique_ptr<MlsSamples> samples_;
  std::vector<double> curvatures_;
  std::vector<float> asymmetries_;
};

}  // namespace meshfront
