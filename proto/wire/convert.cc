// Options between the wire and core. To add an option: a line in ToCore and one in OptionsToProto.
#include "proto/wire/convert.h"

#include <google/protobuf/descriptor.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace meshfront {
namespace {

// Values that are refused beside others until they are built.
absl::Status RefuseNotYet(const v1::RemeshOptions& o) {
  if (!o.has_region() || (o.surface() != v1::SURFACE_TYPE_MLS && o.surface() != v1::SURFACE_TYPE_IMLS))
    return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("options.region with options.surface ", v1::SurfaceType_Name(o.surface()), " is not supported yet"));
}

absl::Status CheckEnums(const v1::RemeshOptions& o) {
  if (!v1::Sizing_IsValid(o.sizing())) {
    return absl::InvalidArgumentError(absl::StrCat("options.sizing is ", o.sizing(), "; it must be a value of Sizing"));
  }
  if (!v1::SurfaceType_IsValid(o.surface())) {
    return absl::InvalidArgumentError(
        absl::StrCat("options.surface is ", o.surface(), "; it must be a value of SurfaceType"));
  }
  if (!v1::AttributePolicy_IsValid(o.attributes())) {
    return absl::InvalidArgumentError(
        absl::StrCat("options.attributes is ", o.attributes(), "; it must be a value of AttributePolicy"));
  }
  if (o.has_crease() && !o.crease().has_angle_degrees() && !o.crease().off()) {
    return absl::InvalidArgumentError("options.crease is empty; it must hold angle_degrees, or off = true");
  }
  return absl::OkStatus();
}

// The sizing that was chosen, or that the parameter given implies.
v1::Sizing SizingOf(const v1::RemeshOptions& o) {
  if (o.sizing() != v1::SIZING_UNSPECIFIED) return o.sizing();
  if (o.has_max_error()) return v1::SIZING_ERROR;
  return o.has_edge_length() ? v1::SIZING_UNIFORM : v1::SIZING_ANGLE;
}

// What excludes one another: parameters, and a parameter and the sizing.
absl::Status CheckSizing(const v1::RemeshOptions& o) {
  struct Parameter {
    absl::string_view name;
    bool is_set;
    v1::Sizing sizing;
  };
  const v1::Sizing sizing = SizingOf(o);
  const v1::Sizing by_rho = sizing == v1::SIZING_THICKNESS ? v1::SIZING_THICKNESS : v1::SIZING_ANGLE;
  const Parameter parameters[] = {{"rho", o.has_rho(), by_rho},
                                  {"lod_rhos", !o.lod_rhos().empty(), by_rho},
                                  {"max_error", o.has_max_error(), v1::SIZING_ERROR},
                                  {"edge_length", o.has_edge_length(), v1::SIZING_UNIFORM},
                                  {"target_triangles", o.has_target_triangles(), sizing}};
  const Parameter* first = nullptr;
  for (const Parameter& parameter : parameters) {
    if (!parameter.is_set) continue;
    if (first != nullptr) {
      return absl::InvalidArgumentError(absl::StrCat("options.", parameter.name, " is set beside options.", first->name,
                                                     "; they exclude one another"));
    }
    if (parameter.sizing != sizing) {
      return absl::InvalidArgumentError(
          absl::StrCat("options.sizing is ", v1::Sizing_Name(sizing), "; it can't be with options.", parameter.name));
    }
    first = &parameter;
  }
  if (sizing == v1::SIZING_UNIFORM && first == nullptr) {
    return absl::InvalidArgumentError(
        "options.sizing is SIZING_UNIFORM; it needs options.edge_length or options.target_triangles");
  }
  return absl::OkStatus();
}

Sizing SizingFromProto(v1::Sizing sizing) {
  switch (sizing) {
    case v1::SIZING_ERROR:
      return Sizing::kError;
    case v1::SIZING_UNIFORM:
      return Sizing::kUniform;
    case v1::SIZING_THICKNESS:
      return Sizing::kThickness;
    default:
      return Sizing::kAngle;
  }
}

v1::Sizing SizingToProto(Sizing sizing) {
  switch (sizing) {
    case Sizing::kError:
      return v1::SIZING_ERROR;
    case Sizing::kUniform:
      return v1::SIZING_UNIFORM;
    case Sizing::kThickness:
      return v1::SIZING_THICKNESS;
    case Sizing::kAngle:
      break;
  }
  return v1::SIZING_ANGLE;
}

SurfaceKind SurfaceFromProto(v1::SurfaceType surface) {
  switch (surface) {
    case v1::SURFACE_TYPE_MESH:
      return SurfaceKind::kMesh;
    case v1::SURFACE_TYPE_MLS:
      return SurfaceKind::kMls;
    case v1::SURFACE_TYPE_IMLS:
      return SurfaceKind::kImls;
    default:
      return SurfaceKind::kAuto;
  }
}

