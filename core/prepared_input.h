// What remeshing regions of one mesh begins with, whatever the region: made once, region after region costs little more than itself.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/context.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/repair.h"
#include "core/mesh/topology.h"
#include "core/mesh/triangle_mesh.h"

namespace meshfront {

// A mesh after repair as regions need it, and what is measured of the whole. Immutable; safe to read from many threads. A region of a
// prepared input gives the bytes that one of the same mesh gives.
//   MESHFRONT_ASSIGN_OR_RETURN(auto prepared, PreparedInput::Create(std::move(mesh), true, context));
//   MESHFRONT_ASSIGN_OR_RETURN(Report first, Remesh({{}, options, region, prepared}, sink, context));
class PreparedInput {
 public:
  // Repairs the mesh, but leaves slivers (which are mended with the region) and the direction of components alone; where `repair` is
  // false it refuses what would need it. Errors of RepairMesh and RequireManifold; InvalidArgument for a point set. Stops with the context.
  static absl::StatusOr<std::shared_ptr<const PreparedInput>> Create(TriangleMesh mesh, bool repair,
                                                                     const Context& context);

  // The mesh as it came.
  TriangleMesh Input() const;
  uint64_t input_triangles() const { return input_triangles_; }
  bool repair() const { return repair_; }  // as asked for

  const TriangleMesh& mesh() const { return mesh_; }  // after repair, with the origins of its faces
  const FaceAdjacency& adjacency() const { return adjacency_; }
  const TopologyReport& topology() const { return topology_; }
  const std::vector<RepairAction>& repairs() const { return repairs_; }
  double diagonal() const { return diagonal_; }  // of the bounding box
  double ComponentDiagonalAt(uint32_t face) const { return component_diagonals_[components_.label[face]]; }
  // Whether repair changed a face, how many it changed, and those of the input that it dropped.
  bool IsChanged(uint32_t face) const { return !is_changed_.empty() && is_changed_[face]; }
  uint64_t changed_faces() const { return changed_faces_; }
  const std::vector<uint32_t>& dropped_faces() const { return dropped_faces_; }
  // Memory that it takes, about.
  uint64_t bytes() const;
  // What a mesh is large by.
  struct Size {
    uint64_t vertices = 0, triangles = 0;
    uint64_t attribute_bytes = 0;
  };
  static Size SizeOf(const TriangleMesh& mesh);
  // What bytes() of a mesh of this size, all of whose vertices are used, will be, or more where something is repaired.
  static uint64_t LeastBytes(const Size& size);

 private:
  PreparedInput() = default;
  void CompareWithInput();
  void MeasureComponents();

  TriangleMesh mesh_;
  std::optional<TriangleMesh> input_;  // none: as it came but for the origins, since nothing was repaired
  uint64_t input_triangles_ = 0;
  bool repair_ = true;
  FaceAdjacency adjacency_;
  TopologyReport topology_;
  std::vector<RepairAction> repairs_;
  double diagonal_ = 0;
  FaceComponents components_;
  std::vector<double> component_diagonals_;
  std::vector<bool> is_changed_;  // empty: nothing was repaired
  uint64_t changed_faces_ = 0;
  std::vector<uint32_t> dropped_faces_;
};

}  // namespace meshfront
