// How edge lengths go over from those of a region's border to those wanted inside (sec. 4.1).
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/geometry/bvh.h"
#include "core/guidance/guidance_field.h"
#include "core/surface/mesh_surface.h"

namespace meshfront {

// The share f that the border has at a vertex of the region: 1 on it, 0 where the way to it is longer than `width` of its edges, or at the
// vertex farthest from it where none is so far, and between them Δf = 0. Where no border leads to, 0.
class RegionBlend {
 public:
  // `part`: one that was cut out of a whole (MeshSurface::CreatePart); outlives this. `width` is in edges of the border, and at least
  // 1 / (1 − 1/eta): the field could not change faster. Stops with the context. About 5 µs a vertex near the border.
  static absl::StatusOr<RegionBlend> Create(const MeshSurface& part, double width, double eta, const Context& context);

  // g = f · (length of the border's edges near by) + (1 − f) · `ideal`, made Lipschitz again; then `added`, which nothing blends.
  absl::StatusOr<GuidanceField> Apply(const GuidanceField& ideal, absl::Span<const SizingSample> added,
                                      const Context& context) const;

  double ShareAt(VertexId v) const { return share_[v.index()]; }

 private:
  explicit RegionBlend(const MeshSurface& part) : part_(&part), faces_(part.mesh().positions, part.mesh().triangles) {}
  void MeasureBorder(std::vector<double>& border_edges);

  const MeshSurface* part_;
  TriangleBvh faces_;
  std::vector<double> share_, length_;  // of each vertex: f, and f times the length of the border's edges
  double shortest_ = 0, longest_ = 0;   // of these; 0: there is no border
};

}  // namespace meshfront
