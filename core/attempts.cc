// 1. the limit up to which the result is held    2. the front    3. its faults: open places, and where it meets itself
// 4. the best attempt so far is kept             5. field and fronts again, finer or for another count, or with faces of the
//                                                   input cut loose around the faults; back to 2
// 6. components that are wrong in the best one are the input's own faces
// Rims and creases are divided before the front starts, and no roll-back can divide them again: an edge of them that is too long for
// what lies close by is only mended so. Where shorter edges don't help, the ground is rough: folds as thin as their own edges look the
// same at any length. There the input's faces, each a patch of its own, are what the mesh is made of.
#include "core/attempts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>

#include "core/base/status_macros.h"
#include "core/features/close_curves.h"
#include "core/geometry/intersection.h"
#include "core/geometry/triangle.h"
#include "core/ground.h"
#include "core/guidance/sizing.h"
#include "core/loose_faces.h"
#include "core/mesh/self_intersection.h"
#include "core/own_faces.h"
#include "core/thinned_attempt.h"
#include "core/uncovered_samples.h"

namespace meshfront {
namespace {

// Of the front before it is stopped. Predictions are right to a tenth; what goes so far beyond folds over itself.
constexpr uint64_t kMaxPerPredicted = 2, kMaxBeyondPredicted = 20000;

// Vertices for each triangle that may be added where the error is largest when a number of triangles is wanted: the maximum is made by
// few places.
constexpr double kInsertionsForCount = 0.0155;

constexpr uint64_t kHeldTriangles = 1 << 19;
constexpr uint64_t kHeldPerFace = 8;  // of the input, where those are more: it takes more memory than they do
// Where there are rims at all, or a number up to this is wanted: not much more than what the settling window keeps before it lets go of any.
constexpr uint64_t kHeldInAnyCase = 6000;
// Of the vertices; of scans it is 0.001 at most.
constexpr double kManyTooClose = 0.02;
constexpr int kMaxAttempts = 7, kMaxForCount = 4;
// Of a point set, no faces can be cut loose. What helps where shorter edges don't are wider supports: where samples lie unevenly or in a
// cloud, those of four spacings see too few, and the surface has bumps or ends where there is none.
constexpr int kMaxForPoints = 6, kFinerForPoints = 1, kRoundedForPoints = 1, kWiderAtPlaces = 2;
constexpr double kWiderAtPlace = 1.6, kWiderEverywhere = 1.5;
constexpr size_t kMostFaultsAtPlaces = 50;
// The attempts end where so many in a row have more than this part of the fewest faults so far.
constexpr double kWorthGoingOn = 0.7;
constexpr int kMaxInVain = 2;
// Or after so many triangles, where there are too many faults to be mended.
constexpr uint64_t kMostTried = 150000;
// And beyond so many roll-backs, and triangles, the front is no good: another support is tried before.
constexpr uint64_t kMaxRollBacksForPoints = 60, kMaxBeyondForPoints = 2000;
// What counts of samples that are looked at (Preparation::most_samples_seen). One attempt may always look at so many candidates a triangle;
// ten to a hundred are usual. Where sheets lie closer than supports are wide the front tries all it can, each time with more samples around:
// a surface with one side took minutes.
constexpr double kCandidatesPerTriangle = 100, kSettlingPerTriangle = 40;
// Where the front was taken back at place after place all over a large mesh, the ground is rough, and shorter edges make it no better:
// roll-backs times triangles.
constexpr double kMostWorkForFiner = 1e7;
// Faults beyond which the ground is no place to be mended but a heap of faces, each attempt takes longer than the one before, and none
// is better (2CylinderEngine: 2,880 faults, then minutes).
constexpr size_t kMostFaults = 1000;
// Of a region, whose faces around faults may also stay as they are: triangles of all attempts beyond which none follows one that has hardly
// fewer faults.
constexpr uint64_t kMostTriedOfRegion = 50000;
// How many more triangles the next front is to make where one found no way, of so few; and off by how much the count of one is for which
// another one is tried before some are taken out.
constexpr double kMoreForFaults = 1.6, kWorthAnotherFront = 0.25;
constexpr int kFinerAttempts = 3;  // before faces are cut loose; none on rough ground
// How far around faults faces are cut loose, in parts of g; twice as far each time.
constexpr double kLooseReach = 3;
// Where creases are not to be kept but no front passes over them, those that turn by more than this are: degrees, the default.
constexpr double kCreaseAngleOfNeed = 40;
// Such fronts lie in layers over sharp edges, each slower than the one before: triangles beyond half as many as predicted.
constexpr uint64_t kMaxBeyondWithoutCreases = 500;
// Where the field is steep, fronts of very different steps meet; a gentler one keeps a larger eta as well. The default.
constexpr double kGentleEta = 1.2;
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

uint64_t MostCandidates(const Preparation& p, double samples_seen) {
  const double left = (p.most_samples_seen - samples_seen) / p.points->samples().MeanListLength();
  return static_cast<uint64_t>(std::max(left, kCandidatesPerTriangle * std::min(p.predicted_triangles, 1e15)));
}

struct AttemptOptions {
  bool is_small = false;            // see IsSmall
  bool looks_closely = false;       // for intersections
  bool passes_sharp_edges = false;  // there are some, and no creases
  double samples_seen = 0;          // by the attempts before
};

FrontOptions FrontOptionsOf(const Preparation& p, const AttemptOptions& attempt) {
  const RemeshOptions& o = p.parameters.options;
  const auto predicted = static_cast<uint64_t>(std::min(p.predicted_triangles, 1e18));
  const uint64_t beyond = p.points ? kMaxBeyondForPoints : kMaxBeyondPredicted;
  const uint64_t most = attempt.passes_sharp_edges ? predicted + predicted / 2 + kMaxBeyondWithoutCreases
                                                   : kMaxPerPredicted * predicted + beyond;
  return {.flips = o.flips,
          .smooth = o.smooth,
          .fit = o.fit,
          .error_per_length = o.sizing == Sizing::kAngle || o.sizing == Sizing::kThickness ? ErrorPerLength(o.rho) : 1,
          .bound_per_length = BoundPerLength(p),
          .predicted_triangles = predicted,
          .max_triangles = most,
          .max_roll_backs = p.points ? kMaxRollBacksForPoints : std::numeric_limits<uint64_t>::max(),
          .max_candidates = p.points ? MostCandidates(p, attempt.samples_seen) : std::numeric_limits<uint64_t>::max(),
          .sweep = LongestAxis(p.Box()),
          .max_error = o.sizing == Sizing::kError ? p.parameter : std::numeric_limits<double>::infinity(),
          .max_insertions = p.parameters.target_triangles > 0 ? kInsertionsForCount * p.predicted_triangles
                                                              : std::numeric_limits<double>::infinity(),
          .wedges = !p.attributes.empty() || (attempt.is_small && p.parameters.target_triangles > 0)};
}

// Of an input that was no surface: what repair made of it may be as thin and as folded as no scan is.
bool WasSoup(const Preparation& p) {
  return std::any_of(p.input.repairs.begin(), p.input.repairs.end(), [](const RepairAction& action) {
    return action.what == "split_non_manifold_edges" || action.what == "cut_non_orientable_edges" ||
           action.what == "dropped_non_manifold_faces";
  });
}

// So few are predicted that all are held, compared, and made again where they are wrong.
bool AreFewPredicted(const Preparation& p) { return p.predicted_triangles <= static_cast<double>(kHeldInAnyCase); }
// … or wanted of those.
bool IsSmall(const Preparation& p) { return p.is_least_count || AreFewPredicted(p); }

// Shells closer to each other than their input's edges are long: no front keeps apart all over what those keep.
bool HasSheetsTooClose(const Preparation& p) { return !p.points && p.builder->ShareTooClose() > kManyTooClose; }

uint64_t HeldLimit(const Preparation& p, bool may_fail) {
  if (p.region) return std::numeric_limits<uint64_t>::max();  // what is close to the rest can only be seen so
  if (p.points) return kHeldTriangles;
  if (may_fail) return std::max(kHeldTriangles, kHeldPerFace * p.surface->mesh().triangles.size());
  if (IsSmall(p)) return std::numeric_limits<uint64_t>::max();  // as many as the front may make
  return p.loops.empty() ? 0 : kHeldInAnyCase;
}

std::array<Vec3, 3> CornersOf(const TriangleMesh& mesh, const Triangle& t) {
  return {mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])};
}

