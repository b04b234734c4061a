#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/commands.h"
#include "client/cli/input.h"
#include "client/cli/text.h"
#include "core/base/status_macros.h"
#include "core/io/weld.h"
#include "core/mesh/distance.h"
#include "core/mesh/quality.h"
#include "core/mesh/self_intersection.h"
#include "core/mesh/topology.h"

namespace meshfront {
namespace {

using Json = nlohmann::ordered_json;

struct Measures {
  TopologyReport topology;
  QualityReport quality;
  SelfIntersections self_intersections;
  std::optional<DistanceReport> distance;
};

// glTF parts vertices along seams of texture and normals; the surface is one there.
TriangleMesh Welded(const TriangleMesh& mesh) {
  TriangleMesh welded;
  Welder welder(welded.positions);
  std::vector<VertexId> to;
  for (const Vec3& p : mesh.positions) to.push_back(welder.Add(p));
  for (const Triangle& t : mesh.triangles)
    welded.triangles.push_back({to[t[0].index()], to[t[1].index()], to[t[2].index()]});
  return welded;
}

absl::StatusOr<TriangleMesh> ReadTriangles(const std::string& path, Format format) {
  MESHFRONT_ASSIGN_OR_RETURN(ReadResult read, ReadInput(path, format));
  if (read.mesh.IsPointSet()) return absl::InvalidArgumentError(absl::StrCat(path, " holds no triangles to measure"));
  PrintWarnings(read.warnings);
  if (format == Format::kUnknown) format = FormatOfName(path);
  if (format == Format::kGlb || format == Format::kGltf) return Welded(read.mesh);
  return std::move(read.mesh);
}

absl::StatusOr<Measures> Measure(const TriangleMesh& mesh, const std::optional<TriangleMesh>& reference) {
  constexpr size_t listed_pairs = 10;
  Context context;
  context.threads = 0;
  Measures measures;
  measures.topology = MeasureTopology(mesh);
  measures.quality = MeasureQuality(mesh);
  MESHFRONT_ASSIGN_OR_RETURN(measures.self_intersections, FindSelfIntersections(mesh, listed_pairs, context));
  if (reference) {
    MESHFRONT_ASSIGN_OR_RETURN(measures.distance, MeasureDistance(mesh, *reference, DistanceOptions(), context));
  }
  return measures;
}

Json CountsJson(const TopologyReport& t) {
  return {{"vertices", t.vertices},
          {"triangles", t.triangles},
          {"components", t.components},
          {"boundary_edges", t.boundary_edges},
          {"boundary_loops", t.boundary_loops},
          {"genus", t.genus ? Json(*t.genus) : Json(nullptr)},
          {"euler_characteristic", t.euler_characteristic},
          {"closed", t.closed},
          {"manifold", t.manifold},
          {"oriented", t.oriented}};
}

Json QualityJson(const QualityReport& q) {
  return {{"radius_ratio_min", q.radius_ratio_min},
          {"radius_ratio_p0_5", q.radius_ratio_p0_5},
          {"radius_ratio_median", q.radius_ratio_median},
          {"radius_ratio_mean", q.radius_ratio_mean},
          {"min_angle_deg", q.min_angle_deg},
          {"share_min_angle_below_30", q.share_min_angle_below_30},
          {"incident_edge_ratio_max", q.incident_edge_ratio_max},
          {"edge_length", {{"min", q.edge_length_min}, {"median", q.edge_length_median}, {"max", q.edge_length_max}}},
          {"valence_histogram", q.valence_histogram}};
}

Json DirectionJson(const DistanceReport& report, const DirectedDistance& d) {
  return {{"max", d.max},
          {"max_percent", report.Percent(d.max)},
          {"mean", d.mean},
          {"mean_percent", report.Percent(d.mean)},
          {"rms", d.rms},
          {"rms_percent", report.Percent(d.rms)},
          {"max_at", {d.max_at.x, d.max_at.y, d.max_at.z}},
          {"samples", d.samples}};
}

Json DistanceJson(const std::optional<DistanceReport>& distance) {
  if (!distance) return nullptr;
  return {{"forward", DirectionJson(*distance, distance->forward)},
          {"backward", DirectionJson(*distance, distance->backward)},
          {"reference_diagonal", distance->reference_diagonal}};
}

void PrintDirection(const char* name, const DistanceReport& report, const DirectedDistance& d) {
  std::cout << absl::StrFormat("%-12s max %.4g (%.4f%%) at %s, mean %.4g (%.4f%%), rms %.4g (%.4f%%)\n", name, d.max,
                               report.Percent(d.max), PlaceText(d.max_at), d.mean, report.Percent(d.mean), d.rms,
                               report.Percent(d.rms));
}

void Print(const Measures& m) {
  const TopologyReport& t = m.topology;
  std::cout << absl::StrFormat("counts       %s vertices, %s triangles, %d components, %d boundary loops, genus %s\n",
                               WithThousands(t.vertices), WithThousands(t.triangles), t.components, t.boundary_loops,
                               t.genus ? absl::StrCat(*t.genus) : "undefined")
            << absl::StrFormat("topology     %s, %s, %s\n", t.closed ? "closed" : "open",
                               t.manifold ? "manifold" : "not manifold", t.oriented ? "oriented" : "not oriented");
  const QualityReport& q = m.quality;
  std::cout << absl::StrFormat(
                   "quality      radius ratio min %.4f, p0.5 %.4f, median %.4f; smallest angle %.2f degrees\n",
                   q.radius_ratio_min, q.radius_ratio_p0_5, q.radius_ratio_median, q.min_angle_deg)
            << absl::StrFormat("edges        %g to %g, median %g\n", q.edge_length_min, q.edge_length_max,
                               q.edge_length_median)
            << absl::StrFormat("intersecting %s pairs of triangles\n", WithThousands(m.self_intersections.pairs));
  for (const auto& [a, b] : m.self_intersections.first_pairs) {
    std::cout << absl::StrFormat("               %d and %d\n", a.index(), b.index());
  }
  if (!m.distance) return;
  PrintDirection("OUT to ref", *m.distance, m.distance->forward);
  PrintDirection("ref to OUT", *m.distance, m.distance->backward);
}

}  // namespace

ExitCode RunMeasure(const MeasureArguments& arguments) {
  const absl::StatusOr<Format> format = FormatFor(arguments.out, arguments.call.in_format, "--in-format");
  if (!format.ok()) return Fail(ExitCode::kUsage, format.status());
  const absl::StatusOr<TriangleMesh> mesh = ReadTriangles(arguments.out, *format);
  if (!mesh.ok()) return Fail(ExitCodeOfRead(mesh.status()), mesh.status());
  std::optional<TriangleMesh> reference;
  if (!arguments.reference.empty()) {
    absl::StatusOr<TriangleMesh> read = ReadTriangles(arguments.reference, Format::kUnknown);
    if (!read.ok()) return Fail(ExitCodeOfRead(read.status()), read.status());
    reference = *std::move(read);
  }
  const absl::StatusOr<Measures> measures = Measure(*mesh, reference);
  if (!measures.ok()) return Fail(ExitCode::kInput, measures.status());
  if (arguments.json) {
    const Json json = {{"counts", CountsJson(measures->topology)},
                       {"quality", QualityJson(measures->quality)},
                       {"distance", DistanceJson(measures->distance)},
                       {"self_intersections", measures->self_intersections.pairs}};
    std::cout << json.dump(2) << "\n";
  } else {
    Print(*measures);
  }
  return std::cout.flush() ? ExitCode::kDone
                           : Fail(ExitCode::kOutput, absl::InternalError("standard output can't be written"));
}

}  // namespace meshfront
