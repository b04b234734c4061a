#include "core/prepared_input.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <utility>

#include "core/base/exceptions.h"
#include "core/base/status_macros.h"
#include "core/geometry/box.h"

namespace meshfront {
namespace {

bool IsSameFace(const TriangleMesh& a, const Triangle& s, const TriangleMesh& b, const Triangle& t) {
  for (int turn = 0; turn < 3; ++turn) {
    bool same = true;
    for (int i = 0; i < 3; ++i)
      same = same && std::memcmp(&a.PositionAt(s[i]), &b.PositionAt(t[(i + turn) % 3]), sizeof(Vec3)) == 0;
    if (same) return true;
  }
  return false;
}

// With the origins of its faces.
uint64_t BytesOfMesh(const PreparedInput::Size& size) {
  return size.vertices * sizeof(Vec3) + size.triangles * (sizeof(Triangle) + sizeof(uint32_t)) + size.attribute_bytes;
}

uint64_t BytesOfAdjacency(uint64_t vertices, uint64_t triangles) {
  return triangles * sizeof(FaceAdjacency().opposite[0]) + vertices * sizeof(uint32_t);
}

}  // namespace

absl::StatusOr<std::shared_ptr<const PreparedInput>> PreparedInput::Create(TriangleMesh mesh, bool repair,
                                                                           const Context& context) try {
  if (mesh.IsPointSet())
    return absl::InvalidArgumentError("the input is a point set; what is kept, or remeshed in part, must be a mesh");
  MESHFRONT_RETURN_IF_ERROR(ValidateAttributes(mesh.attributes, mesh.triangles.size()));
  auto prepared = std::shared_ptr<PreparedInput>(new PreparedInput());
  prepared->repair_ = repair;
  prepared->input_triangles_ = mesh.triangles.size();
  mesh.face_origins.resize(mesh.triangles.size());
  std::iota(mesh.face_origins.begin(), mesh.face_origins.end(), 0u);
  if (repair) {
    MESHFRONT_ASSIGN_OR_RETURN(RepairResult repaired,
                               RepairMeshAsOriented(std::move(mesh), context, &prepared->input_));
    prepared->mesh_ = std::move(repaired.mesh);
    prepared->adjacency_ = std::move(repaired.adjacency);
    prepared->repairs_ = std::move(repaired.actions);
    if (prepared->repairs_.empty()) prepared->input_.reset();
  } else {
    MESHFRONT_RETURN_IF_ERROR(RequireManifold(mesh));
    prepared->adjacency_ = CreateAdjacency(mesh);
    prepared->mesh_ = std::move(mesh);
  }
  prepared->MeasureComponents();
  prepared->topology_ = MeasureTopology(prepared->mesh_, prepared->adjacency_, prepared->components_.count);
  if (prepared->input_) prepared->CompareWithInput();
  return prepared;
} catch (const std::exception&) {
  return StatusOfException();
}

TriangleMesh PreparedInput::Input() const {
  TriangleMesh mesh = input_ ? *input_ : mesh_;
  mesh.face_origins.clear();
  return mesh;
}

void PreparedInput::MeasureComponents() {
  components_ = LabelComponents(adjacency_);
  std::vector<Box3> boxes(components_.count);
  Box3 all;
  for (size_t v = 0; v < mesh_.positions.size(); ++v) {
    const uint32_t h = adjacency_.outgoing[v];
    if (h != kNoHalfEdge) boxes[components_.label[h / 3]].Extend(mesh_.positions[v]);
  }
  for (const Box3& box : boxes) all.Extend(box), component_diagonals_.push_back(box.Diagonal());
  diagonal_ = all.Diagonal();
}

void PreparedInput::CompareWithInput() {
  std::vector<bool> is_left(input_triangles_, false);
  is_changed_.reserve(mesh_.triangles.size());
  for (size_t f = 0; f < mesh_.triangles.size(); ++f) {
    const uint32_t origin = mesh_.face_origins[f];
    is_left[origin] = true;
    is_changed_.push_back(!IsSameFace(*input_, input_->triangles[origin], mesh_, mesh_.triangles[f]));
  }
  changed_faces_ = std::count(is_changed_.begin(), is_changed_.end(), true);
  for (uint32_t f = 0; f < is_left.size(); ++f) {
    if (!is_left[f]) dropped_faces_.push_back(f);
  }
}

PreparedInput::Size PreparedInput::SizeOf(const TriangleMesh& mesh) {
  const MeshAttributes& a = mesh.attributes;
  return {
      mesh.positions.size(), mesh.triangles.size(),
      a.values.size() * sizeof(float) + a.corners.size() * sizeof(CornerWedges) + a.groups.size() * sizeof(uint32_t)};
}

uint64_t PreparedInput::LeastBytes(const Size& size) {
  return sizeof(PreparedInput) + BytesOfMesh(size) + BytesOfAdjacency(size.vertices, size.triangles) +
         size.triangles * sizeof(uint32_t);  // of its components
}

uint64_t PreparedInput::bytes() const {
  return LeastBytes(SizeOf(mesh_)) + (input_ ? BytesOfMesh(SizeOf(*input_)) : 0) + is_changed_.size() / 8;
}

}  // namespace meshfront
