// The facade: a problem in, a mesh to a sink, a report out. Knows nothing of files or networks.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/mesh/mesh_sink.h"
#include "core/mesh/polylines.h"
#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_mesh.h"
#include "core/region.h"

namespace meshfront {

// What an edge follows: the curvature, by the angle that it subtends (rho) or by its distance from the surface (max_error); nothing
// (edge_length); or the local feature size (rho): the angle on a circle through the other side of the part or gap, where that is nearer
// than the centre of curvature is (sec. 6).
enum class Sizing { kAngle, kError, kUniform, kThickness };

// How the input is understood: as it is; as a mesh; or, which makes a point set of a mesh, by a moving-least-squares surface, the one
// that projects on fitted polynomials or the implicit one.
enum class SurfaceKind { kAuto, kMesh, kMls, kImls };

// A length, absolute (in the units of the input) or relative to the diagonal of its bounding box.
struct Length {
  double value = 0;
  bool relative = false;
};

// What a caller may choose. Defaults are those of the contract; unset optionals are derived from the input.
struct RemeshOptions {
  double rho = 0.8;  // angle an edge subtends, radians, (0, 2π/3]; with Sizing::kAngle and Sizing::kThickness
  double eta = 1.2;  // bound on the ratio of incident edges, (1, 2)
  Sizing sizing = Sizing::kAngle;
  // Distance of the output from the surface, verified for every triangle before it settles; only with Sizing::kError; 0.1 % of the
  // diagonal. With target_triangles the one that was solved for, kept as far as the count leaves room.
  std::optional<Length> max_error;
  std::optional<Length> edge_length;  // the median edge; only with Sizing::kUniform, which needs it or target_triangles
  // Solves for the one parameter of the sizing (rho, max_error or edge_length, which must not be set then; rho's value is
  // ignored) so that about this many triangles come out, ≥ 4. Where none makes so few, but one up to 50,000, some of those are taken
  // out again, unless they are of a region or max_edge is given; where flat faces take too few, edges are kept shorter
  // (ParametersInForce::max_edge).
  std::optional<uint64_t> target_triangles;
  // Levels of detail: the rho of each, growing, at most 16; with Sizing::kAngle and Sizing::kThickness and without target_triangles
  // and region. For RemeshLevels alone. Empty: one mesh with `rho`, whose value is ignored else.
  std::vector<double> lod_rhos;
  std::optional<Length> min_edge;  // clamp of the edge length
  std::optional<Length> max_edge;
  // Edges across which the surface turns by more than this are kept as creases: degrees, (0, 180); none: nothing is.
  std::optional<double> crease_angle = 40;
  // Where a region is remeshed: the width of the size transition at its border, in edges of the border, [0, 1000]; at least
  // 1 / (1 − 1/eta), beyond which sizes can't change faster.
  double blend = 8;
  bool flips = true;   // edge flips behind the front
  bool smooth = true;  // guarded smoothing and optimisation behind the front
  bool fit = true;     // vertices moved along the normal to fit the surface between them
  // Carry the mesh's attributes over, and cut the surface along their seams (features/attribute_seams.h).
  bool attributes = true;
  SurfaceKind surface = SurfaceKind::kAuto;
  // Of point sets: radius of a sample's weight in local spacings, [2, 16]. At 4 it is larger where the points are noisy.
  double mls_radius = 4;
  // Gaps in the surface, boundary loops whose diameter is at most this, are closed before meshing: of a mesh its holes, of a point set
  // the rims where the points end. Not with a region.
  std::optional<Length> fill_gaps;
  bool repair = true;  // mend the input first, each change reported; false: refuse what would need it
};
inline constexpr size_t kMaxLevels = 16;
// InvalidArgument naming the field, the value and the rule, e.g. "options.eta is 2.5; it must be in (1, 2)".
absl::Status ValidateOptions(const RemeshOptions& options);

// The mesh as Remesh meshes it where options.repair is set: RepairMesh, then slivers are mended whose sides would be taken for creases
// (repair_slivers.h), by at most 2e-4 of the diagonal and, where it is set, a quarter of max_error. Repairs also where options.repair is
// false, but leaves slivers alone then, and always without crease_angle, as there are no creases. `options` must be valid. Errors of
// RepairMesh; ResourceExhausted: no memory. Stops with the context; deterministic.
absl::StatusOr<RepairResult> RepairInput(TriangleMesh mesh, const RemeshOptions& options, const Context& context);
// The same where a region of it is to be remeshed: the direction of components stays, and so do slivers, which are mended later, where all
// faces that change lie in the region.
absl::StatusOr<RepairResult> RepairInputOfRegion(TriangleMesh mesh, const Context& context);

class PreparedInput;

struct Problem {
  TriangleMesh mesh;  // as read, or without triangles a point set; consumed
  RemeshOptions options;
  // The part to remesh; none: all of it. The faces beside it come back with the bits of their coordinates and their cyclic order, before
  // the new ones; the vertices on its border stay, and are joined to both. Repairs, of the whole, leave the direction of components alone
  // then, and slivers are mended where all faces that change lie in the region. target_triangles counts the new triangles.
  std::optional<Region> region;
  // In place of the mesh: what regions of it begin with (prepared_input.h). Without a region, the whole of it.
  std::shared_ptr<const PreparedInput> prepared = nullptr;
  // Lines to be kept like creases, whatever crease_angle is: the surface's faces are split along them (features/line_insertion.h). Of a
  // region what lies on faces away from its border, with a warning that says which segments do not. A point set becomes a mesh for that,
  // as with sharp edges (sharp_points.h), and lines come to its surface. Not with a mesh that is meshed as a point set.
  Polylines features;
  // Takes the whole mesh as well, also where the region's `patch_only` keeps the rest from the caller's sink, in the order that it has
  // without, but for normals and finalised vertices: for who goes on with it. Outlives the call; null: nobody does. Of Remesh alone.
  MeshSink* whole = nullptr;
  // Hears how many new triangles are predicted before any is made; a status that is not OK ends the job. May hear it more than once, and
  // not where fewer are wanted than can be predicted. Of Remesh alone.
  std::function<absl::Status(uint64_t triangles)> admit = nullptr;
  int most_attempts = 16;  // attempts.h makes no more where the mesh is but a means to another
};

struct InputReport {
  bool is_point_set = false;
  TopologyReport topology;            // of the mesh after repair; of a point set vertices and components only
  std::vector<RepairAction> repairs;  // what was changed
  double diagonal = 0;                // of the bounding box
};

// The parameters in force after defaults and clamps were derived.
struct ParametersInForce {
  RemeshOptions options;          // lengths absolute, the sizing's parameter solved for, no target
  double detail = 0;              // absolute: curvature asks for no shorter edges, where a target needs that; 0: it may
  uint64_t target_triangles = 0;  // that it was solved for; 0: none
  double min_edge = 0, max_edge = 0;  // absolute
  uint64_t feature_segments = 0;      // of Problem.features
  uint64_t clamped_samples = 0;       // sizing samples that a clamp changed
};

struct StageSeconds {
  double repair = 0, index = 0, curvature = 0, guidance = 0, features = 0, mesh = 0, first_chunk = 0, engine = 0;
};

struct Report {
  InputReport input;
  ParametersInForce parameters;
  uint64_t predicted_triangles = 0;  // before any was made
  double error_bound =
      0;  // eq. 7 with the longest edge, absolute; where max_error is held constant that, for a count about 1.3 of it or more
  TopologyReport output;  // of all that was handed on
  bool complete = true;   // false: open_places lists where the mesh could not be closed, or a warning what is wrong
  std::vector<Vec3> open_places;
  std::vector<std::string> warnings;   // what the caller should know of the result, one sentence each
  std::optional<RegionReport> region;  // where one was asked for
  struct {                             // of the triangles that were made
    double radius_ratio_min = 0, radius_ratio_p0_5 = 0, radius_ratio_median = 0, min_angle_deg = 0;
  } quality;
  struct {
    uint64_t free = 0, connection = 0, closing = 0;
  } triangles_by_kind;
  uint64_t flips = 0;
  uint64_t peak_front_edges = 0;
  std::vector<std::pair<std::string, uint64_t>> refusals;  // how often each test refused a candidate
  StageSeconds seconds;
  int threads = 1;
};

// Meshes the problem into the sink. InvalidArgument: bad option or unusable input; FailedPrecondition: the input can't be meshed
// under this policy (with the places); Cancelled / DeadlineExceeded; the sink's own status when it stops the job. A mesh that
// could be closed only in part is OK with `complete == false`; one without any triangle is FailedPrecondition.
// ResourceExhausted: no memory. Deterministic at any thread count. Where there are rims or
// creases, the beginning of the output, or all of it, is held back, to be made again where it came out wrong (attempts.h); else all
// comes as it settles.
absl::StatusOr<Report> Remesh(Problem problem, MeshSink& sink, const Context& context);

// Where the meshes of RemeshLevels go, one after the other. Implemented by the server and by tests.
class LevelSink {
 public:
  virtual ~LevelSink() = default;
  // The sink of the next level, the one with the smallest rho first; it stays until EndLevel.
  virtual MeshSink& BeginLevel() = 0;
  // The level is whole. A status that is not OK ends the job and is returned.
  virtual absl::Status EndLevel(const Report& report) = 0;
};

// A mesh for each of options.lod_rhos: repair, index, curvature and creases are made once, the field, the fronts and a report for each.
// Each is the mesh that Remesh makes with that rho. The errors of Remesh; with one, those levels that are whole are no chain.
absl::Status RemeshLevels(Problem problem, LevelSink& sink, const Context& context);

struct Estimate {
  InputReport input;
  ParametersInForce parameters;
  uint64_t predicted_triangles = 0;
  double error_bound = 0;
  double edge_min = 0, edge_median = 0, edge_max = 0;  // of the predicted edges, absolute
  uint64_t memory_bytes = 0;
};
// The preparation alone: reads everything, meshes nothing.
absl::StatusOr<Estimate> EstimateRemesh(Problem problem, const Context& context);

}  // namespace meshfront
