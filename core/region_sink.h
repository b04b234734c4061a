// Puts the new triangles of a region and the rest of the input together again.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "core/mesh/mesh_sink.h"
#include "core/mesh/triangle_mesh.h"
#include "core/region_parts.h"

namespace meshfront {

// Where the rest is wanted: sends it first, with the bits of its positions, then what the front makes; the vertices on the border are the
// input's. Vertex ids count on. Memory: the rest, which it takes out of `parts`, and the new triangles.
class RegionSink : public MeshSink {
 public:
  // `border`: the vertices of the whole that the front's first joints are. Both outlive the sink.
  RegionSink(MeshSink& next, const std::vector<uint32_t>& border, RegionParts& parts)
      : next_(next), border_(border), parts_(parts) {}

  absl::Status SendRest();
  absl::Status Append(const MeshPiece& piece) override;
  // What was sent; positions of the region's new vertices as well.
  const TriangleMesh& sent() const { return sent_; }

 private:
  VertexId NameOf(const OutputVertex& v, std::vector<OutputVertex>& vertices);

  MeshSink& next_;
  const std::vector<uint32_t>& border_;
  RegionParts& parts_;
  TriangleMesh sent_;
  std::vector<VertexId> border_names_;  // of the border's vertices, once they were sent
  std::vector<VertexId> names_;         // of the front's vertices
};

}  // namespace meshfront
