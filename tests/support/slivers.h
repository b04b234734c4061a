// Shapes with slivers, as CAD kernels and iso-surface extractors leave them.
#pragma once

#include <functional>
#include <optional>
#include <utility>

#include "core/geometry/triangle.h"
#include "core/mesh/triangle_mesh.h"
#include "tests/support/shapes.h"

namespace meshfront::testing {

// Cuts faces (a, b, c) into three around the point that `place` gives for them.
inline TriangleMesh WithSplitFaces(
    TriangleMesh mesh, const std::function<std::optional<Vec3>(const Vec3& a, const Vec3& b, const Vec3& c)>& place) {
  const size_t n = mesh.triangles.size();
  for (size_t f = 0; f < n; ++f) {
    const Triangle t = mesh.triangles[f];
    const auto point = place(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]));
    if (!point) continue;
    const VertexId w(static_cast<uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(*point);
    mesh.triangles[f] = {t[0], t[1], w};
    mesh.triangles.push_back({t[1], t[2], w});
    mesh.triangles.push_back({t[2], t[0], w});
  }
  return mesh;
}

// A cube [-1, 1]³ with a vertex beside the middle of every piece of its upper edges at y = ±1, `height` inside the top and as far above:
// two rows of caps, which stand at 45° to the top.
inline TriangleMesh CubeWithCaps(int n, double height) {
  return WithSplitFaces(Cube(n), [&](const Vec3& a, const Vec3& b, const Vec3& c) -> std::optional<Vec3> {
    if (a.z != 1 || b.z != 1 || c.z != 1) return std::nullopt;
    for (const auto& [p, q] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
      if (p.y == q.y && std::abs(p.y) == 1) return 0.5 * (p + q) + Vec3{0, p.y > 0 ? -height : height, height};
    }
    return std::nullopt;
  });
}

// Every third face gets a vertex close to its first corner, pushed out of the surface by `push` of the way to the centroid: needles
// that stand at any angle to the surface.
inline TriangleMesh WithNeedles(TriangleMesh mesh, double step, double push) {
  int count = 0;
  return WithSplitFaces(std::move(mesh), [&](const Vec3& a, const Vec3& b, const Vec3& c) -> std::optional<Vec3> {
    if (count++ % 3 != 0) return std::nullopt;
    const Vec3 way = (1.0 / 3) * (a + b + c) - a;
    return a + step * way + push * step * Norm(way) * Normalized(AreaVector(a, b, c));
  });
}

}  // namespace meshfront::testing
