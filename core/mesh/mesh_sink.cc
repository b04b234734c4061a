#include "core/mesh/mesh_sink.h"

#include "core/base/status_macros.h"

namespace meshfront {

absl::Status CollectingSink::Append(const MeshPiece& piece) {
  for (const OutputVertex& v : piece.vertices) {
    mesh.positions.push_back(v.position);
    mesh.normals.push_back(v.normal);
  }
  mesh.triangles.insert(mesh.triangles.end(), piece.triangles.begin(), piece.triangles.end());
  MeshAttributes& a = mesh.attributes;
  a.values.insert(a.values.end(), piece.wedge_values.begin(), piece.wedge_values.end());
  a.corners.insert(a.corners.end(), piece.corners.begin(), piece.corners.end());
  a.groups.insert(a.groups.end(), piece.groups.begin(), piece.groups.end());
  finalised.insert(finalised.end(), piece.finalised.begin(), piece.finalised.end());
  return absl::OkStatus();
}

absl::Status TeeSink::Append(const MeshPiece& piece) {
  MESHFRONT_RETURN_IF_ERROR(first_.Append(piece));
  return second_.Append(piece);
}

}  // namespace meshfront