bool HasOtherTopology(const FrontReport& front, const Preparation& p) {
  if (p.region || p.points || !front.open_places.empty() || front.pinched_vertices > 0)
    return false;  // it can't be told
  return HasOtherTopology(TopologyOf(front), p.input.topology);
}

// The settling window compares what it holds at a time; this compares all with all, and with what surrounds a region.
absl::Status FindIntersections(TriangleMesh mesh, const Preparation& p, double bound, Attempt& attempt,
                               const Context& context) {
  const size_t own = mesh.triangles.size();
  if (p.region) AddFacesAround(*p.region, mesh);
  const Surface& input = p.region ? *p.region->around : p.any_surface();
  MESHFRONT_ASSIGN_OR_RETURN(const SelfIntersections found, FindSelfIntersections(mesh, kMaxListedPairs, context));
  attempt.intersections.clear();
  attempt.front.own_intersection.reset();
  for (const auto& [f, g] : found.first_pairs) {
    if (f.index() >= own) continue;  // the input's own
    const auto [a, b, c] = CornersOf(mesh, mesh.triangles[f.index()]);
    const auto [d, e, h] = CornersOf(mesh, mesh.triangles[g.index()]);
    const Vec3 place = PlaceOfMeeting({a, b, c}, {d, e, h});
    if (!input.MeetsItselfNear(place, bound, context))
      attempt.intersections.push_back(place);
    else if (!attempt.front.own_intersection)
      attempt.front.own_intersection = place;
  }
  return context.CheckStop();
}

