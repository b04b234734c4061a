// 1. TriangulateRim  the triangulation of the rim with the least area and the fewest folds    2. Refine  edges that are too long get a
// vertex, and are turned where that makes rounder triangles    3. FairPatch, and 2 again for what it stretched
#include "core/mesh/hole_patch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "core/geometry/bvh.h"
#include "core/geometry/intersection.h"
#include "core/geometry/loop_triangulation.h"
#include "core/geometry/triangle.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh_edits.h"
#include "core/mesh/patch_fairing.h"

namespace meshfront {
namespace {

constexpr size_t kMostToTriangulate = 160;  // vertices: it is cubic
// Weights of a fold and of a triangle without area, against one mean squared edge.
constexpr double kFoldPenalty = 4, kFlatPenalty = 1000, kFlatRatio = 1e-4;
// How fast edges grow away from the rim; the longest in parts of the hole's extent; the shortest that the rim asks for in parts of its mean.
constexpr double kGrowth = 0.15, kLongestPerExtent = 0.05, kShortestPerMean = 0.5;
// In parts of the length wanted: an edge both of whose halves are nearer to it, and how far its middle lies from all other vertices.
constexpr double kTooLong = 1.34, kLeastRoom = 0.6;
constexpr size_t kMostVertices = 20000;
constexpr int kMostFairings = 3, kMostSplits = 40, kMostFlipPasses = 8;
constexpr double kFlipTolerance = 1e-9;  // of the sum of cotangents

uint64_t EdgeKey(uint32_t a, uint32_t b) { return uint64_t{std::min(a, b)} << 32 | std::max(a, b); }

double CotangentAt(const Vec3& apex, const Vec3& a, const Vec3& b) {
  const double sine = Norm(Cross(a - apex, b - apex));
  return sine > 0 ? Dot(a - apex, b - apex) / sine : std::numeric_limits<double>::infinity();
}

class PatchMaker {
 public:
  PatchMaker(absl::Span<const HoleRimVertex> rim, absl::Span<const std::array<uint32_t, 2>> joined) : rim_(rim) {
    Vec3 area;
    for (size_t i = 0; i < rim.size(); ++i) {
      patch_.positions.push_back(rim[i].position);
      area += Cross(rim[i].position - rim[0].position, rim[(i + 1) % rim.size()].position - rim[0].position);
    }
    for (const HoleRimVertex& v : rim) facing_.push_back(Normalized(v.normal + Normalized(area)));
    for (const auto& [a, b] : joined) joined_.insert(EdgeKey(a, b));
    MeasureRim();
  }

  std::optional<HolePatch> Make(PatchShape shape) {
    if (rim_.size() < 3 || !TriangulateRim()) return std::nullopt;
    for (int round = 0; round < kMostFairings && Refine(); ++round) {
      if (!FairPatch(rim_, wanted_, shape, patch_)) return std::nullopt;
    }
    if (MeetsItself()) return std::nullopt;
    return HolePatch{std::move(patch_.positions), std::move(patch_.triangles), std::move(parents_)};
  }

 private:
  void MeasureRim();
  bool ClipEars(std::vector<uint32_t>& loop);
  bool TriangulateRim();
  double WeightOf(uint32_t a, uint32_t b, uint32_t c) const;
  double LengthAt(const Vec3& x) const;
  bool Refine();
  bool SplitLong();
  void FlipForShape();
  bool MayFlip(const FaceAdjacency& adjacency, uint32_t h) const;
  bool MeetsItself() const;
  const Vec3& At(uint32_t v) const { return patch_.positions[v]; }
  void AddTriangle(uint32_t a, uint32_t b, uint32_t c) {
    patch_.triangles.push_back({VertexId(a), VertexId(b), VertexId(c)});
  }

