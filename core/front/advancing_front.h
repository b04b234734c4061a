// The advancing front (sec. 3): grows a triangulation over a surface from initial loops and seeds until every front is closed.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/guidance/guidance_field.h"
#include "core/mesh/mesh_sink.h"
#include "core/mesh/quality.h"
#include "core/surface/oriented_loop.h"
#include "core/surface/surface.h"

namespace meshfront {

struct FrontOptions {
  bool flips = true;   // edge flips behind the front
  bool smooth = true;  // guarded smoothing and optimisation behind the front
  bool fit = true;     // vertices moved along the normal to fit the surface between them
  double error_per_length =
      1;  // ξ of eq. 6 for the angle in force: the fit keeps each triangle within ξ of its longest edge
  // The error bound of an edge in parts of its length (eq. 7); where max_error is finite, that bounds all. What the output may be off
  // where the surface meets itself.
  double bound_per_length = 1;
  uint64_t predicted_triangles = 0;  // for progress only
  // Beyond so many the fronts fold over what is meshed already: the rest is left open. 0: no limit.
  uint64_t max_triangles = 0;
  // The same of places where the front was taken back.
  uint64_t max_roll_backs = std::numeric_limits<uint64_t>::max();
  // The same of candidates that were looked at.
  uint64_t max_candidates = std::numeric_limits<uint64_t>::max();
  Vec3 sweep{
      1, 0,
      0};  // the direction in which the working areas follow each other; best the one in which the surface is longest
  // Absolute: triangles that are farther from the surface are refined before they settle, the worst first; and how many vertices may be
  // added for it, where finite only to those far beyond it.
  double max_error = std::numeric_limits<double>::infinity();
  double max_insertions = std::numeric_limits<double>::infinity();
  bool wedges = false;  // pieces say where on the surface their corners were made (MeshPiece::wedges)
};

struct FrontReport {
  uint64_t vertices = 0, triangles = 0;
  uint64_t free_triangles = 0, connection_triangles = 0, closing_triangles = 0;
  uint64_t flips = 0;
  uint64_t peak_front_edges = 0;
  uint64_t roll_backs = 0;  // places where the front was taken back and advanced again at finer steps
  bool ran_away = false;    // stopped by max_triangles, max_roll_backs or max_candidates
  uint64_t components = 0;  // of the output
  uint64_t boundary_edges = 0, boundary_loops = 0;
  uint64_t pinched_vertices = 0;  // where open places meet each other or the rim: their triangles are not one fan
  double longest_edge = 0;
  double largest_deviation = 0;   // from the surface, of triangles that don't keep max_error
  uint64_t beyond_max_error = 0;  // such triangles
  Vec3 farthest_place;            // the middle of the worst
  QualityReport quality;
  std::vector<Vec3>
      open_places;  // where the mesh could not be closed, or not without an intersection; empty when all is well
  // Where triangles meet others though the surface meets itself only near by, not within the error bound.
  std::vector<Vec3> spread_intersections;
  // The first place where a triangle met another one within the error bound of where the surface meets itself. It may have been taken
  // back since for another reason.
  std::optional<Vec3> own_intersection;
  std::vector<std::pair<std::string, uint64_t>> refusals;  // by verdict
};

// Advances from `loops` (the surface on the right-hand side of their edges) and from one seed for each component without a
// loop. Settled triangles go to `sink` in the order in which they settle. Cancelled, DeadlineExceeded, or the sink's own status
// when it stops the job. Deterministic. Memory: the fronts and the triangles a few rings behind them.
//
//   MESHFRONT_ASSIGN_OR_RETURN(FrontReport report,
//                              AdvanceFront(surface, field, loops, seeds, {}, sink, context));
absl::StatusOr<FrontReport> AdvanceFront(const Surface& surface, const GuidanceField& field,
                                         const std::vector<OrientedLoop>& loops, const std::vector<SourcePoint>& seeds,
                                         const FrontOptions& options, MeshSink& sink, const Context& context);

}  // namespace meshfront
