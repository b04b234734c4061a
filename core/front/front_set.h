// The fronts and the triangles behind them that are not settled yet: pure topology, no geometry is decided here.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "absl/types/span.h"
#include "core/base/ids.h"
#include "core/mesh/mesh_sink.h"
#include "core/surface/oriented_loop.h"
#include "core/surface/surface.h"

namespace meshfront {

using WindowVertexId = Id<struct WindowVertexTag>;
using WindowTriangleId = Id<struct WindowTriangleTag>;
using FrontEdgeId = Id<struct FrontEdgeTag>;

// What lies across a side of a triangle: another triangle's half-edge, a front edge, the rim of the surface, or a triangle
// that was settled and is gone.
class Link {
 public:
  constexpr Link() = default;
  static constexpr Link HalfEdge(WindowTriangleId t, int side) { return Link(3 * t.index() + side); }
  static constexpr Link Front(FrontEdgeId e) { return Link(kFrontBit | e.index()); }
  static constexpr Link Rim() { return Link(kRimCode); }
  static constexpr Link Settled() { return Link(kSettledCode); }

  constexpr bool is_half_edge() const { return code_ < kSettledCode; }
  constexpr bool is_front() const { return (code_ & kFrontBit) != 0; }
  constexpr bool is_rim() const { return code_ == kRimCode; }
  constexpr WindowTriangleId triangle() const { return WindowTriangleId(code_ / 3); }
  constexpr int side() const { return static_cast<int>(code_ % 3); }
  constexpr FrontEdgeId front() const { return FrontEdgeId(code_ & ~kFrontBit); }
  friend constexpr bool operator==(Link, Link) = default;

 private:
  static constexpr uint32_t kFrontBit = 0x80000000u, kRimCode = 0x7fffffffu, kSettledCode = 0x7ffffffeu;
  constexpr explicit Link(uint32_t code) : code_(code) {}
  uint32_t code_ = kRimCode;
};

inline constexpr uint32_t kNoWedge = 0xffffffffu;

// A vertex that some unsettled triangle or front edge uses. It lies at `position`, which is `source.position` until the fit
// moves it along the normal.
struct WindowVertex {
  SourcePoint source;
  Vec3 position;
  double length = 0;             // g at its place when it was made
  double max_curvature = 0;      // of the surface there
  FrontEdgeId first_corner;      // a front edge that starts here; the others follow by next_at_vertex
  Link half_edge = Link::Rim();  // an outgoing half-edge of some triangle
  VertexId emitted;              // its id in the output, once it was sent: from then on it may not move
  uint32_t wedge = kNoWedge;     // its number among the output's wedges, once it was sent
  uint32_t joint = kNoJoint;     // which vertex of the output it shares with vertices of other fronts
  uint32_t triangles = 0;        // unsettled ones that use it
  uint32_t origin = 0;           // which loop or seed its front came from (counts the components)
  uint32_t sheet = 0;            // Surface::SheetOf: fronts on others are none of its business
  uint32_t depth = 0;            // scratch of the settling window: rings between it and the nearest front
  bool improved = false;         // the settling window has had its turn with it
  bool refined = false;          // its length comes from a refinement of the closing ladder
  bool on_rim = false;           // lies on an initial front: keeps its place
  bool alive = false;

