// 1. a polygon with edges of a spacing, a spacing inside of the rim, where the last samples are, and the surface behind it
// 2. a patch (mesh/hole_patch.h)    3. its vertices are samples, unless it passes through those there are, or an earlier one
#include "core/gap_filling.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/base/status_macros.h"
#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"
#include "core/mesh/hole_patch.h"

namespace meshfront {
namespace {

constexpr size_t kFewestRimVertices = 8;
// A patch nearer to a sample than this many spacings passes through the surface there. Not where it begins: within a support of its rim.
constexpr double kThrough = 1.0;

struct Rim {
  std::vector<HoleRimVertex> vertices;
  std::vector<bool> is_beside;  // of each sample
};

double SpacingAt(const MlsSamples& samples, uint32_t patch) { return samples.SpacingAt(samples.MembersOf(patch)[0]); }

// The curve has the surface on its right.
Rim DivideRim(const PointSurface& surface, const RimCurve& curve) {
  const MlsSamples& samples = surface.samples();
  double spacing = 0;
  Rim rim;
  rim.is_beside.resize(samples.samples().size(), false);
  for (const SourcePoint& p : curve.places) {
    spacing += SpacingAt(samples, p.patch) / static_cast<double>(curve.places.size());
    for (const uint32_t i : samples.ListOf(p.patch)) {
      const double reach = samples.samples()[i].support;
      if (SquaredDistance(samples.samples()[i].position, p.position) <= reach * reach) rim.is_beside[i] = true;
    }
  }
  const size_t n = curve.places.size();
  const size_t count = std::clamp(static_cast<size_t>(std::lround(curve.length / spacing)), kFewestRimVertices, n);
  double way = 0;
  size_t at = 0;
  for (size_t k = 0; k < count; ++k) {
    const double target = curve.length * static_cast<double>(k) / static_cast<double>(count);
    while (way < target && at + 1 < n) {
      way += Distance(curve.places[at].position, curve.places[at + 1].position);
      ++at;
    }
    const SourcePoint& p = curve.places[at];
    const Vec3 along = curve.places[(at + 1) % n].position - curve.places[(at + n - 1) % n].position;
    const double spacing_here = SpacingAt(samples, p.patch);
    const Vec3 inward = spacing_here * Normalized(Cross(along, p.normal));
    const SourcePoint last = surface.Snap(p, p.position + inward);
    const SourcePoint near = surface.Snap(last, p.position + 2 * inward);
    const Vec3 far = surface.Snap(near, p.position + 3 * inward).position;
    // Along the tangent of the parabola through all three: chords turn less than the surface does towards the rim.
    rim.vertices.push_back({last.position, last.normal, 0.5 * (4 * near.position - far - last.position)});
  }
  return rim;
}

bool PassesThroughSamples(const MlsSamples& samples, const Rim& rim, const HolePatch& patch) {
  const TriangleBvh bvh(patch.positions, patch.triangles);
  for (uint32_t i = 0; i < samples.samples().size(); ++i) {
    if (rim.is_beside[i] || samples.ComponentOf(i) == MlsSamples::kStray) continue;
    const Vec3& x = samples.samples()[i].position;
    const double reach = kThrough * samples.SpacingAt(i);
    if (bvh.bounds().SquaredDistanceTo(x) <= reach * reach && bvh.FindClosestPoint(x, reach)) return true;
  }
  return false;
}

// Whether a sample that was added for another gap lies closer to the patch than its edges are long.
bool PassesThroughPatches(const GapSamples& added, const HolePatch& patch) {
  if (added.positions.empty()) return false;
  const TriangleBvh bvh(patch.positions, patch.triangles);
  const double reach = Distance(patch.positions[0], patch.positions[1]);
  return std::any_of(added.positions.begin(), added.positions.end(), [&](const Vec3& x) {
    return bvh.bounds().SquaredDistanceTo(x) <= reach * reach && bvh.FindClosestPoint(x, reach).has_value();
  });
}

// Those of the polygon lie between samples.
void AddSamples(const Rim& rim, const HolePatch& patch, GapSamples& gaps) {
  std::vector<Vec3> normals(patch.positions.size());
  for (const Triangle& t : patch.triangles) {
    const std::vector<Vec3>& at = patch.positions;
    const Vec3 area = AreaVector(at[t[0].index()], at[t[1].index()], at[t[2].index()]);
    for (const VertexId v : t) normals[v.index()] += area;
  }
  for (size_t v = rim.vertices.size(); v < patch.positions.size(); ++v) {
    if (!(SquaredNorm(normals[v]) > 0)) continue;
    gaps.positions.push_back(patch.positions[v]);
    gaps.normals.push_back(Normalized(normals[v]));
  }
}

}  // namespace

absl::StatusOr<GapSamples> FillGaps(const PointSurface& surface, absl::Span<const RimCurve> rims, double size,
                                    const Context& context) {
  GapSamples gaps;
  for (const RimCurve& curve : rims) {
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    std::vector<Vec3> places;
    for (const SourcePoint& p : curve.places) places.push_back(p.position);
    if (IsWiderThan(places, size)) continue;
    const Rim rim = DivideRim(surface, curve);
    bool is_filled = false;
    for (const PatchShape shape : {PatchShape::kFair, PatchShape::kTaut}) {
      const std::optional<HolePatch> patch = MakeHolePatch(rim.vertices, {}, shape);
      if (!patch || PassesThroughSamples(surface.samples(), rim, *patch) || PassesThroughPatches(gaps, *patch))
        continue;
      AddSamples(rim, *patch, gaps);
      is_filled = true;
      break;
    }
    (is_filled ? gaps.places : gaps.left_open).push_back(places[0]);
  }
  return gaps;
}

}  // namespace meshfront
