// What the preparation of a point set and its rims need of the surface that the points define, beyond Surface.
#pragma once

#include <array>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/geometry/jet.h"
#include "core/surface/mls_samples.h"
#include "core/surface/surface.h"

namespace meshfront {

// A function whose zero set is the surface, at a place, with derivatives up to the order: about the signed distance from
// the surface, growing outward.
template <int kOrder>
struct MlsValue {
  Jet<kOrder> f;
  // How far to one side the samples lie: of the distance to their weighted centroid, in parts of the support, the
  // square.
  Jet<kOrder> asymmetry2;
  double support = 0;  // weighted mean; 0: no sample has a say, and f is the distance from the nearest one's plane
};

// Implemented by: ImplicitMlsSurface, MlsSurface. Immutable after ComputeCurvature, safe to read from many threads,
// deterministic. A source point's patch is that of the samples, and its u is 1 on a rim.
class PointSurface : public Surface {
 public:
  virtual const MlsSamples& samples() const = 0;
  // The largest absolute principal curvature at each sample, on the context's threads; AsymmetryAt is faster after it. To be called once.
  virtual absl::Status ComputeCurvature(const Context& context) = 0;
  virtual absl::Span<const double> curvatures() const = 0;  // none before ComputeCurvature
  // The function at x as the patch's samples have it.
  virtual MlsValue<1> ValueAt(const Vec3& x, uint32_t patch) const = 0;
  // How far to one side the samples around one lie, in parts of the support.
  virtual double AsymmetryAt(uint32_t sample) const = 0;
  // The place of the surface near a sample.
  virtual SourcePoint AtSample(uint32_t sample) const = 0;

  // A good place to begin at in each component: where the surface is flat and the samples lie all around.
  std::vector<SourcePoint> Seeds() const;
  // Of places that TraceRims found.
  bool IsOnBoundary(const SourcePoint& p) const override { return p.u == 1; }
  // At places of a lattice over the triangle, by the function's value: what lies between them is smoother than the
  // samples are dense.
  bool FindFarPlaces(const SourcePoint& start, const std::array<Vec3, 3>& triangle, double bound, double beside,
                     std::vector<FarPlace>& far, std::vector<DoubtfulPart>* doubtful) const override;

 private:
  // The place of the surface near x, from the normal and the patch of `start` on.
  virtual SourcePoint FootOf(const SourcePoint& start, const Vec3& x) const = 0;
};

}  // namespace meshfront
