#include "core/mesh/repair_degenerate.h"

#include <algorithm>
#include <deque>
#include <tuple>

#include "absl/container/flat_hash_map.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh_edits.h"
#include "core/mesh/repair_survey.h"
#include "core/mesh/tolerances.h"

namespace meshfront {
namespace {

constexpr int kVisitsPerCap = 8;       // a cap is looked at again when a neighbour has changed, so often at most
constexpr int kLongestFanWalk = 4096;  // beyond, a flip is refused rather than its vertices' neighbours searched

std::vector<uint32_t> ZeroAreaFaces(const TriangleMesh& mesh) {
  std::vector<uint32_t> faces;
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f) {
    if (StateOf(mesh, mesh.triangles[f]) == FaceState::kZeroArea) faces.push_back(f);
  }
  return faces;
}

void RemoveFaces(TriangleMesh& mesh, const std::vector<bool>& dropped) {
  size_t kept = 0;
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    if (!dropped[f]) MoveFace(mesh, f, kept++);
  }
  ResizeFaces(mesh, kept);
}

// How many faces lie at the sides of some triangles, sides at the same positions counted together.
class SideCounts {
 public:
  SideCounts(const TriangleMesh& mesh, const std::vector<uint32_t>& faces)
      : mesh_(mesh), position_(mesh.positions.size()) {
    std::vector<uint32_t> order(mesh.positions.size());
    for (uint32_t v = 0; v < order.size(); ++v) order[v] = v;
    const auto key = [&](uint32_t v) {
      return std::tie(mesh.positions[v].x, mesh.positions[v].y, mesh.positions[v].z);
    };
    // A NaN would break the order; such vertices carry no face any more.
    std::erase_if(order, [&](uint32_t v) { return !IsFinite(mesh.positions[v]); });
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
    for (size_t i = 0; i < order.size(); ++i) {
      position_[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? position_[order[i - 1]] : order[i];
    }
    for (const uint32_t f : faces) {
      for (uint32_t i = 0; i < 3; ++i) count_[EndsOf(3 * f + i)] = 0;
    }
    for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
      if (const auto it = count_.find(EndsOf(h)); it != count_.end()) ++it->second;
    }
  }
  int At(uint32_t h) const { return count_.find(EndsOf(h))->second; }
  void Drop(uint32_t f) {
    for (uint32_t i = 0; i < 3; ++i) --count_[EndsOf(3 * f + i)];
  }

 private:
  std::pair<uint32_t, uint32_t> EndsOf(uint32_t h) const {
    const uint32_t a = position_[OriginOf(mesh_, h).index()], b = position_[TargetOf(mesh_, h).index()];
    return {std::min(a, b), std::max(a, b)};
  }
  const TriangleMesh& mesh_;
  std::vector<uint32_t> position_;
  absl::flat_hash_map<std::pair<uint32_t, uint32_t>, int> count_;
};

bool IsLoose(const TriangleMesh& mesh, const SideCounts& counts, uint32_t f) {
  int rims = 0;
  for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) {
    if (counts.At(h) > 2) return true;
    rims += counts.At(h) == 1;
  }
  return rims >= 2 || counts.At(LongestSide(mesh, f)) == 1;
}

// A cap's long side is flipped (FlipEdge has the drawing).
class CapFlipper {
 public:
  explicit CapFlipper(TriangleMesh& mesh) : mesh_(mesh), adjacency_(CreateAdjacency(mesh)) {}

  FlipChanges Run() {
    const std::vector<uint32_t> caps = ZeroAreaFaces(mesh_);
    std::deque<uint32_t> pending(caps.begin(), caps.end());
    absl::flat_hash_map<uint32_t, int> visits;
    FlipChanges changes;
    while (!pending.empty()) {
      const uint32_t f = pending.front();
      pending.pop_front();
      if (StateOf(mesh_, mesh_.triangles[f]) != FaceState::kZeroArea || ++visits[f] > kVisitsPerCap) continue;
      const uint32_t h = LongestSide(mesh_, f), g = adjacency_.OppositeOf(h);
      if (!Flip(h)) continue;
      ++changes.flipped;
      for (const uint32_t changed : {f, FaceOfHalfEdge(g)}) {
        for (const uint32_t o : adjacency_.opposite[changed]) {
          if (o != kNoHalfEdge) pending.push_back(FaceOfHalfEdge(o));
        }
      }
    }
    changes.dropped = DropTheRest();
    return changes;
  }

