// What a front set must be after every step, checked from scratch: slower and stricter than FrontSet::FindViolation.
#pragma once

#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/front/front_set.h"

namespace meshfront::testing {

inline std::vector<WindowTriangleId> LiveTriangles(const FrontSet& fronts) {
  std::vector<WindowTriangleId> live;
  for (uint32_t i = 0; i < fronts.triangle_slots(); ++i) {
    if (fronts.at(WindowTriangleId(i)).alive) live.push_back(WindowTriangleId(i));
  }
  return live;
}

inline std::vector<FrontEdgeId> LiveEdges(const FrontSet& fronts) {
  std::vector<FrontEdgeId> live;
  for (uint32_t i = 0; i < fronts.edge_slots(); ++i) {
    if (fronts.at(FrontEdgeId(i)).alive) live.push_back(FrontEdgeId(i));
  }
  return live;
}

// Number of loops that the live front edges form.
inline int CountLoops(const FrontSet& fronts) {
  std::set<FrontEdgeId> seen;
  int loops = 0;
  for (const FrontEdgeId start : LiveEdges(fronts)) {
    if (!seen.insert(start).second) continue;
    ++loops;
    for (FrontEdgeId e = fronts.at(start).next; e != start; e = fronts.at(e).next) seen.insert(e);
  }
  return loops;
}

// Walks once around every vertex, counter-clockwise, over its triangles, gaps and rim, and compares with what is there.
class FrontCheck {
 public:
  explicit FrontCheck(const FrontSet& fronts) : fronts_(fronts) {}

  // Empty when all is well.
  std::string Fault() {
    if (const char* violation = fronts_.FindViolation()) return violation;
    for (const auto check : {&FrontCheck::CheckTriangles, &FrontCheck::CheckEdges, &FrontCheck::CheckVertices}) {
      if (std::string fault = (this->*check)(); !fault.empty()) return fault;
    }
    return "";
  }

 private:
  struct Around {
    std::set<std::pair<uint32_t, int>> half_edges;  // of triangles, leaving the vertex
    std::set<FrontEdgeId> corners;
    std::vector<Link> past_rim_half_edge;     // leave the vertex, with the rim across
    std::vector<FrontEdgeId> past_rim_front;  // come in, owned by the rim
    bool settled = false;
  };

  std::string CheckTriangles() {
    const auto live = LiveTriangles(fronts_);
    if (live.size() != fronts_.triangle_count()) return "the number of triangles is wrong";
    for (const WindowTriangleId t : live) {
      for (int side = 0; side < 3; ++side) {
        const WindowVertexId u = Corner(t, side), v = Corner(t, side + 1);
        if (!half_edges_.insert({{u.index(), v.index()}, Link::HalfEdge(t, side)}).second)
          return "two triangles run along one edge";
        Around& around = around_[u.index()];
        around.half_edges.insert({t.index(), side});
        const Link across = fronts_.at(t).across[side];
        if (across.is_rim()) around.past_rim_half_edge.push_back(Link::HalfEdge(t, side));
        if (across == Link::Settled()) around.settled = around_[v.index()].settled = true;
      }
    }
    for (const auto& [ends, half_edge] : half_edges_) {
      const Link across = fronts_.at(half_edge.triangle()).across[half_edge.side()];
      const auto twin = half_edges_.find({ends.second, ends.first});
      if (across.is_half_edge() != (twin != half_edges_.end())) return "a triangle does not know its neighbour";
      if (across.is_half_edge() && twin->second != across) return "a triangle takes another for its neighbour";
      if (across.is_front() && fronts_.at(across.front()).owner != half_edge)
        return "a triangle lies at a front that is not its own";
    }
    return "";
  }

  std::string CheckEdges() {
    const auto live = LiveEdges(fronts_);
    if (live.size() != fronts_.front_edge_count()) return "the number of front edges is wrong";
    std::set<std::pair<uint32_t, uint32_t>> directed;
    for (const FrontEdgeId e : live) {
      const WindowVertexId from = fronts_.From(e), to = fronts_.To(e);
      if (!fronts_.at(from).alive) return "a front edge starts at a dropped vertex";
      if (!directed.insert({from.index(), to.index()}).second) return "two front edges run the same way";
      if (fronts_.LoopLength(e, 3) < 3) return "a loop of two edges";
      around_[from.index()].corners.insert(e);
      const Link owner = fronts_.at(e).owner;
      if (owner.is_half_edge() && Corner(owner.triangle(), owner.side() + 1) != to)
        return "a front edge ends elsewhere than its half-edge";
      if (owner.is_rim()) around_[to.index()].past_rim_front.push_back(e);
    }
    return "";
  }

  std::string CheckVertices() {
    for (uint32_t i = 0; i < fronts_.vertex_slots(); ++i) {
      const WindowVertex& v = fronts_.at(WindowVertexId(i));
      if (v.alive != (around_.count(i) > 0))
        return v.alive ? "a vertex that nothing uses is kept" : "a dropped vertex is used";
    }
    for (const auto& [vertex, around] : around_) {
      if (around.settled) continue;
      if (std::string fault = WalkAround(around); !fault.empty()) return fault;
      if (around.half_edges.empty()) continue;
      const Link h = fronts_.at(WindowVertexId(vertex)).half_edge;
      if (!h.is_half_edge() || around.half_edges.count({h.triangle().index(), h.side()}) == 0)
        return "a vertex has lost its triangles";
    }
    return "";
  }

