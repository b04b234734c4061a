// The original moving-least-squares surface of a point set (sec. 3.2, "MLS Surfaces"; [2], [24]).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/surface/implicit_mls_surface.h"
#include "core/surface/mls_fit.h"
#include "core/surface/point_surface.h"

namespace meshfront {

// The places that the projection of MlsFit leaves where they are: the zero set of its SignedDistance. Where no plane fits
// (too few samples, or sheets that cross) it is the implicit surface of the same samples, which is also where all
// iterations begin. Immutable after ComputeCurvature, safe to read from many threads, deterministic.
class MlsSurface final : public PointSurface {
 public:
  explicit MlsSurface(std::unique_ptr<MlsSamples> samples);

  const MlsSamples& samples() const override { return implicit_.samples(); }
  absl::Status ComputeCurvature(const Context& context) override;
  absl::Span<const double> curvatures() const override { return curvatures_; }
  MlsValue<1> ValueAt(const Vec3& x, uint32_t patch) const override { return Evaluate<1>(x, patch); }
  double AsymmetryAt(uint32_t sample) const override { return implicit_.AsymmetryAt(sample); }
  SourcePoint AtSample(uint32_t sample) const override;

  // SignedDistance with its exact derivatives, about 5 µs with the first and 20 µs with the second ones.
  template <int kOrder>
  MlsValue<kOrder> Evaluate(const Vec3& x, uint32_t patch) const;

  std::optional<SourcePoint> FindApex(const SourcePoint& a, const SourcePoint& b, double radius_a,
                                      double radius_b) const override;
  SourcePoint Snap(const SourcePoint& start, const Vec3& target) const override;
  double MaxCurvatureAt(const SourcePoint& p) const override;

 private:
  SourcePoint FootOf(const SourcePoint& start, const Vec3& x) const override;
  struct Circle;
  double CurvatureAt(const Vec3& x, uint32_t patch) const;
  SourcePoint Project(const SourcePoint& start, const Vec3& target) const;
  bool MoveTo(const Circle& circle, SourcePoint& apex) const;

  ImplicitMlsSurface implicit_;
  std::vector<double> curvatures_;
};

}  // namespace meshfront
