// Algorithm: 1. Evaluate the implicit function on a grid; 2. split every cell that the surface crosses into the six tetrahedra
// around its diagonal; 3. cut each tetrahedron (CutTetrahedron), one vertex per crossed grid edge. Marching cubes was
// rejected: its table needs a remedy for ambiguous faces, tetrahedra are manifold by construction, and full of slivers.
#include "client/cli/sample_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "absl/container/flat_hash_map.h"

namespace meshfront {
namespace {

constexpr int kCells = 50;                            // along each axis
constexpr double kMin = -1.25, kStep = 2.5 / kCells;  // the grid covers [-1.25, 1.25]³
constexpr double kBlend = 0.12;                       // radius of the fillets between the parts
// Vertices stay this far, relative to a grid edge, from its ends: no face is so thin that its normal is lost to rounding.
constexpr double kEndGap = 0.02;

double Ball(const Vec3& p, const Vec3& center, double radius) { return Distance(p, center) - radius; }

double Rod(const Vec3& p, const Vec3& a, const Vec3& b, double radius) {
  const double t = std::clamp(Dot(p - a, b - a) / SquaredNorm(b - a), 0.0, 1.0);
  return Distance(p, Lerp(a, b, t)) - radius;
}

// A ring around `axis` (unit length).
double Ring(const Vec3& p, const Vec3& center, const Vec3& axis, std::array<double, 2> radii) {
  const Vec3 d = p - center;
  const double along = Dot(d, axis);
  return std::hypot(Norm(d - along * axis) - radii[0], along) - radii[1];
}

// The smaller of two distances, rounded where they are alike.
double SmoothMin(double a, double b) {
  const double h = std::max(kBlend - std::abs(a - b), 0.0) / kBlend;
  return std::min(a, b) - 0.25 * h * h * kBlend;
}

// Below 0 inside.
double Implicit(const Vec3& p) {
  const Vec3 tilt = Normalized(Vec3{0.25, 1, 0.15});
  double d = Ring(p, {0, -0.35, 0}, tilt, {0.82, 0.2});
  d = SmoothMin(d, Ball(p, {0, 0.42, 0}, 0.36));
  d = SmoothMin(d, Ball(p, {0.3, 0.72, 0.12}, 0.2));
  d = SmoothMin(d, Ring(p, {-0.42, 0.72, 0.05}, Normalized(Vec3{0.3, -0.2, 1}), {0.28, 0.055}));
  for (int i = 0; i < 5; ++i) {
    const double angle = 0.4 + i * 2 * 3.141592653589793 / 5;
    const Vec3 foot{0.8 * std::cos(angle), -0.35 - 0.25 * 0.8 * std::cos(angle) - 0.15 * 0.8 * std::sin(angle),
                    0.8 * std::sin(angle)};
    d = SmoothMin(d, Rod(p, foot, {0.1 * std::cos(angle), 0.3, 0.1 * std::sin(angle)}, 0.05 + 0.01 * i));
  }
  d = SmoothMin(d, Rod(p, {0.3, 0.75, 0.12}, {0.72, 1.08, 0.3}, 0.055));
  return SmoothMin(d, Ball(p, {0.74, 1.08, 0.3}, 0.1));
}

class MarchingTetrahedra {
 public:
  TriangleMesh Run() {
    Evaluate();
    for (int z = 0; z < kCells; ++z) {
      for (int y = 0; y < kCells; ++y) {
        for (int x = 0; x < kCells; ++x) CutCell({x, y, z});
      }
    }
    return std::move(mesh_);
  }

 private:
  static constexpr int kPoints = kCells + 1;
  using GridPoint = std::array<int, 3>;

  static uint32_t IndexOf(const GridPoint& g) { return (g[2] * kPoints + g[1]) * kPoints + g[0]; }
  static Vec3 PositionOf(uint32_t i) {
    const int x = i % kPoints, y = i / kPoints % kPoints, z = i / kPoints / kPoints;
    return {kMin + x * kStep, kMin + y * kStep, kMin + z * kStep};
  }

  void Evaluate() {
    values_.resize(static_cast<size_t>(kPoints) * kPoints * kPoints);
    for (uint32_t i = 0; i < values_.size(); ++i) values_[i] = Implicit(PositionOf(i));
  }

  // The six tetrahedra follow the cell's edges in each order of the axes; odd orders are mirrored, so two corners are swapped.
  void CutCell(const GridPoint& corner) {
    static constexpr std::array<std::array<int, 3>, 6> orders = {
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    for (size_t order = 0; order < orders.size(); ++order) {
      std::array<uint32_t, 4> tetrahedron;
      GridPoint g = corner;
      tetrahedron[0] = IndexOf(g);
      for (int i = 0; i < 3; ++i) ++g[orders[order][i]], tetrahedron[i + 1] = IndexOf(g);
      if (order >= 3) std::swap(tetrahedron[2], tetrahedron[3]);
      CutTetrahedron(tetrahedron);
    }
  }

  // Corners a, b, c, d of a right-handed tetrahedron. One corner apart: a triangle around it. Two and two: a quadrilateral.
  void CutTetrahedron(const std::array<uint32_t, 4>& corners) {
    std::array<int, 4> inside, outside;
    int count = 0, others = 0;
    for (int i = 0; i < 4; ++i) (values_[corners[i]] < 0 ? inside[count++] : outside[others++]) = i;
    if (count == 1 || count == 3) {
      const int apart = count == 1 ? inside[0] : outside[0];
      // apart ^ 1, 2, 3 are the others in an order that keeps the tetrahedron right-handed.
      const uint32_t a = corners[apart];
      std::array<VertexId, 3> v;
      for (int i = 0; i < 3; ++i) v[i] = VertexOn(a, corners[apart ^ (i + 1)]);
      if (count == 3) std::swap(v[1], v[2]);
      mesh_.triangles.push_back(v);
    } else if (count == 2) {
      // {0,1 | 2,3} right-handed, {0,2 | 1,3} left-handed, and so on: left-handed when exactly one index pair is out of order.
      const bool mirrored = (inside[0] + inside[1]) % 2 == 0;
      if (mirrored) std::swap(outside[0], outside[1]);
      const uint32_t a = corners[inside[0]], b = corners[inside[1]], c = corners[outside[0]], d = corners[outside[1]];
      const VertexId ac = VertexOn(a, c), ad = VertexOn(a, d), bd = VertexOn(b, d), bc = VertexOn(b, c);
      mesh_.triangles.push_back({ac, ad, bd});
      mesh_.triangles.push_back({ac, bd, bc});
    }
  }

  VertexId VertexOn(uint32_t a, uint32_t b) {
    if (a > b) std::swap(a, b);
    const auto [it, is_new] = vertex_on_.try_emplace({a, b}, VertexId(mesh_.positions.size()));
    if (is_new) {
      const double t = std::clamp(values_[a] / (values_[a] - values_[b]), kEndGap, 1 - kEndGap);
      mesh_.positions.push_back(Lerp(PositionOf(a), PositionOf(b), t));
    }
    return it->second;
  }

  std::vector<double> values_;
  absl::flat_hash_map<std::pair<uint32_t, uint32_t>, VertexId> vertex_on_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh SampleMesh() { return MarchingTetrahedra().Run(); }

}  // namespace meshfront
