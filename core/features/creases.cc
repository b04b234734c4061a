//   1. FaceNormals, of slivers from the face across their longest side;
//   2. MarkSharp: edges that turn by more than the angle;
//   3. BridgeGaps: from where such a line ends, straight on over weaker edges until it meets a line again;
//   4. DropSpurs: lines that end inside a patch, from their ends back to where they meet others;
//   5. DropSpecks: patches of few faces inside one large patch that are no finer than it, with creases that zigzag or meet at a
//      needle's angle; first by themselves, then as clusters of patches that touch.
// Rejected: the threshold alone. A scan of 100,000 triangles has 12,000 edges beyond 40°, and 500 places that they close around.
#include "core/features/creases.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "core/base/status_macros.h"
#include "core/features/tolerances.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

class CreaseFinder {
 public:
  CreaseFinder(const TriangleMesh& mesh, const FaceAdjacency& adjacency, double angle)
      : mesh_(mesh),
        adjacency_(adjacency),
        sharp_cosine_(std::cos(angle)),
        weak_cosine_(std::cos(kWeakCrease * angle)),
        crease_(3 * mesh.triangles.size(), false),
        degree_(mesh.positions.size(), 0) {}

  absl::StatusOr<std::vector<bool>> Run(const Context& context) {
    FindFaceNormals();
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    if (!MarkSharp()) return std::move(crease_);
    BridgeGaps();
    MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
    DropSpurs();
    for (const uint32_t most : {kSpeckFaces, kMaxSpeckFaces}) {
      DropSpecks(most);
      DropSpurs();
    }
    return std::move(crease_);
  }

 private:
  uint32_t HalfEdges() const { return static_cast<uint32_t>(crease_.size()); }
  uint32_t Origin(uint32_t h) const { return OriginOf(mesh_, h).index(); }
  uint32_t Target(uint32_t h) const { return TargetOf(mesh_, h).index(); }
  const Vec3& Place(uint32_t v) const { return mesh_.positions[v]; }

  void FindFaceNormals();
  bool MarkSharp();
  void BridgeGaps();
  bool Bridge(uint32_t from, std::vector<uint32_t>& way) const;
  void DropSpurs();
  void DropSpecks(uint32_t most);

  double CosineAt(uint32_t h) const { return Dot(normals_[h / 3], normals_[adjacency_.OppositeOf(h) / 3]); }
  void Set(uint32_t h, bool value) {
    const uint32_t other = adjacency_.OppositeOf(h);
    if (crease_[h] == value) return;
    crease_[h] = crease_[other] = value;
    for (const uint32_t v : {Origin(h), Target(h)}) degree_[v] += value ? 1 : -1;
  }
  // Calls visit(h) for the half-edges that leave v, each inner edge once; a rim's last edge is left out.
  template <class Visit>
  void VisitOutgoing(uint32_t v, Visit visit) const {
    const uint32_t first = adjacency_.outgoing[v];
    for (uint32_t h = first; h != kNoHalfEdge;) {
      if (adjacency_.OppositeOf(h) != kNoHalfEdge) visit(h);
      h = adjacency_.NextAroundOrigin(h);
      if (h == first) return;
    }
  }

  const TriangleMesh& mesh_;
  const FaceAdjacency& adjacency_;
  const double sharp_cosine_, weak_cosine_;
  std::vector<Vec3> normals_;
  std::vector<bool> crease_;
  std::vector<int> degree_;  // creases at each vertex; on the rim two more
};

void CreaseFinder::FindFaceNormals() {
  const size_t n = mesh_.triangles.size();
  normals_.resize(n);
  std::vector<uint32_t> slivers;
  for (uint32_t f = 0; f < n; ++f) {
    const Triangle& t = mesh_.triangles[f];
    const Vec3 area = AreaVector(mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1]), mesh_.PositionAt(t[2]));
    double longest2 = 0;
    for (int i = 0; i < 3; ++i)
      longest2 = std::max(longest2, SquaredDistance(mesh_.PositionAt(t[i]), mesh_.PositionAt(t[(i + 1) % 3])));
    normals_[f] = Normalized(area);
    if (Norm(area) < kSliverHeight * longest2) slivers.push_back(f);
  }
  for (const uint32_t f : slivers) {
    const Triangle& t = mesh_.triangles[f];
    int longest = 0;
    const auto length2 = [&](int i) {
      return SquaredDistance(mesh_.PositionAt(t[i]), mesh_.PositionAt(t[(i + 1) % 3]));
    };
    for (int i = 1; i < 3; ++i) longest = length2(i) > length2(longest) ? i : longest;
    const uint32_t across = adjacency_.opposite[f][longest];
    if (across != kNoHalfEdge) normals_[f] = normals_[across / 3];
  }
}

