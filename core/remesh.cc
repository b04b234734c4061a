#include "core/remesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/attempts.h"
#include "core/base/exceptions.h"
#include "core/base/status_macros.h"
#include "core/front/advancing_front.h"
#include "core/geometry/triangle.h"
#include "core/guidance/prediction.h"
#include "core/guidance/sizing.h"
#include "core/preparation.h"
#include "core/region_faults.h"
#include "core/region_sink.h"

namespace meshfront {
namespace {

constexpr uint64_t kMinTargetTriangles = 4;  // a tetrahedron
constexpr double kMaxRho = 2 * std::numbers::pi / 3;
constexpr double kMaxBlend = 1000;
constexpr double kManyMore = 1.5;  // triangles than edges of the length that was asked for would make
// Of a result that has so many triangles, so many times the input's and so many times what its curvature asks for, a warning says so.
constexpr uint64_t kLargeResult = 10000;
constexpr uint64_t kManyPerInput = 4;
constexpr double kManyPerCurvature = 2;
// Triangles between edges that differ so much where they meet have a 2r/R of 0.1 or less, as a few needles of CAD parts do.
constexpr double kUnevenBorder = 20;
constexpr double kMinMlsRadius = 2, kMaxMlsRadius = 16;

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Hands pieces on, in the scale of the input, and notes when the first came.
class OutgoingSink : public MeshSink {
 public:
  // The preparation's attributes outlive the sink.
  OutgoingSink(MeshSink& next, const Preparation& p, Clock::time_point start)
      : next_(next), scale_(p.scale), start_(start), attributes_(p.attributes) {
    if (!p.attributes.channels.empty())
      interpolator_ = std::make_unique<AttributeInterpolator>(p.attributes, p.has_flat_normals);
  }

  absl::Status Append(const MeshPiece& piece) override {
    NoteChunk();
    MeshPiece outgoing = piece;
    std::vector<OutputVertex> vertices;
    if (scale_ != 1) {
      vertices.assign(piece.vertices.begin(), piece.vertices.end());
      for (OutputVertex& v : vertices) v.position = v.position / scale_;
      outgoing.vertices = vertices;
    }
    FindValues(piece);
    outgoing.wedge_values = values_;
    outgoing.groups = groups_;
    if (!interpolator_) outgoing.wedges = {}, outgoing.corners = {};
    return next_.Append(outgoing);
  }
  void NoteChunk() {
    if (first_chunk_ == 0) first_chunk_ = SecondsSince(start_);
  }
  double first_chunk() const { return first_chunk_; }

 private:
  void FindValues(const MeshPiece& piece) {
    values_.clear(), groups_.clear();
    for (const OutputWedge& w : piece.wedges) {
      if (interpolator_) interpolator_->Append(w, values_);
    }
    for (const uint32_t f : piece.faces) {
      if (!attributes_.groups.empty()) groups_.push_back(attributes_.groups[f]);
    }
  }

