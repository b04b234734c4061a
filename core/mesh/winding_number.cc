// A dipole for each node of a tree that is far enough, Van Oosterom's and Strackee's formula for each face of a near leaf. Half angles
// are added by multiplying their directions, which takes one arc tangent for many of them: as long as two directions have a positive
// cosine, the angle of their product is the sum of theirs.
#include "core/mesh/winding_number.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

// Nodes are far from so many of their radii on; and where an answer is not clear, by how much a quick one may be off.
constexpr double kFarPerRadius = 2.5, kFarPerRadiusAtFirst = 1.5, kClearAtFirst = 0.25;
// Faces whose radii differ by less than a factor of 2 to the power of this are of one size.
constexpr int kOctavesPerLayer = 2;
// Open nodes: two for each level of a tree over at most 2³² faces, one of which is taken off again.
constexpr size_t kMaxOpenNodes = 66;
// Of the sum so far, whose factors are at most 1 and at least √½: below, its angle is taken before it has no bits left.
constexpr double kLeastCosine = 1e-30;

}  // namespace

WindingNumber::WindingNumber(const TriangleMesh& mesh) : mesh_(mesh) {
  std::map<int, Layer> layers;
  for (uint32_t face = 0; face < mesh.triangles.size(); ++face) {
    const Triangle& t = mesh.triangles[face];
    const Vec3 centroid = (mesh.PositionAt(t[0]) + mesh.PositionAt(t[1]) + mesh.PositionAt(t[2])) / 3.0;
    double radius2 = 0;
    for (const VertexId v : t) radius2 = std::max(radius2, SquaredDistance(mesh.PositionAt(v), centroid));
    Layer& layer = layers[radius2 > 0 ? std::ilogb(radius2) / (2 * kOctavesPerLayer) : 0];
    layer.faces.push_back(face);
    layer.centroids.push_back(centroid);
  }
  layers_.reserve(layers.size());
  for (auto& [size, layer] : layers) {
    layers_.push_back(std::move(layer));
    Build(layers_.back());
  }
}

void WindingNumber::Build(Layer& layer) const {
  layer.tree = std::make_unique<PointTree>(layer.centroids);
  const auto nodes = layer.tree->nodes();
  layer.clusters.resize(nodes.size());
  for (size_t at = 0; at < nodes.size(); ++at) {
    Cluster& cluster = layer.clusters[at];
    double total = 0;
    for (uint32_t i = nodes[at].begin; i < nodes[at].end; ++i) {
      const uint32_t own = layer.tree->order()[i];
      const Triangle& t = mesh_.triangles[layer.faces[own]];
      const Vec3 area = 0.5 * AreaVector(mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1]), mesh_.PositionAt(t[2]));
      cluster.area += area, total += Norm(area);
      cluster.center += Norm(area) * layer.centroids[own];
    }
    cluster.center = total > 0 ? cluster.center / total : layer.centroids[layer.tree->order()[nodes[at].begin]];
    for (uint32_t i = nodes[at].begin; i < nodes[at].end; ++i) {
      for (const VertexId v : mesh_.triangles[layer.faces[layer.tree->order()[i]]])
        cluster.radius = std::max(cluster.radius, Distance(mesh_.PositionAt(v), cluster.center));
    }
  }
}

WindingNumber::HalfAngle WindingNumber::HalfAngleOf(uint32_t face, const Vec3& x) const {
  const Triangle& t = mesh_.triangles[face];
  const Vec3 a = mesh_.PositionAt(t[0]) - x, b = mesh_.PositionAt(t[1]) - x, c = mesh_.PositionAt(t[2]) - x;
  const double la = Norm(a), lb = Norm(b), lc = Norm(c);
  return {la * lb * lc + Dot(a, b) * lc + Dot(b, c) * la + Dot(c, a) * lb, Dot(a, Cross(b, c))};
}

double WindingNumber::AngleOf(const Layer& layer, const Vec3& x, double far_per_radius) const {
  const auto nodes = layer.tree->nodes();
  std::array<uint32_t, kMaxOpenNodes> open;
  size_t size = 0;
  double angle = 0;
  HalfAngle sum{1, 0};
  const auto flush = [&](HalfAngle& part) { angle += 2 * std::atan2(part.sine, part.cosine), part = {1, 0}; };
  open[size++] = 0;
  while (size > 0) {
    const uint32_t at = open[--size];
    const Cluster& cluster = layer.clusters[at];
    const Vec3 d = cluster.center - x;
    const double distance2 = SquaredNorm(d);
    if (distance2 > far_per_radius * far_per_radius * cluster.radius * cluster.radius) {
      angle += Dot(cluster.area, d) / (distance2 * std::sqrt(distance2));
      continue;
    }
    if (!nodes[at].is_leaf()) {
      open[size++] = at + 1, open[size++] = nodes[at].right;
      continue;
    }
    for (uint32_t i = nodes[at].begin; i < nodes[at].end; ++i) {
      HalfAngle part = HalfAngleOf(layer.faces[layer.tree->order()[i]], x);
      const double size_of_part = std::abs(part.cosine) + std::abs(part.sine);
      if (!(size_of_part > 0)) continue;  // x is a corner
      if (!(part.cosine > 0)) {
        flush(part);
        continue;
      }
      const double cosine = part.cosine / size_of_part, sine = part.sine / size_of_part;
      sum = {sum.cosine * cosine - sum.sine * sine, sum.cosine * sine + sum.sine * cosine};
      if (!(sum.cosine > kLeastCosine)) flush(sum);
    }
  }
  flush(sum);
  return angle;
}

double WindingNumber::Approximate(const Vec3& x, double far_per_radius) const {
  double angle = 0;
  for (const Layer& layer : layers_) angle += AngleOf(layer, x, far_per_radius);
  return angle / (4 * std::numbers::pi);
}

double WindingNumber::At(const Vec3& x) const { return Approximate(x, kFarPerRadius); }

bool WindingNumber::IsAbove(const Vec3& x, double threshold) const {
  const double quick = Approximate(x, kFarPerRadiusAtFirst);
  return std::abs(quick - threshold) > kClearAtFirst ? quick > threshold : At(x) > threshold;
}

}  // namespace meshfront
