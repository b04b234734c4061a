//   1. g at every vertex, once (EvaluateVertices), runs of vertices close to each other together;
//   2. per face, the integral: a face small against g by the edge-midpoint rule with g interpolated (g is Lipschitz with
//      1 − 1/η, so it changes little there); a larger one in four, with g evaluated at the new corners;
//   3. on a part of the faces, evenly spread, once more with g evaluated between the corners, and with what the front makes of
//      that (TrianglesPerIdealTriangle). Samples lie at vertices, where the field has its pits, so that what is interpolated
//      between pits is too small. The ratio of the two corrects the whole;
//   4. sums per block of faces, added in the order of blocks.
// Of many faces only some are asked, for g at their centroids if they are small (OverAsked): as many of all as their part of what the area
// and the curvature alone make of the count (ChooseAsked), so that each stands for about as many triangles.
// Rejected: every so-many-th face. On a scan with sharp detail that is off by a percent and a half.
#include "core/guidance/prediction.h"

#include <algorithm>
#include <cmath>
#include <limits>
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
// About as many of them are asked, flat ones as if they were bent by this part of the mean curvature.
constexpr size_t kAskedFaces = 16384;
constexpr double kFlatPerMean = 1;
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
  Integrals& operator*=(double factor) {
    all *= factor, checked *= factor, expected *= factor;
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

  // Of a face whose corners have no g yet, by g at its centroid if it is small; else as above. Faces come in their order.
  Integrals OverAsked(Corner a, Corner b, Corner c, int depth, int checks) {
    const Vec3 center = (a.position + b.position + c.position) / 3.0;
    last_ = {center, field_.At(center, last_.g > 0 ? BoundAt(center, last_) : std::numeric_limits<double>::max()), 0};
    const double g = last_.g, longest = std::sqrt(SquaredLongestSide(a.position, b.position, c.position));
    if (longest > split_ratio_ * g) {
      for (Corner* corner : {&a, &b, &c}) corner->g = field_.At(corner->position, BoundAt(corner->position, last_));
      return Over(a, b, c, depth, checks);
    }
    const double area = TriangleArea(a.position, b.position, c.position);
    Integrals leaf;
    leaf.all = area * InverseSquare(g);
    if (checks < 0 || !(area > 0)) return leaf;
    patch_.Cover(center, std::max(g, longest), g);
    double corners = 0;
    for (const Corner* corner : {&a, &b, &c}) corners += InverseSquare(patch_.At(corner->position));
    leaf.checked = leaf.all;
    leaf.expected = area * ExpectedPerArea(a, b, c, g, corners);
    return leaf;
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
    leaf.checked = leaf.all;
    leaf.expected = area * ExpectedPerArea(a, b, c, patch_.At(center), corners);
    return leaf;
  }
  // Of a piece around whose centre the patch lies, with g there, and the sum of 1/g² at its corners.
  double ExpectedPerArea(const Corner& a, const Corner& b, const Corner& c, double g, double corners) const {
    const Vec3 center = (a.position + b.position + c.position) / 3.0;
    const Vec3 along = Normalized(b.position - a.position), normal = AreaVector(a.position, b.position, c.position);
    const double gradient2 = SquaredSlope(center, g, along) + SquaredSlope(center, g, Cross(Normalized(normal), along));
    const double curvature = (a.curvature + b.curvature + c.curvature) / 3;
    return (0.75 * InverseSquare(g) + corners / 12) * TrianglesPerIdealTriangle(g * curvature, gradient2);
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
  Corner last_{{}, 0, 0};  // where it was asked last
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

namespace {

// A face, and how many times its integral counts.
struct AskedFace {
  uint32_t face;
  double weight;
};

// Evenly along the order of the faces.
std::vector<AskedFace> ChooseAsked(const FaceSpans& faces) {
  std::vector<double> areas(faces.triangles.size()),
      bent(faces.triangles.size());  // the area, and that times the curvature
  double area = 0, bent_area = 0;
  for (size_t f = 0; f < areas.size(); ++f) {
    const uint32_t a = faces.triangles[f][0].index(), b = faces.triangles[f][1].index(),
                   c = faces.triangles[f][2].index();
    areas[f] = TriangleArea(faces.positions[a], faces.positions[b], faces.positions[c]);
    if (!faces.curvatures.empty())
      bent[f] = areas[f] * (faces.curvatures[a] + faces.curvatures[b] + faces.curvatures[c]) / 3;
    area += areas[f], bent_area += bent[f];
  }
  const double flat = area > 0 && bent_area > 0 ? kFlatPerMean * bent_area / area : 1;
  const double step = (bent_area + flat * area) / static_cast<double>(kAskedFaces);
  std::vector<AskedFace> asked;
  double sum = 0, next = 0.5 * step;
  for (uint32_t f = 0; f < areas.size(); ++f) {
    const double part = bent[f] + flat * areas[f];
    sum += part;
    if (!(sum > next)) continue;
    const double times = std::floor((sum - next) / step) + 1;
    next += times * step;
    asked.push_back({f, times * step / part});
  }
  return asked;
}

std::vector<AskedFace> AllFaces(size_t count) {
  std::vector<AskedFace> all(count);
  for (uint32_t f = 0; f < count; ++f) all[f] = {f, 1};
  return all;
}

// `g`: at the vertices; empty where not all faces are asked.
absl::StatusOr<Integrals> Integrate(const FaceSpans& faces, absl::Span<const AskedFace> asked,
                                    const GuidanceField& field, absl::Span<const double> g, size_t checked_pieces,
                                    const Context& context) {
  const double split_ratio = faces.triangles.size() < kManyFaces ? kSplitRatio : kSplitRatioOfMany;
  const int depth = DepthFor(asked.size()), checks = ChecksFor(asked.size(), checked_pieces);
  const size_t check_stride = asked.size() / checked_pieces | 1;  // odd: not in step with the rows of a grid
  std::vector<Integrals> sums((asked.size() + kFaceGrain - 1) / kFaceGrain);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(asked.size(), kFaceGrain, context, [&](size_t begin, size_t end) {
    Integrator integrator(field, split_ratio);
    for (size_t i = begin; i < end; ++i) {
      Corner corners[3];
      for (int k = 0; k < 3; ++k) {
        const uint32_t v = faces.triangles[asked[i].face][k].index();
        corners[k] = {faces.positions[v], g.empty() ? 0 : g[v], faces.curvatures.empty() ? 0 : faces.curvatures[v]};
      }
      const int own_checks = i % check_stride == 0 ? checks : -1;
      Integrals own = g.empty() ? integrator.OverAsked(corners[0], corners[1], corners[2], depth, own_checks)
                                : integrator.Over(corners[0], corners[1], corners[2], depth, own_checks);
      sums[begin / kFaceGrain] += own *= asked[i].weight;
    }
  }));
  Integrals total;
  for (const Integrals& sum : sums) total += sum;
  return total;
}

}  // namespace

absl::StatusOr<double> PredictTriangles(const FaceSpans& faces, const GuidanceField& field, const Context& context,
                                        size_t checked_pieces) {
  if (faces.triangles.empty()) return 0.0;
  const bool is_part = faces.triangles.size() >= kManyFaces;
  const std::vector<AskedFace> asked = is_part ? ChooseAsked(faces) : AllFaces(faces.triangles.size());
  std::vector<double> g;
  if (!is_part) {
    MESHFRONT_ASSIGN_OR_RETURN(g, EvaluateVertices(faces, field, context));
  }
  if (asked.empty()) return 0.0;  // no area
  MESHFRONT_ASSIGN_OR_RETURN(const Integrals total, Integrate(faces, asked, field, g, checked_pieces, context));
  const double ratio = total.checked > 0 && std::isfinite(total.checked) ? total.expected / total.checked : 1;
  return ratio * total.all / (std::sqrt(3.0) / 4);
}

absl::StatusOr<double> CountOnPlaces(const PlaceSpans& places, const GuidanceField& field, const Context& context) {
  const size_t count = places.positions.size();
  std::vector<double> sums((count + kVertexGrain - 1) / kVertexGrain);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(count, kVertexGrain, context, [&](size_t begin, size_t end) {
    const double slope = 1 - 1 / field.eta();
    double g = 0, sum = 0;
    for (size_t i = begin; i < end; ++i) {
      const Vec3& x = places.positions[i];
      g = i == begin ? field.At(x) : field.At(x, g + slope * Distance(places.positions[i - 1], x));
      sum += places.areas[i] * InverseSquare(g) * TrianglesPerIdealTriangle(g * places.curvatures[i], 0);
    }
    sums[begin / kVertexGrain] = sum;
  }));
  double total = 0;
  for (const double sum : sums) total += sum;
  return total / (std::sqrt(3.0) / 4);
}

}  // namespace meshfront
