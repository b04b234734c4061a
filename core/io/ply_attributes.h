// The properties of a PLY's vertices, as attributes of its triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/types/span.h"
#include "core/io/ply_header.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// "NORMAL" from nx, ny, nz; "TEXCOORD_0" from s, t (or u, v, or texture_u, texture_v); "COLOR_0" from red, green, blue and alpha,
// integers as parts of their largest; every other number by its own name.
class PlyAttributes {
 public:
  // Gives each property that is carried over a slot from 6 on; slots of coordinates stay.
  PlyAttributes(const PlyElement& vertex, std::vector<int>& slots);

  uint32_t Stride() const { return attributes_.Stride(); }
  // The values of the slots of one vertex.
  void AddRow(absl::Span<const double> values);
  void Finish(TriangleMesh& mesh);
  // Numbers that were read as 0, since they are none.
  uint64_t not_finite() const { return not_finite_; }

 private:
  bool Take(const PlyElement& vertex, const AttributeChannel& channel, absl::Span<const std::string_view> properties,
            std::vector<int>& slots);

  MeshAttributes attributes_;
  std::vector<double> scales_;  // of each slot
  uint64_t not_finite_ = 0;
};

}  // namespace meshfront