bool CreaseFinder::MarkSharp() {
  bool any = false;
  for (uint32_t h = 0; h < HalfEdges(); ++h) {
    const uint32_t other = adjacency_.OppositeOf(h);
    if (other == kNoHalfEdge) {
      ++degree_[Origin(h)], ++degree_[Target(h)];
    } else if (other > h && CosineAt(h) < sharp_cosine_) {
      Set(h, true);
      any = true;
    }
  }
  return any;
}

// The way from the end of a line, along the sharpest edges that go straight on, to the next line; false when there is none near by.
bool CreaseFinder::Bridge(uint32_t from, std::vector<uint32_t>& way) const {
  way.clear();
  uint32_t at = from;
  Vec3 direction;
  VisitOutgoing(from, [&](uint32_t h) {
    if (crease_[h]) direction = Normalized(Place(from) - Place(Target(h)));
  });
  for (int step = 0; step < kMaxBridge; ++step) {
    uint32_t best = kNoHalfEdge;
    double best_cosine = weak_cosine_;
    VisitOutgoing(at, [&](uint32_t h) {
      const Vec3 along = Normalized(Place(Target(h)) - Place(at));
      if (crease_[h] || Dot(along, direction) < kBridgeStraightness || CosineAt(h) >= best_cosine) return;
      best = h, best_cosine = CosineAt(h);
    });
    if (best == kNoHalfEdge) return false;
    way.push_back(best);
    direction = Normalized(Place(Target(best)) - Place(at));
    at = Target(best);
    if (at == from) return false;
    if (degree_[at] > 0) return true;
  }
  return false;
}

void CreaseFinder::BridgeGaps() {
  std::vector<uint32_t> way;
  for (uint32_t v = 0; v < degree_.size(); ++v) {
    if (degree_[v] != 1 || !Bridge(v, way)) continue;
    for (const uint32_t h : way) Set(h, true);
  }
}

void CreaseFinder::DropSpurs() {
  std::vector<uint32_t> ends;
  for (uint32_t v = 0; v < degree_.size(); ++v) {
    if (degree_[v] == 1) ends.push_back(v);
  }
  while (!ends.empty()) {
    const uint32_t v = ends.back();
    ends.pop_back();
    uint32_t last = kNoHalfEdge;
    VisitOutgoing(v, [&](uint32_t h) {
      if (crease_[h]) last = h;
    });
    if (degree_[v] != 1 || last == kNoHalfEdge) continue;
    Set(last, false);
    if (degree_[Target(last)] == 1) ends.push_back(Target(last));
  }
}

