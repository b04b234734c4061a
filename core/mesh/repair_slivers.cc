// 1. AnyAtSharpEdges: most meshes have no sliver there, and stay as they are. Else all slivers are looked at in the order of the faces,
//    and with their neighbours again when something has changed;
// 2. Collapse: the shortest side, where it is short enough, towards the end that turns the triangles around less;
// 3. Flip: else the longest side or the one after that, if what is across is not the other side of a thin wall.
// How far the surface may have moved is kept for each face and vertex, so that what adds up is bounded, not only each step.
// Rejected: to give slivers the normal of the face across their longest side where creases are looked for. The surface keeps its
// grooves, curvature fits see them, and a CAD model with strips of 0.04 % of the diagonal got 2.4 to 4 times as many triangles.
// Rejected as well: to mend wherever there is a sliver. Scans have some whose sides are no creases in the end. Or only those at
// creases: where they are, there are flaps in the smooth parts as well, and bent fits around them (twice the triangles on one model).
#include "core/mesh/repair_slivers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <optional>

#include "core/geometry/triangle.h"
#include "core/mesh/mesh_edits.h"
#include "core/mesh/repair_survey.h"
#include "core/mesh/tolerances.h"

namespace meshfront {
namespace {

constexpr int kVisitsPerFace = 8;    // a sliver is looked at again when a neighbour has changed, so often at most
constexpr size_t kLongestFan = 256;  // around a vertex; where there are more faces, nothing is done

class SliverMender {
 public:
  SliverMender(TriangleMesh& mesh, FaceAdjacency& adjacency, double reach, const std::vector<bool>& kept)
      : mesh_(mesh), adjacency_(adjacency), reach_(reach), kept_(kept) {}

  SliverChanges Run(const std::vector<bool>& sharp) {
    if (!AnyAtSharpEdges(sharp)) return changes_;
    for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
      if (!IsKept(f) && IsWrong(f)) pending_.push_back(f);
    }
    moved_.assign(mesh_.triangles.size(), 0);
    vertex_moved_.assign(mesh_.positions.size(), 0);
    visits_.assign(mesh_.triangles.size(), 0);
    while (!pending_.empty()) {
      const uint32_t f = pending_.front();
      pending_.pop_front();
      if (IsKept(f) || IsGone(f) || !IsWrong(f) || IsWall(f) || ++visits_[f] > kVisitsPerFace) continue;
      if (Collapse(ShortestSide(mesh_, f))) {
        ++changes_.collapsed_needles;
      } else if (Flip(LongestSide(mesh_, f)) || Flip(MiddleSide(f))) {
        ++changes_.flipped_caps;
      }
    }
    if (changes_.any()) Finish();
    return changes_;
  }

 private:
  struct Shape {
    double longest2, doubled_area;
    Vec3 area;
    double Aspect() const { return doubled_area / longest2; }
    double Height() const { return doubled_area / std::sqrt(longest2); }
  };
  using Corners = std::array<Vec3, 3>;

