// 1. InsertPoint   each end becomes a vertex: one that is there, or on an edge or in a face that is split
// 2. Trace         from vertex to vertex through the plane of the segment: to a vertex that lies on it, or to where it crosses an edge,
//                  which is split there. Where the surface bends away, in two halves
// 3. Mark          the edges of the way
// Rejected: the shortest way over the input's edges. It needs no splits, but zigzags by as much as those edges are long.
#include "core/features/line_insertion.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "absl/container/flat_hash_map.h"
#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/features/tolerances.h"
#include "core/geometry/bvh.h"
#include "core/geometry/segment.h"
#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

// A mesh whose edges and faces are split one by one.
class SplitMesh {
 public:
  SplitMesh(TriangleMesh& mesh, FaceAdjacency& adjacency, std::vector<bool>& creases, const std::vector<bool>& fixed)
      : mesh_(mesh), a_(adjacency), creases_(creases), fixed_(fixed), original_faces_(mesh.triangles.size()) {}

  const Vec3& At(uint32_t v) const { return mesh_.positions[v]; }
  uint32_t OriginOf(uint32_t h) const { return mesh_.triangles[h / 3][h % 3].index(); }
  uint32_t TargetOf(uint32_t h) const { return OriginOf(NextHalfEdge(h)); }
  const Triangle& FaceAt(uint32_t f) const { return mesh_.triangles[f]; }
  size_t added() const { return mesh_.triangles.size() - original_faces_; }

  // The half-edges of the faces around v that leave it.
  std::vector<uint32_t> Fan(uint32_t v) const {
    std::vector<uint32_t> fan;
    const uint32_t first = a_.outgoing[v];
    uint32_t h = first;
    do {
      fan.push_back(h);
      h = a_.NextAroundOrigin(h);
    } while (h != kNoHalfEdge && h != first);
    for (uint32_t back = first; h == kNoHalfEdge;) {  // a rim: the other way, too
      const uint32_t across = a_.OppositeOf(back);
      if (across == kNoHalfEdge) break;
      fan.push_back(back = NextHalfEdge(across));
    }
    return fan;
  }

