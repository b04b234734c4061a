#include "core/features/boundary.h"

#include <algorithm>
#include <utility>

#include "core/base/status_macros.h"
#include "core/features/curve.h"
#include "core/features/tolerances.h"

namespace meshfront {
namespace {

using Rim = std::vector<uint32_t>;  // half-edges, the mesh on their left

std::vector<Rim> RimsOf(const MeshSurface& surface) {
  std::vector<Rim> rims = FindBoundaryLoops(surface.adjacency());
  // A manifold has no shorter ones; nothing could be grown from them.
  std::erase_if(rims, [](const Rim& rim) { return rim.size() < 3; });
  return rims;
}

ClosedCurve CurveOf(const MeshSurface& surface, const Rim& rim) {
  std::vector<Vec3> points;
  points.reserve(rim.size());
  for (uint32_t h : rim) points.push_back(surface.mesh().PositionAt(OriginOf(surface.mesh(), h)));
  return ClosedCurve(std::move(points));
}

// The place at share t of a half-edge, as the surface knows it.
SourcePoint PlaceOnRim(const MeshSurface& surface, const Rim& rim, const CurvePoint& p) {
  const uint32_t h = rim[p.segment];
  if (p.t == 0) return surface.AtVertex(OriginOf(surface.mesh(), h));
  double weights[3] = {0, 0, 0};
  weights[h % 3] = 1 - p.t;
  weights[(h + 1) % 3] = p.t;
  return surface.AtFace(FaceId(FaceOfHalfEdge(h)), weights[1], weights[2]);
}

}  // namespace

absl::StatusOr<std::vector<SizingSample>> BoundarySizingSamples(
    const MeshSurface& surface, absl::FunctionRef<double(double max_curvature)> ideal_length, const Context& context) {
  std::vector<SizingSample> samples;
  for (const Rim& rim : RimsOf(surface)) {
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    const ClosedCurve curve = CurveOf(surface, rim);
    const double longest = curve.length() / kMinEdgesPerLoop;
    std::vector<double> smooth = CurveCurvatures(curve);
    for (double& value : smooth) value = std::min(longest, ideal_length(value));
    MESHFRONT_ASSIGN_OR_RETURN(const std::vector<double> chords, LongestChords(curve, smooth, ideal_length, context));
    for (size_t i = 0; i < curve.size(); ++i) {
      if (chords[i] > 0) samples.push_back({curve[i], chords[i]});
    }
  }
  return samples;
}

absl::StatusOr<std::vector<OrientedLoop>> BoundaryLoops(const MeshSurface& surface, const GuidanceField& field,
                                                        const Context& context) {
  std::vector<OrientedLoop> loops;
  for (const Rim& rim : RimsOf(surface)) {
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    const ClosedCurve curve = CurveOf(surface, rim);
    MESHFRONT_ASSIGN_OR_RETURN(const std::vector<CurvePoint> points,
                               ResampleCurve(
                                   curve, [&](const Vec3& x) { return field.At(x); }, context));
    OrientedLoop loop;
    loop.points.reserve(points.size());
    for (size_t i = points.size(); i-- > 0;) loop.points.push_back(PlaceOnRim(surface, rim, points[i]));
    loops.push_back(std::move(loop));
  }
  return loops;
}

}  // namespace meshfront
