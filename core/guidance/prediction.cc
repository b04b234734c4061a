//   1. g at every vertex, once (EvaluateVertices);
//   2. per face, IdealTriangles: a face small against g by the edge-midpoint rule with g interpolated (g is Lipschitz with
//      1 − 1/η, so it changes little there); a larger one in four, with g evaluated at the new corners;
//   3. sums per block of faces, added in the order of blocks.
#include "core/guidance/prediction.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

constexpr size_t kVertexGrain = 1024;  // vertices per block: about 0.2 ms
constexpr size_t kFaceGrain = 2048;
// A face is split while an edge is longer than this multiple of its smallest g: below, g varies by less than 1 − 1/η.
constexpr double kSplitRatio = 1.0;
// The splits of all faces together stay below this many pieces, however coarse the input and fine the field.
constexpr double kMaxPieces = 1 << 20;
constexpr int kMinDepth = 2, kMaxDepth = 8;

struct Corner {
  Vec3 position;
  double g;
};

double InverseSquare(double g) { return 1 / (g * g); }

// ∫ dA / g² for g linear on the triangle, by the rule that is exact for quadratics.
double LeafIntegral(double area, double ga, double gb, double gc) {
  return area / 3 * (InverseSquare(0.5 * (ga + gb)) + InverseSquare(0.5 * (gb + gc)) + InverseSquare(0.5 * (gc + ga)));
}

double Integral(const GuidanceField& field, const Corner& a, const Corner& b, const Corner& c, int depth) {
  const double longest =
      std::sqrt(std::max({SquaredDistance(a.position, b.position), SquaredDistance(b.position, c.position),
                          SquaredDistance(c.position, a.position)}));
  if (depth == 0 || longest <= kSplitRatio * std::min({a.g, b.g, c.g})) {
    return LeafIntegral(TriangleArea(a.position, b.position, c.position), a.g, b.g, c.g);
  }
  auto middle = [&](const Corner& p, const Corner& q) {
    const Vec3 x = 0.5 * (p.position + q.position);
    return Corner{x, field.At(x)};
  };
  const Corner ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
  return Integral(field, a, ab, ca, depth - 1) + Integral(field, ab, b, bc, depth - 1) +
         Integral(field, ca, bc, c, depth - 1) + Integral(field, ab, bc, ca, depth - 1);
}

int DepthFor(size_t faces) {
  const double levels = std::floor(std::log2(kMaxPieces / static_cast<double>(faces)) / 2);
  return std::clamp(static_cast<int>(levels), kMinDepth, kMaxDepth);
}

absl::StatusOr<std::vector<double>> EvaluateVertices(const FaceSpans& faces, const GuidanceField& field,
                                                     const Context& context) {
  std::vector<double> g(faces.positions.size());
  const double slope = 1 - 1 / field.eta();
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(g.size(), kVertexGrain, context, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const double bound = i > begin ? g[i - 1] + slope * Distance(faces.positions[i], faces.positions[i - 1])
                                     : field.options().max_length;
      g[i] = field.At(faces.positions[i], bound);
    }
  }));
  return g;
}

}  // namespace

absl::StatusOr<double> PredictTriangles(const FaceSpans& faces, const GuidanceField& field, const Context& context) {
  if (faces.triangles.empty()) return 0.0;
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<double> g, EvaluateVertices(faces, field, context));
  const int depth = DepthFor(faces.triangles.size());
  std::vector<double> sums((faces.triangles.size() + kFaceGrain - 1) / kFaceGrain);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(faces.triangles.size(), kFaceGrain, context, [&](size_t begin, size_t end) {
    double sum = 0;
    for (size_t f = begin; f < end; ++f) {
      Corner corners[3];
      for (int i = 0; i < 3; ++i) {
        const uint32_t v = faces.triangles[f][i].index();
        corners[i] = {faces.positions[v], g[v]};
      }
      sum += Integral(field, corners[0], corners[1], corners[2], depth);
    }
    sums[begin / kFaceGrain] = sum;
  }));
  double total = 0;
  for (double sum : sums) total += sum;
  return kTrianglesPerIdealTriangle * total / (std::sqrt(3.0) / 4);
}

}  // namespace meshfront
