// Where settled vertices and triangles go: a file, a gRPC stream, memory.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/span.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// A vertex that is no joint.
inline constexpr uint32_t kNoJoint = 0xffffffffu;

struct OutputVertex {
  Vec3 position;
  Vec3 normal;                // unit normal of the surface there
  uint32_t joint = kNoJoint;  // its number among the joints of the initial fronts (oriented_loop.h)
  uint32_t sheet = 0;         // of the surface, by its number: a patch between creases, or a component
};

// How a triangle came to be (sec. 3): with a new vertex at the lengths that the guidance field asks for, with an existing front
// vertex, or by what closes the rest: the last of a loop, the closing ladder, a new vertex on a base that is too long or short, or where
// triangles were too far from the surface.
enum class TriangleKind : uint8_t { kFree, kConnection, kClosing };

// A corner of output triangles on one side of every seam and crease: where on the surface it was made.
using OutputWedge = WedgeSource;

// A piece of the output. Vertex ids are global and count up from 0 in the order of emission; a vertex comes once and before
// its first triangle. Valid during the call only.
struct MeshPiece {
  absl::Span<const OutputVertex> vertices;
  absl::Span<const Triangle> triangles;
  absl::Span<const VertexId> finalised;  // vertices that no later triangle will use
  uint64_t open_front_edges = 0;         // left on the fronts when the piece was settled
  absl::Span<const TriangleKind> kinds;  // one per triangle; as grown, a triangle is (base end, base start, apex)
  // Where the input has attributes: wedges, numbered like vertices; of each triangle its corners' wedges and a face of the surface that
  // it lies on. The facade adds the values of the wedges, MeshAttributes::Stride() each, and the triangles' groups.
  absl::Span<const OutputWedge> wedges;
  absl::Span<const CornerWedges> corners;
  absl::Span<const uint32_t> faces;
  absl::Span<const float> wedge_values;
  absl::Span<const uint32_t> groups;
};

// Implemented by: collectors in memory, the server's stream sink. Called by: the settling window, on the job's thread.
// Append may block (back-pressure). A status that is not OK stops the job with it. Nothing is emitted twice or taken back.
class MeshSink {
 public:
  virtual ~MeshSink() = default;
  virtual absl::Status Append(const MeshPiece& piece) = 0;
};

// Keeps everything in memory, as one mesh with normals and attributes, whose channels are the input's.
class CollectingSink : public MeshSink {
 public:
  absl::Status Append(const MeshPiece& piece) override;
  TriangleMesh mesh;
  std::vector<VertexId> finalised;
};

// Hands each piece to one sink, then to another, which both outlive it. The first status that is not OK stops the job.
class TeeSink : public MeshSink {
 public:
  TeeSink(MeshSink& first, MeshSink& second) : first_(first), second_(second) {}
  absl::Status Append(const MeshPiece& piece) override;

 private:
  MeshSink &first_, &second_;
};

}  // namespace meshfront
