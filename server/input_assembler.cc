#include "server/input_assembler.h"

#include <algorithm>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "proto/wire/convert.h"
#include "proto/wire/crc32c.h"
#include "proto/wire/errors.h"

namespace meshfront {
namespace {

constexpr size_t kMaxRequestIdBytes = 128;
constexpr size_t kMaxFileNameBytes = 1024;
constexpr size_t kMaxSessionIdBytes = 64;

absl::Status CheckRequestId(const std::string& id) {
  if (id.size() > kMaxRequestIdBytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("request_id has ", id.size(), " bytes; it must have at most ", kMaxRequestIdBytes));
  }
  if (!std::all_of(id.begin(), id.end(), [](char c) { return absl::ascii_isprint(static_cast<unsigned char>(c)); })) {
    return absl::InvalidArgumentError("request_id has a character that is not printable ASCII");
  }
  return absl::OkStatus();
}

// The counts of a header: at least one, at most what the server takes.
absl::Status CheckCount(absl::string_view field, uint64_t count, uint64_t limit) {
  if (count == 0) return absl::InvalidArgumentError(absl::StrCat(field, " is 0; it must be at least 1"));
  if (count <= limit) return absl::OkStatus();
  return WithReason(
      absl::ResourceExhaustedError(absl::StrCat(field, " is ", count, "; this server takes at most ", limit)),
      "INPUT_TOO_LARGE",
      {{"field", std::string(field)}, {"value", absl::StrCat(count)}, {"limit", absl::StrCat(limit)}});
}

Format FormatFromProto(v1::FileFormat format) {
  switch (format) {
    case v1::FILE_FORMAT_OFF:
      return Format::kOff;
    case v1::FILE_FORMAT_OBJ:
      return Format::kObj;
    case v1::FILE_FORMAT_PLY:
      return Format::kPly;
    case v1::FILE_FORMAT_STL:
      return Format::kStl;
    case v1::FILE_FORMAT_GLB:
      return Format::kGlb;
    case v1::FILE_FORMAT_GLTF:
      return Format::kGltf;
    case v1::FILE_FORMAT_XYZ:
      return Format::kXyz;
    default:
      return Format::kUnknown;
  }
}

absl::Status ChecksumError(absl::string_view what, const ErrorMetadata& metadata) {
  return WithReason(absl::DataLossError(absl::StrCat(what, " differs from what was received; send the data again")),
                    "CHECKSUM_MISMATCH", metadata);
}

}  // namespace

absl::Status InputAssembler::Accept(const v1::Header& header) {
  if (state_ != State::kHeader) return absl::InvalidArgumentError("header came twice; it is the first message, once");
  MESHFRONT_RETURN_IF_ERROR(CheckRequestId(header.request_id()));
  MESHFRONT_ASSIGN_OR_RETURN(options_, OptionsFromProto(header.options()));
  MESHFRONT_ASSIGN_OR_RETURN(output_, NormalizeOutput(header.output()));
  request_id_ = header.request_id();
  requested_threads_ = header.options().threads();
  keeps_session_ = header.keep_session();
  updates_session_ = header.update_session();
  MESHFRONT_RETURN_IF_ERROR(CheckSessionFields(header));
  switch (header.input_case()) {
    case v1::Header::kMesh:
      MESHFRONT_RETURN_IF_ERROR(AnnounceMesh(header.mesh()));
      break;
    case v1::Header::kPoints:
      MESHFRONT_RETURN_IF_ERROR(AnnouncePoints(header.points()));
      break;
    case v1::Header::kFile:
      MESHFRONT_RETURN_IF_ERROR(AnnounceFile(header.file()));
      break;
    case v1::Header::kSessionId:
      MESHFRONT_RETURN_IF_ERROR(AnnounceSession(header));
      break;
    case v1::Header::INPUT_NOT_SET:
      return absl::InvalidArgumentError("header.input is not set; it must be mesh, points, file or session_id");
  }
  MESHFRONT_RETURN_IF_ERROR(AnnounceRegion(header.options()));
  MESHFRONT_RETURN_IF_ERROR(AnnounceFeatures(header.options(), header));
  if (!header.options().lod_rhos().empty() && (keeps_session_ || names_session_)) {
    return absl::InvalidArgumentError(absl::StrCat("options.lod_rhos is set beside ",
                                                   keeps_session_ ? "keep_session" : "session_id",
                                                   "; sessions are for one mesh at a time"));
  }
  MESHFRONT_RETURN_IF_ERROR(CheckAnnouncedBytes());
  state_ = State::kBlocks;
  return absl::OkStatus();
}