  Corners CornersOf(const Triangle& t) const {
    return {mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1]), mesh_.PositionAt(t[2])};
  }
  static Shape ShapeOf(const Corners& c) {
    const Vec3 area = AreaVector(c[0], c[1], c[2]);
    return {SquaredLongestSide(c[0], c[1], c[2]), Norm(area), area};
  }
  bool IsSliver(const Shape& s) const {
    return s.doubled_area < kSliverAspect * s.longest2 && s.Height() <= kFlapReaches * reach_;
  }
  bool IsSliver(const Triangle& t) const { return IsSliver(ShapeOf(CornersOf(t))); }
  Vec3 NormalOf(uint32_t f) const {
    const Shape s = ShapeOf(CornersOf(mesh_.triangles[f]));
    return (1 / s.doubled_area) * s.area;
  }
  // A sliver whose normal disagrees with a neighbour's.
  bool IsWrong(uint32_t f) const {
    if (!IsSliver(mesh_.triangles[f])) return false;
    for (const uint32_t o : adjacency_.opposite[f]) {
      if (o != kNoHalfEdge && Dot(NormalOf(f), NormalOf(o / 3)) < kSliverAgrees) return true;
    }
    return false;
  }
  bool IsWall(uint32_t f) const;
  bool AnyAtSharpEdges(const std::vector<bool>& sharp) const {
    for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
      if (!IsKept(f) && (sharp[3 * f] || sharp[3 * f + 1] || sharp[3 * f + 2]) && IsWrong(f)) return true;
    }
    return false;
  }
  double Moved(VertexId v) const { return vertex_moved_[v.index()]; }
  bool IsGone(uint32_t f) const { return moved_[f] < 0; }
  bool IsKept(uint32_t f) const { return !kept_.empty() && kept_[f]; }

  uint32_t Origin(uint32_t h) const { return OriginOf(mesh_, h).index(); }
  uint32_t Apex(uint32_t h) const { return Origin(PreviousHalfEdge(h)); }
  uint32_t MiddleSide(uint32_t f) const { return 9 * f + 3 - LongestSide(mesh_, f) - ShortestSide(mesh_, f); }

  double Deviation(uint32_t h) const;
  bool Flip(uint32_t h);
  bool Collapse(uint32_t h);
  double DeviationOfMoving(uint32_t h, const std::vector<uint32_t>& fan) const;
  std::optional<double> CostOfMoving(uint32_t h) const;
  bool Fan(uint32_t h, std::vector<uint32_t>& fan) const;
  bool NeighboursOf(uint32_t h, std::vector<uint32_t>& neighbours) const;
  bool KeepsTopology(uint32_t h) const;
  void Move(uint32_t h);
  void LookAgain(uint32_t f) {
    pending_.push_back(f);
    for (const uint32_t o : adjacency_.opposite[f]) {
      if (o != kNoHalfEdge) pending_.push_back(FaceOfHalfEdge(o));
    }
  }
  void Finish();

  TriangleMesh& mesh_;
  FaceAdjacency& adjacency_;
  const double reach_;
  const std::vector<bool>& kept_;
  std::deque<uint32_t> pending_;
  std::vector<int> visits_;
  std::vector<double> moved_;         // how far the surface of each face may have moved; below 0: the face is gone
  std::vector<double> vertex_moved_;  // the same by collapses, at each vertex
  SliverChanges changes_;
};

// The wall of a sheet that is thinner than that: its two sides look away from each other.
bool SliverMender::IsWall(uint32_t f) const {
  const uint32_t a = adjacency_.OppositeOf(LongestSide(mesh_, f)), b = adjacency_.OppositeOf(MiddleSide(f));
  if (a == kNoHalfEdge || b == kNoHalfEdge || IsSliver(mesh_.triangles[a / 3]) || IsSliver(mesh_.triangles[b / 3]))
    return false;
  return Dot(NormalOf(a / 3), NormalOf(b / 3)) < kWallCosine;
}

// How far the turned triangles are from those before at most: no farther than the corner w is from the triangle across (which is
// convex), and where the new side crosses over the old one, than they are from each other. 0 where all lies in a plane, also folded.
double SliverMender::Deviation(uint32_t h) const {
  const uint32_t g = adjacency_.OppositeOf(h);
  const Vec3 u = mesh_.PositionAt(OriginOf(mesh_, h)), v = mesh_.PositionAt(TargetOf(mesh_, h));
  const Vec3 w = mesh_.positions[Apex(h)], d = mesh_.positions[Apex(g)];
  const Corners across = CornersOf(mesh_.triangles[g / 3]);
  const double above = Distance(w, ClosestPointOnTriangle(w, across[0], across[1], across[2]).position);
  // The segments u v and w d, where their lines are nearest to each other.
  const Vec3 a = v - u, b = d - w, c = u - w, n = Cross(a, b);
  const double n2 = SquaredNorm(n);
  if (!(n2 > 0)) return above;
  const double s = Dot(Cross(b, c), n) / n2, t = Dot(Cross(a, c), n) / n2;
  if (!(s >= 0 && s <= 1 && t >= 0 && t <= 1)) return above;
  return std::min(above, std::abs(Dot(c, n)) / std::sqrt(n2));
}

