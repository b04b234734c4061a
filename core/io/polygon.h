// Polygons of a file, cut into triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/types/span.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Appends the n - 2 triangles of one polygon after another to a mesh, keeping its scratch memory. A convex polygon becomes a fan
// from its first corner; another one is projected along its normal (Newell's sum) and loses ears. A polygon that has no plane
// or corners that are not finite, names vertices the mesh does not have yet, or has more than kMaxEarCorners corners becomes a
// fan too. O(n) for convex ones, O(n · reflex corners) for others, never more than 512 n tests.
class PolygonCutter {
 public:
  static constexpr size_t kMaxEarCorners = 65536;

  void Append(absl::Span<const uint32_t> corners, TriangleMesh& mesh);

 private:
  struct Point {
    double x, y;
    friend bool operator==(const Point&, const Point&) = default;
  };
  bool Project(absl::Span<const uint32_t> corners, const std::vector<Vec3>& positions);
  bool IsConvex() const;
  void CutEars(absl::Span<const uint32_t> corners, std::vector<Triangle>& out);
  bool IsEar(uint32_t corner);
  double Turn(uint32_t corner) const;  // twice the signed area of the corner and its neighbours
  void Unlink(uint32_t corner);

  std::vector<Point> points_;
  std::vector<uint32_t> next_, previous_, reflex_;
  int64_t tests_left_ = 0;
};

}  // namespace meshfront