void FindFlatTriangles(const TriangleMesh& mesh, Attempt& attempt) {
  for (const Triangle& t : mesh.triangles) {
    const auto [a, b, c] = CornersOf(mesh, t);
    if (RadiusRatio(a, b, c) < kFlatRatio) attempt.flat_triangles.push_back((a + b + c) / 3.0);
  }
}

// Patches of this cut become components of the whole, whose numbers stay.
void NameWholeComponents(const MeshSurface& surface, std::vector<HeldPiece>& pieces) {
  for (HeldPiece& piece : pieces) {
    for (OutputVertex& v : piece.vertices) v.sheet = surface.WholeComponentOf(v.sheet);
  }
}

absl::StatusOr<Attempt> MakeAttempt(const Preparation& p, const AttemptOptions& how, HoldingSink& held,
                                    const Context& context) {
  const FrontOptions options = FrontOptionsOf(p, how);
  Attempt attempt;
  MESHFRONT_ASSIGN_OR_RETURN(attempt.front,
                             AdvanceFront(p.any_surface(), *p.field, p.loops, p.seeds, options, held, context));
  attempt.samples_seen = how.samples_seen;
  if (p.points) {
    double looks = kSettlingPerTriangle * static_cast<double>(attempt.front.triangles);
    for (const auto& verdict : attempt.front.refusals) looks += static_cast<double>(verdict.second);
    attempt.samples_seen += looks * p.points->samples().MeanListLength();
  }
  attempt.parameters = p.parameters;
  attempt.parameter = p.parameter;
  attempt.lost_rims = p.lost_rims;
  attempt.lost_places = p.lost_places;
  attempt.gaps = p.gaps;
  attempt.widened = p.widened;
  attempt.points = p.input.topology;
  attempt.peak_curvature = p.PeakCurvature();
  attempt.intersections = attempt.front.spread_intersections;
  attempt.has_other_topology = HasOtherTopology(attempt.front, p);
  if (held.is_passing()) return attempt;
  attempt.pieces = held.Take();
  if (!p.points) NameWholeComponents(*p.surface, attempt.pieces);
  const TriangleMesh mesh = MeshOf(attempt.pieces);
  attempt.bound =
      std::isfinite(options.max_error) ? options.max_error : options.bound_per_length * attempt.front.longest_edge;
  if (p.points || p.builder->HasCloseSheets() || how.looks_closely)
    MESHFRONT_RETURN_IF_ERROR(FindIntersections(mesh, p, attempt.bound, attempt, context));
  FindFlatTriangles(mesh, attempt);
  if (p.points) attempt.uncovered = FindUncovered(*p.points, mesh);
  if (how.is_small && !p.points && !p.region) attempt.missed = FindMissed(*p.surface, *p.field, mesh);
  return attempt;
}

