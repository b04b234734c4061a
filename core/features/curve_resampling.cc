//   1. Anchors: the corners; without any, the vertex where the field is smallest.
//   2. MarkPiece walks a piece between anchors with steps whose chords equal the field's length at their start, and tells how
//      many steps it takes, with a fraction for the last.
//   3. DividePiece takes the whole number nearest in ratio and spreads its points evenly over the count of steps, so that
//      spacing follows the field and closes.
//   4. FindFarVertices: where a chord leaves the curve too far aside, the vertex farthest from it becomes an anchor, unless it
//      lies too close to one; again from 2, a few times.
//   5. Fewer than three points of a closed curve: again with the three vertices that span it as anchors. Fewer than asked for:
//      evenly along it.
// Rejected: a second walk with scaled steps. It rarely ends where it should; spreading in step 3 does by construction.
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/features/curve.h"
#include "core/features/tolerances.h"
#include "core/geometry/segment.h"

namespace meshfront {
namespace {

// A piece of the curve between two vertices; `end` may run around up to twice the size.
struct Piece {
  uint32_t begin, end;
};

// The t in [0, 1] at which the segment from inside the ball to outside of it crosses the sphere.
double CrossingOf(const Vec3& inside, const Vec3& outside, const Vec3& center, double radius) {
  const Vec3 d = outside - inside, m = inside - center;
  const double a = SquaredNorm(d), b = Dot(m, d), c = std::min(SquaredNorm(m) - radius * radius, 0.0);
  const double root = std::sqrt(std::max(b * b - a * c, 0.0));
  // −c / (b + root) where that does not cancel, (root − b) / a otherwise.
  const double t = b > 0 ? -c / (b + root) : (root - b) / a;
  return std::isfinite(t) ? std::clamp(t, 0.0, 1.0) : 1;
}

class Resampler {
 public:
  Resampler(const Curve& curve, LengthField field, const Context& context, const CurveLimits& limits)
      : curve_(curve), field_(field), context_(context), limits_(limits) {}

  absl::StatusOr<std::vector<CurvePoint>> Run() {
    MESHFRONT_ASSIGN_OR_RETURN(std::vector<uint32_t> anchors, FindCorners(curve_, field_, context_));
    if (!curve_.closed()) anchors.insert(anchors.begin(), 0);
    if (anchors.empty()) anchors = {VertexOfSmallestLength()};
    MESHFRONT_RETURN_IF_ERROR(DivideBetween(anchors));
    MESHFRONT_RETURN_IF_ERROR(DivideAtFarVertices(anchors));
    if (curve_.closed() && points_.size() < 3) {
      anchors = SpanningVertices();
      MESHFRONT_RETURN_IF_ERROR(DivideBetween(anchors));
      if (std::isfinite(limits_.max_sagitta)) MESHFRONT_RETURN_IF_ERROR(DivideAtFarVertices(anchors));
    }
    if (points_.size() < limits_.least) DivideEvenly();
    for (CurvePoint& p : points_) p.segment %= curve_.size();
    return std::move(points_);
  }

 private:
  uint32_t VertexOfSmallestLength() const {
    uint32_t best = 0;
    double smallest = field_(curve_[0]);
    for (uint32_t i = 1; i < curve_.size(); ++i) {
      const double g = field_(curve_[i]);
      if (g < smallest) smallest = g, best = i;
    }
    return best;
  }

  template <class Measure>
  uint32_t FarthestVertex(Measure measure) const {
    uint32_t best = 0;
    for (uint32_t i = 1; i < curve_.size(); ++i) {
      if (measure(i) > measure(best)) best = i;
    }
    return best;
  }

  // Three vertices whose triangle is large: two far apart, and the one farthest from the line between them. On a collinear curve
  // any third one.
  std::vector<uint32_t> SpanningVertices() const {
    const uint32_t a = FarthestVertex([&](uint32_t i) { return SquaredDistance(curve_[i], curve_[0]); });
    const uint32_t b = FarthestVertex([&](uint32_t i) { return SquaredDistance(curve_[i], curve_[a]); });
    uint32_t c =
        FarthestVertex([&](uint32_t i) { return SquaredNorm(Cross(curve_[i] - curve_[a], curve_[b] - curve_[a])); });
    if (c == a || c == b) {
      c = 0;
      while (c == a || c == b) ++c;
    }
    std::vector<uint32_t> span{a, b, c};
    std::sort(span.begin(), span.end());
    return span;
  }

