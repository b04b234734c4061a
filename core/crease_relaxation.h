// Mends the faces beside creases that a mesh was split along.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "core/base/context.h"
#include "core/mesh/side_fit.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

struct CreasedMesh {
  TriangleMesh mesh;
  std::vector<std::array<uint32_t, 2>> creases;  // edges by their vertices, the smaller first
  uint32_t first_on_crease = 0;                  // the vertices from here on lie on creases, those before on sides
};

// What the vertices lie on. Vertices far from creases lie on no side.
struct CreasedSurface {
  std::function<const SideFit*(uint32_t vertex)> side_of;  // null on creases and far from them
  // The place on all that the vertex lies on, near another place; none where it can't be moved.
  std::function<std::optional<Vec3>(uint32_t vertex, const Vec3& place)> place_of;
  std::function<bool(uint32_t vertex)>
      is_blunt;  // whether no place is known that lies on all of a crease vertex's sides
};

// Makes thin faces beside creases better, and turns over those that face the other way than the side that they lie on, as far as moving
// vertices on their sides and along creases, flips and collapses can. Topology, rims, corners but blunt ones, and faces away from
// creases stay, creases stay paths of edges between the same corners. Vertices that are not used any more go. A few µs a face beside a crease.
absl::Status RelaxCreases(CreasedMesh& creased, const CreasedSurface& surface, const Context& context);

}  // namespace meshfront