// `is_thinned`: where there are too many some are taken out.
bool IsBetter(const Attempt& attempt, const Attempt& best, uint64_t wanted, bool is_thinned) {
  if (attempt.fault_count() != best.fault_count()) return attempt.fault_count() < best.fault_count();
  const auto has_too_few = [&](const Attempt& a) {
    return a.front.triangles < wanted && CountErrorOf(a, wanted) > kCountPromise;
  };
  if (is_thinned && has_too_few(attempt) != has_too_few(best)) return has_too_few(best);
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

void GradeGently(Preparation& p) {
  p.parameters.options.eta = kGentleEta;
  p.builder = std::make_shared<FieldBuilder>(*p.surface, *p.builder, kGentleEta);
}

// What is still wrong is not handed on where the input's own faces may be.
absl::Status PutOwnFacesIn(const Preparation& p, Attempt& best, const Context& context) {
  MESHFRONT_ASSIGN_OR_RETURN(
      PartlyOwn mixed, PutOwnFacesIn(best.pieces, *p.surface,
                                     {best.missed.components, best.bound, kFlatRatio, p.attributes.empty()}, context));
  best.pieces = std::move(mixed.pieces);
  best.own_components = mixed.components;
  best.own_faces = mixed.faces;
  best.missed = {};
  best.intersections.clear();
  best.flat_triangles.clear();
  best.has_other_topology = false;
  best.front.open_places.clear();
  Describe(mixed.topology, mixed.quality, mixed.by_kind, best.front);
  return absl::OkStatus();
}

// What the next attempt does otherwise, from what is lost at large to what is wrong at places. Edges half as long around the faults mend
// rims and creases that lie close to something. Not where an edge must be longer than the input's: those faults stay.
class Remedy {
 public:
  Remedy(const Preparation& p, bool is_small)
      : is_small_(is_small), may_keep_creases_(!p.points && !p.parameters.options.crease_angle) {}

  bool may_keep_creases() const { return may_keep_creases_; }
  bool keeps_creases() const { return keeps_creases_; }

  // Prepares the next attempt. False: there is none that could be better.
  absl::StatusOr<bool> Apply(const Attempt& last, const std::vector<Vec3>& places, bool is_rough,
                             std::optional<uint64_t> count, Preparation& p, const Context& context) {
    const bool is_faulty = last.fault_count() > 0;
    if (p.points && is_faulty) return ApplyToPoints(last, places, count, p, context);
    if (is_faulty && std::exchange(may_keep_creases_, false)) {
      MESHFRONT_ASSIGN_OR_RETURN(keeps_creases_,
                                 CutAlongCreases(kCreaseAngleOfNeed * std::numbers::pi / 180, p, context));
      if (keeps_creases_) return IsPrepared({}, count, p, context);
    }
    if (count && is_faulty && is_small_) return MakeMore(places, p, context);
    if (places.size() > kMostFaults || last.has_other_topology) {
      if (p.parameters.options.eta <= kGentleEta) return false;
      GradeGently(p);
      return IsPrepared({}, count, p, context);
    }
    const bool is_finer = !is_rough && finer_++ < kFinerAttempts;
    if (places.empty() || is_finer || p.parameters.options.min_edge) return IsPrepared(places, count, p, context);
    MESHFRONT_RETURN_IF_ERROR(CutFacesLoose(places, reach_, p, context));
    reach_ *= 2;
    return IsPrepared({}, count, p, context);
  }

 private:
  absl::StatusOr<bool> ApplyToPoints(const Attempt& last, const std::vector<Vec3>& places,
                                     std::optional<uint64_t> count, Preparation& p, const Context& context) {
    if (!last.uncovered.empty() && last.fault_count() == last.uncovered.size()) {
      p.more_seeds.insert(p.more_seeds.end(), last.uncovered.begin(), last.uncovered.end());
      return IsPrepared({}, count, p, context);
    }
    const bool is_at_places = !last.front.ran_away && last.fault_count() <= kMostFaultsAtPlaces;
    if (rounded_++ < kRoundedForPoints) {
      const absl::Span<const Vec3> rounded_at =
          is_at_places ? absl::Span<const Vec3>(places) : absl::Span<const Vec3>();
      MESHFRONT_ASSIGN_OR_RETURN(const bool is_rounder, RoundEdges(rounded_at, count, p, context));
      if (is_rounder) return true;
    }
    if (is_at_places && last.lost_rims == 0 && finer_++ < kFinerForPoints) return IsPrepared(places, count, p, context);
    in_vain_ = static_cast<double>(last.fault_count()) > kWorthGoingOn * fewest_faults_ ? in_vain_ + 1 : 0;
    fewest_faults_ = std::min(fewest_faults_, static_cast<double>(last.fault_count()));
    tried_ += last.front.triangles;
    if (last.samples_seen > p.most_samples_seen) return false;
    if (in_vain_ >= kMaxInVain || (tried_ > kMostTried && last.fault_count() > kMostFaults)) return false;
    absl::StatusOr<bool> wider = is_at_places && wider_++ < kWiderAtPlaces
                                     ? WidenSupports(places, kWiderAtPlace, count, p, context)
                                     : WidenSupports({}, kWiderEverywhere, count, p, context);
    if (absl::IsInvalidArgument(wider.status())) return false;
    return wider;
  }

  // So few triangles were wanted that the front found no way everywhere. In turn: shorter edges at the faults, for the parameter that
  // makes them; and more triangles, of which some are taken out again afterwards.
  absl::StatusOr<bool> MakeMore(const std::vector<Vec3>& places, Preparation& p, const Context& context) {
    const bool is_finer = !places.empty() && places.size() <= kMostFaultsAtPlaces && finer_++ % 2 == 0;
    if (is_finer) return IsPrepared(places, std::nullopt, p, context);
    return IsPrepared({}, static_cast<uint64_t>(kMoreForFaults * p.predicted_triangles) + 1, p, context);
  }

  // Not where so few triangles, or so many, can't be made.
  static absl::StatusOr<bool> IsPrepared(absl::Span<const Vec3> finer_at, std::optional<uint64_t> count, Preparation& p,
                                         const Context& context) {
    const absl::Status prepared = PrepareAgain(finer_at, count, p, context);
    if (absl::IsInvalidArgument(prepared)) return false;
    MESHFRONT_RETURN_IF_ERROR(prepared);
    return true;
  }

  bool is_small_, may_keep_creases_, keeps_creases_ = false;
  int finer_ = 0, wider_ = 0,
      rounded_ = 0;  // attempts with shorter edges, wider supports, and rounder edges around faults
  double reach_ = kLooseReach;
  double fewest_faults_ = std::numeric_limits<double>::infinity();
  uint64_t tried_ = 0;  // triangles of all attempts
  int in_vain_ = 0;     // wider supports that hardly made it better
};

bool IsInVain(const Attempt& attempt, const Attempt& best) {
  return static_cast<double>(attempt.fault_count()) > kWorthGoingOn * static_cast<double>(best.fault_count());
}

}  // namespace

