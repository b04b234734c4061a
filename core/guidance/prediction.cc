//   1. g at every vertex, once (EvaluateVertices), runs of vertices close to each other together;
//   2. per face, the integral: a face small against g by the edge-midpoint rule with g interpolated (g is Lipschitz with
//      1 − 1/η, so it changes little there); a larger one in four, with g evaluated at the new corners;
//   3. on a part of the faces, evenly spread, once more with g evaluated between the corners, and with what the front makes of
//      that (TrianglesPerIdealTriangle). Samples lie at vertices, where the field has its pits, so that what is interpolated
//      between pits is too small. The ratio of the two corrects the whole;
//   4. sums per block of faces, added in the order of blocks.
#include "core/guidance/prediction.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/status_macros.h"
#include "core/geometry/box.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

constexpr size_t kVertexGrain = 1024;  // vertices per block: about 0.2 ms
constexpr size_t kFaceGrain = 2048;
// A face is split while an edge is longer than this multiple of its smallest g: below, g varies by less than 1 − 1/η. Where there
// are many faces the errors of coarser pieces cancel, and the part that is checked corrects what is left of them.
constexpr double kSplitRatio = 1.0, kSplitRatioOfMany = 2.0;
constexpr size_t kManyFaces = 32768;
// The splits of all faces together stay below this many pieces, however coarse the input and fine the field.
constexpr double kMaxPieces = 1 << 20;
// What the front makes of an ideal triangle, fitted to runs of the engine over generated shapes at eta from 1.1 to 1.8.
constexpr double kMorePerSquaredGradient = 2.0;
constexpr double kFewerPerSquaredBend = 0.16;
constexpr double kMaxBend = 1.7320508075688772;  // √3: an edge that subtends a third of the circle
constexpr int kMinDepth = 2, kMaxDepth = 8;
// Vertices in a row that lie within a ball of this radius, in parts of g, are evaluated together, from so many on.
constexpr double kRunPerGuidance = 0.5;
constexpr size_t kShortestRun = 3, kLongestRun = 256;

struct Corner {
  Vec3 position;
  double g, curvature;
};

double InverseSquare(double g) { return 1 / (g * g); }

// ∫ dA / g² with g interpolated between corners; that once more on the part that is checked, and there what to expect instead.
struct Integrals {
  double all = 0, checked = 0, expected = 0;
  Integrals& operator+=(const Integrals& other) {
    all += other.all, checked += other.checked, expected += other.expected;
    return *this;
  }
};

class Integrator {
 public:
  Integrator(const GuidanceField& field, double split_ratio)
      : field_(field), patch_(field), slope_(1 - 1 / field.eta()), split_ratio_(split_ratio) {}

  // `depth`: of further splits, at most. `checks`: < 0: none; else of the parts that the next `checks` splits make each is checked,
  // of those of further splits the one in the middle.
  Integrals Over(const Corner& a, const Corner& b, const Corner& c, int depth, int checks) {
    const double longest = std::sqrt(SquaredLongestSide(a.position, b.position, c.position));
    if (depth == 0 || longest <= split_ratio_ * std::min({a.g, b.g, c.g})) return OverLeaf(a, b, c, checks >= 0);
    const Corner ab = Middle(a, b), bc = Middle(b, c), ca = Middle(c, a);
    const int outer = checks > 0 ? checks - 1 : -1, inner = checks > 0 ? checks - 1 : checks;
    Integrals sum = Over(a, ab, ca, depth - 1, outer);
    sum += Over(ab, b, bc, depth - 1, outer);
    sum += Over(ca, bc, c, depth - 1, outer);
    return sum += Over(ab, bc, ca, depth - 1, inner);
  }

 private:
  // Both rules are exact for quadratics: the middles of the edges; the corners and, with three quarters, the centroid.
  Integrals OverLeaf(const Corner& a, const Corner& b, const Corner& c, bool is_checked) {
    const double area = TriangleArea(a.position, b.position, c.position);
    Integrals leaf;
    leaf.all = area / 3 *
               (InverseSquare(0.5 * (a.g + b.g)) + InverseSquare(0.5 * (b.g + c.g)) + InverseSquare(0.5 * (c.g + a.g)));
    if (!is_checked || !(area > 0)) return leaf;
    const Vec3 center = (a.position + b.position + c.position) / 3.0;
    const double corners = InverseSquare(a.g) + InverseSquare(b.g) + InverseSquare(c.g);
    const double bound = std::min({BoundAt(center, a), BoundAt(center, b), BoundAt(center, c)});
    patch_.Cover(center, bound, bound);
    const double g = patch_.At(center);
    const Vec3 along = Normalized(b.position - a.position), normal = AreaVector(a.position, b.position, c.position);
    const double gradient2 = SquaredSlope(center, g, along) + SquaredSlope(center, g, Cross(Normalized(normal), along));
    const double curvature = (a.curvature + b.curvature + c.curvature) / 3;
    leaf.checked = leaf.all;
    leaf.expected =
        area * (0.75 * InverseSquare(g) + corners / 12) * TrianglesPerIdealTriangle(g * curvature, gradient2);
    return leaf;
  }
  // Of g along a direction, over one edge length g to either side, which the patch covers: what varies within an edge the front doesn't follow.
  double SquaredSlope(const Vec3& x, double g, const Vec3& along) const {
    const Vec3 step = g * along;
    const double rise = patch_.At(x + step) - patch_.At(x - step);
    return 0.25 * rise * rise / SquaredNorm(step);
  }
  Corner Middle(const Corner& p, const Corner& q) const {
    const Vec3 x = 0.5 * (p.position + q.position);
    return {x, field_.At(x, std::min(BoundAt(x, p), BoundAt(x, q))), 0.5 * (p.curvature + q.curvature)};
  }
  double BoundAt(const Vec3& x, const Corner& known) const { return known.g + slope_ * Distance(x, known.position); }

