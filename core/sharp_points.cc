// 1. PointPieces: which samples lie at an edge    2. the surface with round edges is meshed, about as finely as the samples lie
// 3. each vertex near an edge gets the side that it lies on, and moves there    4. edges whose ends lie on different sides are
// crossed by the crease: there is a new vertex, on both sides; in triangles all of whose edges are, a corner, on three
//
//         b              b         Crossed edges get a vertex where the ends' fits are equally near, moved to where both are
//        / \            / \        zero. So the crease is a path of edges, and the mesh has the topology that it had.
//       /   \          m1─m2       .
//      /     \        / \  \       .
//     a1─────a2      a1────a2      .
#include "core/sharp_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/crease_relaxation.h"
#include "core/features/creases.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/point_pieces.h"
#include "core/mesh/self_intersection.h"
#include "core/mesh/union_find.h"

namespace meshfront {
namespace {

constexpr size_t kGrain = 64;
// The edges of the round mesh in spacings, and its triangles for each point at the most.
constexpr double kEdgePerSpacing = 1.5, kMostPerPoint = 4;
// Attempts at the round mesh: where one fails, so do most, and each takes as long as all of the rest.
constexpr int kMostAttempts = 1;
// Round edges lie off the sharp ones by at most so many spacings, and corners by as many of these.
constexpr double kMostOff = 3;
// Cosine to the round mesh, below which a side is that of another sheet.
constexpr double kOtherSheet = -0.5;
// Sides of whose samples more than this part lie on each side of another fit do not end there.
constexpr double kCrossedShare = 0.1;
// Vertices of an island of a side.
constexpr uint32_t kMostOfIsland = 8;
// Where the sharp mesh meets itself, of so many pairs of faces, it is made round again so many spacings around, in so many rounds.
constexpr size_t kMostMeetings = 4096;
constexpr double kRoundedAround = 4;
constexpr int kMostRoundings = 3;
// A vertex that would lie beyond an edge lies so many spacings before it.
constexpr double kBeforeEdge = 0.1;
// Crossings lie at least this part of an edge from its ends.
constexpr double kLeastOfEdge = 0.05;

class Sharpener {
 public:
  Sharpener(const PointPieces& pieces, TriangleMesh mesh)
      : pieces_(pieces), mesh_(std::move(mesh)), adjacency_(CreateAdjacency(mesh_)) {}

  absl::StatusOr<SharpMesh> Run(const Context& context) {
    MESHFRONT_RETURN_IF_ERROR(FindSides(context));
    DropIslands();
    uint64_t rounded = 0;
    for (int round = 0;; ++round) {
      MESHFRONT_RETURN_IF_ERROR(Cut(context));
      MESHFRONT_ASSIGN_OR_RETURN(const SelfIntersections meetings,
                                 FindSelfIntersections(creased_.mesh, kMostMeetings, context));
      if (meetings.pairs == 0 || round == kMostRoundings) break;
      rounded += RoundAround(meetings);
    }
    result_.blunt_places += rounded;
    result_.mesh = std::move(creased_.mesh);
    return std::move(result_);
  }

 private:
  struct New {
    std::array<uint32_t, 3> ends;  // vertices of the round mesh, of an edge two
    int count;
    Vec3 place;
    bool is_blunt = false;
  };

  absl::Status Cut(const Context& context);
  uint64_t RoundAround(const SelfIntersections& meetings);
  absl::Status FindSides(const Context& context);
  void ChooseSide(uint32_t v);
  bool IsWithin(const PointSide& a, const PointSide& b, const Vec3& place) const;
  void DropIslands();
  void FindCrossedEdges();
  bool IsCrossed(uint32_t a, uint32_t b) const;
  absl::Status PlaceVertices(const Context& context);
  void Place(New& vertex) const;
  Vec3 CrossingOf(uint32_t a, uint32_t b) const;
  void SplitFace(uint32_t f);
  void AddFace(uint32_t a, uint32_t b, uint32_t c) {
    creased_.mesh.triangles.push_back({VertexId(a), VertexId(b), VertexId(c)});
  }
  void AddCreaseEdge(uint32_t a, uint32_t b) { creased_.creases.push_back({std::min(a, b), std::max(a, b)}); }
  absl::Status Relax(const Context& context);
  void CountCurves();

