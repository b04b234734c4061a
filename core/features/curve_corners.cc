//   1. TurnAt: the cosine between the chords into and out of a vertex, at a given chord length;
//   2. candidates turn by more than 45° at both scales, the sharper scale counts;
//   3. the sharpest first, a candidate is kept when no corner lies within the least distance along the curve.
// Rejected: the turn of adjacent edges alone; on a scan's rim every second vertex is a corner then.
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/status_macros.h"
#include "core/features/curve.h"
#include "core/features/tolerances.h"

namespace meshfront {
namespace {

// The vector from vertex i along a chord of `radius`, forward or backward: to the place where the curve leaves the ball around
// the vertex, or to the last vertex within reach.
Vec3 ChordFrom(const Curve& curve, size_t i, double radius, bool forward) {
  const size_t n = curve.size();
  const Vec3& center = curve[i];
  Vec3 last = center;
  const size_t to_end = forward ? n - 1 - i : i;
  for (size_t k = 1; k <= std::min(kChordReach, curve.closed() ? n / 2 : to_end); ++k) {
    const Vec3& next = curve[forward ? i + k : i + n - k];
    const double reached = Distance(next, center), before = Distance(last, center);
    if (reached >= radius) {
      // Linear in the distance: exact on the first edge, good enough for an angle beyond it.
      const double t = reached > before ? (radius - before) / (reached - before) : 1;
      return Lerp(last, next, t) - center;
    }
    last = next;
  }
  return last - center;
}

double TurnAt(const Curve& curve, size_t i, double radius) {
  const Vec3 in = -ChordFrom(curve, i, radius, false), out = ChordFrom(curve, i, radius, true);
  const double lengths = Norm(in) * Norm(out);
  return lengths > 0 ? Dot(in, out) / lengths : 1;
}

struct Candidate {
  double cosine;
  uint32_t vertex;
  double radius;
};

bool HasCornerWithin(const Curve& curve, const std::vector<bool>& is_corner, const Candidate& c) {
  const size_t n = curve.size();
  for (const bool forward : {true, false}) {
    const size_t to_end = forward ? n - 1 - c.vertex : c.vertex;
    for (size_t k = 1; k <= std::min(kChordReach, curve.closed() ? n - 1 : to_end); ++k) {
      const size_t i = (forward ? c.vertex + k : c.vertex + n - k) % n;
      if (Distance(curve[i], curve[c.vertex]) >= c.radius) break;
      if (is_corner[i]) return true;
    }
  }
  return false;
}

}  // namespace

absl::StatusOr<std::vector<uint32_t>> FindCorners(const Curve& curve, LengthField field, const Context& context) {
  std::vector<Candidate> candidates;
  const auto ends = curve.closed() ? 0u : 1u;  // which are corners anyhow
  for (uint32_t i = ends; i + ends < curve.size(); ++i) {
    if (i % kCornerStopInterval == 0) MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    const double g = field(curve[i]);
    const double near = TurnAt(curve, i, 0.5 * g);
    if (near >= kCornerCosine || TurnAt(curve, i, g) >= kCornerCosine) continue;
    candidates.push_back({near, i, kMinAnchorDistance * g});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.cosine < b.cosine; });
  std::vector<bool> is_corner(curve.size());
  if (!curve.closed()) is_corner.front() = is_corner.back() = true;
  std::vector<uint32_t> corners;
  for (const Candidate& c : candidates) {
    if (HasCornerWithin(curve, is_corner, c)) continue;
    is_corner[c.vertex] = true;
    corners.push_back(c.vertex);
  }
  std::sort(corners.begin(), corners.end());
  return corners;
}

}  // namespace meshfront
