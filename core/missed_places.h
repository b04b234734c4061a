// What of a mesh few triangles pass over: an ear that a front closed above, though everything else is right.
#pragma once

#include <cstdint>
#include <vector>

#include "core/guidance/guidance_field.h"
#include "core/surface/mesh_surface.h"

namespace meshfront {

struct MissedPlaces {
  std::vector<Vec3> places;          // spread over all of them, some dozens at most
  std::vector<uint32_t> components;  // in which they are, as MeshSurface::WholeComponentOf numbers them; in order
};

// Vertices of a surface that lie farther from an output than edges are long there, both those of the nearest triangle and those that the
// field asks for. At most 20,000 of the surface's are looked at, evenly by number: 2 µs each.
MissedPlaces FindMissed(const MeshSurface& surface, const GuidanceField& field, const TriangleMesh& output);

}  // namespace meshfront