absl::Status InputAssembler::CheckAnnouncedBytes() const {
  uint64_t announced = 0;
  for (const ArrayWriter& array : arrays_) announced += array.announced_memory();
  if (announced == 0 && !input_.session_id.empty()) return absl::OkStatus();
  return CheckCount("header.input in bytes", announced, limits_.max_input_bytes);
}

absl::Status InputAssembler::CheckSessionFields(const v1::Header& header) const {
  if (keeps_session_ && header.has_points())
    return absl::InvalidArgumentError("keep_session is set beside points; only a mesh can be kept");
  if (updates_session_ && !keeps_session_ && !header.has_session_id())
    return absl::InvalidArgumentError(
        "update_session is set; it needs session_id or keep_session, whose mesh it replaces");
  if (header.has_session_revision() && !header.has_session_id())
    return absl::InvalidArgumentError("session_revision is set; it needs session_id");
  return absl::OkStatus();
}

absl::Status InputAssembler::AnnounceSession(const v1::Header& header) {
  const std::string& id = header.session_id();
  if (id.empty() || id.size() > kMaxSessionIdBytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("session_id has ", id.size(), " bytes; it must have 1 to ", kMaxSessionIdBytes));
  }
  input_.session_id = id;
  if (header.has_session_revision()) input_.session_revision = header.session_revision();
  names_session_ = true;
  return absl::OkStatus();
}

absl::Status InputAssembler::AnnounceMesh(const v1::MeshArrays& mesh) {
  MESHFRONT_RETURN_IF_ERROR(CheckCount("mesh.vertex_count", mesh.vertex_count(), limits_.max_vertices));
  MESHFRONT_RETURN_IF_ERROR(CheckCount("mesh.triangle_count", mesh.triangle_count(), limits_.max_triangles));
  MESHFRONT_ASSIGN_OR_RETURN(const v1::ScalarType scalar,
                             ResolveScalarType(mesh.scalar_type(), v1::SCALAR_TYPE_FLOAT64, "mesh.scalar_type"));
  vertex_count_ = mesh.vertex_count();
  arrays_.push_back(ArrayWriter::ForPoints(v1::ARRAY_POSITIONS, &input_.mesh.positions, vertex_count_, scalar));
  arrays_.push_back(ArrayWriter::ForTriangles(&input_.mesh.triangles, mesh.triangle_count()));
  if (mesh.has_normals()) {
    // The surface has its own normals; what is to be carried over comes as an attribute.
    arrays_.push_back(ArrayWriter::ForNothing(v1::ARRAY_NORMALS, vertex_count_ * 3 * ScalarBytes(scalar)));
    input_.mesh.dropped_attributes.push_back("normals");
  }
  return AnnounceAttributes(mesh);
}

absl::Status InputAssembler::AnnounceAttributes(const v1::MeshArrays& mesh) {
  MeshAttributes& attributes = input_.mesh.attributes;
  const uint64_t triangles = mesh.triangle_count();
  if (mesh.has_groups()) arrays_.push_back(ArrayWriter::ForNumbers(v1::ARRAY_GROUPS, &attributes.groups, triangles));
  if (mesh.attributes().empty()) return absl::OkStatus();
  for (const v1::AttributeChannel& channel : mesh.attributes())
    attributes.channels.push_back({channel.name(), channel.components()});
  MESHFRONT_RETURN_IF_ERROR(ValidateChannels(attributes.channels));
  if (mesh.wedge_count() == 0 || mesh.wedge_count() > 3 * triangles) {
    return absl::InvalidArgumentError(absl::StrCat("mesh.wedge_count is ", mesh.wedge_count(), "; it must be in [1, ",
                                                   3 * triangles, "], three a triangle"));
  }
  arrays_.push_back(
      ArrayWriter::ForFloats(v1::ARRAY_WEDGE_VALUES, &attributes.values, mesh.wedge_count() * attributes.Stride()));
  arrays_.push_back(ArrayWriter::ForTriples(v1::ARRAY_CORNER_WEDGES, &attributes.corners, triangles));
  return absl::OkStatus();
}