  // Where the piece behind the last anchor ends.
  uint32_t EndAfter(const std::vector<uint32_t>& anchors) const {
    const auto size = static_cast<uint32_t>(curve_.size());
    return curve_.closed() ? anchors[0] + size : size - 1;
  }

  void DivideEvenly() {
    points_.clear();
    for (size_t i = 0; i < limits_.least; ++i)
      points_.push_back(
          curve_.PointAtArc(curve_.length() * static_cast<double>(i) / static_cast<double>(limits_.least)));
  }

  absl::Status DivideAtFarVertices(std::vector<uint32_t>& anchors) {
    const int rounds = std::isfinite(limits_.max_sagitta) ? kMaxRefinementsForSagitta : kMaxRefinements;
    for (int round = 0; round < rounds; ++round) {
      const std::vector<uint32_t> far = FindFarVertices(anchors);
      if (far.empty()) break;
      anchors.insert(anchors.end(), far.begin(), far.end());
      std::sort(anchors.begin(), anchors.end());
      MESHFRONT_RETURN_IF_ERROR(DivideBetween(anchors));
    }
    return absl::OkStatus();
  }

  absl::Status DivideBetween(const std::vector<uint32_t>& anchors) {
    points_.clear();
    for (size_t i = 0; i < anchors.size(); ++i) {
      const bool last = i + 1 == anchors.size();
      const uint32_t next = last ? EndAfter(anchors) : anchors[i + 1];
      MESHFRONT_RETURN_IF_ERROR(DividePiece({anchors[i], next}));
    }
    return absl::OkStatus();
  }

  // Fills marks_ with the arcs of the steps' starts, and the piece's end last; returns the number of steps.
  absl::StatusOr<double> MarkPiece(const Piece& piece) {
    marks_.clear();
    CurvePoint at{piece.begin, 0};
    while (true) {
      if (marks_.size() % kStopInterval == 0) MESHFRONT_RETURN_IF_ERROR(context_.CheckStop());
      if (points_.size() + marks_.size() > kMaxCurvePoints) {
        return absl::ResourceExhaustedError(absl::StrCat("a boundary of length ", curve_.length(),
                                                         " would get more than ", kMaxCurvePoints,
                                                         " vertices at the edge length asked for; it must be larger"));
      }
      marks_.push_back(curve_.ArcAt(at));
      const Vec3 from = curve_.At(at);
      const double radius = field_(from);
      if (!StepTo(piece, from, radius, at)) {
        marks_.push_back(curve_.ArcAt({piece.end, 0}));
        return static_cast<double>(marks_.size() - 2) + std::min(Distance(from, curve_[piece.end]) / radius, 1.0);
      }
    }
  }

  // Moves `at` to where the curve leaves the ball around `from`; false when the piece ends before.
  bool StepTo(const Piece& piece, const Vec3& from, double radius, CurvePoint& at) const {
    Vec3 inside = from;
    double start = at.t;
    for (uint32_t i = at.segment; i != piece.end; ++i, start = 0) {
      const Vec3& next = curve_[i + 1];
      if (Distance(next, from) >= radius) {
        const double t = start + (1 - start) * CrossingOf(inside, next, from, radius);
        at = t < 1 ? CurvePoint{i, t} : CurvePoint{i + 1, 0};
        return at.segment != piece.end;
      }
      inside = next;
    }
    return false;
  }

  absl::Status DividePiece(const Piece& piece) {
    MESHFRONT_ASSIGN_OR_RETURN(const double steps, MarkPiece(piece));
    double count = std::max(1.0, std::floor(steps));
    if (steps * steps > count * (count + 1)) ++count;
    points_.push_back({piece.begin, 0});
    const size_t last = marks_.size() - 2;
    for (double j = 1; j < count; ++j) {
      const double step = steps * (j / count);
      const size_t i = std::min(static_cast<size_t>(step), last);
      const double width = i < last ? 1 : steps - static_cast<double>(last);
      const double share = width > 0 ? (step - static_cast<double>(i)) / width : j / count;
      const CurvePoint p = curve_.PointAtArc(marks_[i] + share * (marks_[i + 1] - marks_[i]));
      if (IsAfter(p, points_.back()) && IsAfter({piece.end, 0}, p)) points_.push_back(p);
    }
    return absl::OkStatus();
  }

