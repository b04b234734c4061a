// What is wrong with a mesh, and where: triangles one by one, triangles twice, edges, then vertices.
#include <algorithm>
#include <limits>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/mesh/adjacency.h"
#include "core/mesh/repair.h"
#include "core/mesh/repair_survey.h"
#include "core/mesh/tolerances.h"
#include "core/mesh/union_find.h"

namespace meshfront {
namespace {

constexpr size_t kDefectsInMessage = 3;

// " at (1, 2, 3)"; nothing where there is no such place.
std::string At(const Vec3& p) {
  return IsFinite(p) ? absl::StrCat(" at (", p.x, ", ", p.y, ", ", p.z, ")") : std::string();
}

class DefectFinder {
 public:
  DefectFinder(const TriangleMesh& mesh, size_t limit) : mesh_(mesh), limit_(limit) {}

  DefectList Find() {
    for (uint32_t f = 0; f < mesh_.triangles.size(); ++f) LookAtFace(f);
    LookForDuplicates();
    LookAtEdges();
    LookAtVertices();
    return std::move(list_);
  }

 private:
  void Add(const char* what, std::vector<FaceId> faces, std::vector<VertexId> vertices, const Vec3& position,
           const std::string& message) {
    ++list_.total;
    if (list_.defects.size() >= limit_) return;
    list_.defects.push_back({what, message, std::move(faces), std::move(vertices),
                             IsFinite(position) ? std::optional<Vec3>(position) : std::nullopt});
  }
  static constexpr Vec3 kNowhere{std::numeric_limits<double>::quiet_NaN(), 0, 0};
  bool IsListFull() const { return list_.defects.size() >= limit_; }

  void LookAtFace(uint32_t f) {
    const Triangle& t = mesh_.triangles[f];
    for (const VertexId v : t) {
      if (v.index() < mesh_.positions.size()) continue;
      return Add("index_out_of_range", {FaceId(f)}, {}, kNowhere,
                 absl::StrCat("triangle ", f, " names vertex ", v.index(), "; the mesh has ", mesh_.positions.size(),
                              " vertices"));
    }
    const FaceState state = StateOf(mesh_, t);
    if (state == FaceState::kSound) return usable_.triangles.push_back(t), face_of_.push_back(f);
    if (state == FaceState::kZeroArea) usable_.triangles.push_back(t), face_of_.push_back(f);
    const std::vector<VertexId> corners(t.begin(), t.end());
    const Vec3 at = mesh_.PositionAt(t[0]);
    const std::string who = absl::StrCat("triangle ", f, At(at));
    if (state == FaceState::kRepeatedIndex) {
      Add("degenerate_face", {FaceId(f)}, corners, at,
          absl::StrCat(who, " names a vertex twice (", t[0].index(), " ", t[1].index(), " ", t[2].index(), ")"));
    } else if (state == FaceState::kNotFinite) {
      for (const VertexId v : t) {
        if (IsFinite(mesh_.PositionAt(v))) continue;
        return Add("non_finite_vertex", {FaceId(f)}, {v}, kNowhere,
                   absl::StrCat("vertex ", v.index(), " of triangle ", f, " has a coordinate that is not finite"));
      }
    } else if (state == FaceState::kHuge) {
      Add("huge_coordinate", {FaceId(f)}, corners, at,
          absl::StrCat(who, " has a coordinate beyond ±", kLargestCoordinate, ", the most that can be computed with"));
    } else {
      Add("degenerate_face", {FaceId(f)}, corners, at, absl::StrCat(who, " has no area: its corners lie on one line"));
    }
  }

  void LookForDuplicates() {
    std::vector<std::pair<Triangle, uint32_t>> keys;
    for (uint32_t i = 0; i < usable_.triangles.size(); ++i) {
      keys.push_back({usable_.triangles[i], face_of_[i]});
      std::sort(keys.back().first.begin(), keys.back().first.end());
    }
    std::sort(keys.begin(), keys.end());
    for (size_t i = 1; i < keys.size(); ++i) {
      if (keys[i].first != keys[i - 1].first) continue;
      Add("duplicate_face", {FaceId(keys[i - 1].second), FaceId(keys[i].second)}, {},
          mesh_.PositionAt(keys[i].first[0]),
          absl::StrCat("triangles ", keys[i - 1].second, " and ", keys[i].second, " have the same three corners"));
    }
  }

