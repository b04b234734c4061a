// 1. MarkGroups, MarkValues: edges whose sides differ    2. MarkEnds: where a seam runs out    3. MarkMirrors    4. MarkNormals
// Rejected: wedges that differ as seams. Exporters split vertices where nothing differs, or only the tangent, or the last bit.
#include "core/features/attribute_seams.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "core/features/tolerances.h"
#include "core/geometry/triangle.h"
#include "core/mesh/union_find.h"

namespace meshfront {
namespace {

class SeamFinder {
 public:
  SeamFinder(const TriangleMesh& mesh, const FaceAdjacency& adjacency, std::vector<bool>& creases)
      : mesh_(mesh), attributes_(mesh.attributes), adjacency_(adjacency), creases_(creases) {}

  bool Run() {
    MarkGroups();
    if (attributes_.corners.empty()) return false;
    FindTolerances();
    MarkValues();
    MarkMirrors();
    return MarkNormals();
  }

 private:
  struct Compared {
    uint32_t offset;  // in a wedge
    float tolerance;
  };
  template <class Visit>
  void VisitInner(Visit visit) const {
    for (uint32_t h = 0; h < creases_.size(); ++h) {
      const uint32_t across = adjacency_.OppositeOf(h);
      if (across != kNoHalfEdge && across > h) visit(h, across);
    }
  }
  // Each component of each channel, with its place in a wedge.
  template <class Visit>
  void VisitChannels(Visit visit) const {
    uint32_t offset = 0;
    for (const AttributeChannel& c : attributes_.channels) {
      for (uint32_t i = 0; i < c.components; ++i) visit(c, offset++);
    }
  }
  void Set(uint32_t h) { creases_[h] = creases_[adjacency_.OppositeOf(h)] = true; }
  uint32_t WedgeOf(uint32_t h) const { return attributes_.corners[h / 3][h % 3]; }

  void MarkGroups();
  void FindTolerances();
  bool Differ(uint32_t w, uint32_t x) const;
  void MarkValues();
  void MarkMirrors();
  std::vector<int8_t> Unfoldings(uint32_t offset) const;
  bool MarkNormals();
  Vec3 NormalAt(uint32_t wedge, uint32_t offset) const;

