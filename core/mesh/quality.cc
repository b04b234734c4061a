#include "core/mesh/quality.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/triangle.h"
#include "core/mesh/adjacency.h"

namespace meshfront {
namespace {

constexpr size_t kBins = 1 << 14;
constexpr double kDegrees = 180 / std::numbers::pi;
const double kTangentOf30 = 1 / std::sqrt(3.0);

struct Shape {
  double radius_ratio;
  double tangent;  // of the smallest angle, which is at most 60°
};

// As RadiusRatio and MinAngle, in one go and without an arc tangent.
Shape ShapeOf(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  const double ab2 = SquaredNorm(ab), bc2 = SquaredNorm(bc), ca2 = SquaredNorm(ca);
  const double ratio = RadiusRatio(a, b, c);
  if (!(ratio > 0)) return {0, 0};
  // The smallest angle lies opposite the shortest side; its cosine times the two other sides is their dot product.
  const double dot = ab2 <= bc2 && ab2 <= ca2 ? -Dot(bc, ca) : bc2 <= ca2 ? -Dot(ca, ab) : -Dot(ab, bc);
  const double x = std::sqrt(ab2), y = std::sqrt(bc2), z = std::sqrt(ca2);
  const double double_area = 0.5 * std::sqrt(ratio * x * y * z * (x + y + z));
  return {ratio, dot > 0 ? double_area / dot : 0};
}

// Linear between ranks; `values` are sorted.
double PercentileOf(const std::vector<double>& values, double share) {
  if (values.empty()) return 0;
  const double rank = share * double(values.size() - 1);
  const size_t low = static_cast<size_t>(rank);
  if (low + 1 >= values.size()) return values.back();
  return values[low] + (rank - double(low)) * (values[low + 1] - values[low]);
}

void MeasureTriangles(const TriangleMesh& mesh, QualityReport& out) {
  std::vector<double> ratios;
  ratios.reserve(mesh.triangles.size());
  double min_tangent = std::numeric_limits<double>::infinity(), sum = 0;
  uint64_t below_30 = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
    if (!IsFinite(a) || !IsFinite(b) || !IsFinite(c)) continue;
    const Shape shape = ShapeOf(a, b, c);
    ratios.push_back(shape.radius_ratio);
    sum += shape.radius_ratio;
    min_tangent = std::min(min_tangent, shape.tangent);
    below_30 += shape.tangent < kTangentOf30;
  }
  if (ratios.empty()) return;
  std::sort(ratios.begin(), ratios.end());
  out.triangles = ratios.size();
  out.radius_ratio_min = ratios.front();
  out.radius_ratio_p0_5 = PercentileOf(ratios, 0.005);
  out.radius_ratio_median = PercentileOf(ratios, 0.5);
  out.radius_ratio_mean = sum / double(ratios.size());
  out.min_angle_deg = std::atan(min_tangent) * kDegrees;
  out.share_min_angle_below_30 = double(below_30) / double(ratios.size());
}

// What is known of a vertex from its edges.
struct VertexEdges {
  double shortest = std::numeric_limits<double>::infinity(), longest = 0;
  uint32_t edges = 0;
  bool inner = true;
};

void MeasureEdges(const TriangleMesh& mesh, QualityReport& out) {
  const std::vector<uint32_t> order = HalfEdgesByEdge(mesh);
  const auto ends = [&](uint32_t h) {
    const uint32_t a = OriginOf(mesh, h).index(), b = TargetOf(mesh, h).index();
    return std::pair(std::min(a, b), std::max(a, b));
  };
  std::vector<VertexEdges> vertices(mesh.positions.size());
  std::vector<double> lengths;
  for (size_t i = 0, end; i < order.size(); i = end) {
    const auto [a, b] = ends(order[i]);
    for (end = i + 1; end < order.size() && ends(order[end]) == std::pair(a, b);) ++end;
    const double length = Distance(mesh.positions[a], mesh.positions[b]);
    if (!std::isfinite(length)) continue;
    lengths.push_back(length);
    for (const uint32_t v : {a, b}) {
      VertexEdges& at = vertices[v];
      at.shortest = std::min(at.shortest, length);
      at.longest = std::max(at.longest, length);
      ++at.edges;
      at.inner = at.inner && end - i == 2;
    }
  }
  std::sort(lengths.begin(), lengths.end());
  out.edge_length_median = PercentileOf(lengths, 0.5);
  if (!lengths.empty()) out.edge_length_min = lengths.front(), out.edge_length_max = lengths.back();
  for (const VertexEdges& v : vertices) {
    if (v.edges == 0) continue;
    out.incident_edge_ratio_max = std::max(out.incident_edge_ratio_max, v.longest / v.shortest);
    if (!v.inner) continue;
    if (out.valence_histogram.size() <= v.edges) out.valence_histogram.resize(v.edges + 1);
    ++out.valence_histogram[v.edges];
  }
}

}  // namespace

QualityReport MeasureQuality(const TriangleMesh& mesh) {
  QualityReport out;
  MeasureTriangles(mesh, out);
  MeasureEdges(mesh, out);
  return out;
}

QualityAccumulator::QualityAccumulator() : bins_(kBins, 0) {}

void QualityAccumulator::Add(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Shape shape = ShapeOf(a, b, c);
  const size_t bin = static_cast<size_t>(std::clamp(shape.radius_ratio, 0.0, 1.0) * double(kBins));
  ++bins_[std::min(bin, kBins - 1)];
  ++count_;
  sum_ += shape.radius_ratio;
  min_ratio_ = std::min(min_ratio_, shape.radius_ratio);
  max_ratio_ = std::max(max_ratio_, shape.radius_ratio);
  min_tangent_ = std::min(min_tangent_, shape.tangent);
  below_30_ += shape.tangent < kTangentOf30;
}

// Within a bin the values are taken to lie evenly.
double QualityAccumulator::Percentile(double share) const {
  const double rank = share * double(count_ - 1);
  double before = 0;
  for (size_t i = 0; i < kBins; ++i) {
    if (rank < before + double(bins_[i])) {
      const double inside = (rank - before + 0.5) / double(bins_[i]);
      return std::clamp((double(i) + std::min(inside, 1.0)) / double(kBins), min_ratio_, max_ratio_);
    }
    before += double(bins_[i]);
  }
  return max_ratio_;
}

QualityReport QualityAccumulator::Report() const {
  QualityReport out;
  if (count_ == 0) return out;
  out.triangles = count_;
  out.radius_ratio_min = min_ratio_;
  out.radius_ratio_p0_5 = Percentile(0.005);
  out.radius_ratio_median = Percentile(0.5);
  out.radius_ratio_mean = sum_ / double(count_);
  out.min_angle_deg = std::atan(min_tangent_) * kDegrees;
  out.share_min_angle_below_30 = double(below_30_) / double(count_);
  return out;
}

}  // namespace meshfront
