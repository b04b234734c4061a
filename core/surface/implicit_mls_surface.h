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
#include "core/surface/surface.h"

namespace meshfront {

// The function at a place, with derivatives up to the order: about the signed distance from the surface, growing
// outward.
template <int kOrder>
struct MlsValue {
  Jet<kOrder> f;
  // How far to one side the samples lie: of the distance to their weighted centroid, in parts of the support, the
  // square.
  Jet<kOrder> asymmetry2;
  double support = 0;  // weighted mean; 0: no sample has a say, and f is the distance from the nearest one's plane
};

// f(x) = Σ w_i ½ (n(x) + n_i)·(x − p_i) / Σ w_i, w_i = (1 − |x − p_i|²/h_i²)⁴ and n(x) the direction of Σ w_i n_i: the
// half with n(x) is the paper's n(x)·(x − a(x)), which lies inside of a sphere by about h²/12r, the other lies outside
// by as much. Immutable after ComputeCurvature, safe to read from many threads, deterministic. A source point's patch
// is that of the samples, and its u is 1 on a rim.
class ImplicitMlsSurface final : public Surface {
 public:
  explicit ImplicitMlsSurface(std::unique_ptr<MlsSamples> samples);

  // The largest absolute principal curvature at each sample, on the context's threads. To be called once. 3 µs a sample
  // and core.
  absl::Status ComputeCurvature(const Context& context);

  const MlsSamples& samples() const { return *samples_; }
  absl::Span<const double> curvatures() const { return curvatures_; }  // none before ComputeCurvature
  // How far to one side the samples around one lie, in parts of the support.
  double AsymmetryAt(uint32_t sample) const;
  // A good place to begin at in each component: where the surface is flat and the samples lie all around.
  std::vector<SourcePoint> Seeds() const;
  // The place of the surface near a sample.
  SourcePoint AtSample(uint32_t sample) const;

  template <int kOrder>
  MlsValue<kOrder> Evaluate(const Vec3& x, uint32_t patch) const;

  std::optional<SourcePoint> FindApex(const SourcePoint& a, const SourcePoint& b, double radius_a,
                                      double radius_b) const override;
  SourcePoint Snap(const SourcePoint& start, const Vec3& target) const override;
  double MaxCurvatureAt(const SourcePoint& p) const override;
  // Of places that TraceRims found.
  bool IsOnBoundary(const SourcePoint& p) const override { return p.u == 1; }
  // At places of a lattice over the triangle, by the function's value: what lies between them is smoother than the
  // samples are dense.
  bool FindFarPlaces(const SourcePoint& start, const std::array<Vec3, 3>& triangle, double bound, double beside,
                     std::vector<FarPlace>& far, std::vector<DoubtfulPart>* doubtful) const override;

 private:
  struct Circle;
  std::optional<double> FindAngle(const Circle& circle, const Vec3& normal, double angle, SourcePoint& at) const;
  SourcePoint Descend(Vec3 x, const Vec3& normal, uint32_t patch) const;

  std::unique_ptr<MlsSamples> samples_;
  std::vector<double> curvatures_;
};

}  // namespace meshfront
