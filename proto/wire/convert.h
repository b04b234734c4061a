// Between the wire's messages and core's structs; the one place where a new option or figure is added.
#pragma once

#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/remesh.h"
#include "meshfront/v1/events.pb.h"
#include "meshfront/v1/mesh.pb.h"
#include "meshfront/v1/options.pb.h"
#include "meshfront/v1/remesh_service.pb.h"

namespace meshfront {

// Places and defects beyond these are counted, not listed.
inline constexpr int kMaxListedOpenPlaces = 1000;
inline constexpr int kMaxListedDefects = 100;

// The options in core's terms, defaults filled in. InvalidArgument, beginning with the field's path: a value out of
// its range, a contradiction, or one that is not supported yet.
absl::StatusOr<RemeshOptions> OptionsFromProto(const v1::RemeshOptions& proto);
// The region that options.region asks for; none where it is not set. Of faces given by number it is empty: their array comes later.
// InvalidArgument, beginning with the field's path.
absl::StatusOr<std::optional<Region>> RegionFromProto(const v1::RemeshOptions& proto);
// Everything set that has a value; what is off or not supported says so.
v1::RemeshOptions OptionsToProto(const RemeshOptions& options);
// Paths of the options that OptionsFromProto accepts, in the order of their field numbers.
std::vector<std::string> SupportedOptions();

v1::Length LengthToProto(const Length& length);
v1::Point PointToProto(const Vec3& p);
Vec3 PointFromProto(const v1::Point& p);
v1::Topology TopologyToProto(const TopologyReport& topology);
TopologyReport TopologyFromProto(const v1::Topology& proto);
v1::InputSummary InputToProto(const InputReport& input);
v1::ParametersInForce ParametersToProto(const ParametersInForce& parameters);
v1::Progress ProgressToProto(const Progress& progress);
Progress ProgressFromProto(const v1::Progress& proto);
v1::Defect DefectToProto(const Defect& defect);

// All that core knows; the server adds upload, queue, chunks, memory and version.
v1::Summary SummaryFromReport(const Report& report);
// The way back, for what the client prints. Nothing that core knows is lost but open places beyond
// kMaxListedOpenPlaces, and removed faces.
Report ReportFromSummary(const v1::Summary& summary);
v1::EstimateResponse EstimateToProto(const Estimate& estimate);

// OutputFormat with every default filled in. InvalidArgument with the field's path when it is out of range.
absl::StatusOr<v1::OutputFormat> NormalizeOutput(const v1::OutputFormat& output);
// 4 or 8 bytes; `unset` is what SCALAR_TYPE_UNSPECIFIED means there. InvalidArgument naming `field` for unknown values.
absl::StatusOr<v1::ScalarType> ResolveScalarType(v1::ScalarType type, v1::ScalarType unset, absl::string_view field);
inline size_t ScalarBytes(v1::ScalarType type) { return type == v1::SCALAR_TYPE_FLOAT32 ? 4 : 8; }

// The limits of the protocol itself; a server's own are in GetCapabilities.
inline constexpr uint32_t kMaxBlockBytes = 1 << 20;
inline constexpr uint32_t kMinChunkBytes = 16 << 10;
inline constexpr uint32_t kDefaultChunkBytes = 128 << 10;
inline constexpr uint32_t kMaxChunkBytes = 1 << 20;

}  // namespace meshfront