  Vec3 NormalAt(uint32_t v) const {
    Vec3 sum;
    for (const uint32_t h : Fan(v)) {
      const Triangle& t = FaceAt(h / 3);
      sum += AreaVector(mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1]), mesh_.PositionAt(t[2]));
    }
    return Normalized(sum);
  }

  // A half-edge between two vertices, in either direction.
  std::optional<uint32_t> FindEdge(uint32_t v, uint32_t w) const {
    for (const uint32_t h : Fan(v)) {
      if (TargetOf(h) == w) return h;
      if (OriginOf(PreviousHalfEdge(h)) == w) return PreviousHalfEdge(h);
    }
    return std::nullopt;
  }

  void Mark(uint32_t h) {
    const uint32_t across = a_.OppositeOf(h);
    if (across != kNoHalfEdge) creases_[h] = creases_[across] = true;
  }

  // Faces that stay as they are, and sides of such.
  bool IsFixedFace(uint32_t f) const { return f < fixed_.size() && fixed_[f]; }
  bool IsFixedSide(uint32_t h) const {
    const uint32_t across = a_.OppositeOf(h);
    return IsFixedFace(h / 3) || (across != kNoHalfEdge && IsFixedFace(across / 3));
  }

  // The triangles that a face of the input is now.
  template <class Visit>
  void VisitPieces(uint32_t original, Visit visit) const {
    visit(original);
    const auto pieces = pieces_.find(original);
    if (pieces == pieces_.end()) return;
    for (const uint32_t f : pieces->second) visit(f);
  }

  //      c             c
  //     / \           /|\                   The same on the other side of the edge.
  //    a---b   →     a-m-b
  uint32_t SplitEdge(uint32_t h, double t) {
    const uint32_t across = a_.OppositeOf(h), a = OriginOf(h), b = TargetOf(h);
    const CornerWedges wedges = WedgesFrom(h);
    const uint32_t m = AddVertex((1 - t) * At(a) + t * At(b));
    const uint32_t between = AddWedge(wedges[0], wedges[1], t);
    const uint32_t beyond = SplitSide(h, m, between);
    if (across == kNoHalfEdge) {
      Link(h, kNoHalfEdge), Link(3 * beyond, kNoHalfEdge);
    } else {
      const CornerWedges others = WedgesFrom(across);
      const bool is_same = others[0] == wedges[1] && others[1] == wedges[0];
      const uint32_t back = SplitSide(across, m, is_same ? between : AddWedge(others[1], others[0], t));
      Link(h, 3 * back), Link(3 * beyond, across);
    }
    a_.outgoing[m] = 3 * beyond, a_.outgoing[b] = 3 * beyond + 1, a_.outgoing[a] = h;
    return m;
  }

  // Into three, around a place inside.
  uint32_t SplitFace(uint32_t f, const double* weights) {
    const Triangle t = FaceAt(f);
    const CornerWedges w = WedgesFrom(3 * f);
    const uint32_t m =
        AddVertex(weights[0] * At(t[0].index()) + weights[1] * At(t[1].index()) + weights[2] * At(t[2].index()));
    const uint32_t on_side = AddWedge(w[0], w[1], weights[1] / (weights[0] + weights[1]));
    const uint32_t inside = AddWedge(on_side, w[2], weights[2]);
    const uint32_t g = AddFace(f, {t[1], t[2], VertexId(m)}, {w[1], w[2], inside});
    const uint32_t k = AddFace(f, {t[2], t[0], VertexId(m)}, {w[2], w[0], inside});
    MoveSide(3 * f + 1, 3 * g), MoveSide(3 * f + 2, 3 * k);
    SetFace(f, {t[0], t[1], VertexId(m)}, {w[0], w[1], inside});
    Link(3 * f + 1, 3 * g + 2), Link(3 * g + 1, 3 * k + 2), Link(3 * k + 1, 3 * f + 2);
    a_.outgoing[m] = 3 * f + 2, a_.outgoing[t[2].index()] = 3 * g + 1;
    return m;
  }

 private:
  uint32_t AddVertex(const Vec3& position) {
    mesh_.positions.push_back(position);
    a_.outgoing.push_back(kNoHalfEdge);
    return static_cast<uint32_t>(mesh_.positions.size() - 1);
  }

  bool has_wedges() const { return !mesh_.attributes.corners.empty(); }
  CornerWedges WedgesFrom(uint32_t h) const {
    if (!has_wedges()) return {};
    const CornerWedges& w = mesh_.attributes.corners[h / 3];
    return {w[h % 3], w[NextHalfEdge(h) % 3], w[PreviousHalfEdge(h) % 3]};
  }
  uint32_t AddWedge(uint32_t from, uint32_t to, double t) {
    if (!has_wedges() || from == to) return from;
    return AddWedgeBetween(mesh_.attributes, from, to, t);
  }

  // Half of a split edge: h ends in m then, and a new face [m, b, c] takes the rest. Its sides along the edge are not linked yet.
  uint32_t SplitSide(uint32_t h, uint32_t m, uint32_t wedge) {
    const uint32_t f = h / 3, next = NextHalfEdge(h), previous = PreviousHalfEdge(h);
    const CornerWedges w = WedgesFrom(h);
    const Triangle t = FaceAt(f);
    const uint32_t g = AddFace(f, {VertexId(m), t[next % 3], t[previous % 3]}, {wedge, w[1], w[2]});
    creases_[3 * g] = creases_[h];
    MoveSide(next, 3 * g + 1);
    mesh_.triangles[f][next % 3] = VertexId(m);
    if (has_wedges()) mesh_.attributes.corners[f][next % 3] = wedge;
    Link(next, 3 * g + 2);
    return g;
  }

  uint32_t AddFace(uint32_t like, const Triangle& corners, const CornerWedges& wedges) {
    const auto f = static_cast<uint32_t>(mesh_.triangles.size());
    mesh_.triangles.push_back(corners);
    MeshAttributes& attributes = mesh_.attributes;
    if (has_wedges()) attributes.corners.push_back(wedges);
    if (!attributes.groups.empty()) attributes.groups.push_back(attributes.groups[like]);
    if (!mesh_.face_origins.empty()) mesh_.face_origins.push_back(mesh_.face_origins[like]);
    a_.opposite.push_back({kNoHalfEdge, kNoHalfEdge, kNoHalfEdge});
    creases_.resize(3 * mesh_.triangles.size());
    const uint32_t original = like < original_faces_ ? like : originals_[like - original_faces_];
    originals_.push_back(original);
    pieces_[original].push_back(f);
    return f;
  }
  void SetFace(uint32_t f, const Triangle& corners, const CornerWedges& wedges) {
    mesh_.triangles[f] = corners;
    if (has_wedges()) mesh_.attributes.corners[f] = wedges;
  }

  void Link(uint32_t h, uint32_t across) {
    a_.opposite[h / 3][h % 3] = across;
    if (across != kNoHalfEdge) a_.opposite[across / 3][across % 3] = h;
  }
  // What lies across a half-edge, and whether it is a crease, goes to another one.
  void MoveSide(uint32_t from, uint32_t to) {
    Link(to, a_.OppositeOf(from));
    creases_[to] = creases_[from];
    creases_[from] = false;
  }

  TriangleMesh& mesh_;
  FaceAdjacency& a_;
  std::vector<bool>& creases_;
  const std::vector<bool>& fixed_;
  const size_t original_faces_;
  std::vector<uint32_t> originals_;  // of added triangles
  absl::flat_hash_map<uint32_t, std::vector<uint32_t>> pieces_;
};

