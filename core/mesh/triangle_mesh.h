// An indexed triangle mesh, or (without triangles) a point set: plain arrays, no invariants beyond what Validate checks.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/geometry/box.h"
#include "core/geometry/vec3.h"
#include "core/mesh/attributes.h"

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
  MeshAttributes attributes;  // empty, or of every triangle
  // Attributes the file held that no array above carries ("texcoord_0", "materials", …): for the warning that they are dropped.
  std::vector<std::string> dropped_attributes;

  bool IsPointSet() const { return triangles.empty(); }
  const Vec3& PositionAt(VertexId v) const { return positions[v.index()]; }
};

// Changes of the list of triangles, which take their origins and attributes along: face `from` goes to `to`; the last ones go, or those
// whose flag is set, and the others keep their order; corners 1 and 2 of a face change places.
void MoveFace(TriangleMesh& mesh, size_t from, size_t to);
void ResizeFaces(TriangleMesh& mesh, size_t count);
void DropTriangles(TriangleMesh& mesh, const std::vector<bool>& dropped);
void ReverseFace(TriangleMesh& mesh, size_t face);

// Box of the vertices that a triangle uses (of all vertices for a point set).
Box3 BoundingBox(const TriangleMesh& mesh);

}  // namespace meshfront
