// Rounds of 1. MoveVertices  2. flips  3. collapses, each where it makes the worst face of those that change better.
// Faces that are turned away from their side are worse than all others, by their area: so each step undoes some of it.
// Rejected: moves alone. A vertex beyond a corner has its neighbours in the way of each other.
#include "core/crease_relaxation.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/mesh_edits.h"

namespace meshfront {
namespace {

constexpr int kRounds = 12;
// The radius ratio from which on faces are left alone, and below which edges are collapsed.
constexpr double kGoodShape = 0.4, kCollapsedShape = 0.15;

// Cosine between a face and its side from which on it lies on that.
constexpr double kLeastAgreement = 0.5;

class Relaxation {
 public:
  Relaxation(CreasedMesh& creased, const CreasedSurface& surface)
      : creased_(creased), mesh_(creased.mesh), surface_(surface) {
    for (uint32_t v = 0; v < mesh_.positions.size(); ++v) is_blunt_.push_back(surface_.is_blunt(v));
  }

  absl::Status Run(const Context& context) {
    for (int round = 0; round < kRounds; ++round) {
      MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
      BeginRound();
      MoveVertices();
      for (uint32_t h = 0; h < 3 * mesh_.triangles.size(); ++h) {
        if (is_near_[Origin(h)]) TryFlip(h);
      }
      Collapse();
    }
    adjacency_ = CreateAdjacency(mesh_);
    DropUnreferencedVertices(mesh_, adjacency_);
    return absl::OkStatus();
  }

 private:
  uint32_t Origin(uint32_t h) const { return OriginOf(mesh_, h).index(); }
  uint32_t Target(uint32_t h) const { return TargetOf(mesh_, h).index(); }
  bool IsOnCrease(uint32_t v) const { return v >= creased_.first_on_crease; }
  bool IsCorner(uint32_t v) const { return IsOnCrease(v) && beside_[v][1] == kNoHalfEdge; }
  bool IsCrease(uint32_t a, uint32_t b) const {
    const std::array<uint32_t, 2> edge = {std::min(a, b), std::max(a, b)};
    return std::binary_search(creased_.creases.begin(), creased_.creases.end(), edge);
  }

  void BeginRound();
  double ScoreOf(uint32_t f) const;
  double WorstAround(uint32_t v, uint32_t without = kNoHalfEdge) const;
  std::optional<Vec3> RelaxedPlaceOf(uint32_t v) const;
  void MoveVertices();
  void TryFlip(uint32_t h);
  void Flip(uint32_t h);
  bool MayFlip(uint32_t h) const;
  void Collapse();
  bool MayCollapse(uint32_t h) const;
  uint32_t BestCollapse(uint32_t v);

