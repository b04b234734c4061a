// 1. the limit up to which the result is held    2. the front    3. its faults: open places, and where it meets itself
// 4. the best attempt so far is kept             5. field and fronts again, finer or for another count, or with faces of the
//                                                   input cut loose around the faults; back to 2
// Rims and creases are divided before the front starts, and no roll-back can divide them again: an edge of them that is too long for
// what lies close by is only mended so. Where shorter edges don't help, the ground is rough: folds as thin as their own edges look the
// same at any length. There the input's faces, each a patch of its own, are what the mesh is made of.
#include "core/attempts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/base/status_macros.h"
#include "core/features/close_curves.h"
#include "core/geometry/intersection.h"
#include "core/geometry/triangle.h"
#include "core/guidance/sizing.h"
#include "core/loose_faces.h"
#include "core/mesh/self_intersection.h"

namespace meshfront {
namespace {

// Of the front before it is stopped. Predictions are right to a tenth; what goes so far beyond folds over itself.
constexpr uint64_t kMaxPerPredicted = 2, kMaxBeyondPredicted = 20000;

// Vertices for each triangle that may be added where the error is largest when a number of triangles is wanted: the maximum is made by
// few places.
constexpr double kInsertionsForCount = 0.0185;

constexpr uint64_t kHeldTriangles = 1 << 19;
// Where there are rims at all, or a number up to this is wanted: not much more than what the settling window keeps before it lets go of any.
constexpr uint64_t kHeldInAnyCase = 6000;
// Rough ground: this share of the edges turns by more than the angle of this cosine (80°).
constexpr double kRoughShare = 0.005, kRoughCosine = 0.17;
constexpr int kMaxAttempts = 7, kMaxForCount = 4;
constexpr int kMaxForPoints = 3;  // attempts at a point set: no faces can be cut loose
// Where the front was taken back at place after place all over a large mesh, the ground is rough, and shorter edges make it no better:
// roll-backs times triangles.
constexpr double kMostWorkForFiner = 1e7;
// Faults beyond which the ground is no place to be mended but a heap of faces, each attempt takes longer than the one before, and none
// is better (2CylinderEngine: 2,880 faults, then minutes).
constexpr size_t kMostFaults = 1000;
constexpr int kFinerAttempts = 3;  // before faces are cut loose; none on rough ground
// How far around faults faces are cut loose, in parts of g; twice as far each time.
constexpr double kLooseReach = 3;
constexpr double kCountPromise = 0.03;     // of the number of triangles wanted
constexpr double kFlatRatio = 1e-12;       // radius ratio of what has no area, whatever rounding says
constexpr size_t kMaxListedPairs = 20000;  // of an output's intersections, that are looked at

Vec3 LongestAxis(const Box3& box) {
  const Vec3 extent = box.max - box.min;
  if (extent.x >= extent.y && extent.x >= extent.z) return {1, 0, 0};
  return extent.y >= extent.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
}

// The error bound of an edge in parts of its length; with a uniform length, of that length where the surface is bent most.
double BoundPerLength(const Preparation& p) {
  const double length = p.parameters.options.sizing == Sizing::kUniform ? p.parameter : 1;
  return ErrorBoundInForce(p, length, p.PeakCurvature()) / length;
}

FrontOptions FrontOptionsOf(const Preparation& p) {
  const RemeshOptions& o = p.parameters.options;
  const auto predicted = static_cast<uint64_t>(std::min(p.predicted_triangles, 1e18));
  return {.flips = o.flips,
          .smooth = o.smooth,
          .fit = o.fit,
          .error_per_length = o.sizing == Sizing::kAngle || o.sizing == Sizing::kThickness ? ErrorPerLength(o.rho) : 1,
          .bound_per_length = BoundPerLength(p),
          .predicted_triangles = predicted,
          .max_triangles = kMaxPerPredicted * predicted + kMaxBeyondPredicted,
          .sweep = LongestAxis(p.Box()),
          .max_error = o.sizing == Sizing::kError ? p.parameter : std::numeric_limits<double>::infinity(),
          .max_insertions = p.parameters.target_triangles > 0 ? kInsertionsForCount * p.predicted_triangles
                                                              : std::numeric_limits<double>::infinity()};
}

uint64_t HeldLimit(const Preparation& p, bool may_fail) {
  if (may_fail) return kHeldTriangles;
  const uint64_t wanted = p.parameters.target_triangles;
  const uint64_t for_count = wanted <= kHeldInAnyCase ? wanted + wanted / 2 : 0;
  return p.loops.empty() ? for_count : std::max(for_count, kHeldInAnyCase);
}

// Whether so many edges turn sharply beside the creases that the front may fail somewhere. Of scans that it meshes well one edge in 300
// does at most.
bool IsRough(const MeshSurface& surface) {
  const TriangleMesh& mesh = surface.mesh();
  std::vector<Vec3> normals;
  normals.reserve(mesh.triangles.size());
  for (const Triangle& t : mesh.triangles)
    normals.push_back(Normalized(AreaVector(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]))));
  uint64_t sharp = 0, edges = 0;
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    const uint32_t across = surface.adjacency().OppositeOf(h);
    if (across == kNoHalfEdge || across < h) continue;
    ++edges;
    sharp += Dot(normals[h / 3], normals[across / 3]) < kRoughCosine;
  }
  return static_cast<double>(sharp) > kRoughShare * static_cast<double>(edges);
}

