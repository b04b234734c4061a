// How far the coordinates of a mesh were rounded when it was written, told from the numbers themselves.
#pragma once

#include <cstdint>

#include "core/geometry/vec3.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// Numbers of float are told by their bits, numbers of a text by how few decimal digits they have: significant ones ("%g"), or behind the
// point ("%f"). Where all have few digits because the shape is simple, it is taken for rounded as well, unless edges are no more than a few
// of the last digits long: whole numbers on a grid are meant. Immutable. Deterministic.
class CoordinateRounding {
 public:
  // Looks at some hundred vertices, evenly over the mesh; a few among them may have been made later, with other digits.
  explicit CoordinateRounding(const TriangleMesh& mesh);

  // The distance of neighbouring numbers at a coordinate, > 0 but where it is 0: it was moved by at most half of that.
  double SpacingAt(double coordinate) const;
  // By how much the normal of a face can have turned, about, in radians; infinite where it has no area. `normal`: of unit length.
  double TiltOf(const TriangleMesh& mesh, uint32_t face, const Vec3& normal) const;

 private:
  bool is_float_ = false;
  bool is_decimal_ = false;  // then, of all numbers:
  int digits_ = 0;           // significant ones
  double behind_point_ = 0;  // the spacing where so many digits behind the point are all
};

}  // namespace meshfront