  const PointPieces& pieces_;
  TriangleMesh mesh_;
  FaceAdjacency adjacency_;
  std::vector<std::optional<PointSide>> sides_;
  std::vector<Vec3> places_;  // of the round mesh's vertices in the sharp one
  std::vector<New> new_vertices_;
  std::vector<std::array<uint32_t, 3>> on_edge_;  // of each half-edge the new vertex, or kNoHalfEdge
  std::vector<uint32_t> in_face_;
  CreasedMesh creased_;
  SharpMesh result_;
};

// The mesh with creases, from the sides that are known.
absl::Status Sharpener::Cut(const Context& context) {
  result_ = {}, creased_ = {};
  new_vertices_.clear();
  FindCrossedEdges();
  MESHFRONT_RETURN_IF_ERROR(PlaceVertices(context));
  for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) SplitFace(f);
  CountCurves();
  return Relax(context);
}

// Around where the mesh meets itself the edges stay round. Returns at how many places.
uint64_t Sharpener::RoundAround(const SelfIntersections& meetings) {
  std::vector<Vec3> places;
  for (const auto& pair : meetings.first_pairs) {
    Vec3 place;
    for (const VertexId v : creased_.mesh.triangles[pair.first.index()]) place += creased_.mesh.PositionAt(v) / 3.0;
    const double reach = kRoundedAround * pieces_.SpacingAt(place);
    if (std::all_of(places.begin(), places.end(), [&](const Vec3& x) { return Distance(x, place) > reach; }))
      places.push_back(place);
  }
  const PointTree tree(places);
  for (uint32_t v = 0; v < sides_.size(); ++v) {
    if (!sides_[v]) continue;
    const double reach = 2 * kRoundedAround * pieces_.SpacingAt(mesh_.positions[v]);
    if (tree.FindNearest(mesh_.positions[v], reach * reach, [](uint32_t) { return true; }) == PointTree::kNone)
      continue;
    sides_[v].reset();
    places_[v] = mesh_.positions[v];
  }
  return places.size();
}

// Whether a place on side a is there where a's samples lie, seen from b: an edge between the two has them on one side.
bool Sharpener::IsWithin(const PointSide& a, const PointSide& b, const Vec3& place) const {
  if (!pieces_.TurnAt(place, a.fit, b.fit)) return true;
  const auto above = static_cast<double>(std::count_if(
      a.members.begin(), a.members.end(), [&](uint32_t i) { return b.fit.HeightAt(pieces_.position(i)) > 0; }));
  const double share = above / static_cast<double>(a.members.size());
  if (std::min(share, 1 - share) > kCrossedShare) return true;
  return (b.fit.HeightAt(place) > 0) == (share > 0.5);
}

// The nearest side whose foot does not lie beyond an edge; where there is none, as in burrs of the round mesh, the nearest one, and the
// place is a little before the edge.
void Sharpener::ChooseSide(uint32_t v) {
  const Vec3 x = mesh_.positions[v];
  std::vector<PointSide> sides = pieces_.SidesAt(x);
  if (sides.empty()) return;
  std::stable_sort(sides.begin(), sides.end(),
                   [](const PointSide& a, const PointSide& b) { return a.distance < b.distance; });
  const double spacing = pieces_.SpacingAt(x), reach = kMostOff * spacing;
  const auto foot_of = [&](const PointSide& side) {
    const SideFit* const fit = &side.fit;
    return FindMeeting(absl::MakeConstSpan(&fit, 1), x, reach);
  };
  const PointSide* nearest = nullptr;
  for (const PointSide& side : sides) {
    if (Dot(Normalized(side.fit.GradientAt(x)), mesh_.normals[v]) <= kOtherSheet) continue;
    const std::optional<Vec3> foot = foot_of(side);
    if (!foot) continue;
    if (nearest == nullptr) nearest = &side;
    if (side.distance > nearest->distance + reach) break;
    const bool is_within = std::all_of(sides.begin(), sides.end(), [&](const PointSide& other) {
      return &other == &side || IsWithin(side, other, *foot);
    });
    if (!is_within) continue;
    sides_[v] = side, places_[v] = *foot;
    return;
  }
  if (nearest == nullptr) return;
  Vec3 place = *foot_of(*nearest);
  for (const PointSide& other : sides) {
    if (&other == nearest || IsWithin(*nearest, other, place)) continue;
    const std::array<const SideFit*, 2> both = {&nearest->fit, &other.fit};
    const std::optional<Vec3> edge = FindMeeting(both, place, reach);
    if (!edge) continue;
    const Vec3 up = Normalized(nearest->fit.GradientAt(*edge)), across = other.fit.GradientAt(*edge);
    const Vec3 inward = Normalized(across - Dot(across, up) * up) * (other.fit.HeightAt(place) > 0 ? -1.0 : 1.0);
    place = *edge + kBeforeEdge * spacing * inward;
  }
  sides_[v] = *nearest, places_[v] = place;
}

absl::Status Sharpener::FindSides(const Context& context) {
  sides_.resize(mesh_.positions.size());
  places_ = mesh_.positions;
  return ParallelFor(sides_.size(), kGrain, context, [&](size_t begin, size_t end) {
    for (size_t v = begin; v < end; ++v) {
      if (pieces_.IsNearEdge(mesh_.positions[v])) ChooseSide(static_cast<uint32_t>(v));
    }
  });
}

// Both ends know of an edge near by, and their sides share no sample and turn.
bool Sharpener::IsCrossed(uint32_t a, uint32_t b) const {
  if (!sides_[a] || !sides_[b]) return false;
  const Vec3 middle = 0.5 * (mesh_.positions[a] + mesh_.positions[b]);
  if (!pieces_.TurnAt(middle, sides_[a]->fit, sides_[b]->fit)) return false;
  const auto &one = sides_[a]->members, &other = sides_[b]->members;
  for (size_t i = 0, j = 0; i < one.size() && j < other.size();) {
    if (one[i] == other[j]) return false;
    one[i] < other[j] ? ++i : ++j;
  }
  return true;
}

// A few vertices that crossed edges cut off from all others, as at burrs of the round mesh, go to the side around them.
void Sharpener::DropIslands() {
  const auto n = static_cast<uint32_t>(mesh_.positions.size());
  UnionFind sets(n);
  std::vector<uint32_t> crossed;
  for (uint32_t h = 0; h < 3 * mesh_.triangles.size(); ++h) {
    const uint32_t a = OriginOf(mesh_, h).index(), b = TargetOf(mesh_, h).index();
    if (IsCrossed(a, b))
      crossed.push_back(h);
    else
      sets.Unite(a, b);
  }
  std::vector<uint32_t> sizes(n, 0);
  for (uint32_t v = 0; v < n; ++v) ++sizes[sets.Find(v)];
  std::vector<std::pair<double, uint32_t>> nearest(n, {std::numeric_limits<double>::infinity(), kNoHalfEdge});
  for (const uint32_t h : crossed) {
    const uint32_t a = OriginOf(mesh_, h).index(), b = TargetOf(mesh_, h).index();
    if (sizes[sets.Find(a)] > kMostOfIsland || sizes[sets.Find(b)] <= kMostOfIsland) continue;
    nearest[a] = std::min(nearest[a], {std::abs(sides_[b]->fit.HeightAt(mesh_.positions[a])), b});
  }
  for (uint32_t v = 0; v < n; ++v) {
    if (nearest[v].second == kNoHalfEdge) continue;
    sides_[v] = sides_[nearest[v].second];
    const SideFit* const fit = &sides_[v]->fit;
    places_[v] = FindMeeting(absl::MakeConstSpan(&fit, 1), mesh_.positions[v], fit->radius).value_or(places_[v]);
  }
}

void Sharpener::FindCrossedEdges() {
  on_edge_.assign(mesh_.triangles.size(), {kNoHalfEdge, kNoHalfEdge, kNoHalfEdge});
  in_face_.assign(mesh_.triangles.size(), kNoHalfEdge);
  for (uint32_t h = 0; h < 3 * mesh_.triangles.size(); ++h) {
    const uint32_t other = adjacency_.OppositeOf(h);
    if (other != kNoHalfEdge && other < h) continue;
    const uint32_t a = OriginOf(mesh_, h).index(), b = TargetOf(mesh_, h).index();
    if (!IsCrossed(a, b)) continue;
    const auto name = static_cast<uint32_t>(new_vertices_.size());
    on_edge_[h / 3][h % 3] = name;
    if (other != kNoHalfEdge) on_edge_[other / 3][other % 3] = name;
    new_vertices_.push_back({{a, b, 0}, 2, CrossingOf(a, b)});
  }
  for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
    if (std::count(on_edge_[f].begin(), on_edge_[f].end(), kNoHalfEdge) > 0) continue;
    const Triangle& t = mesh_.triangles[f];
    in_face_[f] = static_cast<uint32_t>(new_vertices_.size());
    const Vec3 middle = (mesh_.PositionAt(t[0]) + mesh_.PositionAt(t[1]) + mesh_.PositionAt(t[2])) / 3.0;
    new_vertices_.push_back({{t[0].index(), t[1].index(), t[2].index()}, 3, middle});
  }
}