  // Strictly later along the curve, and elsewhere in space.
  bool IsAfter(const CurvePoint& p, const CurvePoint& before) const {
    if (p.segment < before.segment || (p.segment == before.segment && p.t <= before.t)) return false;
    return curve_.At(p) != curve_.At(before);
  }

  // The vertex farthest from each chord that leaves the curve too far aside, where it is far enough from all anchors and from
  // those already found.
  std::vector<uint32_t> FindFarVertices(const std::vector<uint32_t>& anchors) const {
    std::vector<uint32_t> found;
    for (size_t i = 0; i < points_.size(); ++i) {
      const std::optional<uint32_t> far = FarthestFromChord(i);
      if (!far) continue;
      const double room = RoomAt(*far, i);
      if (!found.empty() && Distance(curve_[*far], curve_[found.back()]) < room) continue;
      const auto next = std::upper_bound(anchors.begin(), anchors.end(), *far);
      const uint32_t after = next == anchors.end() ? EndAfter(anchors) : *next;
      const uint32_t before = next == anchors.begin() ? anchors.back() : *(next - 1);
      if (Distance(curve_[*far], curve_[after]) < room || Distance(curve_[*far], curve_[before]) < room) continue;
      found.push_back(*far);
    }
    return found;
  }

  // How far from others a vertex under the chord from point i must lie to become an anchor. Between two nodes the curve is followed
  // however coarse the field is: a crease of a few edges is seen as much as a long one. So is any where a sagitta is asked for.
  double RoomAt(uint32_t vertex, size_t i) const {
    const Vec3 from = curve_.At(points_[i]), to = EndOfChord(i);
    const bool is_far = DistanceToSegment(curve_[vertex], from, to) > limits_.max_sagitta;
    if (curve_.closed() && !is_far) return kMinAnchorDistance * field_(curve_[vertex]);
    if (!is_far) return kMinCreaseAnchorDistance * Distance(from, to);
    return std::max(limits_.shortest, kMinSagittaAnchorDistance * Distance(from, to));
  }
  Vec3 EndOfChord(size_t i) const {
    if (i + 1 < points_.size()) return curve_.At(points_[i + 1]);
    return curve_.closed() ? curve_.At(points_[0]) : curve_[curve_.size() - 1];
  }

  // Of the vertices that the chord from point i to the next skips, the one farthest from it, if that is too far.
  std::optional<uint32_t> FarthestFromChord(size_t i) const {
    const CurvePoint& a = points_[i];
    CurvePoint b = points_[(i + 1) % points_.size()];
    if (i + 1 == points_.size()) {
      b.segment += static_cast<uint32_t>(curve_.size());
      if (!curve_.closed()) b = {static_cast<uint32_t>(curve_.size() - 1), 0};
    }
    const Vec3 from = curve_.At(a), to = curve_.At(b);
    double farthest = curve_.closed() ? kMaxSagittaShare * std::max(Distance(from, to), field_(from))
                                      : kMaxCreaseSagittaShare * Distance(from, to);
    farthest = std::min(farthest, limits_.max_sagitta);
    std::optional<uint32_t> vertex;
    const uint32_t end = b.t > 0 ? b.segment + 1 : b.segment;
    for (uint32_t k = a.segment + 1; k < end; ++k) {
      const double distance = DistanceToSegment(curve_[k], from, to);
      if (distance > farthest) farthest = distance, vertex = k % static_cast<uint32_t>(curve_.size());
    }
    return vertex;
  }

  const Curve& curve_;
  LengthField field_;
  const Context& context_;
  const CurveLimits limits_;
  std::vector<CurvePoint> points_;  // segments run on past the size until the end
  std::vector<double> marks_;
};

}  // namespace

absl::StatusOr<std::vector<CurvePoint>> ResampleCurve(const Curve& curve, LengthField field, const Context& context,
                                                      const CurveLimits& limits) {
  return Resampler(curve, field, context, limits).Run();
}

}  // namespace meshfront
