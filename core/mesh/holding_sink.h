// Holds the beginning of an output back, as long as it may have to be made again.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "core/mesh/mesh_sink.h"

namespace meshfront {

// A MeshPiece with its own memory.
struct HeldPiece {
  explicit HeldPiece(const MeshPiece& piece);
  MeshPiece View() const {
    return {vertices, triangles, finalised, open_front_edges, kinds, wedges, corners, faces, {}, {}};
  }

  std::vector<OutputVertex> vertices;
  std::vector<Triangle> triangles;
  std::vector<VertexId> finalised;
  std::vector<TriangleKind> kinds;
  std::vector<OutputWedge> wedges;
  std::vector<CornerWedges> corners;
  std::vector<uint32_t> faces;
  uint64_t open_front_edges = 0;
};

// Called by: the facade, between the front and the caller's sink. Memory: about 40 bytes a triangle held.
class HoldingSink : public MeshSink {
 public:
  // Holds up to `limit` triangles. Beyond, everything goes to `next`, as it comes from then on.
  HoldingSink(MeshSink& next, uint64_t limit) : next_(next), limit_(limit) {}

  absl::Status Append(const MeshPiece& piece) override;
  // From now on holds everything, until it is released.
  void HoldAll() { limit_ = std::numeric_limits<uint64_t>::max(); }
  // Whether something went on: it can't be taken back.
  bool is_passing() const { return is_passing_; }
  // What is held, and no longer is afterwards: to be made again, or put back.
  std::vector<HeldPiece> Take();
  void PutBack(std::vector<HeldPiece> pieces) { pieces_ = std::move(pieces); }
  // The end of the output: passes on what is held.
  absl::Status Release();

 private:
  MeshSink& next_;
  uint64_t limit_;
  uint64_t triangles_ = 0;  // held
  bool is_passing_ = false;
  std::vector<HeldPiece> pieces_;
};

}  // namespace meshfront
