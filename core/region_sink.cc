#include "core/region_sink.h"

#include <algorithm>

#include "core/base/status_macros.h"
#include "core/surface/vertex_normals.h"

namespace meshfront {
namespace {

constexpr size_t kTrianglesPerPiece = 8192;

}  // namespace

absl::Status RegionSink::SendRest() {
  border_names_.assign(border_.size(), VertexId());
  if (parts_.patch_only) return absl::OkStatus();
  const TriangleMesh& whole = parts_.whole();
  const std::vector<Vec3> normals = ComputeVertexNormals(whole);
  std::vector<VertexId> names(whole.positions.size());
  std::vector<bool> on_border(whole.positions.size(), false);
  for (const uint32_t v : border_) on_border[v] = true;
  std::vector<uint32_t> last_use(whole.positions.size(), 0);
  for (uint32_t f = 0; f < whole.triangles.size(); ++f) {
    if (parts_.chosen[f]) continue;
    for (const VertexId v : whole.triangles[f]) last_use[v.index()] = f;
  }
  std::vector<OutputVertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<VertexId> finalised;
  const auto send = [&]() -> absl::Status {
    const std::vector<TriangleKind> kinds(triangles.size(), TriangleKind::kConnection);
    MESHFRONT_RETURN_IF_ERROR(next_.Append({vertices, triangles, finalised, border_.size(), kinds}));
    vertices.clear(), triangles.clear(), finalised.clear();
    return absl::OkStatus();
  };
  for (uint32_t f = 0; f < whole.triangles.size(); ++f) {
    if (parts_.chosen[f]) continue;
    Triangle t;
    for (int i = 0; i < 3; ++i) {
      const uint32_t v = whole.triangles[f][i].index();
      if (!names[v].valid()) {
        names[v] = VertexId(static_cast<uint32_t>(sent_.positions.size()));
        sent_.positions.push_back(whole.positions[v]);
        vertices.push_back({whole.positions[v], normals[v]});
      }
      t[i] = names[v];
      if (last_use[v] == f && !on_border[v]) finalised.push_back(t[i]);
    }
    triangles.push_back(t);
    sent_.triangles.push_back(t);
    if (triangles.size() == kTrianglesPerPiece) MESHFRONT_RETURN_IF_ERROR(send());
  }
  for (size_t i = 0; i < border_.size(); ++i) border_names_[i] = names[border_[i]];
  return triangles.empty() ? absl::OkStatus() : send();
}

VertexId RegionSink::NameOf(const OutputVertex& v, std::vector<OutputVertex>& vertices) {
  const bool on_border = v.joint < border_.size();
  if (on_border && border_names_[v.joint].valid()) return border_names_[v.joint];
  const VertexId name(static_cast<uint32_t>(sent_.positions.size()));
  vertices.push_back(v);
  if (on_border) {
    vertices.back().position = parts_.whole().positions[border_[v.joint]];
    border_names_[v.joint] = name;
  }
  sent_.positions.push_back(vertices.back().position);
  return name;
}

absl::Status RegionSink::Append(const MeshPiece& piece) {
  std::vector<OutputVertex> vertices;
  for (const OutputVertex& v : piece.vertices) names_.push_back(NameOf(v, vertices));
  std::vector<Triangle> triangles;
  for (const Triangle& t : piece.triangles)
    triangles.push_back({names_[t[0].index()], names_[t[1].index()], names_[t[2].index()]});
  std::vector<VertexId> finalised;
  for (const VertexId v : piece.finalised) finalised.push_back(names_[v.index()]);
  sent_.triangles.insert(sent_.triangles.end(), triangles.begin(), triangles.end());
  parts_.report.new_triangles += triangles.size();
  return next_.Append({vertices, triangles, finalised, piece.open_front_edges, piece.kinds});
}

}  // namespace meshfront