// The side of a cap f (FlipEdge has the drawing), unless the surface would move too far or turn over.
bool SliverMender::Flip(uint32_t h) {
  const uint32_t g = adjacency_.OppositeOf(h);
  if (g == kNoHalfEdge || IsKept(h / 3) || IsKept(g / 3)) return false;
  const VertexId u = OriginOf(mesh_, h), v = TargetOf(mesh_, h), w = VertexId(Apex(h)), d = VertexId(Apex(g));
  if (w == d) return false;
  const Shape cap = ShapeOf(CornersOf(mesh_.triangles[h / 3])), across = ShapeOf(CornersOf(mesh_.triangles[g / 3]));
  if (Dot(NormalOf(h / 3), NormalOf(g / 3)) >= kSliverAgrees && cap.Height() > reach_) return false;
  const double moved = std::max(moved_[h / 3], moved_[g / 3]) + Deviation(h);
  if (moved + std::max({Moved(u), Moved(v), Moved(w), Moved(d)}) > reach_) return false;
  const Triangle left = {u, d, w}, right = {d, v, w};
  const Vec3 together = Normalized(cap.area + across.area);
  const double before = std::min(cap.Aspect(), across.Aspect());
  for (const Triangle& t : {left, right}) {
    const Shape s = ShapeOf(CornersOf(t));
    if (StateOf(mesh_, t) != FaceState::kSound || !(s.Aspect() > before) ||
        Dot(s.area, together) < kLeastSliverTurn * s.doubled_area)
      return false;
  }
  std::vector<uint32_t> neighbours;
  if (!NeighboursOf(PreviousHalfEdge(h), neighbours) ||
      std::find(neighbours.begin(), neighbours.end(), d.index()) != neighbours.end())
    return false;
  FlipEdge(mesh_, adjacency_, h);
  moved_[h / 3] = moved_[g / 3] = moved;
  LookAgain(h / 3), LookAgain(g / 3);
  return true;
}

// The half-edges that leave the origin of h, from h on; false when it lies on the rim or has too many. Not by VisitOutgoing: flips and
// collapses do not keep `outgoing`, which that begins with, and it has no bound.
bool SliverMender::Fan(uint32_t h, std::vector<uint32_t>& fan) const {
  fan.clear();
  uint32_t at = h;
  do {
    fan.push_back(at);
    at = adjacency_.NextAroundOrigin(at);
  } while (at != kNoHalfEdge && at != h && fan.size() <= kLongestFan);
  return at == h;
}

// The vertices that share an edge with the origin of h; false when there are too many.
bool SliverMender::NeighboursOf(uint32_t h, std::vector<uint32_t>& neighbours) const {
  neighbours.clear();
  uint32_t at = h;
  do {  // counter-clockwise
    neighbours.push_back(TargetOf(mesh_, at).index());
    if (adjacency_.NextAroundOrigin(at) == kNoHalfEdge) neighbours.push_back(Apex(at));
    at = adjacency_.NextAroundOrigin(at);
  } while (at != kNoHalfEdge && at != h && neighbours.size() <= kLongestFan);
  if (at == kNoHalfEdge) {
    for (at = adjacency_.OppositeOf(h); at != kNoHalfEdge && neighbours.size() <= kLongestFan;
         at = adjacency_.OppositeOf(at)) {
      at = NextHalfEdge(at);  // clockwise to the other rim
      neighbours.push_back(TargetOf(mesh_, at).index());
    }
  }
  return neighbours.size() <= kLongestFan;
}

// The link condition: the ends of h have no neighbours in common but those across it, which keep three neighbours.
bool SliverMender::KeepsTopology(uint32_t h) const {
  const uint32_t g = adjacency_.OppositeOf(h);
  std::vector<uint32_t> a, b;
  if (!NeighboursOf(h, a) || !NeighboursOf(g, b)) return false;
  int common = 0;
  for (const uint32_t v : a) common += std::find(b.begin(), b.end(), v) != b.end();
  if (common != 2) return false;
  for (const uint32_t leaving : {PreviousHalfEdge(h), PreviousHalfEdge(g)}) {
    if (!NeighboursOf(leaving, a) || a.size() <= 3) return false;
  }
  return true;
}

