#include "core/surface/vertex_normals.h"

#include <algorithm>
#include <cmath>

#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

// A sum of unit normals times angles that is shorter than this, against the sum of the angles, has cancelled out.
constexpr double kCancelled = 1e-6;

// A right angle where one has no length.
double AngleBetween(const Vec3& a, const Vec3& b) {
  const double squares = SquaredNorm(a) * SquaredNorm(b);
  return ApproximateAngle(squares > 0 ? Dot(a, b) / std::sqrt(squares) : 0);
}

void AddCornerNormals(const TriangleMesh& mesh, const Triangle& t, std::vector<Vec3>& sums) {
  const Vec3 p[3] = {mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])};
  const Vec3 normal = Normalized(AreaVector(p[0], p[1], p[2]));
  const Vec3 side[3] = {p[1] - p[0], p[2] - p[1], p[0] - p[2]};
  const double angle0 = AngleBetween(-side[2], side[0]), angle1 = AngleBetween(-side[0], side[1]);
  sums[t[0].index()] += angle0 * normal;
  sums[t[1].index()] += angle1 * normal;
  sums[t[2].index()] += std::max(0.0, 3.14159265358979323846 - angle0 - angle1) * normal;
}

// For the few vertices whose sum cancelled out.
void TakeLargestFaceNormals(const TriangleMesh& mesh, std::vector<Vec3>& normals) {
  std::vector<double> largest(normals.size(), 0);
  std::vector<bool> cancelled(normals.size());
  for (size_t v = 0; v < normals.size(); ++v) cancelled[v] = SquaredNorm(normals[v]) < kCancelled * kCancelled;
  for (size_t v = 0; v < normals.size(); ++v) normals[v] = cancelled[v] ? Vec3{0, 0, 1} : Normalized(normals[v]);
  for (const Triangle& t : mesh.triangles) {
    for (const VertexId v : t) {
      if (!cancelled[v.index()]) continue;
      const Vec3 normal = AreaVector(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]));
      const double area = Norm(normal);
      if (area > largest[v.index()]) largest[v.index()] = area, normals[v.index()] = normal / area;
    }
  }
}

}  // namespace

double ApproximateAngle(double cosine) {
  const double x = std::min(1.0, std::abs(cosine));
  const double angle = std::sqrt(1 - x) * (1.5707288 + x * (-0.2121144 + x * (0.0742610 - x * 0.0187293)));
  return cosine >= 0 ? angle : 3.14159265358979323846 - angle;
}

std::vector<Vec3> ComputeVertexNormals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size());
  for (const Triangle& t : mesh.triangles) AddCornerNormals(mesh, t, normals);
  TakeLargestFaceNormals(mesh, normals);
  return normals;
}

std::vector<double> ComputeVertexAreas(const TriangleMesh& mesh) {
  std::vector<double> areas(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    const double third = TriangleArea(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])) / 3;
    for (const VertexId v : t) areas[v.index()] += third;
  }
  return areas;
}

}  // namespace meshfront