class Inserter {
 public:
  Inserter(const Polylines& lines, const LineLimits& limits, TriangleMesh& mesh, FaceAdjacency& adjacency,
           std::vector<bool>& creases)
      : lines_(lines),
        limits_(limits),
        positions_(mesh.positions),
        triangles_(mesh.triangles),
        tree_(positions_, triangles_),
        diagonal_(limits.diagonal > 0 ? limits.diagonal : BoundingBox(mesh, adjacency).Diagonal()),
        mesh_(mesh, adjacency, creases, limits.fixed),
        vertices_(lines.points.size()) {}

  absl::StatusOr<InsertedLines> Run(const Context& context) {
    for (size_t i = 0; i < lines_.segments.size(); ++i) {
      MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
      std::optional<uint32_t> ends[2];
      for (int end = 0; end < 2; ++end) {
        MESHFRONT_ASSIGN_OR_RETURN(ends[end], VertexOf(i, lines_.segments[i][end]));
      }
      if (!Trace(*ends[0], *ends[1], kMostHalvings)) return CanNotFollow(i);
    }
    inserted_.split_faces = mesh_.added();
    return inserted_;
  }

 private:
  absl::StatusOr<uint32_t> VertexOf(size_t segment, uint32_t point) {
    std::optional<uint32_t>& vertex = vertices_[point];
    if (vertex) return *vertex;
    const std::optional<ClosestHit> hit = FindPlace(lines_.points[point]);
    if (!hit) return TooFar(segment, lines_.points[point]);
    if (std::sqrt(hit->squared_distance) > kMovedPoint * diagonal_) ++inserted_.moved_points;
    vertex = InsertAt(*hit);
    if (!vertex) return CanNotFollow(segment);
    return *vertex;
  }

  std::optional<ClosestHit> FindPlace(const Vec3& p) const {
    return tree_.FindClosestPoint(p, kLineReach * diagonal_, [&](FaceId f) { return !mesh_.IsFixedFace(f.index()); });
  }

