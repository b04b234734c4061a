#include "core/region_parts.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "core/geometry/box.h"

namespace meshfront {
namespace {

constexpr int kRingsAround = 4;  // one more than the curvature fit looks at

// The faces of the surroundings, one flag each.
std::vector<bool> MarkSurroundings(const TriangleMesh& mesh, const std::vector<bool>& chosen, double reach) {
  Box3 box;
  std::vector<bool> touched(mesh.positions.size(), false);
  for (size_t f = 0; f < chosen.size(); ++f) {
    if (!chosen[f]) continue;
    for (const VertexId v : mesh.triangles[f]) box.Extend(mesh.PositionAt(v)), touched[v.index()] = true;
  }
  std::vector<bool> marked = chosen;
  for (int ring = 0; ring < kRingsAround; ++ring) {
    std::vector<bool> next = touched;
    for (size_t f = 0; f < marked.size(); ++f) {
      const Triangle& t = mesh.triangles[f];
      if (!touched[t[0].index()] && !touched[t[1].index()] && !touched[t[2].index()]) continue;
      marked[f] = true;
      for (const VertexId v : t) next[v.index()] = true;
    }
    touched = std::move(next);
  }
  const double reach2 = reach * reach;
  for (size_t v = 0; v < touched.size(); ++v) touched[v] = box.SquaredDistanceTo(mesh.positions[v]) <= reach2;
  for (size_t f = 0; f < marked.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    if (touched[t[0].index()] || touched[t[1].index()] || touched[t[2].index()]) marked[f] = true;
  }
  return marked;
}

std::vector<double> ComponentDiagonals(const TriangleMesh& mesh, const FaceComponents& components) {
  std::vector<Box3> boxes(components.count);
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (const VertexId v : mesh.triangles[f]) boxes[components.label[f]].Extend(mesh.PositionAt(v));
  }
  std::vector<double> diagonals;
  for (const Box3& box : boxes) diagonals.push_back(box.Diagonal());
  return diagonals;
}

bool IsSameFace(const TriangleMesh& a, const Triangle& s, const TriangleMesh& b, const Triangle& t) {
  for (int turn = 0; turn < 3; ++turn) {
    bool same = true;
    for (int i = 0; i < 3; ++i)
      same = same && std::memcmp(&a.PositionAt(s[i]), &b.PositionAt(t[(i + turn) % 3]), sizeof(Vec3)) == 0;
    if (same) return true;
  }
  return false;
}

}  // namespace

TriangleMesh CutOutSurroundings(const FaceAdjacency& adjacency, double reach, RegionParts& parts) {
  const TriangleMesh& whole = parts.whole;
  const std::vector<bool> marked = MarkSurroundings(whole, parts.chosen, reach);
  const FaceComponents components = LabelComponents(adjacency);
  const std::vector<double> diagonals = ComponentDiagonals(whole, components);
  TriangleMesh around;
  std::vector<uint32_t> names(whole.positions.size(), kNoHalfEdge);
  for (uint32_t f = 0; f < marked.size(); ++f) {
    if (!marked[f]) continue;
    parts.around_faces.push_back(f);
    parts.around_chosen.push_back(parts.chosen[f]);
    parts.diagonals.push_back(diagonals[components.label[f]]);
    for (const VertexId v : whole.triangles[f]) names[v.index()] = 0;
  }
  for (uint32_t v = 0; v < names.size(); ++v) {
    if (names[v] != 0) continue;
    names[v] = static_cast<uint32_t>(around.positions.size());
    around.positions.push_back(whole.positions[v]);
    parts.around_vertices.push_back(v);
  }
  for (const uint32_t f : parts.around_faces) {
    Triangle t;
    for (int i = 0; i < 3; ++i) t[i] = VertexId(names[whole.triangles[f][i].index()]);
    around.triangles.push_back(t);
  }
  return around;
}

std::unique_ptr<MeshSurface> CutOutRegion(const RegionParts& parts) {
  return MeshSurface::CreatePart(parts.around, parts.around_chosen);
}

std::vector<uint32_t> BorderOf(const RegionParts& parts, const MeshSurface& region) {
  std::vector<uint32_t> border;
  for (const uint32_t v : region.border_vertices()) {
    const VertexId around(region.vertices_of_whole()[v]);
    border.push_back(parts.around_vertices[parts.around->OriginalOf(around)]);
  }
  return border;
}

void CompareWithInput(const TriangleMesh& input, bool is_repaired, RegionParts& parts) {
  if (!is_repaired) {
    for (uint32_t f = 0; f < parts.chosen.size() && parts.patch_only; ++f) {
      if (parts.chosen[f]) parts.report.removed_faces.push_back(f);
    }
    return;
  }
  std::vector<bool> is_kept(input.triangles.size(), false);
  std::vector<bool> is_left(input.triangles.size(), false);
  for (size_t f = 0; f < parts.whole.triangles.size(); ++f) {
    const uint32_t origin = parts.whole.face_origins[f];
    is_left[origin] = true;
    if (parts.chosen[f]) continue;
    is_kept[origin] = true;
    parts.changed_outside += !IsSameFace(input, input.triangles[origin], parts.whole, parts.whole.triangles[f]);
  }
  parts.dropped_outside = std::count(is_left.begin(), is_left.end(), false);
  if (!parts.patch_only) return;
  for (uint32_t f = 0; f < is_kept.size(); ++f) {
    if (!is_kept[f]) parts.report.removed_faces.push_back(f);
  }
}

void AddFacesAround(const RegionParts& parts, TriangleMesh& mesh) {
  const Box3 box = BoundingBox(mesh);
  const TriangleMesh& around = parts.around->mesh();
  for (size_t f = 0; f < around.triangles.size(); ++f) {
    if (parts.around_chosen[f]) continue;
    Box3 own;
    for (const VertexId v : around.triangles[f]) own.Extend(around.PositionAt(v));
    const bool apart = own.max.x < box.min.x || own.max.y < box.min.y || own.max.z < box.min.z ||
                       own.min.x > box.max.x || own.min.y > box.max.y || own.min.z > box.max.z;
    if (apart) continue;
    Triangle t;
    for (int i = 0; i < 3; ++i) {
      t[i] = VertexId(static_cast<uint32_t>(mesh.positions.size()));
      mesh.positions.push_back(around.PositionAt(around.triangles[f][i]));
    }
    mesh.triangles.push_back(t);
  }
}

}  // namespace meshfront
