#include "core/remesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/exceptions.h"
#include "core/base/status_macros.h"
#include "core/features/close_curves.h"
#include "core/front/advancing_front.h"
#include "core/geometry/intersection.h"
#include "core/geometry/triangle.h"
#include "core/guidance/prediction.h"
#include "core/guidance/sizing.h"
#include "core/mesh/holding_sink.h"
#include "core/mesh/self_intersection.h"
#include "core/preparation.h"

namespace meshfront {
namespace {

constexpr uint64_t kMinTargetTriangles = 4;  // a tetrahedron

using Clock = std::chrono::steady_clock;

// Of the front before it is stopped. Predictions are right to a tenth; what goes so far beyond folds over itself.
constexpr uint64_t kMaxPerPredicted = 2, kMaxBeyondPredicted = 20000;

// Vertices for each triangle that may be added where the error is largest when a number of triangles is wanted: the maximum is made by
// few places. As it goes; and in all, counting only what is far beyond the bound from there on.
constexpr double kInsertionsForCount = 0.005, kMostInsertionsForCount = 0.0185;

// Rims and creases are divided before the front starts, and no roll-back can divide them again. So where they lie close to something so
// much of the output is held back, for the whole to be made again with shorter edges where it came out wrong.
constexpr uint64_t kHeldTriangles = 1 << 18;
// … and as many wherever there are rims: not much more than what the settling window keeps before it lets go of any.
constexpr uint64_t kHeldInAnyCase = 6000;
constexpr int kMaxAttempts = 4;
// Where the front was taken back at place after place all over a large mesh, the ground is rough, and shorter edges make it no better:
// roll-backs times triangles.
constexpr double kMostWorkForAnother = 1e7;
constexpr double kCountTolerance = 0.03;   // of the number of triangles wanted
constexpr size_t kMaxListedPairs = 20000;  // of an output's intersections, that are looked at

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Hands pieces on, in the scale of the input, and notes when the first came.
class OutgoingSink : public MeshSink {
 public:
  OutgoingSink(MeshSink& next, double scale, Clock::time_point start) : next_(next), scale_(scale), start_(start) {}

  absl::Status Append(const MeshPiece& piece) override {
    if (first_chunk_ == 0) first_chunk_ = SecondsSince(start_);
    if (scale_ == 1) return next_.Append(piece);
    std::vector<OutputVertex> vertices(piece.vertices.begin(), piece.vertices.end());
    for (OutputVertex& v : vertices) v.position = v.position / scale_;
    return next_.Append({vertices, piece.triangles, piece.finalised, piece.open_front_edges, piece.kinds});
  }
  double first_chunk() const { return first_chunk_; }