  size_t NameOf(size_t segment) const { return limits_.origins.empty() ? segment : limits_.origins[segment]; }
  static std::string Place(const Vec3& p) { return absl::StrCat(p.x, ", ", p.y, ", ", p.z); }
  absl::Status TooFar(size_t segment, const Vec3& p) const {
    return absl::InvalidArgumentError(absl::StrCat("options.features.segments[", NameOf(segment), "] lies at ",
                                                   Place(p), "; it must be within ", kLineReach * diagonal_,
                                                   " of the surface, 1 % of the diagonal"));
  }
  absl::Status CanNotFollow(size_t segment) const {
    const auto& [a, b] = lines_.segments[segment];
    return absl::InvalidArgumentError(
        absl::StrCat("options.features.segments[", NameOf(segment), "] runs from ", Place(lines_.points[a]), " to ",
                     Place(lines_.points[b]), "; the surface does not go all the way, within 1 % of the diagonal"));
  }

  // The vertex at a place of the input's surface; nothing where a fixed side would have to be split.
  std::optional<uint32_t> InsertAt(const ClosestHit& hit) {
    const Vec3& place = hit.point.position;
    TrianglePoint nearest{};
    uint32_t face = hit.face.index();
    double least = -1;
    mesh_.VisitPieces(hit.face.index(), [&](uint32_t f) {
      const Triangle& t = mesh_.FaceAt(f);
      const TrianglePoint at =
          ClosestPointOnTriangle(place, mesh_.At(t[0].index()), mesh_.At(t[1].index()), mesh_.At(t[2].index()));
      const double distance = SquaredDistance(at.position, place);
      if (least < 0 || distance < least) least = distance, nearest = at, face = f;
    });
    const double same = kSamePoint * diagonal_;
    for (const VertexId v : mesh_.FaceAt(face)) {
      if (Distance(mesh_.At(v.index()), place) <= same) return v.index();
    }
    for (uint32_t h = 3 * face; h < 3 * face + 3; ++h) {
      const Vec3 &a = mesh_.At(mesh_.OriginOf(h)), &b = mesh_.At(mesh_.TargetOf(h));
      const double t = Dot(place - a, b - a) / SquaredDistance(a, b);
      if (t <= 0 || t >= 1 || Distance(a + t * (b - a), place) > same) continue;
      if (mesh_.IsFixedSide(h)) return std::nullopt;
      return mesh_.SplitEdge(h, t);
    }
    return mesh_.SplitFace(face, nearest.weights);
  }

  // Where a plane leaves the faces around a vertex.
  struct Exit {
    uint32_t half_edge;
    double t;
    double forward;  // cosine of the way there and the segment
  };

  std::optional<Exit> FindExit(uint32_t vertex, const Vec3& side, const Vec3& along) const {
    const Vec3& here = mesh_.At(vertex);
    std::optional<Exit> best;
    for (const uint32_t h : mesh_.Fan(vertex)) {
      const uint32_t edge = NextHalfEdge(h);
      const Vec3 &x = mesh_.At(mesh_.OriginOf(edge)), &y = mesh_.At(mesh_.TargetOf(edge));
      const double dx = Dot(side, x - here), dy = Dot(side, y - here);
      if ((dx > 0 && dy > 0) || (dx < 0 && dy < 0) || dx == dy) continue;
      const double t = dx / (dx - dy);
      const Vec3 way = x + t * (y - x) - here;
      const double forward = Dot(Normalized(way), along);
      if (!best || forward > best->forward) best = Exit{edge, t, forward};
    }
    if (best && best->forward > 0) return best;
    return std::nullopt;
  }