  std::string WalkAround(const Around& around) {
    if (around.past_rim_half_edge.size() + around.past_rim_front.size() > 1) return "a vertex on two rims";
    std::set<std::pair<uint32_t, int>> seen_half_edges;
    std::set<FrontEdgeId> seen_corners;
    Link here = around.corners.empty() ? Link::HalfEdge(WindowTriangleId(around.half_edges.begin()->first),
                                                        around.half_edges.begin()->second)
                                       : Link::Front(*around.corners.begin());
    for (;;) {
      if (here.is_front()) {
        if (!seen_corners.insert(here.front()).second) break;
        here = fronts_.at(here.front()).owner;
      } else if (here.is_half_edge()) {
        if (!seen_half_edges.insert({here.triangle().index(), here.side()}).second) break;
        here = fronts_.at(here.triangle()).across[(here.side() + 2) % 3];
        if (here.is_front()) here = Link::Front(fronts_.at(here.front()).next);
      } else if (!around.past_rim_half_edge.empty()) {
        here = around.past_rim_half_edge[0];
      } else if (!around.past_rim_front.empty()) {
        here = Link::Front(fronts_.at(around.past_rim_front[0]).next);
      } else {
        return "the rim does not go on at a vertex";
      }
    }
    if (seen_half_edges != around.half_edges) return "a vertex whose triangles are not all reached around it";
    if (seen_corners != around.corners) return "a vertex whose gaps are not all reached around it";
    return "";
  }

  WindowVertexId Corner(WindowTriangleId t, int i) const { return fronts_.at(t).corners[i % 3]; }

  const FrontSet& fronts_;
  std::map<std::pair<uint32_t, uint32_t>, Link> half_edges_;
  std::map<uint32_t, Around> around_;
};

inline std::string FaultOf(const FrontSet& fronts) { return FrontCheck(fronts).Fault(); }

// By looking at everything.
inline bool EdgeExistsAnywhere(const FrontSet& fronts, WindowVertexId u, WindowVertexId v) {
  const auto joins = [&](WindowVertexId a, WindowVertexId b) { return (a == u && b == v) || (a == v && b == u); };
  for (const FrontEdgeId e : LiveEdges(fronts)) {
    if (joins(fronts.From(e), fronts.To(e))) return true;
  }
  for (const WindowTriangleId t : LiveTriangles(fronts)) {
    const auto& c = fronts.at(t).corners;
    for (int i = 0; i < 3; ++i) {
      if (joins(c[i], c[(i + 1) % 3])) return true;
    }
  }
  return false;
}

// Whether topology alone lets `edge` connect to `corner`: no edge and no face twice.
inline bool MayConnect(const FrontSet& fronts, FrontEdgeId edge, FrontEdgeId corner) {
  const WindowVertexId a = fronts.From(edge), b = fronts.To(edge), c = fronts.From(corner);
  if (c == a || c == b) return false;
  const Link owner = fronts.at(edge).owner;
  if (owner.is_half_edge() && fronts.at(owner.triangle()).corners[(owner.side() + 2) % 3] == c) return false;
  const bool zip_before = corner == fronts.at(edge).prev;
  const bool zip_after = corner == fronts.at(fronts.at(edge).next).next;
  return (zip_before || !EdgeExistsAnywhere(fronts, a, c)) && (zip_after || !EdgeExistsAnywhere(fronts, b, c));
}

// Grows, connects and seeds at random, only where topology allows it: handles, pinched vertices and merged loops come by themselves.
class RandomFronts {
 public:
  explicit RandomFronts(uint64_t seed) : random_(seed) {}

  size_t Below(size_t n) { return n == 0 ? 0 : random_() % n; }
  WindowVertexId NewVertex() {
    const double x = static_cast<double>(++made_);
    return fronts.AddVertex({{x, 0, 0}, {0, 0, 1}}, 1, 0);
  }
  void Seed() {
    const WindowVertexId a = NewVertex(), b = NewVertex(), c = NewVertex();
    fronts.AddSeed(a, b, c);
  }
  void Loop(int n) {
    std::vector<WindowVertexId> vertices;
    for (int i = 0; i < n; ++i) vertices.push_back(NewVertex());
    fronts.AddLoop(vertices);
  }
  FrontEdgeId AnyEdge() {
    const auto live = LiveEdges(fronts);
    return live.empty() ? FrontEdgeId() : live[Below(live.size())];
  }
  // A side of any triangle; the rim's when there is no triangle.
  Link AnySide() {
    const auto live = LiveTriangles(fronts);
    return live.empty() ? Link::Rim() : Link::HalfEdge(live[Below(live.size())], static_cast<int>(Below(3)));
  }
  Link Across(Link side) const { return fronts.at(side.triangle()).across[side.side()]; }
  WindowVertexId Opposite(Link side) const { return fronts.at(side.triangle()).corners[(side.side() + 2) % 3]; }
  // One step; false when nothing was done.
  bool Step() {
    const FrontEdgeId edge = AnyEdge();
    if (!edge.valid()) return Seed(), true;
    FrontEdgeId corner;
    switch (Below(6)) {
      case 0:
      case 1:
        fronts.Grow(edge, NewVertex());
        return true;
      case 2:
        corner = fronts.at(edge).prev;
        break;
      case 3:
        corner = fronts.at(fronts.at(edge).next).next;
        break;
      default:
        corner = AnyEdge();
    }
    if (!MayConnect(fronts, edge, corner)) return false;
    fronts.Connect(edge, corner, TriangleKind::kConnection);
    return true;
  }

  FrontSet fronts;

 private:
  std::mt19937_64 random_;
  uint64_t made_ = 0;
};

}  // namespace meshfront::testing
