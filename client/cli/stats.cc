#include "client/cli/stats.h"

namespace meshfront {
namespace {

using Json = nlohmann::ordered_json;

Json GenusOf(const v1::Topology& topology) { return topology.has_genus() ? Json(topology.genus()) : Json(nullptr); }

Json InputJson(const v1::InputSummary& input) {
  Json repairs = Json::array();
  for (const v1::Repair& repair : input.repairs())
    repairs.push_back({{"what", repair.what()}, {"count", repair.count()}});
  const v1::Topology& t = input.topology();
  return {{"kind", input.kind() == v1::INPUT_KIND_POINTS ? "points" : "mesh"},
          {"vertices", t.vertices()},
          {"triangles", t.triangles()},
          {"components", t.components()},
          {"boundary_loops", t.boundary_loops()},
          {"genus", GenusOf(t)},
          {"diagonal", input.diagonal()},
          {"repairs", repairs}};
}

const char* SizingName(v1::Sizing sizing) {
  switch (sizing) {
    case v1::SIZING_ERROR:
      return "error";
    case v1::SIZING_UNIFORM:
      return "uniform";
    case v1::SIZING_THICKNESS:
      return "thickness";
    default:
      return "angle";
  }
}

// A length as it was given; null when it was not.
Json LengthJson(bool has, const v1::Length& length) {
  if (!has) return nullptr;
  if (length.value_case() == v1::Length::kDiagonalFraction) return {{"diagonal_fraction", length.diagonal_fraction()}};
  return length.absolute();
}

bool IsOfPoints(v1::SurfaceType surface) { return surface == v1::SURFACE_TYPE_IMLS || surface == v1::SURFACE_TYPE_MLS; }

const char* SurfaceName(v1::SurfaceType surface) {
  if (surface == v1::SURFACE_TYPE_MLS) return "mls";
  return surface == v1::SURFACE_TYPE_IMLS ? "imls" : "mesh";
}

Json ParametersJson(const v1::ParametersInForce& parameters) {
  const v1::RemeshOptions& o = parameters.options();
  return {{"rho", o.has_rho() ? Json(o.rho()) : Json(nullptr)},
          {"eta", o.eta()},
          {"sizing", SizingName(o.sizing())},
          {"target_triangles", parameters.target_triangles() > 0 ? Json(parameters.target_triangles()) : Json(nullptr)},
          {"detail", parameters.detail()},
          {"max_error", LengthJson(o.has_max_error(), o.max_error())},
          {"edge_length", LengthJson(o.has_edge_length(), o.edge_length())},
          {"min_edge", parameters.min_edge()},
          {"max_edge", parameters.max_edge()},
          {"clamped_samples", parameters.clamped_samples()},
          {"flips", o.flips()},
          {"smooth", o.smooth()},
          {"fit", o.fit()},
          {"repair", o.repair()},
          {"crease_angle",
           o.crease().rule_case() == v1::Crease::kAngleDegrees ? Json(o.crease().angle_degrees()) : Json("off")},
          {"features", o.has_features() ? Json(o.features().segment_count()) : Json(nullptr)},
          {"attributes", o.attributes() == v1::ATTRIBUTE_POLICY_KEEP ? "keep" : "drop"},
          {"surface", SurfaceName(o.surface())},
          {"mls_radius", IsOfPoints(o.surface()) ? Json(o.mls_radius()) : Json(nullptr)},
          {"fill_gaps", LengthJson(o.has_fill_gaps(), o.fill_gaps())},
          {"blend", o.blend()}};
}

Json OutputJson(const v1::Summary& summary) {
  Json places = Json::array();
  for (const v1::Point& p : summary.open_places()) places.push_back({p.x(), p.y(), p.z()});
  const v1::Topology& t = summary.output();
  return {{"vertices", t.vertices()},     {"triangles", t.triangles()},
          {"components", t.components()}, {"boundary_loops", t.boundary_loops()},
          {"genus", GenusOf(t)},          {"closed", t.closed()},
          {"manifold", t.manifold()},     {"complete", summary.complete()},
          {"open_places", places}};
}

Json QualityJson(const v1::Quality& q) {
  return {{"radius_ratio_min", q.radius_ratio_min()},
          {"radius_ratio_p0_5", q.radius_ratio_p0_5()},
          {"radius_ratio_median", q.radius_ratio_median()},
          {"min_angle_deg", q.min_angle_degrees()}};
}

Json SecondsJson(const v1::Seconds& server, const ClientFigures& client) {
  return {{"read", client.read},
          {"upload", client.upload},
          {"queued", server.queued()},
          {"repair", server.repair()},
          {"index", server.index()},
          {"curvature", server.curvature()},
          {"guidance", server.guidance()},
          {"features", server.features()},
          {"mesh", server.mesh()},
          {"stalled", server.stalled()},
          {"first_chunk", client.first_chunk},
          {"engine", client.engine},
          {"write", client.write},
          {"total", client.total}};
}

Json RefusalsJson(const v1::Summary& summary) {
  Json refusals = Json::object();
  for (const v1::Refusal& refusal : summary.refusals()) refusals[refusal.reason()] = refusal.count();
  return refusals;
}

}  // namespace

Json StatsJson(const std::string& version, const v1::Summary& summary, const ClientFigures& client) {
  const v1::TrianglesByKind& kinds = summary.triangles_by_kind();
  Json stats = {
      {"version", version},
      {"command", "remesh"},
      {"input", InputJson(summary.input())},
      {"parameters", ParametersJson(summary.parameters())},
      {"predicted_triangles", summary.predicted_triangles()},
      {"error_bound", summary.error_bound()},
      {"output", OutputJson(summary)},
      {"quality", QualityJson(summary.quality())},
      {"triangles_by_kind", {{"free", kinds.free()}, {"connection", kinds.connection()}, {"closing", kinds.closing()}}},
      {"flips", summary.flips()},
      {"refusals", RefusalsJson(summary)},
      {"seconds", SecondsJson(summary.seconds(), client)},
      {"peak_rss_bytes", client.peak_rss_bytes},
      {"peak_front_edges", summary.peak_front_edges()},
      {"chunks", client.chunks},
      {"threads", summary.threads()}};
  if (summary.has_region()) {
    const v1::RegionSummary& region = summary.region();
    stats["region"] = {{"kept_triangles", region.kept_triangles()},
                       {"replaced_triangles", region.replaced_triangles()},
                       {"new_triangles", region.new_triangles()},
                       {"blend", summary.parameters().options().blend()}};
  }
  if (summary.has_session()) {
    const v1::Session& session = summary.session();
    stats["session"] = {
        {"revision", session.revision()}, {"bytes", session.bytes()}, {"ttl_seconds", session.ttl_seconds()}};
  }
  if (client.remote) {
    stats["server_peak_rss_bytes"] = summary.server_peak_rss_bytes();
    stats["server_version"] = summary.version();
  }
  return stats;
}

Json LevelJson(const std::string& file, const v1::Summary& summary, const ClientFigures& client) {
  Json level = StatsJson("", summary, client);
  for (const char* const key :
       {"version", "command", "input", "peak_rss_bytes", "threads", "server_peak_rss_bytes", "server_version"})
    level.erase(key);
  for (const char* const key : {"read", "upload", "queued", "write", "total"}) level["seconds"].erase(key);  // of all
  level["file"] = file;
  return level;
}

Json EstimateJson(const v1::EstimateResponse& estimate) {
  const v1::EdgeLengths& edges = estimate.edge_length();
  return {{"predicted_triangles", estimate.predicted_triangles()},
          {"error_bound", estimate.error_bound()},
          {"edge_length", {{"min", edges.min()}, {"median", edges.median()}, {"max", edges.max()}}},
          {"memory_bytes", estimate.memory_bytes()},
          {"input", InputJson(estimate.input())},
          {"parameters", ParametersJson(estimate.parameters())}};
}

}  // namespace meshfront