absl::Status InputAssembler::AnnouncePoints(const v1::PointSet& points) {
  MESHFRONT_RETURN_IF_ERROR(CheckCount("points.point_count", points.point_count(), limits_.max_vertices));
  MESHFRONT_ASSIGN_OR_RETURN(const v1::ScalarType scalar,
                             ResolveScalarType(points.scalar_type(), v1::SCALAR_TYPE_FLOAT64, "points.scalar_type"));
  const uint64_t count = points.point_count();
  arrays_.push_back(ArrayWriter::ForPoints(v1::ARRAY_POSITIONS, &input_.mesh.positions, count, scalar));
  if (points.has_normals()) {
    arrays_.push_back(ArrayWriter::ForPoints(v1::ARRAY_NORMALS, &input_.mesh.normals, count, scalar));
  }
  return absl::OkStatus();
}

absl::Status InputAssembler::AnnounceFile(const v1::WholeFile& file) {
  MESHFRONT_RETURN_IF_ERROR(CheckCount("file.size_bytes", file.size_bytes(), limits_.max_input_bytes));
  if (file.name().size() > kMaxFileNameBytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("file.name has ", file.name().size(), " bytes; it must have at most ", kMaxFileNameBytes));
  }
  input_.file_name = file.name().empty() ? "file" : file.name();
  input_.format = FormatFromProto(file.format());
  if (file.format() == v1::FILE_FORMAT_UNSPECIFIED) input_.format = FormatOfName(file.name());
  if (input_.format == Format::kUnknown) {
    return absl::InvalidArgumentError(
        "file.format is not set or not known and file.name has no known extension; one of them must say what it is");
  }
  arrays_.push_back(ArrayWriter::ForFile(&input_.file, file.size_bytes()));
  return absl::OkStatus();
}

absl::Status InputAssembler::AnnounceRegion(const v1::RemeshOptions& options) {
  MESHFRONT_ASSIGN_OR_RETURN(input_.region, RegionFromProto(options));
  if (!options.region().has_face_count()) return absl::OkStatus();
  const uint64_t count = options.region().face_count();
  MESHFRONT_RETURN_IF_ERROR(CheckCount("options.region.face_count", count, limits_.max_triangles));
  arrays_.push_back(ArrayWriter::ForNumbers(v1::ARRAY_REGION_FACES, &region_faces_, count));
  return absl::OkStatus();
}

absl::Status InputAssembler::AnnounceFeatures(const v1::RemeshOptions& options, const v1::Header& header) {
  if (!options.has_features()) return absl::OkStatus();
  const uint64_t points = options.features().point_count(), segments = options.features().segment_count();
  MESHFRONT_RETURN_IF_ERROR(CheckCount("options.features.point_count", points, limits_.max_vertices));
  MESHFRONT_RETURN_IF_ERROR(CheckCount("options.features.segment_count", segments, limits_.max_triangles));
  MESHFRONT_ASSIGN_OR_RETURN(
      const v1::ScalarType scalar,
      header.has_points()
          ? ResolveScalarType(header.points().scalar_type(), v1::SCALAR_TYPE_FLOAT64, "points.scalar_type")
          : ResolveScalarType(header.mesh().scalar_type(), v1::SCALAR_TYPE_FLOAT64, "mesh.scalar_type"));
  arrays_.push_back(ArrayWriter::ForPoints(v1::ARRAY_FEATURE_POSITIONS, &input_.features.points, points, scalar));
  arrays_.push_back(ArrayWriter::ForNumbers(v1::ARRAY_FEATURE_SEGMENTS, &segment_ends_, 2 * segments));
  return absl::OkStatus();
}

ArrayWriter* InputAssembler::Find(v1::Array array) {
  const auto found =
      std::find_if(arrays_.begin(), arrays_.end(), [&](const ArrayWriter& a) { return a.array() == array; });
  return found == arrays_.end() ? nullptr : &*found;
}