  const TriangleMesh& mesh_;
  const MeshAttributes& attributes_;
  const FaceAdjacency& adjacency_;
  std::vector<bool>& creases_;
  std::vector<Compared> compared_;
};

void SeamFinder::MarkGroups() {
  VisitInner([&](uint32_t h, uint32_t across) {
    if (attributes_.GroupOf(h / 3) != attributes_.GroupOf(across / 3)) Set(h);
  });
}

void SeamFinder::FindTolerances() {
  const uint32_t stride = attributes_.Stride();
  std::vector<float> least(stride, std::numeric_limits<float>::max()), most(stride, -least[0]);
  for (uint32_t w = 0; w < attributes_.wedge_count(); ++w) {
    const absl::Span<const float> values = attributes_.WedgeAt(w);
    for (uint32_t i = 0; i < stride; ++i)
      least[i] = std::min(least[i], values[i]), most[i] = std::max(most[i], values[i]);
  }
  std::map<std::string, float, std::less<>>
      morph_ranges;  // of all targets' together: what is small to the largest is nothing
  VisitChannels([&](const AttributeChannel& c, uint32_t i) {
    const std::optional<MorphName> morph = MorphNameOf(c.name);
    if (!morph) return;
    float& range = morph_ranges[std::string(morph->attribute)];
    range = std::max(range, most[i] - least[i]);
  });
  VisitChannels([&](const AttributeChannel& c, uint32_t i) {
    const std::optional<MorphName> morph = MorphNameOf(c.name);
    const AttributeRole role = RoleOfName(morph ? morph->attribute : c.name);
    if (role != AttributeRole::kTexcoord && role != AttributeRole::kColour && role != AttributeRole::kCustom) return;
    const float relative = kSeamPerRange * (morph ? morph_ranges.find(morph->attribute)->second : most[i] - least[i]);
    compared_.push_back({i, role == AttributeRole::kColour ? std::max(relative, kColourSeam) : relative});
  });
}

bool SeamFinder::Differ(uint32_t w, uint32_t x) const {
  if (w == x) return false;
  const absl::Span<const float> of_w = attributes_.WedgeAt(w), of_x = attributes_.WedgeAt(x);
  return std::any_of(compared_.begin(), compared_.end(),
                     [&](const Compared& c) { return std::abs(of_w[c.offset] - of_x[c.offset]) > c.tolerance; });
}

void SeamFinder::MarkValues() {
  if (compared_.empty()) return;
  std::vector<uint8_t> ends_here(mesh_.positions.size(), 0);  // edges that differ at this end only
  std::vector<std::array<uint32_t, 2>> one_ended;             // half-edge, and the vertex where it differs
  VisitInner([&](uint32_t h, uint32_t across) {
    const bool at_origin = Differ(WedgeOf(h), WedgeOf(NextHalfEdge(across)));
    const bool at_target = Differ(WedgeOf(NextHalfEdge(h)), WedgeOf(across));
    if (at_origin && at_target) Set(h);
    if (at_origin == at_target) return;
    const uint32_t v = (at_origin ? OriginOf(mesh_, h) : TargetOf(mesh_, h)).index();
    one_ended.push_back({h, v});
    if (ends_here[v] < 255) ++ends_here[v];
  });
  for (const auto& [h, v] : one_ended) {
    if (ends_here[v] <= kMostEndsOfSeams) Set(h);
  }
}

// Of each face whether its texture is seen from its front (1) or from behind (−1); 0 where that is not clear, or only of few faces.
std::vector<int8_t> SeamFinder::Unfoldings(uint32_t offset) const {
  const auto n = static_cast<uint32_t>(mesh_.triangles.size());
  std::vector<int8_t> side(n);
  for (uint32_t f = 0; f < n; ++f) {
    double u[3], v[3];
    for (int i = 0; i < 3; ++i) {
      const absl::Span<const float> values = attributes_.WedgeAt(attributes_.corners[f][i]);
      u[i] = values[offset], v[i] = values[offset + 1];
    }
    const double area = (u[1] - u[0]) * (v[2] - v[0]) - (u[2] - u[0]) * (v[1] - v[0]);
    side[f] = area > 0 ? 1 : area < 0 ? -1 : 0;
  }
  UnionFind parts(n);
  VisitInner([&](uint32_t h, uint32_t across) {
    if (!creases_[h] && side[h / 3] == side[across / 3]) parts.Unite(h / 3, across / 3);
  });
  std::vector<uint32_t> sizes(n, 0);
  for (uint32_t f = 0; f < n; ++f) ++sizes[parts.Find(f)];
  for (uint32_t f = 0; f < n; ++f) {
    if (sizes[parts.Find(f)] < kLeastMirroredFaces) side[f] = 0;
  }
  return side;
}

void SeamFinder::MarkMirrors() {
  uint32_t offset = 0;
  for (const AttributeChannel& c : attributes_.channels) {
    if (RoleOfName(c.name) == AttributeRole::kTexcoord && c.components >= 2) {
      const std::vector<int8_t> side = Unfoldings(offset);
      VisitInner([&](uint32_t h, uint32_t across) {
        if (side[h / 3] * side[across / 3] < 0) Set(h);
      });
    }
    offset += c.components;
  }
}

Vec3 SeamFinder::NormalAt(uint32_t wedge, uint32_t offset) const {
  const absl::Span<const float> values = attributes_.WedgeAt(wedge);
  return Normalized(Vec3{values[offset], values[offset + 1], values[offset + 2]});
}

bool SeamFinder::MarkNormals() {
  const std::optional<uint32_t> offset = attributes_.OffsetOf("NORMAL");
  if (!offset) return false;
  std::vector<Vec3> normals;
  normals.reserve(mesh_.triangles.size());
  for (const Triangle& t : mesh_.triangles)
    normals.push_back(Normalized(AreaVector(mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1]), mesh_.PositionAt(t[2]))));
  const auto differ = [&](uint32_t w, uint32_t x) {
    return w != x && Dot(NormalAt(w, *offset), NormalAt(x, *offset)) < kHardNormalCosine;
  };
  size_t edges = 0;
  std::vector<uint32_t> hard;
  VisitInner([&](uint32_t h, uint32_t across) {
    if (creases_[h]) return;
    ++edges;
    if (Dot(normals[h / 3], normals[across / 3]) < kHardNormalCosine &&
        differ(WedgeOf(h), WedgeOf(NextHalfEdge(across))) && differ(WedgeOf(NextHalfEdge(h)), WedgeOf(across)))
      hard.push_back(h);
  });
  if (static_cast<double>(hard.size()) > kFlatShare * static_cast<double>(edges)) return true;
  for (const uint32_t h : hard) Set(h);
  return false;
}

}  // namespace

bool MarkAttributeSeams(const TriangleMesh& mesh, const FaceAdjacency& adjacency, std::vector<bool>& creases) {
  return SeamFinder(mesh, adjacency, creases).Run();
}

}  // namespace meshfront