  MeshSink& next_;
  const double scale_;
  const Clock::time_point start_;
  const MeshAttributes& attributes_;
  std::unique_ptr<AttributeInterpolator> interpolator_;  // none: there are no values
  std::vector<float> values_;                            // of the piece at hand
  std::vector<uint32_t> groups_;                         // likewise
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

absl::Status CheckLevels(const RemeshOptions& o) {
  if (o.lod_rhos.empty()) return absl::OkStatus();
  if (o.lod_rhos.size() > kMaxLevels) {
    return absl::InvalidArgumentError(
        absl::StrCat("options.lod_rhos has ", o.lod_rhos.size(), " values; it must have at most ", kMaxLevels));
  }
  for (size_t i = 0; i < o.lod_rhos.size(); ++i) {
    const double rho = o.lod_rhos[i], least = i > 0 ? o.lod_rhos[i - 1] : 0;
    if (rho > least && rho <= kMaxRho) continue;
    return absl::InvalidArgumentError(absl::StrCat("options.lod_rhos[", i, "] is ", rho, "; it must be in (", least,
                                                   ", 2π/3], larger than the one before"));
  }
  const bool by_rho = o.sizing == Sizing::kAngle || o.sizing == Sizing::kThickness;
  if (by_rho && !o.target_triangles) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("options.lod_rhos is set; it can't be with options.",
                                                 by_rho ? "target_triangles" : "sizing error or uniform"));
}

int ThreadsInForce(const Context& context) {
  return context.threads > 0 ? context.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

std::string OtherTopology(const TopologyReport& input, const TopologyReport& output) {
  const auto text = [](const TopologyReport& t) {
    return absl::StrCat(t.components, " components, ", t.boundary_loops, " boundary loops and ",
                        t.genus ? absl::StrCat("genus ", *t.genus) : "no genus");
  };
  return absl::StrCat("the result has ", text(output), ", the input ", text(input),
                      ": the front took a way that the surface does not; smaller edges help");
}

// Where the input meets itself, so may the output, but not far from there.
void WarnOfFaults(const Attempt& attempt, double scale, Report& report) {
  if (!attempt.intersections.empty()) {
    report.warnings.push_back(absl::StrCat(attempt.intersections.size(), " pairs of triangles meet where the input ",
                                           "does not within the error bound"));
  }
  if (attempt.front.own_intersection) {
    const Vec3 first = *attempt.front.own_intersection / scale;
    report.warnings.push_back(absl::StrCat("the input meets itself, and so may the result within the error bound of ",
                                           "there, first near ", first.x, ", ", first.y, ", ", first.z));
  }
  if (!attempt.missed.places.empty()) {
    const Vec3 first = attempt.missed.places.front() / scale;
    report.warnings.push_back(
        absl::StrCat("parts of the surface are farther from the result than its edges are long, as near ", first.x,
                     ", ", first.y, ", ", first.z, "; smaller edges help"));
  }
  if (attempt.keeps_creases) {
    report.warnings.push_back(
        "the front could not pass over sharp edges: those of more than 40 degrees are kept as creases, though "
        "crease_angle is off");
  }
  if (attempt.widened > 1) {
    report.warnings.push_back(absl::StrCat("supports were widened, up to ", attempt.widened,
                                           " times, where the points lie too unevenly for an mls_radius of ",
                                           report.parameters.options.mls_radius,
                                           "; details smaller than that are lost"));
  }
  if (attempt.lost_rims > 0) {
    report.warnings.push_back(absl::StrCat("at ", attempt.lost_rims, " places where the points end the rim of ",
                                           "the surface could not be followed"));
  }
  if (!attempt.flat_triangles.empty())
    report.warnings.push_back(absl::StrCat(attempt.flat_triangles.size(), " triangles have no area"));
  if (attempt.own_components > 0) {
    report.warnings.push_back(absl::StrCat(attempt.own_components, " of ", report.input.topology.components,
                                           " components are the input's own faces (", attempt.own_faces,
                                           attempt.thinned_from > 0 ? ", of which some were taken out again)" : ")",
                                           ", since no mesh of them came out whole and without self-intersection"));
  }
}

// Of how many triangles of the median edge that was asked for the surface is.
double TrianglesOfLength(const MeshSurface& surface, double length) {
  double area = 0;
  for (const Triangle& t : surface.mesh().triangles)
    area +=
        TriangleArea(surface.mesh().PositionAt(t[0]), surface.mesh().PositionAt(t[1]), surface.mesh().PositionAt(t[2]));
  return area * 4 / (std::sqrt(3.0) * length * length);
}

// How many triangles curvature alone would ask for, without grading, narrow strips and thin parts.
double TrianglesOfCurvature(const Preparation& p) {
  const MeshSurface& surface = *p.surface;
  double count = 0;
  for (const Triangle& t : surface.mesh().triangles) {
    double inverse = 0;  // of squared lengths, on the average of the corners
    for (const VertexId v : t) {
      const double wanted = IdealLength(p.parameter, surface.vertex_curvatures()[v.index()]);
      const double length = std::clamp(wanted, p.parameters.min_edge, p.parameters.max_edge);
      inverse += 1 / (3 * length * length);
    }
    count += inverse * TriangleArea(surface.mesh().PositionAt(t[0]), surface.mesh().PositionAt(t[1]),
                                    surface.mesh().PositionAt(t[2]));
  }
  return count * 4 / std::sqrt(3.0);
}

// A coarse model with narrow faces or seams close together: what came out is what was asked for, and more than many expect.
void WarnOfManyTriangles(const Preparation& p, uint64_t made, Report& report) {
  const RemeshOptions& options = report.parameters.options;
  const bool by_rho = options.sizing == Sizing::kAngle && report.parameters.target_triangles == 0;
  if (!by_rho || p.region || p.points || made < kLargeResult || p.input.is_point_set) return;
  if (made < kManyPerInput * p.input.topology.triangles) return;
  const double of_curvature = TrianglesOfCurvature(p);
  if (static_cast<double>(made) < kManyPerCurvature * of_curvature) return;
  report.warnings.push_back(
      absl::StrCat(made, " triangles of an input of ", p.input.topology.triangles,
                   ", where its curvature asks for about ", std::llround(of_curvature),
                   " at this rho: creases, seams and rims that lie close together need the "
                   "rest; min_edge or target_triangles make fewer, and estimate predicts how many"));
}

// Where thin walls, rims or faults ask for shorter edges than were wanted.
void WarnOfSizes(const Preparation& p, const Attempt& attempt, Report& report) {
  const uint64_t made = attempt.front.triangles;
  const auto triangles = static_cast<double>(made);
  const auto wanted = static_cast<double>(report.parameters.target_triangles);
  if (wanted > 0 && std::abs(triangles / wanted - 1) > kCountPromise) {
    report.warnings.push_back(absl::StrCat(
        made, " triangles instead of the ", report.parameters.target_triangles, " of target_triangles: ",
        attempt.thinned_from > 0 ? (triangles > wanted ? "creases, rims, topology and what lies close allow no fewer"
                                                       : "one that goes takes another along")
        : triangles > wanted     ? "with fewer it did not come out whole, or they can't be predicted well"
                                 : "they can't be predicted well here; ask for somewhat more"));
  }
  if (attempt.thinned_from > 0) {
    report.warnings.push_back(absl::StrCat(
        "the front made ", attempt.thinned_from, " triangles, of which some were taken out again: what is ",
        "left is neither as round nor as near to the surface, nor graded as by eta"));
  }
  if (!report.parameters.options.edge_length || wanted > 0 || p.region || p.points || !(p.parameter > 0)) return;
  const double of_length = TrianglesOfLength(*p.surface, p.parameter);
  if (triangles > kManyMore * of_length) {
    report.warnings.push_back(absl::StrCat(made, " triangles where edges of edge_length would make about ",
                                           std::llround(of_length),
                                           ": shorter ones are needed where the surface is thin, and around there"));
  }
}

void WarnOfGaps(const GapReport& gaps, double scale, Report& report) {
  if (gaps.left_open.empty()) return;
  const Vec3 first = gaps.left_open.front() / scale;
  report.warnings.push_back(absl::StrCat(gaps.left_open.size(), " gaps that are no wider than fill_gaps (",
                                         report.parameters.options.fill_gaps->value,
                                         ") stay open, since each patch passes through something; the first is at (",
                                         first.x, ", ", first.y, ", ", first.z, ")"));
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

// Where refinement could not keep max_error: beside edges that may not be shorter. Where a count is wanted it is not asked for, and
// what is within it is not told from what is within what gets refined.
void WarnOfDeviations(const FrontReport& front, double scale, Report& report) {
  const double largest = front.largest_deviation / scale;
  report.error_bound = std::max(report.error_bound, largest);
  if (report.parameters.target_triangles > 0 || front.beyond_max_error == 0) return;
  const Vec3 place = front.farthest_place / scale;
  report.warnings.push_back(absl::StrCat(front.beyond_max_error, " of ", front.triangles,
                                         " triangles are farther from the surface than max_error (",
                                         report.parameters.options.max_error->value, "), by up to ", largest, " near ",
                                         place.x, ", ", place.y, ", ", place.z));
}

void ReportRegion(Preparation& p, const FrontReport& front, Report& report) {
  report.region = p.region ? std::move(p.region->report) : std::move(p.everything);
  if (report.region) report.region->new_triangles = front.triangles;
  if (!p.region) return;
  const RegionParts& parts = *p.region;
  const UnevenBorder border = MostUnevenBorder(parts);
  if (border.ratio > kUnevenBorder) {
    report.warnings.push_back(absl::StrCat(
        "edges of the region's border, which stay, differ ", std::llround(border.ratio), " times in length where they ",
        "meet, the most at (", border.place.x, ", ", border.place.y, ", ", border.place.z,
        "): new triangles there are as narrow, of a region that ends elsewhere they need not be"));
  }
  if (parts.changed_outside == 0 && parts.dropped_outside == 0) return;
  report.warnings.push_back(absl::StrCat("repair changed ", parts.changed_outside,
                                         " faces outside of the region, and dropped ", parts.dropped_outside,
                                         " anywhere; options.repair = false would have refused the mesh"));
}

// Lengths of the predicted edges, g at the faces' centroids or at the samples, each with about how many triangles it will be of; and the
// error bound of the worst.
std::vector<std::pair<double, double>> PredictedLengths(const Preparation& p, double& bound) {
  if (p.points) {
    auto lengths = p.point_builder->Lengths(*p.field);
    for (const auto& entry : lengths) bound = std::max(bound, ErrorBoundInForce(p, entry.first, p.PeakCurvature()));
    return lengths;
  }
  const TriangleMesh& mesh = p.surface->mesh();
  std::vector<std::pair<double, double>> lengths;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
    const double g = p.field->At((a + b + c) / 3.0), weight = TriangleArea(a, b, c) / (g * g);
    lengths.push_back({g, weight});
    double peak = 0;
    for (const VertexId v : t) peak = std::max(peak, p.surface->vertex_curvatures()[v.index()]);
    bound = std::max(bound, ErrorBoundInForce(p, g, peak));
  }
  return lengths;
}

}  // namespace

absl::Status ValidateOptions(const RemeshOptions& o) {
  if (!(o.rho > 0 && o.rho <= kMaxRho)) {
    return absl::InvalidArgumentError(absl::StrCat("options.rho is ", o.rho, "; it must be in (0, 2π/3]"));
  }
  if (!(o.eta > 1 && o.eta < 2)) {
    return absl::InvalidArgumentError(absl::StrCat("options.eta is ", o.eta, "; it must be in (1, 2)"));
  }
  if (o.crease_angle && !(*o.crease_angle > 0 && *o.crease_angle < 180)) {
    return absl::InvalidArgumentError(
        absl::StrCat("options.crease_angle is ", *o.crease_angle, "; it must be in (0, 180)"));
  }
  if (!(o.blend >= 0 && o.blend <= kMaxBlend)) {
    return absl::InvalidArgumentError(
        absl::StrCat("options.blend is ", o.blend, "; it must be in [0, ", kMaxBlend, "]"));
  }
  if (!(o.mls_radius >= kMinMlsRadius && o.mls_radius <= kMaxMlsRadius)) {
    return absl::InvalidArgumentError(absl::StrCat("options.mls_radius is ", o.mls_radius, "; it must be in [",
                                                   kMinMlsRadius, ", ", kMaxMlsRadius, "]"));
  }
  MESHFRONT_RETURN_IF_ERROR(CheckLength("max_error", o.max_error));
  MESHFRONT_RETURN_IF_ERROR(CheckLength("edge_length", o.edge_length));
  MESHFRONT_RETURN_IF_ERROR(CheckLength("min_edge", o.min_edge));
  MESHFRONT_RETURN_IF_ERROR(CheckLength("max_edge", o.max_edge));
  MESHFRONT_RETURN_IF_ERROR(CheckLength("fill_gaps", o.fill_gaps));
  MESHFRONT_RETURN_IF_ERROR(CheckLevels(o));
  return CheckSizing(o);
}

namespace {

// Where a region's triangles go: joined to the rest or as a patch to the caller, and joined to the rest to who wants the `whole` as well.
class RegionOutlets : public MeshSink {
 public:
  // `whole` may be null. All but `border`, which is copied, outlive the outlets.
  RegionOutlets(MeshSink& sink, MeshSink* whole, const RegionParts& parts, std::vector<uint32_t> border)
      : border_(std::move(border)), to_caller_(sink, {.rest = !parts.patch_only}, border_, parts) {
    if (whole != nullptr) to_whole_.emplace(*whole, RegionSink::Wanted{.details = false}, border_, parts);
  }