// How far the triangles around the origin of h leave their planes when it moves to the target; those of slivers are none.
double SliverMender::DeviationOfMoving(uint32_t h, const std::vector<uint32_t>& fan) const {
  const Vec3 way = mesh_.PositionAt(TargetOf(mesh_, h)) - mesh_.PositionAt(OriginOf(mesh_, h));
  double deviation = 0;
  for (const uint32_t e : fan) {
    if (!IsSliver(mesh_.triangles[e / 3])) deviation = std::max(deviation, std::abs(Dot(way, NormalOf(e / 3))));
  }
  return deviation;
}

// How much the triangles around the origin of h turn (1 - cosine, the largest) when it moves to the target; nothing when it must not.
std::optional<double> SliverMender::CostOfMoving(uint32_t h) const {
  std::vector<uint32_t> fan;
  if (!Fan(h, fan)) return std::nullopt;
  const uint32_t g = adjacency_.OppositeOf(h);
  const VertexId to = TargetOf(mesh_, h);
  const double moved = DeviationOfMoving(h, fan);
  double cost = 0;
  for (const uint32_t e : fan) {
    if (IsKept(e / 3) || moved_[e / 3] + vertex_moved_[Origin(h)] + moved > reach_) return std::nullopt;
    if (e / 3 == h / 3 || e / 3 == g / 3) continue;
    Triangle t = mesh_.triangles[e / 3];
    const Shape before = ShapeOf(CornersOf(t));
    t[e % 3] = to;
    const Shape after = ShapeOf(CornersOf(t));
    if (StateOf(mesh_, t) != FaceState::kSound) return std::nullopt;
    if (IsSliver(before)) {
      if (after.Aspect() < kLeastSliverAspectKept * before.Aspect()) return std::nullopt;
      continue;
    }
    const double cosine = Dot(before.area, after.area) / (before.doubled_area * after.doubled_area);
    if (cosine < kLeastSliverTurn || IsSliver(after)) return std::nullopt;
    cost = std::max(cost, 1 - cosine);
  }
  return cost;
}

bool SliverMender::Collapse(uint32_t h) {
  const uint32_t g = adjacency_.OppositeOf(h);
  if (g == kNoHalfEdge) return false;
  const double most = (IsSliver(mesh_.triangles[g / 3]) ? kStepReaches : 1) * reach_;
  if (SquaredLength(mesh_, h) > most * most) return false;
  const std::optional<double> one = CostOfMoving(h), other = CostOfMoving(g);
  if ((!one && !other) || !KeepsTopology(h)) return false;
  Move(one && (!other || *one <= *other) ? h : g);
  return true;
}

// The origin of h to its target; the two faces beside h go.
void SliverMender::Move(uint32_t h) {
  const uint32_t g = adjacency_.OppositeOf(h);
  const VertexId to = TargetOf(mesh_, h);
  std::vector<uint32_t> fan;
  Fan(h, fan);
  const double moved = DeviationOfMoving(h, fan);
  vertex_moved_[to.index()] = std::max(Moved(to), vertex_moved_[Origin(h)] + moved);
  MoveWedges(mesh_, h, g, fan);
  for (const uint32_t e : fan) mesh_.triangles[e / 3][e % 3] = to;
  for (const uint32_t side : {h, g}) {
    LinkHalfEdges(adjacency_, adjacency_.OppositeOf(NextHalfEdge(side)), adjacency_.OppositeOf(PreviousHalfEdge(side)));
    moved_[side / 3] = -1;
  }
  for (const uint32_t e : fan) {
    if (!IsGone(e / 3)) LookAgain(e / 3);
  }
}

void SliverMender::Finish() {
  std::vector<bool> dropped(mesh_.triangles.size());
  for (uint32_t f = 0; f < dropped.size(); ++f) dropped[f] = IsGone(f);
  DropTriangles(mesh_, dropped);
  adjacency_ = CreateAdjacency(mesh_);
  DropUnreferencedVertices(mesh_, adjacency_);
}

}  // namespace

SliverChanges MendSlivers(TriangleMesh& mesh, FaceAdjacency& adjacency, const std::vector<bool>& sharp, double reach,
                          const std::vector<bool>& kept) {
  return SliverMender(mesh, adjacency, reach, kept).Run(sharp);
}

}  // namespace meshfront