  const GuidanceField& field_;
  FieldPatch patch_;
  const double slope_;  // of g, at most
  const double split_ratio_;
};

int DepthFor(size_t faces) {
  const double levels = std::floor(std::log2(kMaxPieces / static_cast<double>(faces)) / 2);
  return std::clamp(static_cast<int>(levels), kMinDepth, kMaxDepth);
}

int ChecksFor(size_t faces, size_t checked_pieces) {
  const double pieces_a_face = static_cast<double>(checked_pieces) / static_cast<double>(faces);
  return std::max(0, static_cast<int>(std::log2(pieces_a_face) / 2));
}

// Evaluates g at places, in their order, of which most lie near the one before.
class Evaluator {
 public:
  Evaluator(const GuidanceField& field, absl::Span<const Vec3> places, absl::Span<double> g)
      : field_(field), patch_(field), slope_(1 - 1 / field.eta()), places_(places), g_(g) {}

  void Evaluate(size_t begin, size_t end) {
    for (size_t i = begin; i < end;) {
      if (i == begin) {
        g_[i] = field_.At(places_[i]);
        ++i;
        continue;
      }
      const double bound = BoundAt(places_[i], i - 1);
      Box3 box;
      const size_t run = RunFrom(i, end, kRunPerGuidance * bound, box);
      if (run < kShortestRun) {
        g_[i] = field_.At(places_[i], bound);
        ++i;
        continue;
      }
      const Vec3 center = 0.5 * (box.min + box.max);
      patch_.Cover(center, 0.5 * box.Diagonal(), BoundAt(center, i - 1));
      for (const size_t after = i + run; i < after; ++i) g_[i] = patch_.At(places_[i]);
    }
  }

 private:
  double BoundAt(const Vec3& x, size_t known) const { return g_[known] + slope_ * Distance(x, places_[known]); }
  // How many places from one on lie in one ball of this radius, at least 1, and their box.
  size_t RunFrom(size_t first, size_t end, double radius, Box3& box) const {
    const double most = 4 * radius * radius;
    box.Extend(places_[first]);
    size_t i = first + 1;
    for (; i < end && i - first < kLongestRun; ++i) {
      Box3 longer = box;
      longer.Extend(places_[i]);
      if (SquaredDistance(longer.min, longer.max) > most) break;
      box = longer;
    }
    return i - first;
  }

  const GuidanceField& field_;
  FieldPatch patch_;
  const double slope_;
  const absl::Span<const Vec3> places_;
  const absl::Span<double> g_;
};

absl::StatusOr<std::vector<double>> EvaluateVertices(const FaceSpans& faces, const GuidanceField& field,
                                                     const Context& context) {
  std::vector<double> g(faces.positions.size());
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(g.size(), kVertexGrain, context, [&](size_t begin, size_t end) {
    Evaluator(field, faces.positions, absl::MakeSpan(g)).Evaluate(begin, end);
  }));
  return g;
}

}  // namespace

double TrianglesPerIdealTriangle(double length_curvature, double squared_gradient) {
  const double bend = std::min(length_curvature, kMaxBend);
  return kTrianglesPerIdealTriangle + kMorePerSquaredGradient * squared_gradient - kFewerPerSquaredBend * bend * bend;
}

absl::StatusOr<double> PredictTriangles(const FaceSpans& faces, const GuidanceField& field, const Context& context,
                                        size_t checked_pieces) {
  if (faces.triangles.empty()) return 0.0;
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<double> g, EvaluateVertices(faces, field, context));
  const int depth = DepthFor(faces.triangles.size());
  const size_t stride = faces.triangles.size() / checked_pieces | 1;  // odd: not in step with the rows of a grid
  const int checks = ChecksFor(faces.triangles.size(), checked_pieces);
  std::vector<Integrals> sums((faces.triangles.size() + kFaceGrain - 1) / kFaceGrain);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(faces.triangles.size(), kFaceGrain, context, [&](size_t begin, size_t end) {
    Integrator integrator(field, faces.triangles.size() < kManyFaces ? kSplitRatio : kSplitRatioOfMany);
    for (size_t f = begin; f < end; ++f) {
      Corner corners[3];
      for (int i = 0; i < 3; ++i) {
        const uint32_t v = faces.triangles[f][i].index();
        corners[i] = {faces.positions[v], g[v], faces.curvatures.empty() ? 0 : faces.curvatures[v]};
      }
      sums[begin / kFaceGrain] +=
          integrator.Over(corners[0], corners[1], corners[2], depth, f % stride == 0 ? checks : -1);
    }
  }));
  Integrals total;
  for (const Integrals& sum : sums) total += sum;
  const double ratio = total.checked > 0 && std::isfinite(total.checked) ? total.expected / total.checked : 1;
  return ratio * total.all / (std::sqrt(3.0) / 4);
}

}  // namespace meshfront