v1::SurfaceType SurfaceToProto(SurfaceKind surface) {
  switch (surface) {
    case SurfaceKind::kMesh:
      return v1::SURFACE_TYPE_MESH;
    case SurfaceKind::kMls:
      return v1::SURFACE_TYPE_MLS;
    case SurfaceKind::kImls:
      return v1::SURFACE_TYPE_IMLS;
    case SurfaceKind::kAuto:
      break;
  }
  return v1::SURFACE_TYPE_AUTO;
}

absl::StatusOr<Length> LengthFromProto(const v1::Length& proto, absl::string_view path) {
  if (proto.value_case() == v1::Length::VALUE_NOT_SET) {
    return absl::InvalidArgumentError(absl::StrCat(path, " is empty; it must hold absolute or diagonal_fraction"));
  }
  const Length length{proto.has_absolute() ? proto.absolute() : proto.diagonal_fraction(), !proto.has_absolute()};
  if (!(length.value > 0) || !std::isfinite(length.value)) {
    return absl::InvalidArgumentError(absl::StrCat(path, " is ", length.value, "; it must be positive and finite"));
  }
  return length;
}

absl::StatusOr<std::optional<double>> CreaseFromProto(const v1::Crease& proto) {
  if (proto.off()) return std::nullopt;
  const double angle = proto.angle_degrees();
  if (angle > 0 && angle < 180) return angle;
  return absl::InvalidArgumentError(
      absl::StrCat("options.crease.angle_degrees is ", angle, "; it must be in (0, 180)"));
}

absl::StatusOr<RemeshOptions> ToCore(const v1::RemeshOptions& proto) {
  RemeshOptions o;
  if (proto.has_rho()) o.rho = proto.rho();
  o.lod_rhos.assign(proto.lod_rhos().begin(), proto.lod_rhos().end());
  if (proto.has_eta()) o.eta = proto.eta();
  o.sizing = SizingFromProto(SizingOf(proto));
  if (proto.has_max_error()) {
    MESHFRONT_ASSIGN_OR_RETURN(o.max_error, LengthFromProto(proto.max_error(), "options.max_error"));
  }
  if (proto.has_edge_length()) {
    MESHFRONT_ASSIGN_OR_RETURN(o.edge_length, LengthFromProto(proto.edge_length(), "options.edge_length"));
  }
  if (proto.has_target_triangles()) o.target_triangles = proto.target_triangles();
  if (proto.has_min_edge()) {
    MESHFRONT_ASSIGN_OR_RETURN(o.min_edge, LengthFromProto(proto.min_edge(), "options.min_edge"));
  }
  if (proto.has_max_edge()) {
    MESHFRONT_ASSIGN_OR_RETURN(o.max_edge, LengthFromProto(proto.max_edge(), "options.max_edge"));
  }
  if (proto.has_crease()) {
    MESHFRONT_ASSIGN_OR_RETURN(o.crease_angle, CreaseFromProto(proto.crease()));
  }
  if (proto.has_fill_gaps()) {
    MESHFRONT_ASSIGN_OR_RETURN(o.fill_gaps, LengthFromProto(proto.fill_gaps(), "options.fill_gaps"));
  }
  if (proto.has_blend()) o.blend = proto.blend();
  o.surface = SurfaceFromProto(proto.surface());
  if (proto.has_mls_radius()) o.mls_radius = proto.mls_radius();
  if (proto.has_flips()) o.flips = proto.flips();
  if (proto.has_smooth()) o.smooth = proto.smooth();
  if (proto.has_fit()) o.fit = proto.fit();
  if (proto.has_repair()) o.repair = proto.repair();
  o.attributes = proto.attributes() != v1::ATTRIBUTE_POLICY_DROP;
  return o;
}

}  // namespace

absl::StatusOr<RemeshOptions> OptionsFromProto(const v1::RemeshOptions& proto) {
  MESHFRONT_RETURN_IF_ERROR(CheckEnums(proto));
  MESHFRONT_RETURN_IF_ERROR(RefuseNotYet(proto));
  MESHFRONT_RETURN_IF_ERROR(CheckSizing(proto));
  MESHFRONT_ASSIGN_OR_RETURN(RemeshOptions options, ToCore(proto));
  MESHFRONT_RETURN_IF_ERROR(ValidateOptions(options));
  return options;
}

