// Reports between core and the wire: field by field.
#include "proto/wire/convert.h"

namespace meshfront {

v1::Length LengthToProto(const Length& length) {
  v1::Length proto;
  if (length.relative) {
    proto.set_diagonal_fraction(length.value);
  } else {
    proto.set_absolute(length.value);
  }
  return proto;
}

v1::Point PointToProto(const Vec3& p) {
  v1::Point proto;
  proto.set_x(p.x);
  proto.set_y(p.y);
  proto.set_z(p.z);
  return proto;
}

Vec3 PointFromProto(const v1::Point& p) { return {p.x(), p.y(), p.z()}; }

v1::Topology TopologyToProto(const TopologyReport& t) {
  v1::Topology proto;
  proto.set_vertices(t.vertices);
  proto.set_triangles(t.triangles);
  proto.set_components(t.components);
  proto.set_boundary_edges(t.boundary_edges);
  proto.set_boundary_loops(t.boundary_loops);
  if (t.genus) proto.set_genus(*t.genus);
  proto.set_euler_characteristic(t.euler_characteristic);
  proto.set_closed(t.closed);
  proto.set_manifold(t.manifold);
  proto.set_oriented(t.oriented);
  return proto;
}

TopologyReport TopologyFromProto(const v1::Topology& proto) {
  TopologyReport t;
  t.vertices = proto.vertices();
  t.triangles = proto.triangles();
  t.components = proto.components();
  t.boundary_edges = proto.boundary_edges();
  t.boundary_loops = proto.boundary_loops();
  if (proto.has_genus()) t.genus = proto.genus();
  t.euler_characteristic = proto.euler_characteristic();
  t.closed = proto.closed();
  t.manifold = proto.manifold();
  t.oriented = proto.oriented();
  return t;
}

v1::InputSummary InputToProto(const InputReport& input) {
  v1::InputSummary proto;
  proto.set_kind(input.is_point_set ? v1::INPUT_KIND_POINTS : v1::INPUT_KIND_MESH);
  *proto.mutable_topology() = TopologyToProto(input.topology);
  for (const RepairAction& action : input.repairs) {
    v1::Repair* repair = proto.add_repairs();
    repair->set_what(action.what);
    repair->set_count(action.count);
  }
  proto.set_diagonal(input.diagonal);
  return proto;
}

v1::ParametersInForce ParametersToProto(const ParametersInForce& parameters) {
  v1::ParametersInForce proto;
  *proto.mutable_options() = OptionsToProto(parameters.options);
  if (parameters.feature_segments > 0)
    proto.mutable_options()->mutable_features()->set_segment_count(parameters.feature_segments);
  proto.set_min_edge(parameters.min_edge);
  proto.set_max_edge(parameters.max_edge);
  proto.set_clamped_samples(parameters.clamped_samples);
  proto.set_target_triangles(parameters.target_triangles);
  proto.set_detail(parameters.detail);
  return proto;
}

v1::Progress ProgressToProto(const Progress& progress) {
  v1::Progress proto;
  proto.set_stage(static_cast<v1::Stage>(static_cast<int>(progress.stage) + 1));
  proto.set_predicted_triangles(progress.predicted_triangles);
  proto.set_triangles(progress.triangles);
  proto.set_open_front_edges(progress.open_front_edges);
  return proto;
}

Progress ProgressFromProto(const v1::Progress& proto) {
  Progress progress;
  const int stage = proto.stage() - 1;  // STAGE_UNSPECIFIED is 0 on the wire
  if (stage >= 0 && stage <= static_cast<int>(Stage::kMesh)) progress.stage = static_cast<Stage>(stage);
  progress.predicted_triangles = proto.predicted_triangles();
  progress.triangles = proto.triangles();
  progress.open_front_edges = proto.open_front_edges();
  return progress;
}

v1::Defect DefectToProto(const Defect& defect) {
  v1::Defect proto;
  proto.set_what(defect.what);
  proto.set_message(defect.message);
  for (const FaceId face : defect.faces) proto.add_faces(face.index());
  for (const VertexId vertex : defect.vertices) proto.add_vertices(vertex.index());
  if (defect.position) *proto.mutable_position() = PointToProto(*defect.position);
  return proto;
}

namespace {

v1::Seconds SecondsToProto(const StageSeconds& s) {
  v1::Seconds proto;
  proto.set_repair(s.repair);
  proto.set_index(s.index);
  proto.set_curvature(s.curvature);
  proto.set_guidance(s.guidance);
  proto.set_features(s.features);
  proto.set_mesh(s.mesh);
  proto.set_first_chunk(s.first_chunk);
  proto.set_engine(s.engine);
  return proto;
}

StageSeconds SecondsFromProto(const v1::Seconds& proto) {
  StageSeconds s;
  s.repair = proto.repair();
  s.index = proto.index();
  s.curvature = proto.curvature();
  s.guidance = proto.guidance();
  s.features = proto.features();
  s.mesh = proto.mesh();
  s.first_chunk = proto.first_chunk();
  s.engine = proto.engine();
  return s;
}

InputReport InputFromProto(const v1::InputSummary& proto) {
  InputReport input;
  input.is_point_set = proto.kind() == v1::INPUT_KIND_POINTS;
  input.topology = TopologyFromProto(proto.topology());
  for (const v1::Repair& repair : proto.repairs()) input.repairs.push_back({repair.what(), repair.count()});
  input.diagonal = proto.diagonal();
  return input;
}

ParametersInForce ParametersFromProto(const v1::ParametersInForce& proto) {
  ParametersInForce parameters;
  // What a server had in force is valid; one of a later version may have options that this client does not know.
  if (absl::StatusOr<RemeshOptions> options = OptionsFromProto(proto.options()); options.ok())
    parameters.options = *options;
  parameters.min_edge = proto.min_edge();
  parameters.max_edge = proto.max_edge();
  parameters.clamped_samples = proto.clamped_samples();
  parameters.target_triangles = proto.target_triangles();
  parameters.detail = proto.detail();
  return parameters;
}

}  // namespace

v1::Summary SummaryFromReport(const Report& report) {
  v1::Summary s;
  *s.mutable_input() = InputToProto(report.input);
  *s.mutable_parameters() = ParametersToProto(report.parameters);
  s.set_predicted_triangles(report.predicted_triangles);
  s.set_error_bound(report.error_bound);
  for (const std::string& warning : report.warnings) s.add_warnings(warning);
  *s.mutable_output() = TopologyToProto(report.output);
  s.set_complete(report.complete);
  s.set_open_place_count(report.open_places.size());
  for (size_t i = 0; i < report.open_places.size() && i < kMaxListedOpenPlaces; ++i) {
    *s.add_open_places() = PointToProto(report.open_places[i]);
  }
  s.mutable_quality()->set_radius_ratio_min(report.quality.radius_ratio_min);
  s.mutable_quality()->set_radius_ratio_p0_5(report.quality.radius_ratio_p0_5);
  s.mutable_quality()->set_radius_ratio_median(report.quality.radius_ratio_median);
  s.mutable_quality()->set_min_angle_degrees(report.quality.min_angle_deg);
  s.mutable_triangles_by_kind()->set_free(report.triangles_by_kind.free);
  s.mutable_triangles_by_kind()->set_connection(report.triangles_by_kind.connection);
  s.mutable_triangles_by_kind()->set_closing(report.triangles_by_kind.closing);
  s.set_flips(report.flips);
  for (const auto& [reason, count] : report.refusals) {
    v1::Refusal* refusal = s.add_refusals();
    refusal->set_reason(reason);
    refusal->set_count(count);
  }
  if (report.region) {
    s.mutable_region()->set_kept_triangles(report.region->kept_triangles);
    s.mutable_region()->set_replaced_triangles(report.region->replaced_triangles);
    s.mutable_region()->set_new_triangles(report.region->new_triangles);
    s.mutable_region()->set_removed_faces(report.region->removed_faces.size());
  }
  *s.mutable_seconds() = SecondsToProto(report.seconds);
  s.set_peak_front_edges(report.peak_front_edges);
  s.set_threads(report.threads);
  return s;
}

Report ReportFromSummary(const v1::Summary& s) {
  Report report;
  report.input = InputFromProto(s.input());
  report.parameters = ParametersFromProto(s.parameters());
  report.predicted_triangles = s.predicted_triangles();
  report.error_bound = s.error_bound();
  report.output = TopologyFromProto(s.output());
  report.complete = s.complete();
  for (const v1::Point& place : s.open_places()) report.open_places.push_back(PointFromProto(place));
  report.quality = {s.quality().radius_ratio_min(), s.quality().radius_ratio_p0_5(), s.quality().radius_ratio_median(),
                    s.quality().min_angle_degrees()};
  report.triangles_by_kind = {s.triangles_by_kind().free(), s.triangles_by_kind().connection(),
                              s.triangles_by_kind().closing()};
  report.flips = s.flips();
  report.peak_front_edges = s.peak_front_edges();
  for (const v1::Refusal& refusal : s.refusals()) report.refusals.emplace_back(refusal.reason(), refusal.count());
  if (s.has_region()) {
    report.region =
        RegionReport{s.region().kept_triangles(), s.region().replaced_triangles(), s.region().new_triangles(), {}};
  }
  report.seconds = SecondsFromProto(s.seconds());
  report.threads = static_cast<int>(s.threads());
  return report;
}

v1::EstimateResponse EstimateToProto(const Estimate& estimate) {
  v1::EstimateResponse proto;
  *proto.mutable_input() = InputToProto(estimate.input);
  *proto.mutable_parameters() = ParametersToProto(estimate.parameters);
  proto.set_predicted_triangles(estimate.predicted_triangles);
  proto.set_error_bound(estimate.error_bound);
  proto.mutable_edge_length()->set_min(estimate.edge_min);
  proto.mutable_edge_length()->set_median(estimate.edge_median);
  proto.mutable_edge_length()->set_max(estimate.edge_max);
  proto.set_memory_bytes(estimate.memory_bytes);
  return proto;
}

}  // namespace meshfront