// Where the edge is as near to the one side as to the other.
Vec3 Sharpener::CrossingOf(uint32_t a, uint32_t b) const {
  const Vec3 &x = mesh_.positions[a], &y = mesh_.positions[b];
  const auto off = [&](uint32_t v, const Vec3& at) { return std::abs(sides_[v]->fit.HeightAt(at)); };
  const double at_x = off(b, x) - off(a, x), at_y = off(a, y) - off(b, y);
  const double t = at_x + at_y > 0 ? at_x / (at_x + at_y) : 0.5;
  return x + std::clamp(t, kLeastOfEdge, 1 - kLeastOfEdge) * (y - x);
}

// Where the sides of the ends meet; then with fits around that place.
void Sharpener::Place(New& vertex) const {
  const double reach = kMostOff * pieces_.SpacingAt(vertex.place);
  std::array<const SideFit*, 3> fits{};
  for (int i = 0; i < vertex.count; ++i) fits[i] = &sides_[vertex.ends[i]]->fit;
  const absl::Span<const SideFit* const> span(fits.data(), vertex.count);
  const std::optional<Vec3> first = FindMeeting(span, vertex.place, reach);
  vertex.is_blunt = !first;
  if (!first) return;
  const std::vector<PointSide> around = pieces_.SidesAt(*first);
  for (int i = 0; i < vertex.count; ++i) {
    const auto& members = sides_[vertex.ends[i]]->members;
    size_t most = 0;
    for (const PointSide& side : around) {
      const auto shared = static_cast<size_t>(std::count_if(side.members.begin(), side.members.end(), [&](uint32_t s) {
        return std::binary_search(members.begin(), members.end(), s);
      }));
      if (shared > most) most = shared, fits[i] = &side.fit;
    }
  }
  vertex.place = FindMeeting(span, *first, reach).value_or(*first);
}

