// A dipole for each node of a tree that is far enough, Van Oosterom's and Strackee's formula for each face of a near leaf.
#include "core/mesh/winding_number.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

constexpr double kFarPerRadius = 2.5;

double SolidAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double la = Norm(a), lb = Norm(b), lc = Norm(c);
  const double below = la * lb * lc + Dot(a, b) * lc + Dot(b, c) * la + Dot(c, a) * lb;
  return 2 * std::atan2(Dot(a, Cross(b, c)), below);
}

}  // namespace

WindingNumber::WindingNumber(const TriangleMesh& mesh) : mesh_(mesh) {
  for (const Triangle& t : mesh.triangles)
    centroids_.push_back((mesh.PositionAt(t[0]) + mesh.PositionAt(t[1]) + mesh.PositionAt(t[2])) / 3.0);
  tree_ = std::make_unique<PointTree>(centroids_);
  const auto nodes = tree_->nodes();
  clusters_.resize(nodes.size());
  for (size_t at = 0; at < nodes.size(); ++at) {
    Cluster& cluster = clusters_[at];
    double total = 0;
    for (uint32_t i = nodes[at].begin; i < nodes[at].end; ++i) {
      const Triangle& t = mesh.triangles[tree_->order()[i]];
      const Vec3 area = 0.5 * AreaVector(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]));
      cluster.area += area, total += Norm(area);
      cluster.center += Norm(area) * centroids_[tree_->order()[i]];
    }
    cluster.center = total > 0 ? cluster.center / total : centroids_[tree_->order()[nodes[at].begin]];
    for (uint32_t i = nodes[at].begin; i < nodes[at].end; ++i) {
      for (const VertexId v : mesh.triangles[tree_->order()[i]])
        cluster.radius = std::max(cluster.radius, Distance(mesh.PositionAt(v), cluster.center));
    }
  }
}

double WindingNumber::At(const Vec3& x) const {
  const auto nodes = tree_->nodes();
  double angle = 0;
  std::vector<uint32_t> open;
  if (!nodes.empty()) open.push_back(0);
  while (!open.empty()) {
    const uint32_t at = open.back();
    open.pop_back();
    const Cluster& cluster = clusters_[at];
    const Vec3 d = cluster.center - x;
    const double distance = Norm(d);
    if (distance > kFarPerRadius * cluster.radius) {
      angle += Dot(cluster.area, d) / (distance * distance * distance);
      continue;
    }
    if (!nodes[at].is_leaf()) {
      open.push_back(at + 1), open.push_back(nodes[at].right);
      continue;
    }
    for (uint32_t i = nodes[at].begin; i < nodes[at].end; ++i) {
      const Triangle& t = mesh_.triangles[tree_->order()[i]];
      angle += SolidAngle(mesh_.PositionAt(t[0]) - x, mesh_.PositionAt(t[1]) - x, mesh_.PositionAt(t[2]) - x);
    }
  }
  return angle / (4 * std::numbers::pi);
}

}  // namespace meshfront