TriangleMesh MeshOf(const std::vector<HeldPiece>& pieces) {
  TriangleMesh mesh;
  for (const HeldPiece& piece : pieces) {
    for (const OutputVertex& v : piece.vertices) mesh.positions.push_back(v.position);
    mesh.triangles.insert(mesh.triangles.end(), piece.triangles.begin(), piece.triangles.end());
  }
  return mesh;
}

std::array<Vec3, 3> CornersOf(const TriangleMesh& mesh, const Triangle& t) {
  return {mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])};
}

// The settling window compares what it holds at a time; this compares all with all.
absl::Status FindIntersections(const TriangleMesh& mesh, const Preparation& p, double bound, Attempt& attempt,
                               const Context& context) {
  MESHFRONT_ASSIGN_OR_RETURN(const SelfIntersections found, FindSelfIntersections(mesh, kMaxListedPairs, context));
  attempt.intersections.clear();
  for (const auto& [f, g] : found.first_pairs) {
    const auto [a, b, c] = CornersOf(mesh, mesh.triangles[f.index()]);
    const auto [d, e, h] = CornersOf(mesh, mesh.triangles[g.index()]);
    const Vec3 place = PlaceOfMeeting({a, b, c}, {d, e, h});
    if (!p.any_surface().MeetsItselfNear(place, bound, context)) attempt.intersections.push_back(place);
  }
  return context.CheckStop();
}

void FindFlatTriangles(const TriangleMesh& mesh, Attempt& attempt) {
  for (const Triangle& t : mesh.triangles) {
    const auto [a, b, c] = CornersOf(mesh, t);
    if (RadiusRatio(a, b, c) < kFlatRatio) attempt.flat_triangles.push_back((a + b + c) / 3.0);
  }
}

absl::StatusOr<Attempt> MakeAttempt(const Preparation& p, bool looks_closely, HoldingSink& held,
                                    const Context& context) {
  const FrontOptions options = FrontOptionsOf(p);
  Attempt attempt;
  MESHFRONT_ASSIGN_OR_RETURN(attempt.front,
                             AdvanceFront(p.any_surface(), *p.field, p.loops, p.seeds, options, held, context));
  attempt.parameters = p.parameters;
  attempt.parameter = p.parameter;
  attempt.intersections = attempt.front.spread_intersections;
  if (held.is_passing()) return attempt;
  attempt.pieces = held.Take();
  const TriangleMesh mesh = MeshOf(attempt.pieces);
  const double bound =
      std::isfinite(options.max_error) ? options.max_error : options.bound_per_length * attempt.front.longest_edge;
  if (p.points || p.builder->HasCloseSheets() || looks_closely)
    MESHFRONT_RETURN_IF_ERROR(FindIntersections(mesh, p, bound, attempt, context));
  FindFlatTriangles(mesh, attempt);
  return attempt;
}