absl::StatusOr<std::optional<Region>> RegionFromProto(const v1::RemeshOptions& proto) {
  if (!proto.has_region()) return std::nullopt;
  const v1::Region& shape = proto.region();
  for (const auto& [is_set, field] :
       {std::pair{!proto.lod_rhos().empty(), "lod_rhos"}, {proto.has_fill_gaps(), "fill_gaps"}}) {
    if (!is_set) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("options.region is set beside options.", field, "; they exclude one another"));
  }
  Region region;
  region.patch_only = shape.patch_only();
  switch (shape.shape_case()) {
    case v1::Region::kSphere:
      region.shape = RegionSphere{PointFromProto(shape.sphere().center()), shape.sphere().radius()};
      break;
    case v1::Region::kBox:
      region.shape = Box3{PointFromProto(shape.box().min()), PointFromProto(shape.box().max())};
      break;
    case v1::Region::kFaceCount:
      region.shape = RegionFaces();
      if (shape.face_count() > 0) return region;
      return absl::InvalidArgumentError("options.region.face_count is 0; it must be at least 1");
    case v1::Region::SHAPE_NOT_SET:
      return absl::InvalidArgumentError("options.region is empty; it must hold sphere, box or face_count");
  }
  MESHFRONT_RETURN_IF_ERROR(ValidateRegion(region));
  return region;
}

v1::RemeshOptions OptionsToProto(const RemeshOptions& o) {
  v1::RemeshOptions proto;
  const bool by_rho = o.sizing == Sizing::kAngle || o.sizing == Sizing::kThickness;
  if (by_rho && !o.target_triangles && o.lod_rhos.empty()) proto.set_rho(o.rho);
  proto.mutable_lod_rhos()->Add(o.lod_rhos.begin(), o.lod_rhos.end());
  proto.set_eta(o.eta);
  proto.set_sizing(SizingToProto(o.sizing));
  if (o.max_error) *proto.mutable_max_error() = LengthToProto(*o.max_error);
  if (o.edge_length) *proto.mutable_edge_length() = LengthToProto(*o.edge_length);
  if (o.target_triangles) proto.set_target_triangles(*o.target_triangles);
  if (o.min_edge) *proto.mutable_min_edge() = LengthToProto(*o.min_edge);
  if (o.max_edge) *proto.mutable_max_edge() = LengthToProto(*o.max_edge);
  if (o.crease_angle)
    proto.mutable_crease()->set_angle_degrees(*o.crease_angle);
  else
    proto.mutable_crease()->set_off(true);
  if (o.fill_gaps) *proto.mutable_fill_gaps() = LengthToProto(*o.fill_gaps);
  proto.set_attributes(o.attributes ? v1::ATTRIBUTE_POLICY_KEEP : v1::ATTRIBUTE_POLICY_DROP);
  proto.set_blend(o.blend);
  proto.set_surface(SurfaceToProto(o.surface));
  proto.set_mls_radius(o.mls_radius);
  proto.set_flips(o.flips);
  proto.set_smooth(o.smooth);
  proto.set_fit(o.fit);
  proto.set_repair(o.repair);
  return proto;
}

std::vector<std::string> SupportedOptions() {
  std::vector<std::string> paths;
  const google::protobuf::Descriptor* descriptor = v1::RemeshOptions::descriptor();
  for (int i = 0; i < descriptor->field_count(); ++i) {
    paths.push_back(absl::StrCat("options.", descriptor->field(i)->name()));
  }
  return paths;
}

absl::StatusOr<v1::ScalarType> ResolveScalarType(v1::ScalarType type, v1::ScalarType unset, absl::string_view field) {
  if (type == v1::SCALAR_TYPE_UNSPECIFIED) return unset;
  if (v1::ScalarType_IsValid(type)) return type;
  return absl::InvalidArgumentError(
      absl::StrCat(field, " is ", static_cast<int>(type), "; it must be a value of ScalarType"));
}

absl::StatusOr<v1::OutputFormat> NormalizeOutput(const v1::OutputFormat& output) {
  v1::OutputFormat full = output;
  MESHFRONT_ASSIGN_OR_RETURN(const v1::ScalarType scalar,
                             ResolveScalarType(output.scalar_type(), v1::SCALAR_TYPE_FLOAT32, "output.scalar_type"));
  full.set_scalar_type(scalar);
  full.set_chunk_bytes(output.has_chunk_bytes() ? output.chunk_bytes() : kDefaultChunkBytes);
  if (full.chunk_bytes() < kMinChunkBytes || full.chunk_bytes() > kMaxChunkBytes) {
    return absl::InvalidArgumentError(absl::StrCat("output.chunk_bytes is ", full.chunk_bytes(), "; it must be in [",
                                                   kMinChunkBytes, ", ", kMaxChunkBytes, "]"));
  }
  return full;
}

}  // namespace meshfront
