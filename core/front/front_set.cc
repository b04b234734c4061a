// Front set. The steps of sec. 3, on loops in an arena:
//
//   Grow      … P → e → N …   becomes  … P → x → y → N …            (a new vertex between x and y)
//   Connect   to the corner O (with I before it), e = a → b, apex c:
//     ear     c = start of P, or end of N: e and that neighbour are replaced by one edge
//     close   both: the loop had three edges and is gone
//     else    P → x → O and I → y → N: a split when O is on the same loop, a merge when it is on another. The rewiring is the
//             same for both, so nobody needs to know which loop an edge is on (rejected: loop ids, which a merge must rename).
#include "core/front/front_set.h"

#include <algorithm>

namespace meshfront {
namespace {

constexpr int Next(int i) { return i == 2 ? 0 : i + 1; }
constexpr int Prev(int i) { return i == 0 ? 2 : i - 1; }

// A free slot of `pool`, reused or new.
template <class T>
uint32_t Allocate(std::vector<T>& pool, std::vector<uint32_t>& free_slots) {
  if (free_slots.empty()) {
    pool.emplace_back();
    return static_cast<uint32_t>(pool.size() - 1);
  }
  const uint32_t slot = free_slots.back();
  free_slots.pop_back();
  return slot;
}

}  // namespace

WindowVertexId FrontSet::AddVertex(const SourcePoint& source, double length, double max_curvature) {
  const WindowVertexId id(Allocate(vertices_, free_vertices_));
  WindowVertex& v = at(id);
  v = WindowVertex{};
  v.source = source;
  v.position = source.position;
  v.length = length;
  v.max_curvature = max_curvature;
  v.alive = true;
  return id;
}

void FrontSet::AttachJoint(WindowVertexId v, uint32_t joint) {
  if (joint >= joints_.size()) joints_.resize(joint + 1);
  at(v).joint = joint;
  joints_[joint].normal += at(v).source.normal;
  ++joints_[joint].vertices;
}

uint64_t FrontSet::PairOf(uint32_t joint, uint32_t other) {
  const auto [low, high] = std::minmax(joint, other);
  return uint64_t{low} << 32 | high;
}

void FrontSet::CountSide(WindowVertexId u, WindowVertexId v, int change) {
  if (at(u).joint == kNoJoint || at(v).joint == kNoJoint) return;
  uint8_t& count = sides_at_joints_[JointPair(u, v)];
  count = static_cast<uint8_t>(count + change);
}

void FrontSet::CountSides(const WindowTriangle& t, int change) {
  for (int i = 0; i < 3; ++i) CountSide(t.corners[i], t.corners[Next(i)], change);
}

int FrontSet::SidesOnCrease(FrontEdgeId e) const {
  const auto found = sides_at_joints_.find(JointPair(From(e), To(e)));
  return found == sides_at_joints_.end() ? 0 : found->second & ~kOnCrease;
}

bool FrontSet::IsOnCrease(WindowVertexId u, WindowVertexId v) const {
  if (at(u).joint == kNoJoint || at(v).joint == kNoJoint) return false;
  const auto found = sides_at_joints_.find(JointPair(u, v));
  return found != sides_at_joints_.end() && (found->second & kOnCrease) != 0;
}

std::vector<std::pair<uint32_t, uint32_t>> FrontSet::BareCreases() const {
  std::vector<std::pair<uint32_t, uint32_t>> bare;
  for (const auto& [pair, sides] : sides_at_joints_) {
    if (sides == (kOnCrease | 1)) bare.push_back({static_cast<uint32_t>(pair >> 32), static_cast<uint32_t>(pair)});
  }
  std::sort(bare.begin(), bare.end());
  return bare;
}

FrontEdgeId FrontSet::NewEdge(WindowVertexId from, Link owner) {
  const FrontEdgeId id(Allocate(edges_, free_edges_));
  FrontEdge& e = edges_[id.index()];
  const uint32_t generation = e.generation;
  e = FrontEdge{};
  e.from = from;
  e.owner = owner;
  e.generation = generation;
  e.birth = births_++;
  e.alive = true;
  e.next_at_vertex = at(from).first_corner;
  at(from).first_corner = id;
  if (owner.is_half_edge()) at(owner.triangle()).across[owner.side()] = Link::Front(id);
  ++front_edge_count_;
  return id;
}

void FrontSet::DropEdge(FrontEdgeId id) {
  FrontEdge& e = edges_[id.index()];
  FrontEdgeId* hook = &at(e.from).first_corner;
  while (*hook != id) hook = &edges_[hook->index()].next_at_vertex;
  *hook = e.next_at_vertex;
  e.alive = false;
  ++e.generation;
  free_edges_.push_back(id.index());
  --front_edge_count_;
}

WindowTriangleId FrontSet::NewTriangle(WindowVertexId a, WindowVertexId b, WindowVertexId c, TriangleKind kind) {
  const WindowTriangleId id(Allocate(triangles_, free_triangles_));
  WindowTriangle& t = at(id);
  t = WindowTriangle{};
  t.corners = {a, b, c};
  t.kind = kind;
  t.alive = true;
  for (int i = 0; i < 3; ++i) at(t.corners[i]).half_edge = Link::HalfEdge(id, i), ++at(t.corners[i]).triangles;
  ++triangle_count_;
  CountSides(t, 1);
  return id;
}

void FrontSet::Join(Link half_edge, Link other) {
  at(half_edge.triangle()).across[half_edge.side()] = other;
  if (other.is_half_edge()) at(other.triangle()).across[other.side()] = half_edge;
}

void FrontSet::Chain(FrontEdgeId first, FrontEdgeId second) {
  edges_[first.index()].next = second;
  edges_[second.index()].prev = first;
}

FrontEdgeId FrontSet::AddLoop(absl::Span<const WindowVertexId> vertices) {
  std::vector<FrontEdgeId> made;
  for (const WindowVertexId v : vertices) {
    made.push_back(NewEdge(v, Link::Rim()));
    at(v).on_rim = true;
  }
  for (size_t i = 0; i < made.size(); ++i) Chain(made[i], made[(i + 1) % made.size()]);
  return made[0];
}

FrontEdgeId FrontSet::AddSeed(WindowVertexId a, WindowVertexId b, WindowVertexId c) {
  const WindowTriangleId t = NewTriangle(a, b, c, TriangleKind::kFree);
  std::array<FrontEdgeId, 3> made;
  for (int i = 0; i < 3; ++i) made[i] = NewEdge(at(t).corners[i], Link::HalfEdge(t, i));
  for (int i = 0; i < 3; ++i) Chain(made[i], made[Next(i)]);
  return made[0];
}

FrontSet::Step FrontSet::Grow(FrontEdgeId edge, WindowVertexId apex) {
  const FrontEdge e = at(edge);
  const WindowVertexId a = e.from, b = To(edge);
  Step step;
  step.triangle = NewTriangle(b, a, apex, TriangleKind::kFree);
  DropEdge(edge);
  Join(Link::HalfEdge(step.triangle, 0), e.owner);
  const FrontEdgeId x = NewEdge(a, Link::HalfEdge(step.triangle, 1));
  const FrontEdgeId y = NewEdge(apex, Link::HalfEdge(step.triangle, 2));
  Chain(e.prev, x), Chain(x, y), Chain(y, e.next);
  step.made = {x, y};
  step.made_count = 2;
  return step;
}

FrontSet::Step FrontSet::Connect(FrontEdgeId edge, FrontEdgeId corner, TriangleKind kind) {
  const FrontEdge e = at(edge), before = at(e.prev), after = at(e.next), apex = at(corner);
  const WindowVertexId a = e.from, b = after.from, c = apex.from;
  const bool zip_before = corner == e.prev;     // c → a is the edge before
  const bool zip_after = corner == after.next;  // b → c is the edge after
  Step step;
  step.triangle = NewTriangle(b, a, c, kind);
  const Link side_ac = Link::HalfEdge(step.triangle, 1), side_cb = Link::HalfEdge(step.triangle, 2);
  DropEdge(edge);
  Join(Link::HalfEdge(step.triangle, 0), e.owner);
  if (zip_before) DropEdge(e.prev), Join(side_ac, before.owner);
  if (zip_after) DropEdge(e.next), Join(side_cb, after.owner);
  if (!zip_before) step.made[step.made_count++] = NewEdge(a, side_ac);
  if (!zip_after) step.made[step.made_count++] = NewEdge(c, side_cb);
  if (zip_before && zip_after) return step;
  const FrontEdgeId x = step.made[0], y = step.made[step.made_count - 1];
  if (zip_before) {
    Chain(before.prev, y), Chain(y, e.next);
  } else if (zip_after) {
    Chain(e.prev, x), Chain(x, corner);
  } else {
    Chain(e.prev, x), Chain(x, corner), Chain(apex.prev, y), Chain(y, e.next);
  }
  return step;
}

// The front edge that follows at a vertex once the removed triangles are gone: turns around the vertex through removed
// triangles, from the removed side that leaves it, until something that stays comes in.
FrontEdgeId FrontSet::CornerAfterRemoval(Link side, const std::vector<FrontEdgeId>& made_at,
                                         const std::vector<uint32_t>& slot) const {
  for (;;) {
    const WindowTriangleId t = side.triangle();
    const int incoming = Prev(side.side());
    const FrontEdgeId made = made_at[3 * slot[t.index()] + incoming];
    if (made.valid()) return made;
    const Link across = at(t).across[incoming];
    if (across.is_front()) {
      const FrontEdgeId corner = at(across.front()).next;
      const Link owner = at(corner).owner;
      if (!owner.is_half_edge() || slot[owner.triangle().index()] == WindowTriangleId::kInvalid) return corner;
      side = owner;
    } else {
      side = across;  // the half-edge of another removed triangle that leaves the vertex
    }
  }
}

std::vector<FrontEdgeId> FrontSet::Remove(absl::Span<const WindowTriangleId> removed) {
  std::vector<uint32_t> slot(triangles_.size(), WindowTriangleId::kInvalid);
  for (size_t i = 0; i < removed.size(); ++i) slot[removed[i].index()] = static_cast<uint32_t>(i);
  const auto is_removed = [&](Link l) {
    return l.is_half_edge() && slot[l.triangle().index()] != WindowTriangleId::kInvalid;
  };

  // New front edges where a removed triangle meets something that stays, indexed by the removed side.
  std::vector<FrontEdgeId> made_at(3 * removed.size());
  std::vector<Link> made_from(0);
  std::vector<FrontEdgeId> made, gone;
  std::vector<std::pair<FrontEdgeId, Link>>
      survivors;  // front edges whose next is gone, and the removed side that it owned
  for (size_t i = 0; i < removed.size(); ++i) {
    for (int side = 0; side < 3; ++side) {
      const Link across = at(removed[i]).across[side];
      if (across.is_front()) {
        gone.push_back(across.front());
        const FrontEdge& before = at(at(across.front()).prev);
        if (!is_removed(before.owner)) survivors.push_back({at(across.front()).prev, Link::HalfEdge(removed[i], side)});
      } else if (!is_removed(across)) {
        const FrontEdgeId e = NewEdge(at(removed[i]).corners[Next(side)], across);
        made_at[3 * i + side] = e;
        made.push_back(e);
        made_from.push_back(Link::HalfEdge(removed[i], side));
      }
    }
  }
  std::vector<FrontEdgeId> next_of_made, next_of_survivor;
  for (const Link side : made_from) next_of_made.push_back(CornerAfterRemoval(side, made_at, slot));
  for (const auto& [e, side] : survivors) next_of_survivor.push_back(CornerAfterRemoval(side, made_at, slot));
  for (size_t i = 0; i < made.size(); ++i) Chain(made[i], next_of_made[i]);
  for (size_t i = 0; i < survivors.size(); ++i) Chain(survivors[i].first, next_of_survivor[i]);
  for (const FrontEdgeId e : gone) DropEdge(e);
  std::vector<WindowVertexId> touched;
  for (const WindowTriangleId t : removed) {
    for (const WindowVertexId v : at(t).corners) at(v).half_edge = Link::Rim(), --at(v).triangles, touched.push_back(v);
    at(t).alive = false;
    CountSides(at(t), -1);
    free_triangles_.push_back(t.index());
    --triangle_count_;
  }
  for (const FrontEdgeId e : made) {
    const Link owner = at(e).owner;
    if (!owner.is_half_edge()) continue;
    at(From(e)).half_edge = owner;
    at(at(owner.triangle()).corners[Next(owner.side())]).half_edge =
        Link::HalfEdge(owner.triangle(), Next(owner.side()));
  }
  // A vertex pinched between kept triangles may have none of the new edges' triangles at its fan; its corners know one.
  for (const WindowVertexId v : touched) {
    WindowVertex& w = at(v);
    if (!w.alive || w.half_edge.is_half_edge()) continue;
    for (FrontEdgeId c = w.first_corner; c.valid(); c = at(c).next_at_vertex) {
      const Link owner = at(c).owner, before = at(at(c).prev).owner;
      if (owner.is_half_edge())
        w.half_edge = owner;
      else if (before.is_half_edge())
        w.half_edge = Link::HalfEdge(before.triangle(), Next(before.side()));
    }
    if (!w.first_corner.valid()) {
      w.alive = false;
      free_vertices_.push_back(v.index());
    }
  }
  return made;
}

void FrontSet::Flip(Link h) {
  const Link g = at(h.triangle()).across[h.side()];
  const WindowTriangleId s = h.triangle(), t = g.triangle();
  const int i = h.side(), j = g.side();
  // s = (a, b, c) with a → b shared, t = (b, a, d).
  const WindowVertexId a = at(s).corners[i], b = at(s).corners[Next(i)], c = at(s).corners[Prev(i)];
  const WindowVertexId d = at(t).corners[Prev(j)];
  const Link bc = at(s).across[Next(i)], ca = at(s).across[Prev(i)];
  const Link ad = at(t).across[Next(j)], db = at(t).across[Prev(j)];
  at(s).corners = {c, d, b};
  at(t).corners = {d, c, a};
  const std::array<std::pair<Link, Link>, 5> joints = {{{Link::HalfEdge(s, 0), Link::HalfEdge(t, 0)},
                                                        {Link::HalfEdge(s, 1), db},
                                                        {Link::HalfEdge(s, 2), bc},
                                                        {Link::HalfEdge(t, 1), ca},
                                                        {Link::HalfEdge(t, 2), ad}}};
  for (const auto& [side, other] : joints) {
    Join(side, other);
    if (other.is_front()) edges_[other.front().index()].owner = side;
  }
  for (int k = 0; k < 3; ++k) {
    at(at(s).corners[k]).half_edge = Link::HalfEdge(s, k);
    at(at(t).corners[k]).half_edge = Link::HalfEdge(t, k);
  }
  --at(a).triangles, --at(b).triangles, ++at(c).triangles, ++at(d).triangles;
  CountSide(a, b, -2), CountSide(c, d, 2);
}

void FrontSet::JoinBothWays(Link half_edge, Link other) {
  Join(half_edge, other);
  if (other.is_front()) edges_[other.front().index()].owner = half_edge;
}

Link FrontSet::SplitSide(Link h, WindowVertexId v) {
  // s = (a, b, c) with a → b in its side becomes (a, v, c) and (v, b, c); so does the one across, (b, a, d), if there is one.
  const auto halve = [&](WindowTriangleId s, int side) {
    const WindowVertexId a = at(s).corners[side], b = at(s).corners[Next(side)], c = at(s).corners[Prev(side)];
    const Link bc = at(s).across[Next(side)], ca = at(s).across[Prev(side)];
    const WindowTriangleId half = NewTriangle(v, b, c, TriangleKind::kClosing);
    WindowTriangle& rest = at(s);
    CountSides(rest, -1);
    rest.corners = {a, v, c};
    CountSides(rest, 1);
    rest.across = {Link::Rim(), Link::Rim(), Link::Rim()};
    rest.kind = TriangleKind::kClosing;
    --at(b).triangles, ++at(v).triangles;
    JoinBothWays(Link::HalfEdge(half, 1), bc);
    JoinBothWays(Link::HalfEdge(s, 2), ca);
    Join(Link::HalfEdge(s, 1), Link::HalfEdge(half, 2));
    for (int i = 0; i < 3; ++i) at(at(s).corners[i]).half_edge = Link::HalfEdge(s, i);
    at(b).half_edge = Link::HalfEdge(half, 1);
    return half;
  };
  const Link g = at(h.triangle()).across[h.side()];
  const WindowTriangleId s = h.triangle(), s_half = halve(s, h.side());
  if (!g.is_half_edge()) {
    at(v).on_rim = true;
    return Link::HalfEdge(s_half, 0);
  }
  const WindowTriangleId t = g.triangle(), t_half = halve(t, g.side());
  Join(Link::HalfEdge(s, 0), Link::HalfEdge(t_half, 0));  // a → v and v → a
  Join(Link::HalfEdge(s_half, 0), Link::HalfEdge(t, 0));  // v → b and b → v
  return Link::HalfEdge(s_half, 0);
}

void FrontSet::SplitTriangle(WindowTriangleId t, WindowVertexId v) {
  const std::array<WindowVertexId, 3> c = at(t).corners;
  const std::array<Link, 3> across = at(t).across;
  const std::array<WindowTriangleId, 3> parts = {t, NewTriangle(c[1], c[2], v, TriangleKind::kClosing),
                                                 NewTriangle(c[2], c[0], v, TriangleKind::kClosing)};
  CountSides(at(t), -1);
  at(t).corners = {c[0], c[1], v};
  CountSides(at(t), 1);
  at(t).kind = TriangleKind::kClosing;
  --at(c[2]).triangles, ++at(v).triangles;
  for (int i = 0; i < 3; ++i) {
    JoinBothWays(Link::HalfEdge(parts[i], 0), across[i]);
    Join(Link::HalfEdge(parts[i], 1), Link::HalfEdge(parts[Next(i)], 2));
    at(c[i]).half_edge = Link::HalfEdge(parts[i], 0);
  }
  at(v).half_edge = Link::HalfEdge(t, 2);
}

std::vector<VertexId> FrontSet::Settle(absl::Span<const WindowTriangleId> settled) {
  std::vector<WindowVertexId> touched;
  for (const WindowTriangleId t : settled) {
    WindowTriangle& triangle = at(t);
    triangle.alive = false;
    free_triangles_.push_back(t.index());
    --triangle_count_;
    for (const WindowVertexId v : triangle.corners) --at(v).triangles, touched.push_back(v);
  }
  for (const WindowVertexId v : touched) {
    const Link h = at(v).half_edge;
    if (h.is_half_edge() && !at(h.triangle()).alive) at(v).half_edge = Link::Settled();
  }
  for (const WindowTriangleId t : settled) {
    for (const Link across : at(t).across) {
      if (across.is_front()) edges_[across.front().index()].owner = Link::Settled();
      if (!across.is_half_edge() || !at(across.triangle()).alive) continue;
      WindowTriangle& neighbour = at(across.triangle());
      neighbour.across[across.side()] = Link::Settled();
      at(neighbour.corners[across.side()]).half_edge = across;
      const int after = Next(across.side());
      at(neighbour.corners[after]).half_edge = Link::HalfEdge(across.triangle(), after);
    }
  }
  std::vector<VertexId> finalised;
  for (const WindowVertexId v : touched) {
    WindowVertex& w = at(v);
    if (!w.alive || w.triangles > 0 || w.first_corner.valid())
      continue;  // not by half_edge: it knows one run of several
    w.alive = false;
    if (w.joint == kNoJoint || --joints_[w.joint].vertices == 0) finalised.push_back(w.emitted);
    free_vertices_.push_back(v.index());
  }
  return finalised;
}

template <class Visitor>
bool FrontSet::AnyNeighbour(WindowVertexId v, const Visitor& visit) const {
  for (FrontEdgeId corner = at(v).first_corner; corner.valid(); corner = at(corner).next_at_vertex) {
    if (visit(To(corner)) || visit(From(at(corner).prev))) return true;
    for (Link h = at(corner).owner; h.is_half_edge();) {  // away from the front edge that leaves v
      const WindowTriangle& t = at(h.triangle());
      if (visit(t.corners[Prev(h.side())])) return true;
      h = t.across[Prev(h.side())];
    }
    for (Link h = at(at(corner).prev).owner; h.is_half_edge();) {  // and away from the one that comes in
      const WindowTriangle& t = at(h.triangle());
      if (visit(t.corners[Prev(h.side())])) return true;
      h = t.across[Next(h.side())];
    }
  }
  if (at(v).first_corner.valid()) return false;
  bool found = false;
  VisitFan(v, [&](WindowTriangleId t, int i) {
    found = found || visit(at(t).corners[Next(i)]) || visit(at(t).corners[Prev(i)]);
  });
  return found;
}

bool FrontSet::EdgeExists(WindowVertexId u, WindowVertexId v) const {
  if (at(u).joint != kNoJoint && at(v).joint != kNoJoint) {  // other patches count as well
    const auto found = sides_at_joints_.find(JointPair(u, v));
    if (at(u).joint == at(v).joint || (found != sides_at_joints_.end() && found->second > 0)) return true;
  }
  if (at(u).frozen()) {  // some of its triangles may be gone
    if (at(v).frozen()) return true;
    std::swap(u, v);
  }
  return AnyNeighbour(u, [v](WindowVertexId w) { return w == v; });
}

std::vector<FrontEdgeId> FrontSet::LoopOf(FrontEdgeId edge) const {
  std::vector<FrontEdgeId> loop;
  FrontEdgeId e = edge;
  do {
    loop.push_back(e);
    e = at(e).next;
  } while (e != edge);
  return loop;
}

FrontEdgeId FrontSet::FindEdge(WindowVertexId u, WindowVertexId v) const {
  FrontEdgeId e = at(u).first_corner;
  while (e.valid() && To(e) != v) e = at(e).next_at_vertex;
  return e;
}

FrontEdgeId FrontSet::CornerOnLoop(FrontEdgeId edge, WindowVertexId v) const {
  FrontEdgeId e = edge;
  while (From(e) != v) {
    e = at(e).next;
    if (e == edge) return {};
  }
  return e;
}

size_t FrontSet::LoopLength(FrontEdgeId edge, size_t limit) const {
  size_t length = 0;
  FrontEdgeId e = edge;
  do {
    e = at(e).next;
    ++length;
  } while (e != edge && length < limit);
  return length;
}

const char* FrontSet::FindViolation() const {
  for (uint32_t i = 0; i < edges_.size(); ++i) {
    const FrontEdge& e = edges_[i];
    if (!e.alive) continue;
    if (!at(e.next).alive || at(e.next).prev != FrontEdgeId(i)) return "a front edge is not before its next";
    if (e.from == To(FrontEdgeId(i))) return "a front edge starts where it ends";
    if (e.owner.is_half_edge()) {
      const WindowTriangle& t = at(e.owner.triangle());
      if (!t.alive || t.across[e.owner.side()] != Link::Front(FrontEdgeId(i)))
        return "a front edge and its triangle disagree";
      if (t.corners[e.owner.side()] != e.from) return "a front edge starts elsewhere than its half-edge";
    }
    bool listed = false;
    for (FrontEdgeId c = at(e.from).first_corner; c.valid(); c = at(c).next_at_vertex) listed |= c == FrontEdgeId(i);
    if (!listed) return "a corner is not listed at its vertex";
  }
  for (uint32_t i = 0; i < triangles_.size(); ++i) {
    const WindowTriangle& t = triangles_[i];
    for (int side = 0; side < 3 && t.alive; ++side) {
      const Link across = t.across[side];
      if (!at(t.corners[side]).alive) return "a triangle uses a dropped vertex";
      if (across.is_front() && !at(across.front()).alive) return "a triangle lies at a front edge that is gone";
      if (!across.is_half_edge()) continue;
      const WindowTriangle& other = at(across.triangle());
      if (!other.alive || other.across[across.side()] != Link::HalfEdge(WindowTriangleId(i), side))
        return "two sides disagree";
      if (other.corners[across.side()] != t.corners[Next(side)]) return "two sides run the same way";
    }
  }
  return nullptr;
}

}  // namespace meshfront
