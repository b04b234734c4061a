#include "core/mesh/mesh_sink.h"

namespace meshfront {

absl::Status CollectingSink::Append(const MeshPiece& piece) {
  for (const OutputVertex& v : piece.vertices) {
    mesh.positions.push_back(v.position);
    mesh.normals.push_back(v.normal);
  }
  mesh.triangles.insert(mesh.triangles.end(), piece.triangles.begin(), piece.triangles.end());
  finalised.insert(finalised.end(), piece.finalised.begin(), piece.finalised.end());
  return absl::OkStatus();
}

}  // namespace meshfront