// By how much of what is wanted the number of triangles is off; 0 where none is wanted.
double CountErrorOf(const Attempt& attempt, uint64_t wanted) {
  if (wanted == 0) return 0;
  return std::abs(static_cast<double>(attempt.front.triangles) / static_cast<double>(wanted) - 1);
}

bool IsBetter(const Attempt& attempt, const Attempt& best, uint64_t wanted) {
  if (attempt.fault_count() != best.fault_count()) return attempt.fault_count() < best.fault_count();
  return CountErrorOf(attempt, wanted) < CountErrorOf(best, wanted);
}

// What the next one is to be predicted for: as many as this one was, corrected by what came of it.
std::optional<uint64_t> NextCount(const Preparation& p, const Attempt& attempt, uint64_t wanted) {
  if (wanted == 0 || attempt.front.triangles == 0) return std::nullopt;
  const double ratio = CountErrorOf(attempt, wanted) > kCountPromise
                           ? static_cast<double>(wanted) / static_cast<double>(attempt.front.triangles)
                           : 1;
  return static_cast<uint64_t>(std::llround(p.predicted_triangles * ratio));
}

// Edges half as long around the faults mend rims and creases that lie close to something. Not where an edge must be longer than the
// input's: those faults stay.
class Remedy {
 public:
  // Prepares the next attempt.
  absl::Status Apply(const std::vector<Vec3>& places, bool is_rough, std::optional<uint64_t> count, Preparation& p,
                     const Context& context) {
    const bool is_finer = !is_rough && finer_++ < kFinerAttempts;
    if (places.empty() || is_finer || p.points || p.parameters.options.min_edge)
      return PrepareAgain(places, count, p, context);
    MESHFRONT_RETURN_IF_ERROR(CutFacesLoose(places, reach_, p, context));
    reach_ *= 2;
    return PrepareAgain({}, count, p, context);
  }

 private:
  int finer_ = 0;  // attempts with shorter edges
  double reach_ = kLooseReach;
};

}  // namespace

std::vector<Vec3> Attempt::Faults() const {
  std::vector<Vec3> places = front.open_places;
  places.insert(places.end(), intersections.begin(), intersections.end());
  places.insert(places.end(), flat_triangles.begin(), flat_triangles.end());
  return places;
}

absl::StatusOr<Attempt> AdvanceInAttempts(Preparation& p, MeshSink& sink, const Context& context) {
  bool is_close = p.points != nullptr;  // sheets of samples may
  if (!p.points) {
    MESHFRONT_ASSIGN_OR_RETURN(is_close, DoCurvesLieClose(*p.surface, p.loops, context));
  }
  const bool is_rough = !p.points && IsRough(*p.surface);
  HoldingSink held(sink, HeldLimit(p, is_close || is_rough));
  const uint64_t wanted = p.parameters.target_triangles;
  Attempt best;
  Remedy remedy;
  for (int number = 1;; ++number) {
    MESHFRONT_ASSIGN_OR_RETURN(Attempt attempt, MakeAttempt(p, is_rough || number > 1, held, context));
    if (held.is_passing()) return attempt;
    held.HoldAll();  // the next may be larger, and worse: at most what max_triangles allows
    const std::vector<Vec3> places = attempt.Faults();
    const bool is_off = CountErrorOf(attempt, wanted) > kCountPromise;
    const double work = static_cast<double>(attempt.front.roll_backs) * static_cast<double>(attempt.front.triangles);
    const std::optional<uint64_t> count = NextCount(p, attempt, wanted);
    if (number == 1 || IsBetter(attempt, best, wanted)) best = std::move(attempt);
    if (places.empty() && (!is_off || number >= kMaxForCount)) break;
    if (number == (p.points ? kMaxForPoints : kMaxAttempts) || places.size() > kMostFaults) break;
    const absl::Status prepared = remedy.Apply(places, is_rough || work > kMostWorkForFiner, count, p, context);
    if (absl::IsInvalidArgument(prepared)) break;  // so few, or so many, can't be made
    MESHFRONT_RETURN_IF_ERROR(prepared);
  }
  held.PutBack(std::exchange(best.pieces, {}));
  MESHFRONT_RETURN_IF_ERROR(held.Release());
  return best;
}

}  // namespace meshfront