// Clusters of small patches with one large patch around them, whose faces are as large as those around: noise, or what the input
// does not resolve.
void CreaseFinder::DropSpecks(uint32_t most) {
  const size_t n = mesh_.triangles.size();
  FaceAdjacency cut{adjacency_.opposite, {}};
  for (uint32_t h = 0; h < HalfEdges(); ++h) {
    if (crease_[h]) cut.opposite[h / 3][h % 3] = kNoHalfEdge;
  }
  const FaceComponents patches = LabelComponents(cut);
  std::vector<uint32_t> sizes(patches.count, 0);
  for (const uint32_t label : patches.label) ++sizes[label];
  // Small patches that touch are one cluster: faces connected over anything but large patches.
  FaceAdjacency small = {adjacency_.opposite, {}};
  for (uint32_t f = 0; f < n; ++f) {
    for (uint32_t& across : small.opposite[f]) {
      if (across == kNoHalfEdge) continue;
      if (sizes[patches.label[f]] > most || sizes[patches.label[across / 3]] > most) across = kNoHalfEdge;
    }
  }
  const FaceComponents clusters = LabelComponents(small);
  struct Cluster {
    uint32_t faces = 0, large = kNoHalfEdge;
    bool is_inside = true;  // one large patch
    bool is_speck = false;
    double length = 0, length_around = 0;  // sums of the faces' longest sides
    uint32_t around = 0, most_around = 0;  // sides towards large patches, and faces of the largest
    Box3 box;
    double cosines = 0;  // of the turns of its creases from edge to edge
    uint32_t turns = 0;
    bool has_wedge = false;  // two of its creases leave a vertex in almost the same direction
  };
  std::map<uint32_t, Cluster> found;
  const double diagonal = BoundingBox(mesh_, adjacency_).Diagonal();
  const auto longest_of = [&](uint32_t f) {
    const Triangle& t = mesh_.triangles[f];
    double longest2 = 0;
    for (int i = 0; i < 3; ++i)
      longest2 = std::max(longest2, SquaredDistance(mesh_.PositionAt(t[i]), mesh_.PositionAt(t[(i + 1) % 3])));
    return std::sqrt(longest2);
  };
  for (uint32_t f = 0; f < n; ++f) {
    if (sizes[patches.label[f]] > most) continue;
    Cluster& c = found[clusters.label[f]];
    ++c.faces;
    c.length += longest_of(f);
    for (const VertexId v : mesh_.triangles[f]) c.box.Extend(mesh_.PositionAt(v));
    for (const uint32_t across : adjacency_.opposite[f]) {
      if (across == kNoHalfEdge || sizes[patches.label[across / 3]] <= most) continue;
      const uint32_t other = patches.label[across / 3];
      c.is_inside = c.is_inside && (c.large == kNoHalfEdge || c.large == other);
      c.large = other;
      c.most_around = std::max(c.most_around, sizes[other]);
      c.length_around += longest_of(across / 3), ++c.around;
    }
  }
  for (uint32_t v = 0; v < degree_.size(); ++v) {
    uint32_t edges[2] = {kNoHalfEdge, kNoHalfEdge};
    if (degree_[v] != 2) continue;
    VisitOutgoing(v, [&](uint32_t h) {
      if (crease_[h]) edges[edges[0] != kNoHalfEdge] = h;
    });
    if (edges[1] == kNoHalfEdge) continue;
    auto c = found.find(clusters.label[edges[0] / 3]);
    if (c == found.end()) c = found.find(clusters.label[adjacency_.OppositeOf(edges[0]) / 3]);
    if (c == found.end()) continue;
    const Vec3 in = Place(v) - Place(Target(edges[0])), out = Place(Target(edges[1])) - Place(v);
    c->second.cosines += Dot(Normalized(in), Normalized(out));
    ++c->second.turns;
  }
  std::vector<uint32_t> leaving;
  for (uint32_t v = 0; v < degree_.size(); ++v) {
    if (degree_[v] < 2) continue;
    leaving.clear();
    VisitOutgoing(v, [&](uint32_t h) {
      if (crease_[h]) leaving.push_back(h);
    });
    for (size_t i = 0; i < leaving.size(); ++i) {
      for (size_t k = 0; k < i; ++k) {
        const Vec3 a = Normalized(Place(Target(leaving[i])) - Place(v));
        if (Dot(a, Normalized(Place(Target(leaving[k])) - Place(v))) < kWedgeCosine) continue;
        for (const uint32_t h : {leaving[i], leaving[k]}) {
          const auto c = found.find(clusters.label[h / 3]);
          if (c != found.end()) c->second.has_wedge = true;
        }
      }
    }
  }
  for (auto& [label, c] : found) {
    const bool is_fine = c.length / c.faces <= kSpeckFineness * c.length_around / c.around;
    const bool is_small = c.box.Diagonal() < kSpeckOfDiagonal * diagonal;
    // Or has hardly a way that could: a spike's edges all end in nodes.
    bool zigzags = c.cosines < kZigzagCosine * c.turns || (2 * c.turns < c.faces && c.faces <= kSpeckFaces);
    const bool is_island = c.is_inside && c.most_around > kIslandsSea;
    const bool is_few = c.faces <= kSpeckFaces;
    const bool is_lost = c.most_around >= kLargePerSpeck * c.faces;
    const bool is_lost_smooth = is_few && c.most_around >= kLargePerSmoothSpeck * c.faces;
    zigzags = zigzags || (is_lost && c.has_wedge);
    const bool may_go = (zigzags && (is_lost || (is_island && is_few))) || is_lost_smooth;
    c.is_speck = c.around > 0 && c.faces <= most && c.is_inside && ((may_go && !is_fine) || (is_island && is_small));
  }
  for (uint32_t h = 0; h < HalfEdges(); ++h) {
    if (!crease_[h]) continue;
    const auto in_speck = [&](uint32_t f) {
      const auto c = found.find(clusters.label[f]);
      return c != found.end() && c->second.is_speck;
    };
    if (in_speck(h / 3) || in_speck(adjacency_.OppositeOf(h) / 3)) Set(h, false);
  }
}

}  // namespace

absl::StatusOr<std::vector<bool>> FindCreases(const TriangleMesh& mesh, const FaceAdjacency& adjacency, double angle,
                                              const Context& context) {
  return CreaseFinder(mesh, adjacency, angle).Run(context);
}

}  // namespace meshfront
