// The last resort: components of which no mesh comes out right are handed on as they came in.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/types/span.h"
#include "core/base/context.h"
#include "core/mesh/holding_sink.h"
#include "core/mesh/quality.h"
#include "core/mesh/topology.h"
#include "core/surface/mesh_surface.h"

namespace meshfront {

// An output of which some components are the input's own faces.
struct PartlyOwn {
  std::vector<HeldPiece> pieces;
  TopologyReport topology;
  QualityReport quality;
  uint64_t by_kind[3] = {0, 0, 0};  // triangles, as in TriangleKind; the input's faces close what the front left
  uint64_t components = 0;          // that are the input's own
  uint64_t faces = 0;               // of these
};

struct OwnFacesOptions {
  absl::Span<const uint32_t> wrong;  // components of the surface that are exchanged in any case, in order
  double bound = 0;                  // how far from where the surface meets itself the output may, too
  double flat_ratio = 0;             // radius ratio below which a triangle has no area
  bool shares_wedges = false;        // between the faces of a patch: they have no attributes
};

// Puts the surface's own faces, as they were before it was cut, in the place of every component of the output whose components, boundary
// loops or genus are not those of the surface's, which is no oriented manifold, has a triangle without area, or meets itself or another
// farther than the bound from where the surface's faces do, be it at one of the surface's seams, and of every one that is said to be
// wrong. What is left meets nothing else, since the surface itself doesn't. Vertices of the pieces have for a sheet the component before the cut (MeshSurface::WholeComponentOf). Cancelled or
// DeadlineExceeded. O(n log n) a round, of which there is one more than components that touch one another in a row, and 8 at most.
absl::StatusOr<PartlyOwn> PutOwnFacesIn(const std::vector<HeldPiece>& pieces, const MeshSurface& surface,
                                        const OwnFacesOptions& options, const Context& context);

}  // namespace meshfront