  bool on_front() const { return first_corner.valid(); }
  bool frozen() const { return emitted.valid(); }
};

// A vertex of the output that lies on a crease: every patch around it has a window vertex of its own there.
struct Joint {
  Vec3 normal;            // sum of those of its window vertices
  uint32_t vertices = 0;  // of the window that are this one
  uint32_t label = 0;     // origin of the first front that came through here
  VertexId emitted;
};

// What the audit before settling decided of a triangle that intersects another.
enum class AuditMark : uint8_t { kNone, kExcused, kFault };

// Counter-clockwise seen from outside; side i runs from corner i to corner i + 1.
struct WindowTriangle {
  std::array<WindowVertexId, 3> corners;
  std::array<Link, 3> across;
  TriangleKind kind = TriangleKind::kFree;
  AuditMark audit = AuditMark::kNone;
  bool alive = false;
  double deviation = -1;  // from the surface, where that is to be kept; < 0: not measured since something moved
};

// A directed edge of a front: the meshed side on its left, the open side on its right. It is also the *corner* of the front at
// its start: a vertex where fronts touch has several.
struct FrontEdge {
  WindowVertexId from;
  FrontEdgeId next, prev;
  FrontEdgeId next_at_vertex;
  Link owner;               // the half-edge that runs the same way (in the triangle on its left), or the rim
  uint32_t generation = 0;  // counts the lives of this slot, so that stale references are recognised
  uint32_t birth = 0;       // order of creation
  bool alive = false;
};

// Keeps the invariant "the meshed part is an oriented manifold with the fronts as its boundary": every edge has at most two
// triangles and every vertex's triangles and gaps alternate around it (CheckInvariant; run after each step in debug builds).
// The caller says where a triangle goes and must have asked EdgeExists before.
class FrontSet {
 public:
  WindowVertexId AddVertex(const SourcePoint& source, double length, double max_curvature);
  // A closed loop of front edges along `vertices` with nothing on its meshed side (a rim). At least 3. Returns its first edge.
  FrontEdgeId AddLoop(absl::Span<const WindowVertexId> vertices);
  // Says which joint a new vertex is, before its loop is added, and that an edge of the loop lies on a crease, where the loop on
  // the other side has it too. `joint`: below 2^31.
  void AttachJoint(WindowVertexId v, uint32_t joint);
  void MarkCrease(WindowVertexId u, WindowVertexId v) { sides_at_joints_.try_emplace(JointPair(u, v), kOnCrease); }
  // Joints that an edge outside of what is meshed joins: no edge here may.
  void MarkTaken(uint32_t u, uint32_t v) { sides_at_joints_.try_emplace(PairOf(u, v), kOnCrease); }
  bool IsOnCrease(WindowVertexId u, WindowVertexId v) const;
  bool IsOnCrease(FrontEdgeId e) const { return IsOnCrease(From(e), To(e)); }
  // Triangles that have this edge of a crease as a side, on both of its sides, 0 to 2.
  int SidesOnCrease(FrontEdgeId e) const;
  // Edges of creases that have a triangle on one side only, as pairs of joints, in increasing order. O(edges of creases).
  std::vector<std::pair<uint32_t, uint32_t>> BareCreases() const;
  Joint& joint(uint32_t number) { return joints_[number]; }
  // What tells vertices of the output apart: the same number for all window vertices of a joint.
  uint32_t IdentityOf(WindowVertexId v) const {
    return at(v).joint == kNoJoint ? v.index() : IdentityOfJoint(at(v).joint);
  }
  static constexpr uint32_t IdentityOfJoint(uint32_t joint) { return kJointBit | joint; }
  // A triangle with three front edges around it. Returns one of them.
  FrontEdgeId AddSeed(WindowVertexId a, WindowVertexId b, WindowVertexId c);

  // What a step did to the fronts: the edges that it made (at most two).
  struct Step {
    WindowTriangleId triangle;
    std::array<FrontEdgeId, 2> made;
    int made_count = 0;
  };
  // The triangle (to, from, apex) on the open side of `edge`, with a new vertex: the loop grows by one edge.
  Step Grow(FrontEdgeId edge, WindowVertexId apex);
  // The same with the vertex at `corner`, an existing corner of a front: cuts an ear, closes a loop of three, splits the loop or
  // merges two, whatever the corner is.
  Step Connect(FrontEdgeId edge, FrontEdgeId corner, TriangleKind kind);

  // Takes triangles back: the fronts retreat behind them, vertices that nothing uses are dropped. No vertex of them may be
  // frozen. Returns the front edges that appeared.
  std::vector<FrontEdgeId> Remove(absl::Span<const WindowTriangleId> triangles);
  // Turns the edge across which `half_edge` lies. Both triangles must be alive; the caller has checked the new edge.
  void Flip(Link half_edge);
  // Puts vertex `v` on the side of `half_edge`: its triangle and the one across become two each, all of kind kClosing. Across must
  // lie a triangle or the rim, which then goes through v. The first half-edge from v along the side.
  Link SplitSide(Link half_edge, WindowVertexId v);
  // Puts vertex `v` into a triangle, which becomes three of kind kClosing.
  void SplitTriangle(WindowTriangleId t, WindowVertexId v);
  // Drops triangles that went to the sink, and the vertices that only they used; returns the ids of those vertices' output.
  std::vector<VertexId> Settle(absl::Span<const WindowTriangleId> triangles);