absl::Status Sharpener::PlaceVertices(const Context& context) {
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(new_vertices_.size(), kGrain, context, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) Place(new_vertices_[i]);
  }));
  creased_.mesh.positions = places_;
  creased_.first_on_crease = static_cast<uint32_t>(places_.size());
  for (const New& vertex : new_vertices_) {
    creased_.mesh.positions.push_back(vertex.place);
    result_.blunt_places += vertex.is_blunt;
  }
  return absl::OkStatus();
}

void Sharpener::SplitFace(uint32_t f) {
  const auto base = static_cast<uint32_t>(mesh_.positions.size());
  const auto& names = on_edge_[f];
  const auto crossed = 3 - static_cast<int>(std::count(names.begin(), names.end(), kNoHalfEdge));
  int first = 0;  // corner i, so that sides are as in the drawings below
  while (crossed == 1 && names[first] == kNoHalfEdge) ++first;
  while (crossed == 2 && names[(first + 1) % 3] != kNoHalfEdge) ++first;
  const Triangle& t = mesh_.triangles[f];
  std::array<uint32_t, 3> corner, middle;
  for (int i = 0; i < 3; ++i) {
    corner[i] = t[(first + i) % 3].index();
    middle[i] = base + names[(first + i) % 3];
  }
  if (crossed == 0) return AddFace(corner[0], corner[1], corner[2]);
  if (crossed == 1) {  // the crease ends here
    AddFace(corner[0], middle[0], corner[2]);
    return AddFace(middle[0], corner[1], corner[2]);
  }
  if (crossed == 2) {  // corner 0 is alone on its side
    AddFace(corner[0], middle[0], middle[2]);
    AddCreaseEdge(middle[0], middle[2]);
    const auto& x = creased_.mesh.positions;
    if (SquaredDistance(x[middle[0]], x[corner[2]]) < SquaredDistance(x[corner[1]], x[middle[2]])) {
      AddFace(middle[0], corner[1], corner[2]);
      return AddFace(middle[0], corner[2], middle[2]);
    }
    AddFace(middle[0], corner[1], middle[2]);
    return AddFace(corner[1], corner[2], middle[2]);
  }
  const uint32_t center = base + in_face_[f];
  for (int i = 0; i < 3; ++i) {
    AddFace(corner[i], middle[i], center);
    AddFace(corner[i], center, middle[(i + 2) % 3]);
    AddCreaseEdge(middle[i], center);
  }
}

