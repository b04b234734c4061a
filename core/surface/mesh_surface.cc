#include "core/surface/mesh_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"
#include "core/mesh/union_find.h"
#include "core/surface/apex_search.h"
#include "core/surface/crease_cut.h"
#include "core/surface/shadow.h"
#include "core/surface/tolerances.h"
#include "core/surface/vertex_normals.h"
#include "core/surface/way.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

// `adjacency`: null where it is not known yet.
absl::Status ValidateMesh(const TriangleMesh& mesh, const FaceAdjacency* adjacency) {
  if (mesh.triangles.empty())
    return absl::InvalidArgumentError("the mesh has no triangles; a surface needs at least one");
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (const VertexId v : mesh.triangles[f]) {
      if (v.index() >= mesh.positions.size()) {
        return absl::InvalidArgumentError(absl::StrCat("triangle ", f, " names vertex ", v.index(), "; the mesh has ",
                                                       mesh.positions.size(), " vertices"));
      }
      if (!IsFinite(mesh.PositionAt(v))) {
        return absl::InvalidArgumentError(absl::StrCat("vertex ", v.index(), " has a coordinate that is not finite"));
      }
    }
  }
  const double diagonal = (adjacency ? BoundingBox(mesh, *adjacency) : BoundingBox(mesh)).Diagonal();
  if (!(diagonal >= kMinDiagonal && diagonal <= kMaxDiagonal)) {
    return absl::InvalidArgumentError(absl::StrCat("the mesh's bounding box has the diagonal ", diagonal,
                                                   "; it must be in [", kMinDiagonal, ", ", kMaxDiagonal,
                                                   "], scale it first"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<MeshSurface>> MeshSurface::Create(TriangleMesh mesh, const Context& context) {
  return Create(std::move(mesh), std::nullopt, context);
}

absl::StatusOr<std::unique_ptr<MeshSurface>> MeshSurface::Create(TriangleMesh mesh,
                                                                 std::optional<FaceAdjacency> adjacency,
                                                                 const Context& context) {
  MESHFRONT_RETURN_IF_ERROR(ValidateMesh(mesh, adjacency ? &*adjacency : nullptr));
  MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
  if (!adjacency) adjacency = FindOrientedAdjacency(mesh);
  if (!adjacency) {
    return absl::InvalidArgumentError("the mesh is not an oriented manifold; repair it first");
  }
  MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
  auto surface = std::unique_ptr<MeshSurface>(new MeshSurface(std::move(mesh), *std::move(adjacency)));
  MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
  return surface;
}

absl::StatusOr<std::unique_ptr<MeshSurface>> MeshSurface::Create(TriangleMesh mesh, FaceAdjacency adjacency,
                                                                 const std::vector<bool>& creases,
                                                                 const Context& context) {
  if (std::find(creases.begin(), creases.end(), true) == creases.end())
    return Create(std::move(mesh), std::move(adjacency), context);
  MESHFRONT_RETURN_IF_ERROR(ValidateMesh(mesh, &adjacency));
  CreaseCut cut = CutAlongCreases(std::move(mesh), std::move(adjacency), creases);
  MESHFRONT_ASSIGN_OR_RETURN(auto surface, Create(std::move(cut.mesh), std::move(cut.adjacency), context));
  surface->originals_ = std::move(cut.original);
  surface->whole_opposite_ = std::move(cut.opposite);
  surface->MeasureWholeComponents();
  return surface;
}

void MeshSurface::MeasureWholeComponents() {
  UnionFind patches(component_count());
  for (uint32_t h = 0; h < 3 * mesh_.triangles.size(); ++h) {
    const uint32_t across = AcrossCrease(h);
    if (across != kNoHalfEdge) patches.Unite(components_.label[h / 3], components_.label[across / 3]);
  }
  std::vector<Box3> boxes(component_count());
  for (size_t v = 0; v < mesh_.positions.size(); ++v) {
    const uint32_t h = adjacency_.outgoing[v];
    if (h == kNoHalfEdge) continue;
    boxes[patches.Find(components_.label[FaceOfHalfEdge(h)])].Extend(mesh_.positions[v]);
  }
  std::vector<uint32_t> number(component_count(), kNoHalfEdge);  // of the whole, by its root
  uint32_t count = 0;
  for (uint32_t patch = 0; patch < component_count(); ++patch) {
    const uint32_t root = patches.Find(patch);
    whole_diagonals_.push_back(boxes[root].Diagonal());
    if (number[root] == kNoHalfEdge) number[root] = count++;
    whole_components_.push_back(number[root]);
  }
}

// Copies of a vertex are numbered behind all originals.
TriangleMesh MeshSurface::MeshBeforeCut() const {
  TriangleMesh mesh;
  for (size_t v = 0; v < mesh_.positions.size() && OriginalOf(VertexId(v)) == v; ++v)
    mesh.positions.push_back(mesh_.positions[v]);
  mesh.triangles.reserve(mesh_.triangles.size());
  for (const Triangle& t : mesh_.triangles) {
    Triangle whole;
    for (int i = 0; i < 3; ++i) whole[i] = VertexId(OriginalOf(t[i]));
    mesh.triangles.push_back(whole);
  }
  return mesh;
}

void MeshSurface::SetWholeDiagonals(absl::FunctionRef<double(FaceId)> diagonal) {
  whole_diagonals_.assign(component_count(), 0);
  for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
    double& known = whole_diagonals_[components_.label[f]];
    if (known == 0) known = diagonal(FaceId(f));
  }
}

MeshSurface::MeshSurface(TriangleMesh mesh, FaceAdjacency adjacency)
    : mesh_(std::move(mesh)),
      adjacency_(std::move(adjacency)),
      normals_(ComputeVertexNormals(mesh_)),
      areas_(ComputeVertexAreas(mesh_)),
      curvatures_(mesh_.positions.size(), 0.0),
      components_(LabelComponents(adjacency_)),
      component_has_boundary_(components_.count, false) {
  std::vector<Box3> boxes(components_.count);
  for (size_t v = 0; v < mesh_.positions.size(); ++v) {
    const uint32_t h = adjacency_.outgoing[v];
    if (h != kNoHalfEdge) boxes[components_.label[FaceOfHalfEdge(h)]].Extend(mesh_.positions[v]);
  }
  for (const Box3& box : boxes) component_diagonals_.push_back(box.Diagonal());
  for (size_t f = 0; f < adjacency_.opposite.size(); ++f) {
    for (const uint32_t across : adjacency_.opposite[f]) {
      if (across == kNoHalfEdge) component_has_boundary_[components_.label[f]] = true;
    }
  }
}

FaceView MeshSurface::View() const {
  return {mesh_.positions.data(), mesh_.triangles.data(), adjacency_.opposite.data()->data(),
          static_cast<uint32_t>(mesh_.triangles.size())};
}

SourcePoint MeshSurface::Place(const FaceHit& hit) const {
  const FaceView view = View();
  const Vec3 blend = BlendNormals(view, normals_, hit);
  double length = Norm(blend);
  if (length > kCancelledNormal) return {hit.position, blend / length, hit.face, hit.u, hit.v};
  const Vec3 face = AreaVector(view.Corner(hit.face, 0), view.Corner(hit.face, 1), view.Corner(hit.face, 2));
  length = Norm(face);
  const Vec3 normal = length > 0 ? face / length : normals_[mesh_.triangles[hit.face][0].index()];
  return {hit.position, normal, hit.face, hit.u, hit.v};
}

SourcePoint MeshSurface::AtVertex(VertexId v) const {
  const uint32_t h = adjacency_.outgoing[v.index()];
  const uint32_t corner = h % 3;
  return {mesh_.PositionAt(v), normals_[v.index()], h / 3, corner == 1 ? 1.0 : 0.0, corner == 2 ? 1.0 : 0.0};
}

SourcePoint MeshSurface::AtFace(FaceId face, double u, double v) const {
  const Triangle& t = mesh_.triangles[face.index()];
  const Vec3 position = (1 - u - v) * mesh_.PositionAt(t[0]) + u * mesh_.PositionAt(t[1]) + v * mesh_.PositionAt(t[2]);
  return Place({face.index(), u, v, position});
}

std::vector<SourcePoint> MeshSurface::Seeds(bool all) const {
  // Well shaped counts, and flat against the size of the component.
  std::vector<std::pair<double, uint32_t>> best(component_count(), {-1, 0});
  for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) {
    const Triangle& t = mesh_.triangles[f];
    double curvature = 0;
    for (const VertexId v : t) curvature = std::max(curvature, curvatures_[v.index()]);
    const uint32_t component = components_.label[f];
    const double against = 1 + kSeedFlatness * component_diagonals_[component] * curvature;
    if (best[component].first * against > 1) continue;  // no shape is better than 1
    const double shape = RadiusRatio(mesh_.PositionAt(t[0]), mesh_.PositionAt(t[1]), mesh_.PositionAt(t[2]));
    const double score = shape / against;
    if (score > best[component].first) best[component] = {score, f};
  }
  std::vector<SourcePoint> seeds;
  for (uint32_t component = 0; component < component_count(); ++component) {
    if (!all && component_has_boundary_[component]) continue;
    seeds.push_back(AtFace(FaceId(best[component].second), 1.0 / 3, 1.0 / 3));
  }
  return seeds;
}

std::optional<SourcePoint> MeshSurface::FindApex(const SourcePoint& a, const SourcePoint& b, double radius_a,
                                                 double radius_b) const {
  if (a.patch >= mesh_.triangles.size() || b.patch >= mesh_.triangles.size()) return std::nullopt;
  const std::optional<ApexQuery> query = CreateApexQuery(a, b, radius_a, radius_b);
  if (!query) return std::nullopt;
  const FaceView view = View();
  if (const auto hit = WalkToCircle(view, radius_a <= radius_b ? a.patch : b.patch, query->circle)) {
    if (FrontAgreement(*query, hit->position, BlendNormals(view, normals_, *hit)) >= kMinFrontAgreement)
      return Place(*hit);
  }
  if (const auto hit = SearchApex(view, normals_, *query)) return Place(*hit);
  return std::nullopt;
}

SourcePoint MeshSurface::Snap(const SourcePoint& start, const Vec3& target) const {
  return Place(DescendToClosest(View(), FaceOf(start), target));
}

SourcePoint MeshSurface::Foot(const SourcePoint& start, const Vec3& target) const {
  const FaceHit hit = DescendToClosest(View(), FaceOf(start), target);
  return {hit.position, {}, hit.face, hit.u, hit.v};
}

bool MeshSurface::Reaches(const SourcePoint& start, const SourcePoint& place, double tolerance) const {
  if (start.patch == place.patch) return true;  // a descent never gets farther than where it starts
  return Surface::Reaches(start, place, tolerance);
}

double MeshSurface::MaxCurvatureAt(const SourcePoint& p) const {
  const Triangle& t = mesh_.triangles[FaceOf(p)];
  return (1 - p.u - p.v) * curvatures_[t[0].index()] + p.u * curvatures_[t[1].index()] +
         p.v * curvatures_[t[2].index()];
}

bool MeshSurface::TraceWay(const SourcePoint& a, const SourcePoint& b, std::vector<WayPiece>& way) const {
  way.clear();
  return meshfront::TraceWay(View(), {FaceOf(a), a.position}, {FaceOf(b), b.position}, a.normal + b.normal, way);
}

bool MeshSurface::FindFarPlaces(const SourcePoint& start, const std::array<Vec3, 3>& triangle, double bound,
                                double beside, std::vector<FarPlace>& far, std::vector<DoubtfulPart>* doubtful) const {
  thread_local Shadow shadow;
  CastShadow(View(), FaceOf(start), triangle, {bound, beside, doubtful != nullptr}, shadow);
  far.clear();
  if (doubtful) doubtful->clear();
  const auto centroid = [&](uint32_t face) { return AtFace(FaceId(face), 1.0 / 3, 1.0 / 3); };
  for (const ShadowPart& part : shadow.doubtful) doubtful->push_back({part.corners, centroid(part.face)});
  for (const ShadowHit& hit : shadow.far) far.push_back({hit.below, Place(hit.above), hit.is_vertex, hit.is_beside});
  return shadow.is_whole;
}

double MeshSurface::DistanceToPieceOf(const SourcePoint& p, const Vec3& place) const {
  return std::sqrt(ClosestOnFace(View(), FaceOf(p), place).squared_distance);
}

const SelfMeetings& MeshSurface::MeetingsFound(const Context& context) const {
  std::call_once(meetings_once_, [this, &context] {
    std::vector<std::array<Vec3, 2>> rims;
    for (uint32_t h = 0; h < 3 * mesh_.triangles.size(); ++h) {
      if (adjacency_.OppositeOf(h) == kNoHalfEdge && AcrossCrease(h) == kNoHalfEdge)
        rims.push_back({mesh_.PositionAt(OriginOf(mesh_, h)), mesh_.PositionAt(TargetOf(mesh_, h))});
    }
    meetings_ = std::make_unique<SelfMeetings>(mesh_, rims, context);
  });
  return *meetings_;
}

bool MeshSurface::MeetsItselfNear(const Vec3& place, double radius, const Context& context) const {
  return MeetingsFound(context).IsAnyWithin(place, radius);
}

bool MeshSurface::DoFacesMeetNear(const Vec3& place, double radius, const Context& context) const {
  return MeetingsFound(context).DoFacesMeetWithin(place, radius);
}

bool MeshSurface::IsOnBoundary(const SourcePoint& p) const {
  const uint32_t face = FaceOf(p);
  const double weights[3] = {1 - p.u - p.v, p.u, p.v};
  for (int corner = 0; corner < 3; ++corner) {
    const int facing = corner == 2 ? 0 : corner + 1;  // the half-edge that faces this corner
    if (weights[corner] <= kOnEdge && adjacency_.opposite[face][facing] == kNoHalfEdge) return true;
    if (weights[corner] >= 1 - kOnEdge && adjacency_.IsRimVertex(mesh_.triangles[face][corner].index())) return true;
  }
  return false;
}

}  // namespace meshfront