  // Goes from vertex to vertex, and marks the way once it has arrived.
  bool Trace(uint32_t from, uint32_t to, int halvings) {
    if (from == to || TraceInPlane(from, to)) return true;
    if (halvings == 0) return false;
    const std::optional<ClosestHit> hit = FindPlace(0.5 * (mesh_.At(from) + mesh_.At(to)));
    const std::optional<uint32_t> middle = hit ? InsertAt(*hit) : std::nullopt;
    if (!middle || *middle == from || *middle == to) return false;
    return Trace(from, *middle, halvings - 1) && Trace(*middle, to, halvings - 1);
  }

  bool TraceInPlane(uint32_t from, uint32_t to) {
    const Vec3 begin = mesh_.At(from), chord = mesh_.At(to) - begin, along = Normalized(chord);
    const Vec3 side = Normalized(Cross(chord, mesh_.NormalAt(from) + mesh_.NormalAt(to)));
    if (side == Vec3{}) return false;
    std::vector<std::pair<uint32_t, uint32_t>> way;
    double reached = 0;
    const double length = Norm(chord);
    for (uint32_t at = from; at != to;) {
      uint32_t next = to;
      if (!mesh_.FindEdge(at, to)) {
        const std::optional<Exit> exit = FindExit(at, side, along);
        const std::optional<uint32_t> left = exit ? Leave(*exit, begin, along, reached) : std::nullopt;
        if (!left) return false;
        next = *left;
      }
      const Vec3 offset = mesh_.At(next) - begin;
      const double now = Dot(offset, along);
      const bool is_beside = Norm(offset - now * along) > kLineReach * diagonal_;
      if (next != to && (now <= reached || now >= length || is_beside)) return false;
      way.push_back({at, next});
      reached = now, at = next;
    }
    for (const auto& [a, b] : way) {
      if (const std::optional<uint32_t> edge = mesh_.FindEdge(a, b)) mesh_.Mark(*edge);
    }
    return true;
  }

  // The vertex where a segment leaves: an end of the edge that is near enough and farther on, or a new one. Nothing where the
  // edge is fixed.
  std::optional<uint32_t> Leave(const Exit& exit, const Vec3& begin, const Vec3& along, double reached) {
    const uint32_t x = mesh_.OriginOf(exit.half_edge), y = mesh_.TargetOf(exit.half_edge);
    const double length = Distance(mesh_.At(x), mesh_.At(y));
    const double snap = std::min(kSnapPerEdge * length, kSnapPerDiagonal * diagonal_);
    const uint32_t nearer = exit.t < 0.5 ? x : y;
    const double distance = length * std::min(exit.t, 1 - exit.t);
    const bool is_on = Dot(mesh_.At(nearer) - begin, along) > reached;
    if (distance <= 0 || (distance <= snap && is_on)) return nearer;
    if (mesh_.IsFixedSide(exit.half_edge)) return std::nullopt;
    return mesh_.SplitEdge(exit.half_edge, exit.t);
  }

  const Polylines& lines_;
  const LineLimits& limits_;
  const std::vector<Vec3> positions_;  // of the input
  const std::vector<Triangle> triangles_;
  const TriangleBvh tree_;
  const double diagonal_;
  SplitMesh mesh_;
  std::vector<std::optional<uint32_t>> vertices_;  // of points, once they are inserted
  InsertedLines inserted_;
};

}  // namespace

absl::StatusOr<InsertedLines> InsertPolylines(const Polylines& lines, TriangleMesh& mesh, FaceAdjacency& adjacency,
                                              std::vector<bool>& creases, const Context& context,
                                              const LineLimits& limits) {
  MESHFRONT_ASSIGN_OR_RETURN(const InsertedLines inserted,
                             Inserter(lines, limits, mesh, adjacency, creases).Run(context));
  std::optional<FaceAdjacency> again = FindOrientedAdjacency(mesh);
  if (!again) return absl::InternalError("a mesh split along polylines is no oriented manifold; please report it");
  adjacency = *std::move(again);
  return inserted;
}

}  // namespace meshfront