std::vector<Vec3> Attempt::Faults() const {
  std::vector<Vec3> places = front.open_places;
  places.insert(places.end(), intersections.begin(), intersections.end());
  places.insert(places.end(), flat_triangles.begin(), flat_triangles.end());
  places.insert(places.end(), lost_places.begin(), lost_places.end());
  places.insert(places.end(), missed.places.begin(), missed.places.end());
  return places;
}

bool HasOtherTopology(const TopologyReport& output, const TopologyReport& input) {
  return output.components != input.components || output.boundary_loops != input.boundary_loops ||
         (input.genus && output.genus != input.genus);
}

TopologyReport TopologyOf(const FrontReport& front) {
  TopologyReport t;
  t.vertices = front.vertices;
  t.triangles = front.triangles;
  t.components = front.components;
  t.boundary_edges = front.boundary_edges;
  t.boundary_loops = front.boundary_loops;
  t.closed = front.triangles > 0 && front.boundary_edges == 0;
  t.oriented = true;  // the front set's invariant, as is that no edge has more than two triangles
  t.manifold = front.pinched_vertices == 0;
  const auto n = [](uint64_t x) { return static_cast<int64_t>(x); };
  t.euler_characteristic = n(t.vertices) - (3 * n(t.triangles) + n(t.boundary_edges)) / 2 + n(t.triangles);
  const int64_t twice = 2 * n(t.components) - t.euler_characteristic - n(t.boundary_loops);
  if (front.open_places.empty()) t.genus = twice / 2;
  return t;
}