  const WindowVertex& at(WindowVertexId v) const { return vertices_[v.index()]; }
  WindowVertex& at(WindowVertexId v) { return vertices_[v.index()]; }
  const WindowTriangle& at(WindowTriangleId t) const { return triangles_[t.index()]; }
  WindowTriangle& at(WindowTriangleId t) { return triangles_[t.index()]; }
  const FrontEdge& at(FrontEdgeId e) const { return edges_[e.index()]; }
  WindowVertexId From(FrontEdgeId e) const { return at(e).from; }
  WindowVertexId To(FrontEdgeId e) const { return at(at(e).next).from; }
  bool IsAlive(FrontEdgeId e, uint32_t generation) const { return at(e).alive && at(e).generation == generation; }

  size_t vertex_slots() const { return vertices_.size(); }
  size_t triangle_slots() const { return triangles_.size(); }
  size_t edge_slots() const { return edges_.size(); }
  size_t front_edge_count() const { return front_edge_count_; }
  size_t triangle_count() const { return triangle_count_; }

  // Whether some triangle side or front edge already joins u and v; true as well when nobody can tell, because both have
  // triangles that are settled and gone. O(triangles around one of them).
  bool EdgeExists(WindowVertexId u, WindowVertexId v) const;
  // The edges of a loop, from `edge` on in its direction.
  std::vector<FrontEdgeId> LoopOf(FrontEdgeId edge) const;
  // The front edge from u to v, and on the loop of an edge the corner at a vertex; none where there is none.
  FrontEdgeId FindEdge(WindowVertexId u, WindowVertexId v) const;
  FrontEdgeId CornerOnLoop(FrontEdgeId edge, WindowVertexId v) const;
  // Number of front edges in the loop of `edge`, at most `limit`.
  size_t LoopLength(FrontEdgeId edge, size_t limit) const;
  // Calls visit(triangle, corner index of v) for the triangles of the fan that v's half-edge belongs to, counter-clockwise when
  // the fan is closed. Returns whether it is closed.
  template <class Visitor>
  bool VisitFan(WindowVertexId v, const Visitor& visit) const;

  // First violation of the invariant, or nothing. O(window): for tests and builds with assertions.
  const char* FindViolation() const;

 private:
  FrontEdgeId NewEdge(WindowVertexId from, Link owner);
  void DropEdge(FrontEdgeId e);
  WindowTriangleId NewTriangle(WindowVertexId a, WindowVertexId b, WindowVertexId c, TriangleKind kind);
  void Join(Link half_edge, Link other);          // makes the two (half-edge, rim or settled) lie across each other
  void JoinBothWays(Link half_edge, Link other);  // and says so to a front edge, too
  void Chain(FrontEdgeId first, FrontEdgeId second);
  static uint64_t PairOf(uint32_t joint, uint32_t other);
  uint64_t JointPair(WindowVertexId u, WindowVertexId v) const { return PairOf(at(u).joint, at(v).joint); }
  void CountSides(const WindowTriangle& t, int change);
  void CountSide(WindowVertexId u, WindowVertexId v, int change);
  FrontEdgeId CornerAfterRemoval(Link removed_side, const std::vector<FrontEdgeId>& made_at,
                                 const std::vector<uint32_t>& slot) const;
  template <class Visitor>
  bool AnyNeighbour(WindowVertexId v, const Visitor& visit) const;

  static constexpr uint32_t kJointBit = 0x80000000u;
  static constexpr uint8_t kOnCrease = 0x80;  // beside a count of triangle sides

  std::vector<Joint> joints_;
  // Of each pair of joints that an edge of the output joins, wherever its triangles are by now: two patches may not have the same.
  absl::flat_hash_map<uint64_t, uint8_t> sides_at_joints_;
  std::vector<WindowVertex> vertices_;
  std::vector<WindowTriangle> triangles_;
  std::vector<FrontEdge> edges_;
  std::vector<uint32_t> free_vertices_, free_triangles_, free_edges_;
  size_t front_edge_count_ = 0, triangle_count_ = 0;
  uint32_t births_ = 0;
};

template <class Visitor>
bool FrontSet::VisitFan(WindowVertexId v, const Visitor& visit) const {
  const Link start = at(v).half_edge;
  if (!start.is_half_edge()) return false;
  Link h = start;
  do {  // h leaves v; the side before it comes in to v
    const WindowTriangleId t = h.triangle();
    const int side = h.side();
    visit(t, side);
    h = at(t).across[side == 0 ? 2 : side - 1];
  } while (h.is_half_edge() && h != start);
  if (h == start) return true;
  h = at(start.triangle()).across[start.side()];
  while (h.is_half_edge()) {  // h comes in to v
    const int corner = (h.side() + 1) % 3;
    visit(h.triangle(), corner);
    h = at(h.triangle()).across[corner];
  }
  return false;
}

}  // namespace meshfront
