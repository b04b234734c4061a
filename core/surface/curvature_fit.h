// Maximum curvature at the vertices of a mesh, from a quadratic fitted to the 3-ring (sec. 3.2).
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/triangle_mesh.h"
#include "core/surface/vertex_rings.h"

namespace meshfront {

// The least length over which a turn counts, by component: see kLeastOfDiagonal.
struct LeastLengths {
  absl::Span<const double> of_component;
  absl::Span<const uint32_t> label;  // of each face, its component
};

// max(|κ₁|, |κ₂|) of every vertex, 1/length, raised towards the largest turn of the normals where the rings turn far: finite, ≥ 0, and
// at most 2 / (the shorter incident edges), which is what the mesh can resolve; 0 for vertices without a face. `normals` are unit
// vertex normals. At a rim the fit is one-sided. Runs on the context's threads, same bits at any number; its status when it is stopped.
// Where `wanted` is not empty, 0 where it is not set. Below 1 µs a vertex and core.
absl::StatusOr<std::vector<double>> FitMaxCurvatures(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                                     absl::Span<const Vec3> normals, const Context& context,
                                                     const LeastLengths& least = {},
                                                     const std::vector<bool>& wanted = {});
// The same with the rings of the mesh (CreateVertexRings) and the areas of its vertices (ComputeVertexAreas).
absl::StatusOr<std::vector<double>> FitMaxCurvatures(const TriangleMesh& mesh, const FaceAdjacency& adjacency,
                                                     const VertexRings& rings, absl::Span<const Vec3> normals,
                                                     absl::Span<const double> areas, const Context& context,
                                                     const LeastLengths& least, const std::vector<bool>& wanted);

// Of the height field z = a x² + b x y + c y² + d x + e y at the origin, from its first and second fundamental forms.
double MaxCurvatureOfQuadratic(double a, double b, double c, double d, double e);

}  // namespace meshfront