  absl::Status SendRest() {
    MESHFRONT_RETURN_IF_ERROR(to_caller_.SendRest());
    return to_whole_ ? to_whole_->SendRest() : absl::OkStatus();
  }
  absl::Status Append(const MeshPiece& piece) override {
    MESHFRONT_RETURN_IF_ERROR(to_caller_.Append(piece));
    return to_whole_ ? to_whole_->Append(piece) : absl::OkStatus();
  }
  const TriangleMesh& sent() const { return to_caller_.sent(); }  // to the caller

 private:
  const std::vector<uint32_t> border_;
  RegionSink to_caller_;
  std::optional<RegionSink> to_whole_;
};

// The caller's, Problem.whole and Problem.admit.
struct Sinks {
  MeshSink& caller;
  MeshSink* whole = nullptr;
  std::function<absl::Status(uint64_t)> admit = nullptr;
};

// From a preparation to the report, `start` being when it began. Nothing, and nothing was handed on: more faces of the region are `left`
// as they are, and the rest of it is to be tried again.
absl::StatusOr<std::optional<Report>> RemeshPrepared(Preparation& p, const Sinks& sinks, Clock::time_point start,
                                                     LeftFaces* left, const Context& context) {
  const double prepared = SecondsSince(start);
  const auto predicted = static_cast<uint64_t>(std::min(p.predicted_triangles, 1e18));
  if (sinks.admit && !p.is_least_count) MESHFRONT_RETURN_IF_ERROR(sinks.admit(predicted));
  std::optional<RegionOutlets> joined;
  std::optional<TeeSink> both;
  MeshSink* next = &sinks.caller;
  if (p.region)
    next = &joined.emplace(sinks.caller, sinks.whole, *p.region, BorderOf(*p.region, *p.surface));
  else if (sinks.whole != nullptr)
    next = &both.emplace(sinks.caller, *sinks.whole);
  OutgoingSink outgoing(*next, p, start);
  HoldingSink kept(outgoing, joined ? std::numeric_limits<uint64_t>::max() : 0);
  MESHFRONT_ASSIGN_OR_RETURN(const Attempt attempt,
                             AdvanceInAttempts(p, joined ? static_cast<MeshSink&>(kept) : outgoing, context));
  if (joined) {
    if (left != nullptr && LeaveFaultyFaces(p, attempt, *left)) return std::nullopt;
    if (!p.region->patch_only) outgoing.NoteChunk();
    MESHFRONT_RETURN_IF_ERROR(joined->SendRest());
    MESHFRONT_RETURN_IF_ERROR(kept.Release());
  }
  p.parameters = attempt.parameters;
  p.parameter = attempt.parameter;
  if (p.points) p.input.topology = attempt.points;
  AddGaps(attempt.gaps, p.input.repairs);
  const FrontReport& front = attempt.front;
  if (front.triangles == 0) return NothingMeshed(front, p.scale);
  Report report;
  report.input = p.input;
  report.parameters = p.parameters;
  report.predicted_triangles = predicted;
  report.warnings = p.warnings;
  report.error_bound = ErrorBoundInForce(p, front.longest_edge, attempt.peak_curvature);
  report.output = joined ? MeasureTopology(joined->sent()) : TopologyOf(front);
  const bool is_whole_region = joined && !p.region->patch_only && front.open_places.empty();
  const bool has_other_topology =
      attempt.has_other_topology || (is_whole_region && HasOtherTopology(report.output, p.input.topology));
  report.complete = front.open_places.empty() && !has_other_topology;
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
  WarnOfFaults(attempt, p.scale, report);
  WarnOfSizes(p, attempt, report);
  WarnOfManyTriangles(p, front.triangles, report);
  WarnOfGaps(attempt.gaps, p.scale, report);
  if (has_other_topology) report.warnings.push_back(OtherTopology(p.input.topology, report.output));
  ReportRegion(p, front, report);
  return report;
}

void WarnOfLeftFaces(const LeftFaces& left, Report& report) {
  if (left.count == 0) return;
  const uint64_t chosen = left.count + report.region->replaced_triangles;
  report.warnings.push_back(absl::StrCat(left.count, " of ", chosen,
                                         " faces of options.region stay as they are, since no ",
                                         "mesh of them came out whole and without self-intersection; the first is at ",
                                         left.first.x, ", ", left.first.y, ", ", left.first.z));
}

// In rounds, each of a smaller region where the one before has faults. What comes before the surroundings is made once.
absl::StatusOr<Report> RemeshRegion(Problem problem, MeshSink& sink, Clock::time_point start, const Context& context) {
  const Problem again{{}, problem.options, problem.region, nullptr, problem.features};
  const Sinks sinks{sink, problem.whole, problem.admit};
  LeftFaces left;
  for (;;) {
    MESHFRONT_ASSIGN_OR_RETURN(Preparation p, Prepare(std::move(problem), context, left.is_left));
    MESHFRONT_ASSIGN_OR_RETURN(std::optional<Report> report, RemeshPrepared(p, sinks, start, &left, context));
    if (report) {
      WarnOfLeftFaces(left, *report);
      return *std::move(report);
    }
    problem = again;
    problem.prepared = p.region->input;
  }
}

}  // namespace

absl::StatusOr<Report> Remesh(Problem problem, MeshSink& sink, const Context& context) try {
  const Clock::time_point start = Clock::now();
  if (!problem.options.lod_rhos.empty())
    return absl::InvalidArgumentError("options.lod_rhos is set; levels of detail are what RemeshLevels makes");
  if (problem.region) return RemeshRegion(std::move(problem), sink, start, context);
  const Sinks sinks{sink, problem.whole, problem.admit};
  MESHFRONT_ASSIGN_OR_RETURN(Preparation p, Prepare(std::move(problem), context));
  MESHFRONT_ASSIGN_OR_RETURN(std::optional<Report> report, RemeshPrepared(p, sinks, start, nullptr, context));
  return *std::move(report);
} catch (const std::exception&) {
  return StatusOfException();
}

absl::Status RemeshLevels(Problem problem, LevelSink& sink, const Context& context) try {
  Clock::time_point start = Clock::now();
  const std::vector<double> rhos = problem.options.lod_rhos;
  if (rhos.empty()) return absl::InvalidArgumentError("options.lod_rhos is empty; it must hold the rho of each level");
  if (problem.whole != nullptr || problem.admit)
    return absl::InvalidArgumentError("problem.whole or admit is set beside options.lod_rhos; it takes one mesh");
  MESHFRONT_ASSIGN_OR_RETURN(Preparation p, Prepare(std::move(problem), context));
  const LevelStart first(p);
  for (size_t level = 0; level < rhos.size(); ++level) {
    if (level > 0) {
      start = Clock::now();
      MESHFRONT_RETURN_IF_ERROR(first.Prepare(rhos[level], p, context));
    }
    MESHFRONT_ASSIGN_OR_RETURN(const std::optional<Report> report,
                               RemeshPrepared(p, {sink.BeginLevel()}, start, nullptr, context));
    MESHFRONT_RETURN_IF_ERROR(sink.EndLevel(*report));
  }
  return absl::OkStatus();
} catch (const std::exception&) {
  return StatusOfException();
}

absl::StatusOr<Estimate> EstimateRemesh(Problem problem, const Context& context) try {
  if (problem.options.lod_rhos.size() > 1)
    return absl::InvalidArgumentError("options.lod_rhos has several values; estimate them one by one, by options.rho");
  MESHFRONT_ASSIGN_OR_RETURN(Preparation p, Prepare(std::move(problem), context));
  Estimate estimate;
  AddGaps(p.gaps, p.input.repairs);
  estimate.input = p.input;
  estimate.parameters = p.parameters;
  estimate.predicted_triangles = static_cast<uint64_t>(std::min(p.predicted_triangles, 1e18));
  double bound = 0, total = 0;
  std::vector<std::pair<double, double>> lengths = PredictedLengths(p, bound);
  for (const auto& entry : lengths) total += entry.second;
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
  constexpr uint64_t kBytesPerInputTriangle = 200, kBytesPerPoint = 400, kBytesPerSharpPoint = 600,
                     kFixedBytes = 32 << 20;  // measured peaks, rounded up
  estimate.memory_bytes = kFixedBytes + (p.points               ? kBytesPerPoint * p.points->samples().samples().size()
                                         : p.input.is_point_set ? kBytesPerSharpPoint * p.input.topology.vertices
                                                                : kBytesPerInputTriangle * p.input.topology.triangles);
  return estimate;
} catch (const std::exception&) {
  return StatusOfException();
}

}  // namespace meshfront
