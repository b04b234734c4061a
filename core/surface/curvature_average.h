// Curvature without the peaks that are narrower than the edges of a mesh to come.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/surface/mesh_surface.h"
#include "core/surface/vertex_rings.h"

namespace meshfront {

// The curvatures of a surface's vertices, averaged over disks about as wide as the edges of a mesh to come. Detail that is narrower
// than they are is seen by no triangle beyond what its height is, but would pull the field down all around. Not thread-safe.
class CurvatureAverage {
 public:
  // `surface` must have its curvature, and outlives this. O(vertices); fails when the context stops it.
  static absl::StatusOr<CurvatureAverage> Create(const MeshSurface& surface, const Context& context);

  // Of each vertex the curvature, ≥ 0: not more than a set multiple of its average. The disk follows from how many input triangles
  // there are for each that edges of `ideal_length` over η (η ≥ 1) make: next to none where there are as many, two input edges where
  // there are five times as many. `ideal_length` falls with the curvature and is called from one thread. About 5 ns a vertex and
  // step of averaging, of which there are up to 15.
  absl::StatusOr<std::vector<double>> ForEdges(absl::FunctionRef<double(double max_curvature)> ideal_length, double eta,
                                               const Context& context);

 private:
  CurvatureAverage(const MeshSurface& surface, std::shared_ptr<const VertexRings> rings)
      : surface_(&surface), rings_(std::move(rings)), areas_(surface.vertex_areas()) {}
  double PassesFor(absl::FunctionRef<double(double max_curvature)> ideal_length, double eta) const;
  absl::Status Average(double passes, const Context& context);
  absl::Status AverageInSteps(double passes, const Context& context);
  absl::Status TakeRingMeans(absl::Span<const double> values, std::vector<double>& means, const Context& context) const;

  const MeshSurface* surface_;
  std::shared_ptr<const VertexRings> rings_;
  absl::Span<const double> areas_;    // of the vertices
  std::vector<double> inverse_sums_;  // of each vertex's ring and itself
  std::vector<double> means_;         // after passes_
  double passes_ = -1;
};

}  // namespace meshfront
