#include "core/region_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/geometry/box.h"

namespace meshfront {
namespace {

constexpr int kRingsAround = 4;  // one more than the curvature fit looks at

// The faces of the surroundings, one flag each.
std::vector<uint8_t> MarkSurroundings(const PreparedInput& input, const std::vector<uint32_t>& chosen, double reach) {
  const TriangleMesh& mesh = input.mesh();
  Box3 box;
  std::vector<uint8_t> touched(mesh.positions.size(), 0), marked(mesh.triangles.size(), 0);
  std::vector<uint32_t> ring, next;  // vertices
  const auto touch = [&](VertexId v, std::vector<uint32_t>& list) {
    if (!touched[v.index()]) touched[v.index()] = 1, list.push_back(v.index());
  };
  for (const uint32_t f : chosen) {
    marked[f] = 1;
    for (const VertexId v : mesh.triangles[f]) box.Extend(mesh.PositionAt(v)), touch(v, ring);
  }
  for (int i = 0; i < kRingsAround; ++i) {
    next.clear();
    for (const uint32_t v : ring) {
      VisitOutgoing(input.adjacency(), v, [&](uint32_t h) {
        marked[h / 3] = 1;
        for (const VertexId u : mesh.triangles[h / 3]) touch(u, next);
      });
    }
    std::swap(ring, next);
  }
  const double reach2 = reach * reach;
  for (size_t v = 0; v < touched.size(); ++v) touched[v] = box.SquaredDistanceTo(mesh.positions[v]) <= reach2;
  for (size_t f = 0; f < marked.size(); ++f) {
    const Triangle& t = mesh.triangles[f];
    marked[f] |= touched[t[0].index()] | touched[t[1].index()] | touched[t[2].index()];
  }
  return marked;
}

}  // namespace

namespace {

// Those of some faces, with the wedges that they use.
MeshAttributes CutOutAttributes(const MeshAttributes& whole, const std::vector<uint32_t>& faces) {
  constexpr uint32_t unnamed = 0xffffffffu;
  MeshAttributes part;
  part.channels = whole.channels;
  std::vector<uint32_t> names(whole.wedge_count(), unnamed);
  uint32_t count = 0;
  for (const uint32_t f : faces) {
    if (!whole.groups.empty()) part.groups.push_back(whole.groups[f]);
    if (whole.corners.empty()) continue;
    CornerWedges corners = whole.corners[f];
    for (uint32_t& w : corners) {
      if (names[w] == unnamed) {
        names[w] = count++;
        const absl::Span<const float> values = whole.WedgeAt(w);
        part.values.insert(part.values.end(), values.begin(), values.end());
      }
      w = names[w];
    }
    part.corners.push_back(corners);
  }
  return part;
}

}  // namespace

TriangleMesh CutOutSurroundings(double reach, const RegionParts& parts) {
  const TriangleMesh& whole = parts.whole();
  const std::vector<uint8_t> marked = MarkSurroundings(*parts.input, parts.chosen_faces, reach);
  TriangleMesh around;
  std::vector<uint32_t>& faces = around.face_origins;
  constexpr uint32_t unused = 0xffffffffu;
  std::vector<uint32_t> names(whole.positions.size(), unused);
  for (uint32_t f = 0; f < marked.size(); ++f) {
    if (!marked[f]) continue;
    faces.push_back(f);
    for (const VertexId v : whole.triangles[f]) names[v.index()] = 0;
  }
  for (uint32_t v = 0; v < names.size(); ++v) {
    if (names[v] == unused) continue;
    names[v] = static_cast<uint32_t>(around.positions.size());
    around.positions.push_back(whole.positions[v]);
  }
  for (const uint32_t f : faces) {
    Triangle t;
    for (int i = 0; i < 3; ++i) t[i] = VertexId(names[whole.triangles[f][i].index()]);
    around.triangles.push_back(t);
  }
  if (parts.keeps_attributes) around.attributes = CutOutAttributes(whole.attributes, faces);
  return around;
}

std::vector<bool> FacesBesideRegion(const TriangleMesh& around, const RegionParts& parts) {
  std::vector<bool> beside;
  beside.reserve(around.face_origins.size());
  for (const uint32_t f : around.face_origins) beside.push_back(!parts.chosen[f]);
  return beside;
}

void NameSurroundings(TriangleMesh& around, double scale, RegionParts& parts) {
  const TriangleMesh& whole = parts.whole();
  parts.around_vertices.assign(around.positions.size(), 0);
  for (size_t i = 0; i < around.triangles.size(); ++i) {
    const uint32_t f = around.face_origins[i];
    const Triangle &t = around.triangles[i], &original = whole.triangles[f];
    bool is_same = true;
    for (int k = 0; k < 3; ++k) is_same = is_same && around.PositionAt(t[k]) == whole.PositionAt(original[k]) * scale;
    for (int k = 0; k < 3 && is_same; ++k) parts.around_vertices[t[k].index()] = original[k].index();
    parts.around_chosen.push_back(parts.chosen[f]);
    parts.diagonals.push_back(parts.input->ComponentDiagonalAt(f));
    if (!parts.chosen[f]) continue;
    parts.region_faces.push_back(is_same ? f : kNoFace);
    parts.region_origins.push_back(f);
  }
  around.face_origins = {};
}

MeshAttributes AttributesOfRegion(const RegionParts& parts, MeshAttributes around) {
  if (around.empty()) return around;
  std::vector<uint32_t> faces;
  for (uint32_t f = 0; f < parts.around_chosen.size(); ++f) {
    if (parts.around_chosen[f]) faces.push_back(f);
  }
  return CutOutAttributes(around, faces);
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

UnevenBorder MostUnevenBorder(const RegionParts& parts) {
  const TriangleMesh& mesh = parts.whole();
  const FaceAdjacency& adjacency = parts.input->adjacency();
  struct Lengths {
    double shortest2 = std::numeric_limits<double>::infinity(), longest2 = 0;
  };
  std::map<VertexId, Lengths> at;
  for (const uint32_t f : parts.chosen_faces) {
    for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
      const uint32_t across = adjacency.OppositeOf(h);
      if (across == kNoHalfEdge || parts.chosen[across / 3]) continue;
      const double length2 = SquaredLength(mesh, h);
      for (const VertexId v : {OriginOf(mesh, h), TargetOf(mesh, h)}) {
        Lengths& lengths = at[v];
        lengths.shortest2 = std::min(lengths.shortest2, length2);
        lengths.longest2 = std::max(lengths.longest2, length2);
      }
    }
  }
  UnevenBorder most;
  for (const auto& [v, lengths] : at) {
    const double ratio = std::sqrt(lengths.longest2 / lengths.shortest2);
    if (ratio > most.ratio) most = {ratio, mesh.PositionAt(v)};
  }
  return most;
}

void CompareWithInput(RegionParts& parts) {
  const PreparedInput& input = *parts.input;
  const std::vector<uint32_t>& origins = parts.whole().face_origins;
  std::vector<uint32_t>& removed = parts.report.removed_faces;
  parts.dropped_outside = input.dropped_faces().size();
  parts.changed_outside = input.changed_faces();
  for (const uint32_t f : parts.chosen_faces) {
    parts.changed_outside -= input.IsChanged(f);
    if (parts.patch_only) removed.push_back(origins[f]);
  }
  if (!parts.patch_only) return;
  removed.insert(removed.end(), input.dropped_faces().begin(), input.dropped_faces().end());
  std::sort(removed.begin(), removed.end());
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
