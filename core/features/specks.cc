//   1. LabelPatches between the creases, and LabelClusters: small patches that touch;
//   2. FindPlanes, FindNormalsAround, MeasureFaces, MeasureCreases: of each cluster its size, what lies around it, and how its creases run;
//   3. IsSpeck.
// Rejected: patch by patch. Of a line of small patches along the edge of a thin wing it takes some and leaves half a crease, where
// the front then runs over itself.
#include "core/features/specks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "core/features/coordinate_rounding.h"
#include "core/features/tolerances.h"

namespace meshfront {
namespace {

// Small patches that touch, and what lies around them.
struct Cluster {
  uint32_t faces = 0;
  double length = 0,
         length_around = 0;   // sums of the longest sides of its faces, and of those of large patches across its rim
  uint32_t sides_around = 0;  // … and how many these are
  uint32_t sea = 0;           // a large patch across the rim: its label
  bool is_inside = true;      // … and there is no other
  Box3 box;
  double cosines = 0;  // of the turns of its creases from edge to edge, …
  uint32_t turns = 0;  // … so many
  bool has_wedge = false;
  Vec3 normal_around;  // of the large patch's face across the rim that rounding turned the least, …
  double tilt_around = std::numeric_limits<double>::infinity();  // … by at most so much
  bool is_flat_around = true,
       turns_around = true;  // … and whether all are alike, and all faces inside of it turn from them
  bool has_plane = false;    // a patch of several faces that is flat
};

class SpeckFinder {
 public:
  SpeckFinder(const TriangleMesh& mesh, const FaceAdjacency& adjacency, const std::vector<bool>& creases,
              uint32_t most_faces)
      : mesh_(mesh),
        adjacency_(adjacency),
        creases_(creases),
        most_(most_faces),
        rounding_(mesh),
        smallest_(kSpeckOfDiagonal * BoundingBox(mesh, adjacency).Diagonal()) {
    for (uint32_t h = 0; h < creases_.size(); ++h) {
      if (creases_[h]) on_crease_.push_back(h);
    }
  }

  std::vector<bool> Run() {
    LabelPatches();
    LabelClusters();
    FindPlanes();
    FindNormalsAround();
    MeasureFaces();
    MeasureCreases();
    std::vector<bool> found(creases_.size());
    for (const uint32_t h : on_crease_) {
      for (const uint32_t f : {h / 3, adjacency_.OppositeOf(h) / 3}) {
        const Cluster* c = ClusterOf(f);
        if (c != nullptr && IsSpeck(*c)) found[h] = true;
      }
    }
    return found;
  }

 private:
  bool IsLarge(uint32_t f) const { return sizes_[patches_.label[f]] > most_; }
  Cluster* ClusterOf(uint32_t f) {
    const auto found = clusters_.find(cluster_of_.label[f]);
    return found == clusters_.end() ? nullptr : &found->second;
  }
  Vec3 DirectionOf(uint32_t h) const {
    return Normalized(mesh_.PositionAt(TargetOf(mesh_, h)) - mesh_.PositionAt(OriginOf(mesh_, h)));
  }
  // Zero where the face has no area.
  Vec3 NormalOf(uint32_t f) const {
    const Triangle& t = mesh_.triangles[f];
    const Vec3 &a = mesh_.PositionAt(t[0]), &b = mesh_.PositionAt(t[1]), &c = mesh_.PositionAt(t[2]);
    return Normalized(Cross(b - a, c - a));
  }
  double LongestLength(uint32_t f) const { return std::sqrt(SquaredLength(mesh_, LongestSide(mesh_, f))); }
  void LabelPatches();
  void LabelClusters();
  // Whether two normals are of one plane, which rounding turned by at most so much together.
  static bool AreAlike(const Vec3& a, const Vec3& b, double tilt) {
    const double angle = std::max(kFlatAngle, std::min(tilt, kMostRoundedAngle));
    return Dot(a, b) > 0 && SquaredNorm(Cross(a, b)) <= angle * angle;
  }
  // The same of two faces' own normals. Rounding is looked at only where it decides.
  bool AreFacesAlike(uint32_t f, const Vec3& here, uint32_t g, const Vec3& there) const {
    const bool is_alike_at_least = AreAlike(here, there, 0),
               is_alike_at_most = AreAlike(here, there, kMostRoundedAngle);
    if (is_alike_at_least == is_alike_at_most) return is_alike_at_least;
    return AreAlike(here, there, TiltOf(f, here) + TiltOf(g, there));
  }
  // Whether a face turns from a plane by more than 20° and what rounding can have made of it.
  static bool TurnsFrom(const Vec3& plane, const Vec3& normal, double tilt) {
    return tilt < 1 && Dot(plane, normal) <= kMeantTurnCosine * (1 - 0.5 * tilt * tilt) - kMeantTurnSine * tilt;
  }
  double TiltOf(uint32_t f, const Vec3& normal) const { return rounding_.TiltOf(mesh_, f, normal); }
  void FindPlanes();
  void FindNormalsAround();
  void MeasureFaces();
  void MeasureSide(uint32_t inside, uint32_t across, Cluster& c) const;
  void MeasureCreases();
  void MeasureTurn(uint32_t in, uint32_t out);
  bool IsMeant(const Cluster& c) const { return c.is_flat_around && c.turns_around && c.has_plane; }
  bool IsSpeck(const Cluster& c) const;

