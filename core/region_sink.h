// Puts the new triangles of a region and the rest of the input together again.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "core/mesh/mesh_sink.h"
#include "core/mesh/triangle_mesh.h"
#include "core/region_parts.h"

namespace meshfront {

// Unless the patch alone is wanted, sends the rest first, with the bits of its positions, then what the front makes; the vertices on the
// border are the input's, and so are wedges there that both use. Vertices and wedges count on. Memory: the rest and the new triangles.
class RegionSink : public MeshSink {
 public:
  struct Wanted {
    bool rest = true;  // false: the patch alone
    // Normals of the rest's vertices, which ones are finalised, and `sent` of it. False: normals are zero and the others empty, which saves
    // the time of the whole mesh's.
    bool details = true;
  };
  // `border`: the vertices of the whole that the front's first joints are. All outlive the sink.
  RegionSink(MeshSink& next, const Wanted& wanted, const std::vector<uint32_t>& border, const RegionParts& parts)
      : next_(next), wanted_(wanted), border_(border), parts_(parts) {}

  absl::Status SendRest();
  absl::Status Append(const MeshPiece& piece) override;
  // What was sent where details are wanted; positions of the region's new vertices as well.
  const TriangleMesh& sent() const { return sent_; }

 private:
  // A piece at hand, with what is new to the output of vertices and wedges.
  struct Outgoing {
    std::vector<OutputVertex> vertices;
    std::vector<OutputWedge> wedges;
    std::vector<float> values;  // of these wedges
    std::vector<Triangle> triangles;
    std::vector<CornerWedges> corners;
    std::vector<uint32_t> groups;
    std::vector<VertexId> finalised;
  };
  absl::Status Send(Outgoing& piece);
  void FindLastUses();
  void AddRestOf(uint32_t face, const std::vector<Vec3>& normals, Outgoing& piece);
  void AddRestWedgesOf(uint32_t face, Outgoing& piece);
  VertexId NameOf(const OutputVertex& v, std::vector<OutputVertex>& vertices);
  void NameWedges(const MeshPiece& piece, Outgoing& out);
  uint32_t SharedWedge(const OutputWedge& w) const;

  MeshSink& next_;
  const Wanted wanted_;
  const std::vector<uint32_t>& border_;
  const RegionParts& parts_;
  TriangleMesh sent_;
  std::vector<VertexId> border_names_;  // of the border's vertices, once they were sent
  std::vector<VertexId> names_;         // of the front's vertices
  std::vector<bool> on_border_;         // of the whole's vertices
  std::vector<VertexId> rest_names_;    // likewise, once they were sent
  std::vector<uint32_t> last_use_;      // likewise, by a face of the rest
  std::vector<uint32_t> rest_wedges_;   // of the whole's wedges, once they were sent
  std::vector<uint32_t> wedge_names_;   // of the front's wedges
  uint32_t vertex_count_ = 0;           // sent
  uint32_t wedge_count_ = 0;            // likewise
};

}  // namespace meshfront
