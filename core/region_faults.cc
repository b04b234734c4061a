#include "core/region_faults.h"

#include <algorithm>
#include <utility>

#include "core/geometry/bvh.h"
#include "core/geometry/triangle.h"
#include "core/mesh/adjacency.h"

namespace meshfront {
namespace {

constexpr int kMostRounds = 5, kRoundsAtPlaces = 2;
// In parts of g.
constexpr double kFirstReach = 2;

class FaultyFaces {
 public:
  explicit FaultyFaces(const Preparation& p)
      : p_(p),
        mesh_(p.surface->MeshBeforeCut()),
        tree_(mesh_.positions, mesh_.triangles),
        marked_(mesh_.triangles.size()) {}

  void MarkAround(const Vec3& place, double reach) {
    const Vec3 extent{reach, reach, reach};
    Box3 box;
    box.Extend(place - extent), box.Extend(place + extent);
    tree_.VisitOverlaps(box, [&](FaceId f) { return Mark(f.index()); });
    const auto nearest = tree_.FindClosestPoint(place, p_.input.diagonal * p_.scale);
    if (nearest) Mark(nearest->face.index());
  }

  // Faces that share a vertex with a marked one.
  void MarkNeighbours() {
    std::vector<bool> touched(mesh_.positions.size());
    for (size_t f = 0; f < marked_.size(); ++f) {
      for (const VertexId v : mesh_.triangles[f]) touched[v.index()] = touched[v.index()] || marked_[f];
    }
    for (size_t f = 0; f < marked_.size(); ++f) {
      for (const VertexId v : mesh_.triangles[f]) marked_[f] = marked_[f] || touched[v.index()];
    }
  }

  // Faces that hang together with a marked one by edges.
  void MarkComponents() {
    const FaceComponents components = LabelComponents(CreateAdjacency(mesh_));
    std::vector<bool> has_marked(components.count);
    for (size_t f = 0; f < marked_.size(); ++f)
      has_marked[components.label[f]] = has_marked[components.label[f]] || marked_[f];
    for (size_t f = 0; f < marked_.size(); ++f) marked_[f] = has_marked[components.label[f]];
  }

  bool is_everything() const { return std::find(marked_.begin(), marked_.end(), false) == marked_.end(); }

  void AddTo(LeftFaces& left) const {
    const RegionParts& parts = *p_.region;
    left.is_left.resize(parts.whole().triangles.size());
    for (size_t f = 0; f < marked_.size(); ++f) {
      const uint32_t face = parts.region_origins[f];
      if (!marked_[f] || left.is_left[face]) continue;
      left.is_left[face] = true;
      if (left.count++ == 0) left.first = parts.whole().PositionAt(parts.whole().triangles[face][0]);
    }
  }

 private:
  bool Mark(uint32_t face) {
    marked_[face] = true;
    return true;
  }

  const Preparation& p_;
  const TriangleMesh mesh_;
  const TriangleBvh tree_;
  std::vector<bool> marked_;
};

}  // namespace

bool LeaveFaultyFaces(const Preparation& p, const Attempt& attempt, LeftFaces& left) {
  const std::vector<Vec3> places = attempt.Faults();
  if (places.empty() || left.rounds == kMostRounds) return false;
  FaultyFaces faces(p);
  const double reach = kFirstReach * (1 << left.rounds);
  for (const Vec3& place : places) faces.MarkAround(place, reach * p.field->At(place));
  faces.MarkNeighbours();
  if (left.rounds >= kRoundsAtPlaces) faces.MarkComponents();
  if (faces.is_everything()) return false;
  faces.AddTo(left);
  ++left.rounds;
  return true;
}

}  // namespace meshfront
