// Rims of open meshes and creases as initial fronts, and what they ask of the edge length (sec. 3.3).
#pragma once

#include <limits>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/guidance/guidance_field.h"
#include "core/surface/mesh_surface.h"
#include "core/surface/oriented_loop.h"

namespace meshfront {

// One sizing sample per rim vertex: `ideal_length` of the rim's own curvature there, at most a quarter of the rim's
// length. To be added to the surface's samples before the field is made. None on the border of a region. Stops with the
// context. About 0.2 µs a rim vertex.
absl::StatusOr<std::vector<SizingSample>> BoundarySizingSamples(
    const MeshSurface& surface, absl::FunctionRef<double(double max_curvature)> ideal_length, const Context& context);

// How far an edge may lie from the curve that it divides, absolute.
struct SagittaLimits {
  double any = std::numeric_limits<double>::infinity();  // of every curve
  double rim = std::numeric_limits<double>::infinity();  // of rims
};

// One loop per rim of the surface and of its patches between creases, in the order of FindBoundaryLoops: at least three
// vertices on the rim's edges, about g apart, sharp corners exactly. Each runs against the faces' half-edges, so that
// the surface lies on its right. Each curve between two nodes of the feature graph is divided once, so that both sides
// of a crease have the same points; curves that share both ends with others have one between them. The border of a
// region stays as it is, vertex for vertex: its joints are numbered first, in the order of
// MeshSurface::border_vertices. Edges lie no farther from the curve than `limits` say, unless that took
// edges shorter than the field's shortest or a tenth of what they divide. ResourceExhausted when g is so small that a
// curve would get more than 2^22 vertices; stops with the context. O(faces + points), about 0.1 µs a face where there
// are creases.
absl::StatusOr<std::vector<OrientedLoop>> BoundaryLoops(const MeshSurface& surface, const GuidanceField& field,
                                                        const SagittaLimits& limits, const Context& context);

}  // namespace meshfront
