// The longest chord that may replace a curve around each of its vertices. From long to short, the first whose sagitta (the
// largest distance of the vertices in its window from the chord) is that of an arc on which an ideal edge is at least as long.
// The fitted curvature alone misses bumps and zig-zags that are wider than its reach and narrower than an edge; looking from
// long to short takes the amplitude of noise at the scale of the edge, not at its own.
// Windows end at sharp vertices: those are kept exactly, and chords do not cross them.
#include <algorithm>
#include <cmath>

#include "core/features/curve.h"

namespace meshfront {
namespace {

constexpr double kScaleStep = 0.8;  // from one chord length to the next

double DistanceToSegment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double squared = SquaredNorm(d);
  const double t = squared > 0 ? std::clamp(Dot(p - a, d) / squared, 0.0, 1.0) : 0.0;
  return Distance(p, a + t * d);
}

// One half of a window around vertex i: the vertices up to `reach` of arc away (`step` is 1 or size − 1), ending at a sharp one, and
// the place where it ends.
struct HalfWindow {
  size_t count = 0;
  Vec3 end;
};

HalfWindow WindowFrom(const ClosedCurve& curve, const std::vector<bool>& sharp, size_t i, size_t step, double reach) {
  const size_t n = curve.size();
  HalfWindow window;
  window.end = curve[i];
  double left = reach;
  for (size_t at = i; window.count < n / 2; ++window.count) {
    const size_t next = (at + step) % n;
    const double edge = Distance(curve[at], curve[next]);
    if (edge > left) {
      window.end = Lerp(curve[at], curve[next], left / edge);
      break;
    }
    left -= edge;
    at = next;
    window.end = curve[at];
    if (sharp[at]) break;
  }
  return window;
}

}  // namespace

double LongestChordAt(const ClosedCurve& curve, const std::vector<bool>& sharp, size_t i, double longest,
                      absl::FunctionRef<double(double max_curvature)> ideal_length) {
  const size_t n = curve.size();
  const double shortest = std::min(Distance(curve[i], curve[i + 1]), Distance(curve[i], curve[i + n - 1]));
  if (sharp[i] || !(shortest > 0)) return longest;
  for (double chord = longest; chord > shortest; chord *= kScaleStep) {
    const HalfWindow after = WindowFrom(curve, sharp, i, 1, chord / 2);
    const HalfWindow before = WindowFrom(curve, sharp, i, n - 1, chord / 2);
    double sagitta = 0;
    for (size_t k = i + n - before.count; k <= i + n + after.count; ++k) {
      sagitta = std::max(sagitta, DistanceToSegment(curve[k], before.end, after.end));
    }
    const double span = Distance(before.end, after.end);
    if (!(span > 0)) continue;
    if (ideal_length(8 * sagitta / (span * span)) >= span) return chord;
  }
  return shortest;
}

}  // namespace meshfront