 private:
  MeshSink& next_;
  const double scale_;
  const Clock::time_point start_;
  double first_chunk_ = 0;
};

absl::Status CheckLength(absl::string_view field, const std::optional<Length>& length) {
  if (!length || (std::isfinite(length->value) && length->value > 0)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("options.", field, " is ", length->value, "; it must be finite and positive"));
}

// That the one parameter of the sizing, and no other, is there.
absl::Status CheckSizing(const RemeshOptions& o) {
  if (o.sizing != Sizing::kError && o.max_error) {
    return absl::InvalidArgumentError("options.max_error is set; it needs options.sizing to be error");
  }
  if (o.sizing != Sizing::kUniform && o.edge_length) {
    return absl::InvalidArgumentError("options.edge_length is set; it needs options.sizing to be uniform");
  }
  if (!o.target_triangles) {
    if (o.sizing != Sizing::kUniform || o.edge_length) return absl::OkStatus();
    return absl::InvalidArgumentError(
        "options.sizing is uniform; it needs options.edge_length or options.target_triangles");
  }
  if (*o.target_triangles < kMinTargetTriangles) {
    return absl::InvalidArgumentError(absl::StrCat("options.target_triangles is ", *o.target_triangles,
                                                   "; it must be at least ", kMinTargetTriangles));
  }
  if (!o.max_error && !o.edge_length) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("options.target_triangles is set beside options.",
                                                 o.max_error ? "max_error" : "edge_length",
                                                 "; they exclude one another"));
}

int ThreadsInForce(const Context& context) {
  return context.threads > 0 ? context.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

Vec3 LongestAxis(const TriangleMesh& mesh) {
  const Box3 box = BoundingBox(mesh);
  const Vec3 extent = box.max - box.min;
  if (extent.x >= extent.y && extent.x >= extent.z) return {1, 0, 0};
  return extent.y >= extent.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
}

// Topology of the output from the counts that the front kept: V − E + F with E = (3F + rim) / 2.
TopologyReport OutputTopology(const FrontReport& front) {
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

// What came of one run of the front, and where it is wrong.
struct Attempt {
  FrontReport front;
  std::vector<HeldPiece> pieces;
  ParametersInForce parameters;
  double parameter = 0;             // the sizing's, as in Preparation
  std::vector<Vec3> intersections;  // where it meets itself though the surface does not within the error bound

  size_t faults() const { return front.open_places.size() + intersections.size(); }
};

Vec3 WhereTheyMeet(const TriangleMesh& mesh, FaceId s, FaceId t) {
  const auto corner = [&](FaceId f, int i) { return mesh.PositionAt(mesh.triangles[f.index()][i]); };
  const Vec3 a[3] = {corner(s, 0), corner(s, 1), corner(s, 2)}, b[3] = {corner(t, 0), corner(t, 1), corner(t, 2)};
  const auto stretch = CommonStretch(a, b);
  return stretch ? 0.5 * ((*stretch)[0] + (*stretch)[1]) : (a[0] + a[1] + a[2]) / 3.0;
}

// The settling window compares what it holds at a time; this compares all with all.
absl::Status FindIntersections(const Preparation& p, const FrontOptions& options, Attempt& attempt,
                               const Context& context) {
  TriangleMesh mesh;
  for (const HeldPiece& piece : attempt.pieces) {
    for (const OutputVertex& v : piece.vertices) mesh.positions.push_back(v.position);
    mesh.triangles.insert(mesh.triangles.end(), piece.triangles.begin(), piece.triangles.end());
  }
  MESHFRONT_ASSIGN_OR_RETURN(const SelfIntersections found, FindSelfIntersections(mesh, kMaxListedPairs, context));
  const double bound =
      std::isfinite(options.max_error) ? options.max_error : options.error_per_length * attempt.front.longest_edge;
  for (const auto& [s, t] : found.first_pairs) {
    const Vec3 place = WhereTheyMeet(mesh, s, t);
    if (!p.surface->MeetsItselfNear(place, bound)) attempt.intersections.push_back(place);
  }
  return absl::OkStatus();
}

FrontOptions FrontOptionsOf(const Preparation& p) {
  const RemeshOptions& o = p.parameters.options;
  const auto predicted = static_cast<uint64_t>(std::min(p.predicted_triangles, 1e18));
  return {.flips = o.flips,
          .smooth = o.smooth,
          .fit = o.fit,
          .error_per_length = o.sizing == Sizing::kAngle ? ErrorPerLength(o.rho) : 1,
          .predicted_triangles = predicted,
          .max_triangles = kMaxPerPredicted * predicted + kMaxBeyondPredicted,
          .sweep = LongestAxis(p.surface->mesh()),
          .max_error = o.sizing == Sizing::kError ? p.parameter : std::numeric_limits<double>::infinity(),
          .insertions = p.parameters.target_triangles > 0
                            ? InsertionLimits{kInsertionsForCount, kMostInsertionsForCount * p.predicted_triangles}
                            : InsertionLimits{}};
}

// By how much of what is wanted the number of triangles is off; 0 where none is wanted.
double CountErrorOf(const Attempt& attempt, uint64_t wanted) {
  if (wanted == 0) return 0;
  return std::abs(static_cast<double>(attempt.front.triangles) / static_cast<double>(wanted) - 1);
}

bool IsBetter(const Attempt& attempt, const Attempt& best, uint64_t wanted) {
  if (attempt.faults() != best.faults()) return attempt.faults() < best.faults();
  return CountErrorOf(attempt, wanted) < CountErrorOf(best, wanted);
}

// The front; and, while nothing of it went on, again: with shorter edges around its faults, and for as many more or fewer triangles as
// came too few or too many. The best of the attempts.
absl::StatusOr<Attempt> AdvanceInAttempts(Preparation& p, MeshSink& sink, const Context& context) {
  const uint64_t limit = DoCurvesLieClose(*p.surface, p.loops) ? kHeldTriangles : kHeldInAnyCase;
  HoldingSink held(sink, p.loops.empty() ? 0 : limit);
  const uint64_t wanted = p.parameters.target_triangles;
  double aim = static_cast<double>(wanted);
  Attempt best;
  for (int number = 1;; ++number) {
    const FrontOptions options = FrontOptionsOf(p);
    Attempt attempt;
    MESHFRONT_ASSIGN_OR_RETURN(attempt.front,
                               AdvanceFront(*p.surface, *p.field, p.loops, p.seeds, options, held, context));
    attempt.parameters = p.parameters;
    attempt.parameter = p.parameter;
    attempt.intersections = attempt.front.spread_intersections;
    if (held.is_passing()) return attempt;
    attempt.pieces = held.Take();
    attempt.intersections.clear();
    if (p.builder->HasCloseSheets()) MESHFRONT_RETURN_IF_ERROR(FindIntersections(p, options, attempt, context));
    std::vector<Vec3> places = attempt.front.open_places;
    places.insert(places.end(), attempt.intersections.begin(), attempt.intersections.end());
    const bool is_off = CountErrorOf(attempt, wanted) > kCountTolerance && attempt.front.triangles > 0;
    if (is_off) aim *= static_cast<double>(wanted) / static_cast<double>(attempt.front.triangles);
    const double work = static_cast<double>(attempt.front.roll_backs) * static_cast<double>(attempt.front.triangles);
    if (number == 1 || IsBetter(attempt, best, wanted)) best = std::move(attempt);
    if ((places.empty() && !is_off) || number == kMaxAttempts || work > kMostWorkForAnother) break;
    const auto count = is_off ? std::optional(static_cast<uint64_t>(std::llround(aim))) : std::nullopt;
    const absl::Status prepared = PrepareAgain(places, count, p, context);
    if (absl::IsInvalidArgument(prepared)) break;  // so few, or so many, can't be made
    MESHFRONT_RETURN_IF_ERROR(prepared);
  }
  held.PutBack(std::exchange(best.pieces, {}));
  MESHFRONT_RETURN_IF_ERROR(held.Release());
  return best;
}

// Where the input meets itself, so may the output, but not far from there.
void WarnOfIntersections(const Attempt& attempt, Report& report) {
  if (attempt.intersections.empty()) return;
  report.warnings.push_back(absl::StrCat("triangles meet where the input does not within the error bound, in ",
                                         attempt.intersections.size(), " places near parts of it that meet"));
}

// An empty mesh is no result. The test that refused most says why.
absl::Status NothingMeshed(const FrontReport& front, double scale) {
  std::string message = "not one triangle could be meshed";
  if (!front.open_places.empty()) {
    const Vec3 first = front.open_places.front() / scale;
    absl::StrAppend(&message, ": there was no place for the first one at (", first.x, ", ", first.y, ", ", first.z,
                    ")");
    if (front.open_places.size() > 1)
      absl::StrAppend(&message, " nor at ", front.open_places.size() - 1, " other starts");
  }
  const auto most = std::max_element(front.refusals.begin(), front.refusals.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most != front.refusals.end() && most->second > 0) {
    absl::StrAppend(&message, "; most candidates, ", most->second, ", were refused by the test ", most->first);
  }
  return absl::FailedPreconditionError(message);
}

void Scale(Preparation& p, Report& report) {
  report.parameters.min_edge /= p.scale;
  report.parameters.max_edge /= p.scale;
  report.error_bound /= p.scale;
  for (Vec3& place : report.open_places) place = place / p.scale;
}

// Where refinement could not keep max_error: beside edges that may not be shorter. Where a count is wanted it is not asked for.
void WarnOfDeviations(const FrontReport& front, double scale, Report& report) {
  if (front.beyond_max_error == 0) return;
  const double largest = front.largest_deviation / scale;
  report.error_bound = std::max(report.error_bound, largest);
  if (report.parameters.target_triangles > 0) return;
  report.warnings.push_back(absl::StrCat(front.beyond_max_error, " of ", front.triangles,
                                         " triangles are farther from the surface than ", "max_error (",
                                         report.parameters.options.max_error->value, "), by up to ", largest));
}

}  // namespace

absl::Status ValidateOptions(const RemeshOptions& o) {
  if (!(o.rho > 0 && o.rho <= 2 * std::numbers::pi / 3)) {
    return absl::InvalidArgumentError(absl::StrCat("options.rho is ", o.rho, "; it must be in (0, 2π/3]"));
  }
  if (!(o.eta > 1 && o.eta < 2)) {
    return absl::InvalidArgumentError(absl::StrCat("options.eta is ", o.eta, "; it must be in (1, 2)"));
  }
  if (o.crease_angle && !(*o.crease_angle > 0 && *o.crease_angle < 180)) {
    return absl::InvalidArgumentError(
        absl::StrCat("options.crease_angle is ", *o.crease_angle, "; it must be in (0, 180)"));
  }
  MESHFRONT_RETURN_IF_ERROR(CheckLength("max_error", o.max_error));
  MESHFRONT_RETURN_IF_ERROR(CheckLength("edge_length", o.edge_length));
  MESHFRONT_RETURN_IF_ERROR(CheckLength("min_edge", o.min_edge));
  MESHFRONT_RETURN_IF_ERROR(CheckLength("max_edge", o.max_edge));
  return CheckSizing(o);
}

absl::StatusOr<Report> Remesh(Problem problem, MeshSink& sink, const Context& context) try {
  const Clock::time_point start = Clock::now();
  MESHFRONT_ASSIGN_OR_RETURN(Preparation p, Prepare(std::move(problem), context));
  const double prepared = SecondsSince(start);
  OutgoingSink outgoing(sink, p.scale, start);
  const auto predicted = static_cast<uint64_t>(std::min(p.predicted_triangles, 1e18));
  MESHFRONT_ASSIGN_OR_RETURN(const Attempt attempt, AdvanceInAttempts(p, outgoing, context));
  p.parameters = attempt.parameters;
  p.parameter = attempt.parameter;
  const FrontReport& front = attempt.front;
  if (front.triangles == 0) return NothingMeshed(front, p.scale);
  Report report;
  report.input = p.input;
  report.parameters = p.parameters;
  report.predicted_triangles = predicted;
  const auto curvatures = p.surface->vertex_curvatures();
  const double peak = curvatures.empty() ? 0 : *std::max_element(curvatures.begin(), curvatures.end());
  report.error_bound = ErrorBoundInForce(p, front.longest_edge, peak);
  report.output = OutputTopology(front);
  report.complete = front.open_places.empty();
  report.open_places = front.open_places;
  report.quality.radius_ratio_min = front.quality.radius_ratio_min;
  report.quality.radius_ratio_p0_5 = front.quality.radius_ratio_p0_5;
  report.quality.radius_ratio_median = front.quality.radius_ratio_median;
  report.quality.min_angle_deg = front.quality.min_angle_deg;
  report.triangles_by_kind.free = front.free_triangles;
  report.triangles_by_kind.connection = front.connection_triangles;
  report.triangles_by_kind.closing = front.closing_triangles;
  report.flips = front.flips;
  report.peak_front_edges = front.peak_front_edges;
  report.refusals = front.refusals;
  report.seconds = p.seconds;
  report.seconds.first_chunk = outgoing.first_chunk();
  report.seconds.engine = SecondsSince(start);
  report.seconds.mesh = report.seconds.engine - prepared;
  report.threads = ThreadsInForce(context);
  Scale(p, report);
  WarnOfDeviations(front, p.scale, report);
  WarnOfIntersections(attempt, report);
  return report;
} catch (const std::exception&) {
  return StatusOfException();
}

absl::StatusOr<Estimate> EstimateRemesh(Problem problem, const Context& context) try {
  MESHFRONT_ASSIGN_OR_RETURN(Preparation p, Prepare(std::move(problem), context));
  Estimate estimate;
  estimate.input = p.input;
  estimate.parameters = p.parameters;
  estimate.predicted_triangles = static_cast<uint64_t>(std::min(p.predicted_triangles, 1e18));
  // Lengths of the predicted edges: g at the faces' centroids, weighted by how many triangles each face will get.
  const TriangleMesh& mesh = p.surface->mesh();
  std::vector<std::pair<double, double>> lengths;  // g, weight
  double total = 0, bound = 0;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
    const double g = p.field->At((a + b + c) / 3.0), weight = TriangleArea(a, b, c) / (g * g);
    lengths.push_back({g, weight});
    total += weight;
    double peak = 0;
    for (const VertexId v : t) peak = std::max(peak, p.surface->vertex_curvatures()[v.index()]);
    bound = std::max(bound, ErrorBoundInForce(p, g, peak));
  }
  std::sort(lengths.begin(), lengths.end());
  estimate.edge_min = kMedianEdgePerGuidance * lengths.front().first / p.scale;
  estimate.edge_max = lengths.back().first / p.scale;
  double below = 0;
  for (const auto& [g, weight] : lengths) {
    below += weight;
    estimate.edge_median = kMedianEdgePerGuidance * g / p.scale;
    if (below >= 0.5 * total) break;
  }
  estimate.error_bound = bound / p.scale;
  estimate.parameters.min_edge /= p.scale;
  estimate.parameters.max_edge /= p.scale;
  constexpr uint64_t kBytesPerInputTriangle = 200, kFixedBytes = 32 << 20;  // measured peaks, rounded up
  estimate.memory_bytes = kFixedBytes + kBytesPerInputTriangle * mesh.triangles.size();
  return estimate;
} catch (const std::exception&) {
  return StatusOfException();
}

}  // namespace meshfront