uint64_t InputAssembler::allocated_bytes() const {
  uint64_t bytes = 0;
  for (const ArrayWriter& array : arrays_) bytes += array.allocated_bytes();
  return bytes;
}

uint64_t InputAssembler::GrowthFor(const v1::DataBlock& block) {
  const ArrayWriter* array = Find(block.array());
  return array == nullptr ? 0 : array->GrowthFor(block.data().size());
}

absl::Status InputAssembler::Accept(const v1::DataBlock& block) {
  if (state_ == State::kHeader)
    return absl::InvalidArgumentError("block came before the header; the header is the first message");
  if (state_ == State::kWhole)
    return absl::InvalidArgumentError("block came after the end; the end is the last message");
  ArrayWriter* array = Find(block.array());
  if (array == nullptr) {
    return absl::InvalidArgumentError(absl::StrCat("block.array is ", static_cast<int>(block.array()), " (",
                                                   v1::Array_Name(block.array()), "); the header did not announce it"));
  }
  if (block.data().size() > kMaxBlockBytes) {
    return absl::InvalidArgumentError(
        absl::StrCat("block.data has ", block.data().size(), " bytes; it must have at most ", kMaxBlockBytes));
  }
  if (Crc32c(block.data()) != block.crc32c()) {
    return ChecksumError("block.crc32c",
                         {{"array", v1::Array_Name(block.array())}, {"offset", absl::StrCat(block.offset())}});
  }
  MESHFRONT_RETURN_IF_ERROR(array->Write(block.offset(), block.data()));
  sha256_.Update(block.data());
  bytes_ += block.data().size();
  return block.array() == v1::ARRAY_TRIANGLES ? CheckNewIndices() : absl::OkStatus();
}

absl::Status InputAssembler::CheckNewIndices() {
  const std::vector<Triangle>& triangles = input_.mesh.triangles;
  const size_t whole = Find(v1::ARRAY_TRIANGLES)->received_bytes() / sizeof(Triangle);
  for (; checked_triangles_ < whole; ++checked_triangles_) {
    for (const VertexId v : triangles[checked_triangles_]) {
      if (v.index() < vertex_count_) continue;
      return WithReason(
          absl::InvalidArgumentError(absl::StrCat("mesh.triangles: triangle ", checked_triangles_, " names vertex ",
                                                  v.index(), "; there are ", vertex_count_)),
          "INDEX_OUT_OF_RANGE", {{"face", absl::StrCat(checked_triangles_)}, {"vertex", absl::StrCat(v.index())}});
    }
  }
  return absl::OkStatus();
}

absl::Status InputAssembler::Accept(const v1::EndOfInput& end) {
  if (state_ == State::kHeader)
    return absl::InvalidArgumentError("end came before the header; the header is the first message");
  if (state_ == State::kWhole) return absl::InvalidArgumentError("end came twice; it is the last message, once");
  for (const ArrayWriter& array : arrays_) {
    if (array.whole()) continue;
    return absl::InvalidArgumentError(absl::StrCat("end came when ", v1::Array_Name(array.array()), " had ",
                                                   array.received_bytes(), " of ", array.announced_bytes(), " bytes"));
  }
  if (!end.sha256().empty() && end.sha256().size() != 32) {
    return absl::InvalidArgumentError(
        absl::StrCat("end.sha256 has ", end.sha256().size(), " bytes; it must have 32, or none"));
  }
  if (!end.sha256().empty() && end.sha256() != sha256_.Finish()) return ChecksumError("end.sha256", {});
  MESHFRONT_RETURN_IF_ERROR(ValidateAttributes(input_.mesh.attributes, input_.mesh.triangles.size()));
  for (Vec3& normal : input_.mesh.normals) normal = IsFinite(normal) ? Normalized(normal) : Vec3{};
  if (!region_faces_.empty()) input_.region->shape = std::exchange(region_faces_, {});
  for (size_t i = 0; i < segment_ends_.size(); i += 2)
    input_.features.segments.push_back({segment_ends_[i], segment_ends_[i + 1]});
  MESHFRONT_RETURN_IF_ERROR(ValidatePolylines(input_.features));
  state_ = State::kWhole;
  return absl::OkStatus();
}

}  // namespace meshfront
