// An indexed triangle mesh, or (without triangles) a point set: plain arrays, no invariants beyond what Validate checks.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"

namespace meshfront {

// Counter-clockwise seen from outside.
using Triangle = std::array<VertexId, 3>;
static_assert(sizeof(Triangle) == 12);

struct TriangleMesh {
  std::vector<Vec3> positions;
  std::vector<Triangle> triangles;
  std::vector<Vec3> normals;  // empty, or one per vertex, unit length (point sets)
  // Empty, or for each triangle the number that it came with, which repairs take along.
  std::vector<uint32_t> face_origins;
  // Attributes the file held that no array above carries ("texcoord_0", "materials", …): for the warning that they are dropped.
  std::vector<std::string> dropped_attributes;

  bool IsPointSet() const { return triangles.empty(); }
  const Vec3& PositionAt(VertexId v) const { return positions[v.index()]; }
};

// Triangles whose flag is set go, with their origins; the others keep their order.
void DropTriangles(TriangleMesh& mesh, const std::vector<bool>& dropped);

// Box of the vertices that a triangle uses (of all vertices for a point set).
Box3 BoundingBox(const TriangleMesh& mesh);

}  // namespace meshfront
