// Parts in the order of a depth-first walk, so that what one part owes the next one nearby pays. Rejected: as many places at
// random as the area takes; their gaps are twice as wide.
#include "core/mesh/surface_samples.h"

#include <array>
#include <utility>

#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

constexpr int kMaxHalvings = 40;

// Spreads numbers evenly over the unit square: additive recurrence with the powers of the plastic number.
class Lattice {
 public:
  std::array<double, 2> Next() {
    for (size_t i = 0; i < 2; ++i) {
      at_[i] += kSteps[i];
      if (at_[i] >= 1) at_[i] -= 1;
    }
    return at_;
  }

 private:
  static constexpr std::array<double, 2> kSteps = {0.75487766624669276, 0.56984029099805327};
  std::array<double, 2> at_ = {0.5, 0.5};
};

struct Sampler {
  const std::function<double(const Vec3&)>& spacing;
  FaceSamples samples;
  Lattice lattice;
  double owed = 0.5;
  uint32_t face = 0;

  void Visit(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal, int halvings) {
    const double s = spacing((a + b + c) / 3.0), wanted = TriangleArea(a, b, c) / (s * s);
    if (wanted > 1 && halvings < kMaxHalvings) {
      const double ab = SquaredDistance(a, b), bc = SquaredDistance(b, c), ca = SquaredDistance(c, a);
      if (bc > ab && bc >= ca) return Visit(b, c, a, normal, halvings);
      if (ca > ab) return Visit(c, a, b, normal, halvings);
      const Vec3 middle = 0.5 * (a + b);
      Visit(a, middle, c, normal, halvings + 1);
      return Visit(middle, b, c, normal, halvings + 1);
    }
    owed += wanted;
    for (; owed >= 1; owed -= 1) {
      auto [u, v] = lattice.Next();
      if (u + v > 1) u = 1 - u, v = 1 - v;
      samples.points.positions.push_back(a + u * (b - a) + v * (c - a));
      samples.points.normals.push_back(normal);
      samples.faces.push_back(face);
    }
  }
};

}  // namespace

FaceSamples SampleFaces(const TriangleMesh& mesh, const std::function<double(const Vec3&)>& spacing) {
  Sampler sampler{spacing, {}, {}};
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    sampler.face = f;
    const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
    const Vec3 area = AreaVector(a, b, c);
    if (SquaredNorm(area) > 0) sampler.Visit(a, b, c, Normalized(area), 0);
  }
  return std::move(sampler.samples);
}

}  // namespace meshfront