  void LookAtEdges() {
    usable_.positions = mesh_.positions;
    told_.assign(usable_.positions.size(), false);
    partner_.assign(3 * usable_.triangles.size(), kNoHalfEdge);
    const std::vector<uint32_t> order = HalfEdgesByEdge(usable_);
    const auto ends = [&](uint32_t h) {
      const VertexId a = OriginOf(usable_, h), b = TargetOf(usable_, h);
      return std::pair(std::min(a, b), std::max(a, b));
    };
    for (size_t i = 0, end; i < order.size(); i = end) {
      for (end = i + 1; end < order.size() && ends(order[i]) == ends(order[end]);) ++end;
      if (end - i == 2) partner_[order[i]] = order[i + 1], partner_[order[i + 1]] = order[i];
      LookAtEdge(absl::MakeConstSpan(order).subspan(i, end - i));
    }
  }

  void LookAtEdge(absl::Span<const uint32_t> half_edges) {
    const uint32_t h = half_edges[0];
    const bool same_direction = half_edges.size() == 2 && OriginOf(usable_, h) == OriginOf(usable_, half_edges[1]);
    if (half_edges.size() < 2 || (half_edges.size() == 2 && !same_direction)) return;
    const VertexId a = OriginOf(usable_, h), b = TargetOf(usable_, h);
    if (!same_direction) told_[a.index()] = told_[b.index()] = true;
    if (IsListFull()) return void(++list_.total);
    const Vec3 middle = 0.5 * usable_.PositionAt(a) + 0.5 * usable_.PositionAt(b);
    std::vector<FaceId> faces;
    for (const uint32_t g : half_edges) faces.push_back(FaceId(face_of_[FaceOfHalfEdge(g)]));
    const std::string who = absl::StrCat("the edge from vertex ", a.index(), " to ", b.index(), At(middle));
    if (same_direction) {
      Add("inconsistent_orientation", faces, {a, b}, middle,
          absl::StrCat(who, " is run through in the same direction by triangles ", faces[0].index(), " and ",
                       faces[1].index()));
    } else {
      Add("non_manifold_edge", faces, {a, b}, middle,
          absl::StrCat(who, " has ", faces.size(), " triangles (", faces[0].index(), ", ", faces[1].index(), ", ",
                       faces[2].index(), faces.size() > 3 ? ", …" : "", "); at most two can meet there"));
    }
  }

  // Vertices whose faces are not one fan; those on an edge with more than two faces have been told already.
  void LookAtVertices() {
    UnionFind corners(partner_.size());
    for (uint32_t h = 0; h < partner_.size(); ++h) {
      const uint32_t g = partner_[h];
      if (g == kNoHalfEdge || g < h) continue;
      const bool opposed = OriginOf(usable_, h) == TargetOf(usable_, g);
      corners.Unite(h, opposed ? NextHalfEdge(g) : g);
      corners.Unite(NextHalfEdge(h), opposed ? g : NextHalfEdge(g));
    }
    std::vector<uint32_t> first_face(usable_.positions.size(), kNoHalfEdge);
    for (uint32_t c = 0; c < partner_.size(); ++c) {
      if (corners.Find(c) != c) continue;
      const VertexId v = OriginOf(usable_, c);
      uint32_t& first = first_face[v.index()];
      if (first == kNoHalfEdge) {
        first = face_of_[FaceOfHalfEdge(c)];
      } else if (!told_[v.index()]) {
        told_[v.index()] = true;
        Add("non_manifold_vertex", {FaceId(first), FaceId(face_of_[FaceOfHalfEdge(c)])}, {v}, usable_.PositionAt(v),
            absl::StrCat("vertex ", v.index(), At(usable_.PositionAt(v)), " joins separate fans of triangles (", first,
                         " in one, ", face_of_[FaceOfHalfEdge(c)], " in another)"));
      }
    }
  }

  const TriangleMesh& mesh_;
  const size_t limit_;
  TriangleMesh usable_;            // triangles with three different finite corners
  std::vector<uint32_t> face_of_;  // their ids in mesh_
  std::vector<uint32_t> partner_;
  std::vector<bool> told_;  // vertices that a defect has named already
  DefectList list_;
};

}  // namespace

DefectList FindDefects(const TriangleMesh& mesh, size_t limit) { return DefectFinder(mesh, limit).Find(); }

absl::Status RequireManifold(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) return absl::FailedPreconditionError("the mesh has no triangles");
  if (ValidateIndices(mesh).ok() && Survey(mesh).unsound_faces == 0 && FindManifoldAdjacency(mesh))
    return absl::OkStatus();
  const DefectList list = FindDefects(mesh, kDefectsInMessage);
  std::string message =
      absl::StrCat("the mesh can't be meshed without repair: ", list.total, list.total == 1 ? " defect" : " defects");
  const char* separator = list.total > list.defects.size() ? ", the first: " : ": ";
  for (const Defect& d : list.defects) {
    absl::StrAppend(&message, separator, d.message);
    separator = "; ";
  }
  return absl::FailedPreconditionError(message);
}

}  // namespace meshfront