  const TriangleMesh& mesh_;
  const FaceAdjacency& adjacency_;
  const std::vector<bool>& creases_;
  std::vector<uint32_t> on_crease_;  // half-edges, in their order
  const uint32_t most_;
  const CoordinateRounding rounding_;
  const double smallest_;
  FaceComponents patches_, cluster_of_;
  std::vector<uint32_t> sizes_;        // of each patch, in faces
  std::vector<uint32_t> small_faces_;  // those of small patches, in their order
  std::vector<bool> is_plane_;         // likewise: several faces in one plane
  std::map<uint32_t, Cluster> clusters_;
};

void SpeckFinder::LabelPatches() {
  FaceAdjacency cut{adjacency_.opposite, {}};
  for (const uint32_t h : on_crease_) cut.opposite[h / 3][h % 3] = kNoHalfEdge;
  patches_ = LabelComponents(cut);
  sizes_.assign(patches_.count, 0);
  for (const uint32_t label : patches_.label) ++sizes_[label];
  for (uint32_t f = 0; f < patches_.label.size(); ++f) {
    if (!IsLarge(f)) small_faces_.push_back(f);
  }
}

// Large faces are in none.
void SpeckFinder::LabelClusters() {
  cluster_of_.label.assign(mesh_.triangles.size(), kNoHalfEdge);
  std::vector<uint32_t> pending;
  for (const uint32_t seed : small_faces_) {
    if (cluster_of_.label[seed] != kNoHalfEdge) continue;
    cluster_of_.label[seed] = cluster_of_.count;
    for (pending.push_back(seed); !pending.empty();) {
      const uint32_t f = pending.back();
      pending.pop_back();
      for (const uint32_t h : adjacency_.opposite[f]) {
        if (h == kNoHalfEdge || IsLarge(h / 3) || cluster_of_.label[h / 3] != kNoHalfEdge) continue;
        cluster_of_.label[h / 3] = cluster_of_.count;
        pending.push_back(h / 3);
      }
    }
    ++cluster_of_.count;
  }
}

// Of small patches alone: there are few faces in them.
void SpeckFinder::FindPlanes() {
  is_plane_.resize(patches_.count);
  for (uint32_t label = 0; label < patches_.count; ++label) is_plane_[label] = sizes_[label] > 1;
  for (const uint32_t f : small_faces_) {
    const Vec3 here = NormalOf(f);
    for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
      const uint32_t across = adjacency_.OppositeOf(h);
      if (creases_[h] || across == kNoHalfEdge) continue;
      const Vec3 there = NormalOf(across / 3);
      if (!AreFacesAlike(f, here, across / 3, there)) is_plane_[patches_.label[f]] = false;
    }
  }
}

void SpeckFinder::FindNormalsAround() {
  for (const uint32_t h : on_crease_) {
    const uint32_t across = adjacency_.OppositeOf(h) / 3;
    if (IsLarge(h / 3) || !IsLarge(across)) continue;
    Cluster& c = clusters_[cluster_of_.label[h / 3]];
    const Vec3 normal = NormalOf(across);
    const double tilt = TiltOf(across, normal);
    if (tilt < c.tilt_around) c.normal_around = normal, c.tilt_around = tilt;
  }
}

void SpeckFinder::MeasureSide(uint32_t inside, uint32_t across, Cluster& c) const {
  const uint32_t sea = patches_.label[across];
  const Vec3 normal = NormalOf(across), normal_inside = NormalOf(inside);
  c.is_inside = c.is_inside && (c.sides_around == 0 || c.sea == sea);
  const double tilt = TiltOf(across, normal);
  const bool says_nothing = tilt > kMostRoundedAngle && c.tilt_around <= kMostRoundedAngle;  // a sliver
  c.is_flat_around = c.is_flat_around && (says_nothing || AreAlike(normal, c.normal_around, tilt + c.tilt_around));
  c.turns_around = c.turns_around && TurnsFrom(c.normal_around, normal_inside, TiltOf(inside, normal_inside));
  c.sea = sea;
  c.length_around += LongestLength(across);
  ++c.sides_around;
}

void SpeckFinder::MeasureFaces() {
  for (const uint32_t f : small_faces_) {
    Cluster& c = clusters_[cluster_of_.label[f]];
    ++c.faces;
    c.length += LongestLength(f);
    c.has_plane = c.has_plane || is_plane_[patches_.label[f]];
    for (const VertexId v : mesh_.triangles[f]) c.box.Extend(mesh_.PositionAt(v));
    for (const uint32_t across : adjacency_.opposite[f]) {
      if (across != kNoHalfEdge && IsLarge(across / 3)) MeasureSide(f, across / 3, c);
    }
  }
}

// Where two creases meet at a vertex and no more: how far the line turns there. And anywhere: whether two leave side by side.
void SpeckFinder::MeasureCreases() {
  std::vector<uint32_t> leaving;
  std::vector<uint8_t> is_at_crease(mesh_.positions.size(), 0);
  for (const uint32_t h : on_crease_) is_at_crease[OriginOf(mesh_, h).index()] = 1;
  for (uint32_t v = 0; v < mesh_.positions.size(); ++v) {
    if (!is_at_crease[v]) continue;
    leaving.clear();
    VisitOutgoing(adjacency_, v, [&](uint32_t h) {
      if (creases_[h]) leaving.push_back(h);
    });
    if (leaving.size() == 2 && !adjacency_.IsRimVertex(v)) MeasureTurn(leaving[0], leaving[1]);
    for (size_t i = 0; i < leaving.size(); ++i) {
      for (size_t k = 0; k < i; ++k) {
        if (Dot(DirectionOf(leaving[i]), DirectionOf(leaving[k])) < kWedgeCosine) continue;
        for (const uint32_t h : {leaving[i], leaving[k]}) {
          if (Cluster* c = ClusterOf(h / 3)) c->has_wedge = true;
        }
      }
    }
  }
}

void SpeckFinder::MeasureTurn(uint32_t in, uint32_t out) {
  Cluster* c = ClusterOf(in / 3);
  if (c == nullptr) c = ClusterOf(adjacency_.OppositeOf(in) / 3);
  if (c == nullptr) return;
  c->cosines -= Dot(DirectionOf(in), DirectionOf(out));
  ++c->turns;
}

bool SpeckFinder::IsSpeck(const Cluster& c) const {
  if (c.sides_around == 0 || !c.is_inside || c.faces > most_) return false;
  const uint32_t sea = sizes_[c.sea];
  const bool in_sea = sea > kIslandsSea;
  if (in_sea && c.box.Diagonal() < smallest_) return true;
  if (IsMeant(c)) return false;
  if (c.length / c.faces <= kSpeckFineness * c.length_around / c.sides_around) return false;
  const bool is_few = c.faces <= kSpeckFaces;
  // Of a spike all edges end in nodes: there is hardly a line that could zigzag.
  const bool zigzags = c.cosines < kZigzagCosine * c.turns || (is_few && 2 * c.turns < c.faces);
  if (zigzags && is_few && in_sea) return true;
  if ((zigzags || c.has_wedge) && sea >= kSeaPerSpeck * c.faces) return true;
  return is_few && sea >= kSeaPerSmoothSpeck * c.faces;
}

}  // namespace

std::vector<bool> FindSpecks(const TriangleMesh& mesh, const FaceAdjacency& adjacency, const std::vector<bool>& creases,
                             uint32_t most_faces) {
  if (std::find(creases.begin(), creases.end(), true) == creases.end()) return std::vector<bool>(creases.size());
  return SpeckFinder(mesh, adjacency, creases, most_faces).Run();
}

}  // namespace meshfront