// Moves along sides and creases are by the fits that the vertices lie on.
absl::Status Sharpener::Relax(const Context& context) {
  const auto side_of = [&](uint32_t v) { return v < sides_.size() && sides_[v] ? &sides_[v]->fit : nullptr; };
  const auto place_of = [&](uint32_t v, const Vec3& place) -> std::optional<Vec3> {
    if (v < sides_.size()) {
      const SideFit* const fit = side_of(v);
      if (fit == nullptr) return std::nullopt;
      return FindMeeting(absl::MakeConstSpan(&fit, 1), place, fit->radius);
    }
    New moved = new_vertices_[v - sides_.size()];
    moved.place = place;
    Place(moved);
    return moved.place;  // where the sides do not meet, between its neighbours
  };
  const auto is_blunt = [&](uint32_t v) { return v >= sides_.size() && new_vertices_[v - sides_.size()].is_blunt; };
  return RelaxCreases(creased_, {side_of, place_of, is_blunt}, context);
}

// A curve goes from corner to corner, where other than two crease edges meet, or around.
void Sharpener::CountCurves() {
  std::vector<uint32_t> degree(creased_.mesh.positions.size(), 0), last(degree.size(), kNoHalfEdge);
  for (const auto& edge : creased_.creases) ++degree[edge[0]], ++degree[edge[1]];
  UnionFind sets(creased_.creases.size());
  result_.curves = creased_.creases.size();
  for (uint32_t e = 0; e < creased_.creases.size(); ++e) {
    for (const uint32_t v : creased_.creases[e]) {
      if (degree[v] != 2) continue;
      if (last[v] != kNoHalfEdge) result_.curves -= sets.Unite(last[v], e);
      last[v] = e;
    }
  }
  result_.corners =
      static_cast<uint64_t>(std::count_if(degree.begin(), degree.end(), [](uint32_t d) { return d > 2; }));
}