 private:
  bool Flip(uint32_t h) {
    const uint32_t g = adjacency_.OppositeOf(h);
    if (g == kNoHalfEdge) return false;
    const VertexId u = OriginOf(mesh_, h), v = TargetOf(mesh_, h);
    const VertexId w = OriginOf(mesh_, PreviousHalfEdge(h)), d = OriginOf(mesh_, PreviousHalfEdge(g));
    const Triangle left = {u, d, w}, right = {d, v, w};
    if (w == d || !IsGood(left, mesh_.triangles[FaceOfHalfEdge(g)]) ||
        !IsGood(right, mesh_.triangles[FaceOfHalfEdge(g)]) || AreNeighbours(h, d)) {
      return false;
    }
    FlipEdge(mesh_, adjacency_, h);
    return true;
  }

  bool IsGood(const Triangle& t, const Triangle& like) const {
    if (StateOf(mesh_, t) != FaceState::kSound || StateOf(mesh_, like) != FaceState::kSound) return false;
    const auto normal = [&](const Triangle& x) {
      return AreaVectorOf(mesh_.PositionAt(x[0]), mesh_.PositionAt(x[1]), mesh_.PositionAt(x[2]));
    };
    return Dot(normal(t), normal(like)) > 0;
  }
  static Vec3 AreaVectorOf(const Vec3& a, const Vec3& b, const Vec3& c) { return Normalized(Cross(b - a, c - a)); }

  // Whether an edge joins the corner across h with d; also when too many would have to be looked at.
  bool AreNeighbours(uint32_t h, VertexId d) const {
    const uint32_t start = PreviousHalfEdge(h);  // leaves w
    uint32_t at = start;
    int steps = 0;
    do {  // counter-clockwise
      if (TargetOf(mesh_, at) == d || OriginOf(mesh_, PreviousHalfEdge(at)) == d || ++steps > kLongestFanWalk)
        return true;
      at = adjacency_.NextAroundOrigin(at);
    } while (at != kNoHalfEdge && at != start);
    if (at == start) return false;
    for (at = adjacency_.OppositeOf(start); at != kNoHalfEdge;
         at = adjacency_.OppositeOf(at)) {  // clockwise to the other rim
      at = NextHalfEdge(at);
      if (TargetOf(mesh_, at) == d || OriginOf(mesh_, PreviousHalfEdge(at)) == d || ++steps > kLongestFanWalk)
        return true;
    }
    return false;
  }

  uint64_t DropTheRest() {
    const std::vector<uint32_t> rest = ZeroAreaFaces(mesh_);
    if (rest.empty()) return 0;
    std::vector<bool> dropped(mesh_.triangles.size(), false);
    for (const uint32_t f : rest) dropped[f] = true;
    RemoveFaces(mesh_, dropped);
    return rest.size();
  }

  TriangleMesh& mesh_;
  FaceAdjacency adjacency_;
};

}  // namespace

uint64_t DropNeedlesAndLooseCaps(TriangleMesh& mesh) {
  const std::vector<uint32_t> faces = ZeroAreaFaces(mesh);
  if (faces.empty()) return 0;
  std::vector<bool> dropped(mesh.triangles.size(), false);
  uint64_t count = 0;
  const auto drop = [&](uint32_t f) { dropped[f] = true, ++count; };
  for (const uint32_t f : faces) {
    const uint32_t h = ShortestSide(mesh, f);
    if (SquaredLength(mesh, h) > kZeroSideRatio * kZeroSideRatio * SquaredLength(mesh, LongestSide(mesh, f))) continue;
    const VertexId kept = std::min(OriginOf(mesh, h), TargetOf(mesh, h)),
                   moved = std::max(OriginOf(mesh, h), TargetOf(mesh, h));
    mesh.positions[moved.index()] = mesh.positions[kept.index()];
    drop(f);
  }
  SideCounts counts(mesh, faces);
  for (const uint32_t f : faces) {
    if (dropped[f]) counts.Drop(f);
  }
  for (const uint32_t f : faces) {
    if (dropped[f] || !IsLoose(mesh, counts, f)) continue;
    counts.Drop(f);
    drop(f);
  }
  RemoveFaces(mesh, dropped);
  return count;
}

FlipChanges FlipCaps(TriangleMesh& mesh) { return CapFlipper(mesh).Run(); }

}  // namespace meshfront
