// One buffer: positions, normals, indices, each a multiple of four bytes long; described by JSON that holds their exact bounds.
#include <array>
#include <cmath>
#include <limits>

#include "core/base/status_macros.h"
#include "core/geometry/box.h"
#include "core/io/base64.h"
#include "core/io/gltf.h"

namespace meshfront {
namespace {

constexpr double kFarDiagonals = 100;  // from the origin; from there on a float32 keeps fewer than 16 bits of the shape
constexpr uint64_t kMostGlbBytes = std::numeric_limits<uint32_t>::max();

struct Float3 {
  float x, y, z;
};
Float3 ToFloat(const Vec3& v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

struct Plan {
  Vec3 origin;  // of the positions that are written
  Box3 bounds;  // of those, after rounding to 32 bits
  bool normals = false;
  uint64_t position_bytes = 0, normal_bytes = 0, index_bytes = 0;

  uint64_t buffer_bytes() const { return position_bytes + normal_bytes + index_bytes; }
};

bool AllHaveDirections(const std::vector<Vec3>& normals) {
  for (const Vec3& n : normals) {
    if (!(std::fabs(Norm(n) - 1) < 0.5)) return false;
  }
  return !normals.empty();
}

absl::StatusOr<Plan> MakePlan(const TriangleMesh& mesh) {
  Plan plan;
  Box3 box;
  for (size_t i = 0; i < mesh.positions.size(); ++i) {
    if (!IsFinite(mesh.positions[i])) {
      return absl::InvalidArgumentError(
          Concat("vertex ", i, " has a coordinate that is not finite; glTF holds finite ones only"));
    }
    box.Extend(mesh.positions[i]);
  }
  const Vec3 center = 0.5 * box.min + 0.5 * box.max;
  if (Norm(center) > kFarDiagonals * box.Diagonal()) plan.origin = center;
  for (const Vec3& p : mesh.positions) {
    const Float3 f = ToFloat(p - plan.origin);
    const Vec3 rounded{f.x, f.y, f.z};
    if (!IsFinite(rounded)) return absl::InvalidArgumentError("glTF has 32-bit floats; a coordinate is beyond them");
    plan.bounds.Extend(rounded);
  }
  plan.normals = AllHaveDirections(mesh.normals);
  plan.position_bytes = 12 * mesh.positions.size();
  plan.normal_bytes = plan.normals ? plan.position_bytes : 0;
  plan.index_bytes = 12 * mesh.triangles.size();
  return plan;
}

void PutTriple(Output& out, std::string_view name, const Vec3& v) {
  out.Text(",\""), out.Text(name), out.Text("\":[");
  out.Number(v.x), out.Text(","), out.Number(v.y), out.Text(","), out.Number(v.z), out.Text("]");
}

void PutView(Output& out, uint64_t offset, uint64_t bytes, std::string_view target) {
  out.Text(offset > 0 ? "," : ""), out.Text("{\"buffer\":0,\"byteOffset\":"), out.Number(offset);
  out.Text(",\"byteLength\":"), out.Number(bytes), out.Text(",\"target\":"), out.Text(target), out.Text("}");
}

void PutScene(Output& out, const Plan& plan, bool points) {
  out.Text(
      R"({"asset":{"generator":"Meshfront","version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0)");
  if (!(plan.origin == Vec3{})) PutTriple(out, "translation", plan.origin);
  out.Text(R"(}],"meshes":[{"primitives":[{"attributes":{"POSITION":0)");
  if (plan.normals) out.Text(R"(,"NORMAL":1)");
  out.Text("}");
  if (points)
    out.Text(R"(,"mode":0)");
  else
    out.Text(plan.normals ? R"(,"indices":2)" : R"(,"indices":1)");
  out.Text("}]}]");
}

void PutAccessors(Output& out, const TriangleMesh& mesh, const Plan& plan) {
  out.Text(R"(,"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":)");
  out.Number(uint64_t{mesh.positions.size()});
  PutTriple(out, "min", plan.bounds.min), PutTriple(out, "max", plan.bounds.max);
  if (plan.normals) {
    out.Text(R"(},{"bufferView":1,"componentType":5126,"type":"VEC3","count":)");
    out.Number(uint64_t{mesh.positions.size()});
  }
  if (!mesh.IsPointSet()) {
    out.Text(R"(},{"bufferView":)"), out.Number(uint64_t{plan.normals ? 2u : 1u});
    out.Text(R"(,"componentType":5125,"type":"SCALAR","count":)"), out.Number(uint64_t{3 * mesh.triangles.size()});
  }
  out.Text(R"(}],"bufferViews":[)");
  PutView(out, 0, plan.position_bytes, "34962");
  if (plan.normals) PutView(out, plan.position_bytes, plan.normal_bytes, "34962");
  if (!mesh.IsPointSet()) PutView(out, plan.position_bytes + plan.normal_bytes, plan.index_bytes, "34963");
  out.Text("]");
}

// Everything up to the buffer's uri or its end.
void PutJson(Output& out, const TriangleMesh& mesh, const Plan& plan) {
  PutScene(out, plan, mesh.IsPointSet());
  PutAccessors(out, mesh, plan);
  out.Text(R"(,"buffers":[{"byteLength":)"), out.Number(plan.buffer_bytes());
}

void PutBuffer(Output& out, const TriangleMesh& mesh, const Plan& plan) {
  for (const Vec3& p : mesh.positions) out.Raw(ToFloat(p - plan.origin));
  if (plan.normals) {
    for (const Vec3& n : mesh.normals) out.Raw(ToFloat(Normalized(n)));
  }
  for (const Triangle& t : mesh.triangles) out.Raw(t);
}

}  // namespace

absl::Status WriteGlb(const TriangleMesh& mesh, Output& output) {
  MESHFRONT_ASSIGN_OR_RETURN(const Plan plan, MakePlan(mesh));
  StringSink sink;
  Output json_output(sink);
  PutJson(json_output, mesh, plan);
  json_output.Text("}]}");
  MESHFRONT_RETURN_IF_ERROR(json_output.Finish());
  std::string json = sink.Take();
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const uint64_t length = 12 + 8 + json.size() + 8 + plan.buffer_bytes();
  if (length > kMostGlbBytes)
    return absl::InvalidArgumentError(Concat("GLB holds 4 GiB at most; the mesh takes ", length, " bytes"));
  output.Text("glTF"), output.Raw(uint32_t{2}), output.Raw(static_cast<uint32_t>(length));
  output.Raw(static_cast<uint32_t>(json.size())), output.Text("JSON"), output.Text(json);
  output.Raw(static_cast<uint32_t>(plan.buffer_bytes())), output.Text(std::string_view("BIN\0", 4));
  PutBuffer(output, mesh, plan);
  return absl::OkStatus();
}

absl::Status WriteGltf(const TriangleMesh& mesh, Output& output) {
  MESHFRONT_ASSIGN_OR_RETURN(const Plan plan, MakePlan(mesh));
  PutJson(output, mesh, plan);
  output.Text(R"(,"uri":"data:application/octet-stream;base64,)");
  Base64Sink sink(output);
  Output buffer(sink);
  PutBuffer(buffer, mesh, plan);
  MESHFRONT_RETURN_IF_ERROR(buffer.Finish());
  sink.Finish();
  output.Text("\"}]}\n");
  return absl::OkStatus();
}

}  // namespace meshfront