// The surface with round edges, about as fine as the samples; nothing, and why, where it can't be meshed.
absl::StatusOr<std::optional<TriangleMesh>> MeshRoundly(const TriangleMesh& points, const PointPieces& pieces,
                                                        const RemeshOptions& options, std::string& why_not,
                                                        const Context& context) {
  Problem problem;
  problem.mesh = points;
  problem.most_attempts = kMostAttempts;
  RemeshOptions& round = problem.options;
  round.surface = options.surface, round.mls_radius = options.mls_radius;
  round.crease_angle = std::nullopt;
  round.sizing = Sizing::kUniform;
  const double least = std::sqrt(pieces.mean_area() / (0.25 * std::numbers::sqrt3 * kMostPerPoint));
  round.edge_length = Length{std::max(kEdgePerSpacing * pieces.median_spacing(), least), false};
  Context quiet = context;
  quiet.progress = nullptr;
  CollectingSink sink;
  const absl::StatusOr<Report> report = Remesh(std::move(problem), sink, quiet);
  MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
  if (report.ok() && report->complete) return std::move(sink.mesh);
  why_not = report.ok() ? "it was left open" : std::string(report.status().message());
  return std::nullopt;
}

// Nothing where no crease comes of the edges.
absl::StatusOr<std::optional<SharpMesh>> Sharpen(const PointPieces& pieces, TriangleMesh round, double angle,
                                                 const Context& context) {
  MESHFRONT_ASSIGN_OR_RETURN(SharpMesh sharp, Sharpener(pieces, std::move(round)).Run(context));
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<bool> creases,
                             FindCreases(sharp.mesh, CreateAdjacency(sharp.mesh), angle, context));
  if (std::find(creases.begin(), creases.end(), true) == creases.end()) return std::nullopt;
  return sharp;
}

}  // namespace

absl::StatusOr<std::optional<SharpMesh>> MeshSharpPoints(const SharpPoints& input, const RemeshOptions& options,
                                                         std::vector<std::string>& warnings, const Context& context) {
  const double degrees = options.crease_angle.value_or(RemeshOptions().crease_angle.value());
  const double angle = degrees * std::numbers::pi / 180;
  MESHFRONT_ASSIGN_OR_RETURN(
      const std::unique_ptr<PointPieces> pieces,
      PointPieces::Create(input.points.positions, input.points.normals, angle, input.are_estimated, context));
  const bool is_sharp = options.crease_angle && pieces->HasEdges();
  if (!is_sharp && !input.needs_mesh) return std::nullopt;
  std::string why_not;
  MESHFRONT_ASSIGN_OR_RETURN(std::optional<TriangleMesh> round,
                             MeshRoundly(input.points, *pieces, options, why_not, context));
  if (!round && input.needs_mesh) {
    return absl::FailedPreconditionError(
        absl::StrCat("options.features can't be kept: no mesh of the points to put lines on could be made (", why_not,
                     "); leave options.features out, or mesh the points first and give the lines with that mesh"));
  }
  if (!round) {
    warnings.push_back(absl::StrCat("the point set has sharp edges, which are rounded: no mesh to find them on ",
                                    "could be made (", why_not, ")"));
    return std::nullopt;
  }
  std::optional<SharpMesh> sharp;
  if (is_sharp) {
    MESHFRONT_ASSIGN_OR_RETURN(sharp, Sharpen(*pieces, *round, angle, context));
  }
  if (!sharp && input.needs_mesh) sharp.emplace().mesh = *std::move(round);
  return sharp;
}

}  // namespace meshfront
