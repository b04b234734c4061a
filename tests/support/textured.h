// Attributes on generated shapes.
#pragma once

#include <functional>
#include <string>

#include "core/mesh/triangle_mesh.h"

namespace meshfront::testing {

// A channel "TEXCOORD_0" whose value at each corner is map(position, centroid of the face): the centroid tells on which side of a seam
// the corner lies. Corners of equal values at a vertex share a wedge.
TriangleMesh Textured(TriangleMesh mesh, const std::function<std::array<double, 2>(const Vec3&, const Vec3&)>& map);
// The angle around the z axis in turns from −½ to ½, with its seam at −x, and the height.
std::array<double, 2> AroundZ(const Vec3& place, const Vec3& centroid);
// One more channel.
TriangleMesh WithChannel(TriangleMesh mesh, const std::string& name, uint32_t components,
                         const std::function<std::vector<float>(const Vec3& place, const Vec3& centroid)>& value);

}  // namespace meshfront::testing
