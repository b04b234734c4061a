// How narrow the patches between creases and rims are: a strip narrower than an edge can only be filled with needles.
// Ours, not the paper's (core/README.md, "Edges know how wide their patch is").
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/geometry/vec3.h"
#include "core/surface/mesh_surface.h"

namespace meshfront {

// A place on a rim of a patch, and how far the patch reaches from there.
struct WidthSample {
  Vec3 position;
  double width = 0;        // straight across the patch to the rim on its other side, along the surface, > 0
  uint32_t half_edge = 0;  // of the (cut) surface, that it lies on
  double stretch = 0;      // length of rim that it stands for; together those of a half-edge are not longer than it
};

// The widths that are looked for.
struct WidthRange {
  double least = 0;  // > 0; narrower places are left out, and shorter stretches of a rim are one place
  double most = 0;
};

// Where patches are as wide as `ranges[component]` says: of each rim half-edge at least its middle, and so many more places that they lie
// at most four widths apart (bounded). Not at corners, in round or square patches, or in wedges of 4° or more: where the way along the
// rim to the other side is less than four widths, or about as long as to the wedge's tip and back. Nothing where there is no rim. In the
// order of the half-edges. On the context's threads; deterministic. About 40 ns for each face that a line crosses, at most 256 of them;
// without rims 2 ns a face of the surface.
absl::StatusOr<std::vector<WidthSample>> MeasurePatchWidths(const MeshSurface& surface,
                                                            const std::vector<WidthRange>& ranges,
                                                            const Context& context);

}  // namespace meshfront
