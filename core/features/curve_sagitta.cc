// The longest chord that may replace a curve around each of its vertices. From long to short, the first whose sagitta (the
// largest distance of the vertices in its window from the chord) is that of an arc on which an ideal edge is at least as long.
// The fitted curvature alone misses bumps and zig-zags that are wider than its reach and narrower than an edge; looking from
// long to short takes the amplitude of noise at the scale of the edge, not at its own.
// Windows end at sharp vertices: those are kept exactly, and chords do not cross them. Where a window holds many vertices a part of
// them is looked at, evenly spread: a smooth rim of a million vertices would take hours otherwise.
#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/status_macros.h"
#include "core/features/curve.h"
#include "core/features/tolerances.h"
#include "core/geometry/segment.h"

namespace meshfront {
namespace {

// One half of a window around a vertex: how many strides it goes, and the place where it ends.
struct HalfWindow {
  size_t strides = 0;
  Vec3 end;
};

class ChordSearch {
 public:
  using LengthOfCurvature = absl::FunctionRef<double(double max_curvature)>;

  ChordSearch(const Curve& curve, LengthOfCurvature ideal_length)
      : curve_(curve),
        ideal_length_(ideal_length),
        sharp_(FindSharpVertices(curve)),
        sharp_before_(2 * curve.size() + 1) {
    for (size_t i = 0; i < 2 * curve.size(); ++i) sharp_before_[i + 1] = sharp_before_[i] + sharp_[i % curve.size()];
  }

  // At most `longest`, at least the shorter edge at vertex i; `longest` at sharp vertices.
  double LongestChordAt(size_t i, double longest) const {
    const size_t n = curve_.size();
    const double edge = std::min(Distance(curve_[i], curve_[i + 1]), Distance(curve_[i], curve_[i + n - 1]));
    if (sharp_[i] || !(edge > 0)) return longest;
    const double shortest = std::min(longest, std::max(edge, kIdealPerEdgeCircle * ideal_length_(1 / edge)));
    double chord = longest;
    for (int scale = 0; chord > shortest && scale < kMaxChordScales; ++scale, chord *= kChordScale) {
      if (StandsForCurve(i, chord)) return chord;
    }
    return std::max(chord, shortest);
  }

 private:
  bool StandsForCurve(size_t i, double chord) const {
    const size_t n = curve_.size(), stride = StrideFor(chord);
    const HalfWindow after = WindowFrom(i, chord / 2, stride, true);
    const HalfWindow before = WindowFrom(i, chord / 2, stride, false);
    double squared = 0;
    for (size_t k = i + n - before.strides * stride; k <= i + n + after.strides * stride; k += stride) {
      squared = std::max(squared, SquaredDistanceToSegment(curve_[k], before.end, after.end));
    }
    const double span = Distance(before.end, after.end);
    return span > 0 && ideal_length_(8 * std::sqrt(squared) / (span * span)) >= span;
  }

  // 1, unless the curve is so fine against the chord that more than kWindowVertices would lie in its window on average.
  size_t StrideFor(double chord) const {
    const double vertices = static_cast<double>(curve_.size()) * std::min(chord / curve_.length(), 1.0);
    return std::max<size_t>(1, static_cast<size_t>(vertices / kWindowVertices));
  }

  // Up to `reach` of arc away from vertex i, measured from stride to stride, or to the first stride that reaches a sharp vertex.
  HalfWindow WindowFrom(size_t i, double reach, size_t stride, bool forward) const {
    const size_t n = curve_.size(), limit = std::min(n / 2 / stride, kMaxWindow);
    HalfWindow window{0, curve_[i]};
    double left = reach;
    for (size_t at = i; window.strides < limit; ++window.strides) {
      const size_t next = (forward ? at + stride : at + n - stride) % n;
      const double edge = Distance(curve_[at], curve_[next]);
      if (edge > left) {
        window.end = Lerp(curve_[at], curve_[next], left / edge);
        break;
      }
      left -= edge;
      window.end = curve_[next];
      if (HasSharp(forward ? at + 1 : next, stride)) break;
      at = next;
    }
    return window;
  }

  // Whether one of `count` vertices from `first` on is sharp.
  bool HasSharp(size_t first, size_t count) const {
    const size_t begin = first % curve_.size();
    return sharp_before_[begin + count] > sharp_before_[begin];
  }

  const Curve& curve_;
  LengthOfCurvature ideal_length_;
  std::vector<bool> sharp_;
  std::vector<uint32_t> sharp_before_;  // of two rounds: how many of the vertices before are sharp
};

}  // namespace

absl::StatusOr<std::vector<double>> LongestChords(const Curve& curve, absl::Span<const double> longest,
                                                  absl::FunctionRef<double(double max_curvature)> ideal_length,
                                                  const Context& context) {
  const ChordSearch search(curve, ideal_length);
  std::vector<double> chords(curve.size());
  for (size_t i = 0; i < curve.size(); ++i) {
    if (i % kChordStopInterval == 0) MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    chords[i] = search.LongestChordAt(i, longest[i]);
  }
  return chords;
}

}  // namespace meshfront
