// From where a shape is looked at: an orthographic view that shows much of it.
#pragma once

#include <optional>

#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// An orthographic camera: three orthonormal directions, the point in the middle of the picture, and the half width of the
// square that must fit.
struct View {
  Vec3 right{1, 0, 0}, up{0, 1, 0}, toward{0, 0, 1};  // toward: from the shape to the eye
  Vec3 center;
  double half_extent = 1;
};

enum class UpAxis { kY, kZ };

// A three-quarter view from slightly above. Up is y or z, whichever shows more unless it is given; the azimuth and the
// elevation are those that turn most of the surface towards the eye. Deterministic; O(n) with a small constant. Any mesh
// gives a view, an empty one too.
View ChooseView(const TriangleMesh& mesh, std::optional<UpAxis> up = std::nullopt);

}  // namespace meshfront