absl::StatusOr<Attempt> AdvanceInAttempts(Preparation& p, MeshSink& sink, const Context& context) {
  bool is_close = p.points != nullptr;  // sheets of samples may
  if (!p.points) {
    MESHFRONT_ASSIGN_OR_RETURN(is_close, DoCurvesLieClose(*p.surface, p.loops, context));
  }
  const Ground ground = p.points ? Ground{} : GroundOf(*p.surface, *p.field);
  const bool is_rough = ground.is_rough;
  HoldingSink held(sink, HeldLimit(p, is_close || is_rough || ground.folds_back || WasSoup(p) || HasSheetsTooClose(p)));
  const uint64_t wanted = p.parameters.target_triangles;
  Attempt best;
  double samples_seen = 0;
  const bool is_small = IsSmall(p) && !p.region;
  const bool is_thinned = is_small && wanted > 0;
  Remedy remedy(p, AreFewPredicted(p) && !p.region);
  uint64_t tried = 0;  // triangles
  for (int number = 1;; ++number) {
    MESHFRONT_ASSIGN_OR_RETURN(Attempt attempt, MakeAttempt(p,
                                                            {is_small, is_rough || p.region || number > 1 || is_small,
                                                             is_rough && remedy.may_keep_creases(), samples_seen},
                                                            held, context));
    samples_seen = attempt.samples_seen;
    attempt.keeps_creases = remedy.keeps_creases();
    if (held.is_passing()) return attempt;
    tried += attempt.front.triangles;
    held.HoldAll();  // the next may be larger, and worse: at most what max_triangles allows
    const bool is_off = CountErrorOf(attempt, wanted) > kCountPromise;
    const bool is_thinned_now =
        is_thinned && HasTooMany(attempt, wanted) && CountErrorOf(attempt, wanted) > kWorthAnotherFront;
    const bool is_as_near_as_can_be =
        !is_off || is_thinned_now || (p.is_least_count && attempt.front.triangles > wanted);
    const bool is_good = attempt.fault_count() == 0 && (is_as_near_as_can_be || number >= kMaxForCount);
    bool goes_on = !is_good && (attempt.front.triangles > 0 || p.points) &&
                   number < (p.points ? std::min(kMaxForPoints, p.most_attempts) : kMaxAttempts);
    const double work = static_cast<double>(attempt.front.roll_backs) * static_cast<double>(attempt.front.triangles);
    if (p.region && attempt.fault_count() > 0 &&
        (work > kMostWorkForFiner || (number > 1 && tried > kMostTriedOfRegion && IsInVain(attempt, best))))
      goes_on = false;
    if (goes_on) {
      MESHFRONT_ASSIGN_OR_RETURN(goes_on, remedy.Apply(attempt, attempt.Faults(), is_rough || work > kMostWorkForFiner,
                                                       NextCount(p, attempt, wanted), p, context));
    }
    if (number == 1 || IsBetter(attempt, best, wanted, is_thinned)) best = std::move(attempt);
    if (!goes_on) break;
  }
  if (best.fault_count() > 0 && best.front.triangles > 0 && !p.parameters.options.min_edge && !p.region && !p.points)
    MESHFRONT_RETURN_IF_ERROR(PutOwnFacesIn(p, best, context));
  if (is_thinned && HasTooMany(best, wanted)) MESHFRONT_RETURN_IF_ERROR(ThinToCount(wanted, best, context));
  if (p.attributes.empty()) {
    for (HeldPiece& piece : best.pieces) piece.wedges.clear(), piece.corners.clear(), piece.faces.clear();
  }
  for (const SourcePoint& place : best.uncovered) best.front.open_places.push_back(place.position);
  held.PutBack(std::exchange(best.pieces, {}));
  MESHFRONT_RETURN_IF_ERROR(held.Release());
  return best;
}

}  // namespace meshfront