  CreasedMesh& creased_;
  TriangleMesh& mesh_;
  const CreasedSurface& surface_;
  FaceAdjacency adjacency_;
  std::vector<std::array<uint32_t, 2>> beside_;  // of each vertex on one curve its neighbours there
  std::vector<bool> is_blunt_;
  std::vector<bool> is_near_;  // vertices of faces that have one on a crease
};

void Relaxation::BeginRound() {
  adjacency_ = CreateAdjacency(mesh_);
  std::sort(creased_.creases.begin(), creased_.creases.end());
  const size_t n = mesh_.positions.size();
  beside_.assign(n, {kNoHalfEdge, kNoHalfEdge});
  std::vector<uint32_t> degree(n, 0);
  for (const auto& [a, b] : creased_.creases) {
    if (degree[a]++ < 2) beside_[a][degree[a] - 1] = b;
    if (degree[b]++ < 2) beside_[b][degree[b] - 1] = a;
  }
  for (size_t v = 0; v < n; ++v) {
    if (degree[v] != 2) beside_[v] = {kNoHalfEdge, kNoHalfEdge};
  }
  is_near_.assign(n, false);
  for (const Triangle& t : mesh_.triangles) {
    const bool is_beside = std::any_of(t.begin(), t.end(), [&](VertexId v) { return IsOnCrease(v.index()); });
    for (const VertexId v : t) is_near_[v.index()] = is_near_[v.index()] || is_beside;
  }
}

// The radius ratio; less the area where the face is turned away from the side that it lies on.
double Relaxation::ScoreOf(uint32_t f) const {
  const Triangle& t = mesh_.triangles[f];
  const Vec3 &a = mesh_.PositionAt(t[0]), &b = mesh_.PositionAt(t[1]), &c = mesh_.PositionAt(t[2]);
  for (const VertexId v : t) {
    const SideFit* const side = surface_.side_of(v.index());
    if (side == nullptr) continue;
    const Vec3 area = AreaVector(a, b, c), up = side->GradientAt((a + b + c) / 3.0);
    if (Dot(area, up) > kLeastAgreement * Norm(area) * Norm(up)) break;
    return -TriangleArea(a, b, c);
  }
  return RadiusRatio(a, b, c);
}

// The worst shape of the faces around v; where some are turned over, less their area. Faces that have the vertex `without` are left out.
double Relaxation::WorstAround(uint32_t v, uint32_t without) const {
  double worst = 1, turned_over = 0;
  VisitOutgoing(adjacency_, v, [&](uint32_t h) {
    if (Target(h) == without || Origin(PreviousHalfEdge(h)) == without) return;
    const double score = ScoreOf(h / 3);
    worst = std::min(worst, score), turned_over += std::min(score, 0.0);
  });
  return turned_over < 0 ? turned_over : worst;
}

// In the middle of its neighbours, on a crease of the two beside it there. Corners stay, and what lies on a rim.
std::optional<Vec3> Relaxation::RelaxedPlaceOf(uint32_t v) const {
  if (adjacency_.IsRimVertex(v) || IsCorner(v)) return std::nullopt;
  const auto& x = mesh_.positions;
  if (IsOnCrease(v)) return surface_.place_of(v, 0.5 * (x[beside_[v][0]] + x[beside_[v][1]]));
  Vec3 sum;
  double count = 0;
  VisitNeighbours(mesh_, adjacency_, v, [&](VertexId at) { sum += x[at.index()], ++count; });
  return surface_.place_of(v, sum / count);
}

void Relaxation::MoveVertices() {
  for (uint32_t v = 0; v < mesh_.positions.size(); ++v) {
    if (!is_near_[v]) continue;
    const double worst = WorstAround(v);
    if (worst > kGoodShape) continue;
    const std::optional<Vec3> place = RelaxedPlaceOf(v);
    if (!place) continue;
    const Vec3 before = std::exchange(mesh_.positions[v], *place);
    if (WorstAround(v) <= worst) mesh_.positions[v] = before;
  }
}

// Inside of a side, so that both new faces have a vertex that is on no crease.
bool Relaxation::MayFlip(uint32_t h) const {
  const uint32_t u = Origin(h), v = Target(h), w = Origin(PreviousHalfEdge(h)),
                 d = Origin(PreviousHalfEdge(adjacency_.OppositeOf(h)));
  if (adjacency_.IsRimVertex(u) || adjacency_.IsRimVertex(v) || w == d || IsCrease(u, v)) return false;
  if (IsOnCrease(w) && IsOnCrease(d) && (IsOnCrease(u) || IsOnCrease(v))) return false;
  bool are_joined = false;
  VisitNeighbours(mesh_, adjacency_, w, [&](VertexId x) { are_joined = are_joined || x.index() == d; });
  return !are_joined;
}

void Relaxation::Flip(uint32_t h) {
  const uint32_t f = h / 3, g = adjacency_.OppositeOf(h) / 3;
  FlipEdge(mesh_, adjacency_, h);
  for (const uint32_t face : {f, g}) {
    for (uint32_t side = 3 * face; side < 3 * face + 3; ++side) {
      if (!adjacency_.IsRimVertex(Origin(side))) adjacency_.outgoing[Origin(side)] = side;
    }
  }
}

void Relaxation::TryFlip(uint32_t h) {
  const uint32_t other = adjacency_.OppositeOf(h);
  if (other == kNoHalfEdge || other < h) return;
  const uint32_t f = h / 3, g = other / 3;
  const double worst = std::min(ScoreOf(f), ScoreOf(g));
  if (worst > kGoodShape || !MayFlip(h)) return;
  Flip(h);
  if (std::min(ScoreOf(f), ScoreOf(g)) > worst) return;
  Flip(3 * f + 1);  // which FlipEdge made of it
}

// The origin goes to the target: along the crease where it is on one, and leaves no face that is on creases only.
bool Relaxation::MayCollapse(uint32_t h) const {
  const uint32_t v = Origin(h), to = Target(h);
  if (adjacency_.OppositeOf(h) == kNoHalfEdge || (IsOnCrease(v) && !IsCrease(v, to))) return false;
  std::vector<uint32_t> around;
  VisitNeighbours(mesh_, adjacency_, v, [&](VertexId x) { around.push_back(x.index()); });
  int shared = 0;
  VisitNeighbours(mesh_, adjacency_, to,
                  [&](VertexId x) { shared += std::find(around.begin(), around.end(), x.index()) != around.end(); });
  if (shared != 2 || around.size() < 4) return false;
  bool keeps_sides = true;
  VisitOutgoing(adjacency_, v, [&](uint32_t at) {
    const uint32_t a = Target(at), b = Origin(PreviousHalfEdge(at));
    if (a != to && b != to && IsOnCrease(to) && IsOnCrease(a) && IsOnCrease(b)) keeps_sides = false;
  });
  return keeps_sides;
}

// The half-edge from v to collapse, if that makes it better; of corners only of blunt ones, which then lie at another or on a curve.
uint32_t Relaxation::BestCollapse(uint32_t v) {
  double best_score = WorstAround(v);
  uint32_t best = kNoHalfEdge;
  if (best_score > kCollapsedShape || adjacency_.IsRimVertex(v) || (IsCorner(v) && !is_blunt_[v])) return best;
  std::vector<uint32_t> fan;
  VisitOutgoing(adjacency_, v, [&](uint32_t h) { fan.push_back(h); });
  const Vec3 place = mesh_.positions[v];
  for (const uint32_t h : fan) {
    if (!MayCollapse(h)) continue;
    mesh_.positions[v] = mesh_.positions[Target(h)];
    const double score = WorstAround(v, Target(h));
    mesh_.positions[v] = place;
    if (score > best_score) best = h, best_score = score;
  }
  return best;
}

// Faces that one collapse changes are left alone by the others of the round.
void Relaxation::Collapse() {
  std::vector<bool> is_taken(mesh_.positions.size(), false), dropped(mesh_.triangles.size(), false);
  std::vector<uint32_t> goes_to(mesh_.positions.size());
  std::iota(goes_to.begin(), goes_to.end(), 0u);
  bool any = false;
  for (uint32_t v = 0; v < mesh_.positions.size(); ++v) {
    if (!is_near_[v] || is_taken[v] || adjacency_.outgoing[v] == kNoHalfEdge) continue;
    const uint32_t h = BestCollapse(v);
    if (h == kNoHalfEdge) continue;
    const uint32_t to = Target(h);
    std::vector<uint32_t> around;
    VisitNeighbours(mesh_, adjacency_, v, [&](VertexId x) { around.push_back(x.index()); });
    if (std::any_of(around.begin(), around.end(), [&](uint32_t x) { return is_taken[x]; })) continue;
    std::vector<uint32_t> fan;
    VisitOutgoing(adjacency_, v, [&](uint32_t at) { fan.push_back(at); });
    for (const uint32_t at : fan) {
      const bool goes = Target(at) == to || Origin(PreviousHalfEdge(at)) == to;
      dropped[at / 3] = dropped[at / 3] || goes;
    }
    for (const uint32_t at : fan) {
      for (VertexId& x : mesh_.triangles[at / 3]) {
        if (x.index() == v) x = VertexId(to);
      }
    }
    is_taken[v] = is_taken[to] = any = true;
    for (const uint32_t x : around) is_taken[x] = true;
    goes_to[v] = to;
    if (IsCorner(v) && !IsCorner(to)) is_blunt_[to] = true;  // more curves meet there than it has a place for
  }
  if (!any) return;
  for (auto& [a, b] : creased_.creases) {
    a = goes_to[a], b = goes_to[b];
    if (a > b) std::swap(a, b);
  }
  std::erase_if(creased_.creases, [](const auto& edge) { return edge[0] == edge[1]; });
  DropTriangles(mesh_, dropped);
}

}  // namespace

absl::Status RelaxCreases(CreasedMesh& creased, const CreasedSurface& surface, const Context& context) {
  return Relaxation(creased, surface).Run(context);
}

}  // namespace meshfront