  const absl::Span<const HoleRimVertex> rim_;
  std::vector<Vec3> facing_;    // between the surface's normal and that of the plane of the hole
  std::vector<double> wanted_;  // length of the edges around each vertex
  double mean_ = 0, longest_ = 0;
  absl::flat_hash_set<uint64_t> joined_, edges_;
  TriangleMesh patch_;
  std::vector<std::array<VertexId, 2>> parents_;
};

void PatchMaker::MeasureRim() {
  const size_t n = rim_.size();
  Box3 box;
  for (size_t i = 0; i < n; ++i) {
    box.Extend(rim_[i].position);
    const double before = Distance(rim_[i].position, rim_[(i + n - 1) % n].position);
    const double after = Distance(rim_[i].position, rim_[(i + 1) % n].position);
    wanted_.push_back(0.5 * (before + after));
    mean_ += after / static_cast<double>(n);
  }
  for (double& length : wanted_) length = std::max(length, kShortestPerMean * mean_);
  longest_ = std::max(mean_, kLongestPerExtent * box.Diagonal());
}

double PatchMaker::WeightOf(uint32_t a, uint32_t b, uint32_t c) const {
  for (const auto& [i, j] : {std::pair{a, b}, std::pair{b, c}, std::pair{a, c}}) {
    if (joined_.contains(EdgeKey(i, j))) return -1;
  }
  const Vec3 area = AreaVector(At(a), At(b), At(c)), normal = Normalized(area);
  const double agreement = std::min({Dot(normal, facing_[a]), Dot(normal, facing_[b]), Dot(normal, facing_[c])});
  const bool is_flat = RadiusRatio(At(a), At(b), At(c)) < kFlatRatio;
  return Norm(area) + mean_ * mean_ * (kFoldPenalty * (1 - agreement) + (is_flat ? kFlatPenalty : 0));
}

// The shortest ears first, none beside another one of the same pass.
bool PatchMaker::ClipEars(std::vector<uint32_t>& loop) {
  const size_t n = loop.size();
  std::vector<std::pair<double, size_t>> ears;
  for (size_t i = 0; i < n; ++i) {
    const uint32_t a = loop[(i + n - 1) % n], b = loop[i], c = loop[(i + 1) % n];
    const bool is_ear = Dot(AreaVector(At(a), At(b), At(c)), facing_[b]) > 0 && !joined_.contains(EdgeKey(a, c));
    if (is_ear) ears.push_back({SquaredDistance(At(a), At(c)), i});
  }
  std::sort(ears.begin(), ears.end());
  std::vector<bool> is_kept(n, true);
  size_t left = n;
  for (const auto& [length, i] : ears) {
    const size_t before = (i + n - 1) % n, after = (i + 1) % n;
    if (left <= kMostToTriangulate || !is_kept[before] || !is_kept[after]) continue;
    AddTriangle(loop[before], loop[i], loop[after]);
    joined_.insert(EdgeKey(loop[before], loop[after]));  // no other triangle makes it again
    is_kept[i] = false, --left;
  }
  size_t kept = 0;
  for (size_t i = 0; i < n; ++i) {
    if (is_kept[i]) loop[kept++] = loop[i];
  }
  loop.resize(kept);
  return kept < n;
}

bool PatchMaker::TriangulateRim() {
  std::vector<uint32_t> loop(rim_.size());
  std::iota(loop.begin(), loop.end(), 0u);
  while (loop.size() > kMostToTriangulate) {
    if (!ClipEars(loop)) return false;
  }
  // The loop's own edges are joined to what was clipped, but are those of the triangulation.
  for (size_t i = 0; i < loop.size(); ++i) joined_.erase(EdgeKey(loop[i], loop[(i + 1) % loop.size()]));
  const auto weight = [&](int first, int apex, int last) { return WeightOf(loop[first], loop[apex], loop[last]); };
  const auto steps = TriangulateLoop(static_cast<int>(loop.size()), weight);
  if (!steps) return false;
  for (const ClosureStep& s : *steps) AddTriangle(loop[s.first], loop[s.apex], loop[s.last]);
  edges_ = joined_;
  for (const Triangle& t : patch_.triangles) {
    for (int i = 0; i < 3; ++i) edges_.insert(EdgeKey(t[i].index(), t[(i + 1) % 3].index()));
  }
  return true;
}

double PatchMaker::LengthAt(const Vec3& x) const {
  double least = longest_;
  for (size_t i = 0; i < rim_.size(); ++i) least = std::min(least, wanted_[i] + kGrowth * Distance(x, At(i)));
  return least;
}

// One edge of a triangle at a time, the longest first. False where none is too long.
bool PatchMaker::SplitLong() {
  const FaceAdjacency adjacency = CreateAdjacency(patch_);
  std::vector<std::pair<double, uint32_t>> edges;
  for (uint32_t h = 0; h < 3 * adjacency.opposite.size(); ++h) {
    const uint32_t g = adjacency.OppositeOf(h);
    if (g == kNoHalfEdge || g < h) continue;
    const Vec3 &a = patch_.PositionAt(OriginOf(patch_, h)), &b = patch_.PositionAt(TargetOf(patch_, h));
    const Vec3& c = patch_.PositionAt(OriginOf(patch_, PreviousHalfEdge(h)));
    const Vec3 &d = patch_.PositionAt(OriginOf(patch_, PreviousHalfEdge(g))), middle = 0.5 * (a + b);
    const double length = Distance(a, b);
    const double wanted = 0.5 * (wanted_[OriginOf(patch_, h).index()] + wanted_[TargetOf(patch_, h).index()]);
    const bool is_room = std::min(Distance(middle, c), Distance(middle, d)) > kLeastRoom * wanted;
    if (length > kTooLong * wanted && is_room) edges.push_back({-length / wanted, h});
  }
  std::sort(edges.begin(), edges.end());
  std::vector<bool> is_touched(adjacency.opposite.size(), false);
  bool any = false;
  for (const auto& [length, h] : edges) {
    const uint32_t g = adjacency.OppositeOf(h);
    if (is_touched[h / 3] || is_touched[g / 3] || patch_.positions.size() >= kMostVertices) continue;
    is_touched[h / 3] = is_touched[g / 3] = any = true;
    const VertexId u = OriginOf(patch_, h), v = TargetOf(patch_, h);
    const VertexId m(static_cast<uint32_t>(patch_.positions.size()));
    patch_.positions.push_back(0.5 * (patch_.PositionAt(u) + patch_.PositionAt(v)));
    parents_.push_back({u, v});
    wanted_.push_back(LengthAt(patch_.positions.back()));
    edges_.erase(EdgeKey(u.index(), v.index()));
    for (const uint32_t side : {h, g}) {
      const VertexId from = OriginOf(patch_, side), to = TargetOf(patch_, side);
      const VertexId apex = OriginOf(patch_, PreviousHalfEdge(side));
      patch_.triangles[side / 3] = {from, m, apex};
      patch_.triangles.push_back({m, to, apex});
      edges_.insert(EdgeKey(m.index(), apex.index()));
    }
    edges_.insert(EdgeKey(u.index(), m.index()));
    edges_.insert(EdgeKey(m.index(), v.index()));
  }
  return any;
}

bool PatchMaker::MayFlip(const FaceAdjacency& adjacency, uint32_t h) const {
  const uint32_t g = adjacency.OppositeOf(h);
  if (g == kNoHalfEdge) return false;
  const VertexId w = OriginOf(patch_, PreviousHalfEdge(h)), d = OriginOf(patch_, PreviousHalfEdge(g));
  const Vec3 &u = patch_.PositionAt(OriginOf(patch_, h)), &v = patch_.PositionAt(TargetOf(patch_, h));
  const Vec3 &above = patch_.PositionAt(w), &below = patch_.PositionAt(d);
  if (!(CotangentAt(above, u, v) + CotangentAt(below, u, v) < -kFlipTolerance)) return false;
  if (edges_.contains(EdgeKey(w.index(), d.index()))) return false;
  const Vec3 normal = AreaVector(u, v, above) + AreaVector(v, u, below);
  return Dot(AreaVector(u, below, above), normal) > 0 && Dot(AreaVector(below, v, above), normal) > 0;
}

void PatchMaker::FlipForShape() {
  FaceAdjacency adjacency = CreateAdjacency(patch_);
  bool any = true;
  for (int pass = 0; pass < kMostFlipPasses && any; ++pass) {
    any = false;
    for (uint32_t h = 0; h < 3 * adjacency.opposite.size(); ++h) {
      if (!MayFlip(adjacency, h)) continue;
      const uint32_t g = adjacency.OppositeOf(h);
      edges_.erase(EdgeKey(OriginOf(patch_, h).index(), TargetOf(patch_, h).index()));
      edges_.insert(
          EdgeKey(OriginOf(patch_, PreviousHalfEdge(h)).index(), OriginOf(patch_, PreviousHalfEdge(g)).index()));
      FlipEdge(patch_, adjacency, h);
      any = true;
    }
  }
}

// False where no edge was too long.
bool PatchMaker::Refine() {
  bool any = false;
  for (int pass = 0; pass < kMostSplits && SplitLong(); ++pass) {
    FlipForShape();
    any = true;
  }
  return any;
}

bool PatchMaker::MeetsItself() const {
  const TriangleBvh bvh(patch_.positions, patch_.triangles);
  bool meets = false;
  bvh.VisitOverlappingPairs([&](FaceId f, FaceId g) {
    const Triangle &s = patch_.triangles[f.index()], &t = patch_.triangles[g.index()];
    meets = meets || TrianglesIntersect({patch_.PositionAt(s[0]), patch_.PositionAt(s[1]), patch_.PositionAt(s[2])},
                                        {patch_.PositionAt(t[0]), patch_.PositionAt(t[1]), patch_.PositionAt(t[2])},
                                        SharedCornersOf(s, t));
  });
  return meets;
}

}  // namespace

std::optional<HolePatch> MakeHolePatch(absl::Span<const HoleRimVertex> rim,
                                       absl::Span<const std::array<uint32_t, 2>> joined, PatchShape shape) {
  return PatchMaker(rim, joined).Make(shape);
}

bool IsWiderThan(absl::Span<const Vec3> loop, double size) {
  Box3 box;
  for (const Vec3& x : loop) box.Extend(x);
  const Vec3 extent = box.max - box.min;
  if (std::max({extent.x, extent.y, extent.z}) > size) return true;
  if (box.Diagonal() <= size) return false;
  for (size_t i = 0; i < loop.size(); ++i) {
    for (size_t j = i + 1; j < loop.size(); ++j) {
      if (SquaredDistance(loop[i], loop[j]) > size * size) return true;
    }
  }
  return false;
}

}  // namespace meshfront
