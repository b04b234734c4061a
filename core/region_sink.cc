#include "core/region_sink.h"

#include <algorithm>

#include "core/base/status_macros.h"
#include "core/surface/vertex_normals.h"

namespace meshfront {
namespace {

constexpr size_t kTrianglesPerPiece = 8192;
constexpr uint32_t kNoWedge = 0xffffffffu;
// A wedge with this weight at a corner of its face lies there.
constexpr double kAtCorner = 1 - 1e-9;

}  // namespace

void RegionSink::AddRestWedgesOf(uint32_t face, Outgoing& piece) {
  const MeshAttributes& attributes = parts_.whole().attributes;
  if (!attributes.groups.empty()) piece.groups.push_back(attributes.groups[face]);
  if (attributes.corners.empty()) return;
  CornerWedges wedges = attributes.corners[face];
  for (uint32_t& w : wedges) {
    if (rest_wedges_[w] == kNoWedge) {
      rest_wedges_[w] = wedge_count_++;
      piece.wedges.push_back({face, 0, 0, {}});
      const absl::Span<const float> values = attributes.WedgeAt(w);
      piece.values.insert(piece.values.end(), values.begin(), values.end());
    }
    w = rest_wedges_[w];
  }
  piece.corners.push_back(wedges);
}

void RegionSink::AddRestOf(uint32_t face, const std::vector<Vec3>& normals, Outgoing& piece) {
  const TriangleMesh& whole = parts_.whole();
  Triangle t;
  for (int i = 0; i < 3; ++i) {
    const uint32_t v = whole.triangles[face][i].index();
    if (!rest_names_[v].valid()) {
      rest_names_[v] = VertexId(vertex_count_++);
      if (wanted_.details) sent_.positions.push_back(whole.positions[v]);
      piece.vertices.push_back({whole.positions[v], wanted_.details ? normals[v] : Vec3{}});
    }
    t[i] = rest_names_[v];
    if (wanted_.details && last_use_[v] == face && !on_border_[v]) piece.finalised.push_back(t[i]);
  }
  piece.triangles.push_back(t);
  if (wanted_.details) sent_.triangles.push_back(t);
  if (parts_.keeps_attributes) AddRestWedgesOf(face, piece);
}

absl::Status RegionSink::Send(Outgoing& piece) {
  const std::vector<TriangleKind> kinds(piece.triangles.size(), TriangleKind::kConnection);
  MESHFRONT_RETURN_IF_ERROR(next_.Append({piece.vertices,
                                          piece.triangles,
                                          piece.finalised,
                                          border_.size(),
                                          kinds,
                                          piece.wedges,
                                          piece.corners,
                                          {},
                                          piece.values,
                                          piece.groups}));
  piece = {};
  return absl::OkStatus();
}

void RegionSink::FindLastUses() {
  const TriangleMesh& whole = parts_.whole();
  last_use_.assign(whole.positions.size(), 0);
  for (uint32_t f = 0; f < whole.triangles.size(); ++f) {
    if (parts_.chosen[f]) continue;
    for (const VertexId v : whole.triangles[f]) last_use_[v.index()] = f;
  }
}

absl::Status RegionSink::SendRest() {
  border_names_.assign(border_.size(), VertexId());
  if (!wanted_.rest) return absl::OkStatus();
  const TriangleMesh& whole = parts_.whole();
  std::vector<Vec3> normals;
  if (wanted_.details) {
    normals = ComputeVertexNormals(whole);
    sent_.positions.reserve(whole.positions.size());
    sent_.triangles.reserve(whole.triangles.size());
    FindLastUses();
  }
  rest_names_.assign(whole.positions.size(), VertexId());
  on_border_.assign(whole.positions.size(), false);
  for (const uint32_t v : border_) on_border_[v] = true;
  if (parts_.keeps_attributes) rest_wedges_.assign(whole.attributes.wedge_count(), kNoWedge);
  Outgoing piece;
  for (uint32_t f = 0; f < whole.triangles.size(); ++f) {
    if (parts_.chosen[f]) continue;
    AddRestOf(f, normals, piece);
    if (piece.triangles.size() == kTrianglesPerPiece) MESHFRONT_RETURN_IF_ERROR(Send(piece));
  }
  for (size_t i = 0; i < border_.size(); ++i) border_names_[i] = rest_names_[border_[i]];
  return piece.triangles.empty() ? absl::OkStatus() : Send(piece);
}

VertexId RegionSink::NameOf(const OutputVertex& v, std::vector<OutputVertex>& vertices) {
  const bool on_border = v.joint < border_.size();
  if (on_border && border_names_[v.joint].valid()) return border_names_[v.joint];
  const VertexId name(vertex_count_++);
  vertices.push_back(v);
  if (on_border) {
    vertices.back().position = parts_.whole().positions[border_[v.joint]];
    border_names_[v.joint] = name;
  }
  if (wanted_.details) sent_.positions.push_back(vertices.back().position);
  return name;
}

// The rest's wedge that a new one on the border is: the input's corner there has it on this side of every seam.
uint32_t RegionSink::SharedWedge(const OutputWedge& w) const {
  if (rest_wedges_.empty()) return kNoWedge;
  const double weights[3] = {1 - w.u - w.v, w.u, w.v};
  const uint32_t face = parts_.region_faces[w.face];
  if (face == kNoFace) return kNoWedge;
  for (int i = 0; i < 3; ++i) {
    if (weights[i] < kAtCorner) continue;
    if (on_border_[parts_.whole().triangles[face][i].index()])
      return rest_wedges_[parts_.whole().attributes.corners[face][i]];
  }
  return kNoWedge;
}

void RegionSink::NameWedges(const MeshPiece& piece, Outgoing& out) {
  const size_t stride = piece.wedges.empty() ? 0 : piece.wedge_values.size() / piece.wedges.size();
  for (size_t i = 0; i < piece.wedges.size(); ++i) {
    const uint32_t shared = SharedWedge(piece.wedges[i]);
    wedge_names_.push_back(shared != kNoWedge ? shared : wedge_count_++);
    if (shared != kNoWedge) continue;
    out.wedges.push_back(piece.wedges[i]);
    const absl::Span<const float> values = piece.wedge_values.subspan(i * stride, stride);
    out.values.insert(out.values.end(), values.begin(), values.end());
  }
}

absl::Status RegionSink::Append(const MeshPiece& piece) {
  Outgoing out;
  for (const OutputVertex& v : piece.vertices) names_.push_back(NameOf(v, out.vertices));
  NameWedges(piece, out);
  for (const Triangle& t : piece.triangles)
    out.triangles.push_back({names_[t[0].index()], names_[t[1].index()], names_[t[2].index()]});
  for (const CornerWedges& c : piece.corners)
    out.corners.push_back({wedge_names_[c[0]], wedge_names_[c[1]], wedge_names_[c[2]]});
  for (const VertexId v : piece.finalised) out.finalised.push_back(names_[v.index()]);
  if (wanted_.details) sent_.triangles.insert(sent_.triangles.end(), out.triangles.begin(), out.triangles.end());
  return next_.Append({out.vertices,
                       out.triangles,
                       out.finalised,
                       piece.open_front_edges,
                       piece.kinds,
                       out.wedges,
                       out.corners,
                       {},
                       out.values,
                       piece.groups});
}

}  // namespace meshfront
