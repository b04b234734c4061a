#include "core/mesh/repair_survey.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "core/mesh/tolerances.h"

namespace meshfront {
namespace {

// Comparisons with what is not a number fail.
bool IsComputable(const Vec3& p) {
  return (std::abs(p.x) <= kLargestCoordinate) & (std::abs(p.y) <= kLargestCoordinate) &
         (std::abs(p.z) <= kLargestCoordinate);
}

double LargestComponent(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// Two triangles back to back: all sides of one lead to the other.
bool HasPillow(const FaceAdjacency& adjacency) {
  for (const auto& sides : adjacency.opposite) {
    if (sides[0] != kNoHalfEdge && sides[1] != kNoHalfEdge && sides[2] != kNoHalfEdge &&
        FaceOfHalfEdge(sides[0]) == FaceOfHalfEdge(sides[1]) && FaceOfHalfEdge(sides[1]) == FaceOfHalfEdge(sides[2])) {
      return true;
    }
  }
  return false;
}

}  // namespace

namespace {

// `longest2`: the square of the longest side of a face that is sound, or without area only.
FaceState StateOf(const TriangleMesh& mesh, const Triangle& t, double& longest2) {
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return FaceState::kRepeatedIndex;
  const Vec3 &a = mesh.PositionAt(t[0]), &b = mesh.PositionAt(t[1]), &c = mesh.PositionAt(t[2]);
  if (!IsComputable(a) || !IsComputable(b) || !IsComputable(c)) {
    return IsFinite(a) && IsFinite(b) && IsFinite(c) ? FaceState::kHuge : FaceState::kNotFinite;
  }
  const Vec3 ab = b - a, bc = c - b, ca = a - c;
  longest2 = std::max({SquaredNorm(ab), SquaredNorm(bc), SquaredNorm(ca)});
  // The largest component stands for the norm: its square could vanish.
  return LargestComponent(Cross(ab, ca)) > kZeroAreaRatio * longest2 ? FaceState::kSound : FaceState::kZeroArea;
}

}  // namespace

FaceState StateOf(const TriangleMesh& mesh, const Triangle& t) {
  double longest2 = 0;
  return StateOf(mesh, t, longest2);
}

absl::Status ValidateIndices(const TriangleMesh& mesh) {
  const size_t count = mesh.positions.size();
  for (size_t f = 0; f < mesh.triangles.size(); ++f) {
    for (const VertexId v : mesh.triangles[f]) {
      if (v.index() < count) continue;
      return absl::InvalidArgumentError(
          absl::StrCat("triangle ", f, " names vertex ", v.index(), "; the mesh has ", count, " vertices"));
    }
  }
  return absl::OkStatus();
}

MeshSurvey Survey(const TriangleMesh& mesh) {
  MeshSurvey out;
  double longest2 = 0;
  const size_t stride = mesh.triangles.size() / 1000 + 1;
  std::vector<double> sample;
  std::vector<uint8_t> is_in_box(mesh.positions.size(), 0);
  for (size_t f = 0, next = 0; f < mesh.triangles.size(); ++f) {
    const bool is_sample = f == next;
    if (is_sample) next += stride;
    const Triangle& t = mesh.triangles[f];
    double side2 = 0;
    const FaceState state = StateOf(mesh, t, side2);
    out.unsound_faces += state != FaceState::kSound;
    if (state != FaceState::kSound && state != FaceState::kZeroArea) continue;
    for (const VertexId v : t) is_in_box[v.index()] = 1;
    longest2 = std::max(longest2, side2);
    if (is_sample) sample.push_back(side2);
  }
  for (size_t v = 0; v < is_in_box.size(); ++v) {
    if (is_in_box[v]) out.box.Extend(mesh.positions[v]);
  }
  out.longest_side = std::sqrt(longest2);
  if (sample.empty()) return out;
  std::nth_element(sample.begin(), sample.begin() + sample.size() / 2, sample.end());
  out.median_side = std::sqrt(sample[sample.size() / 2]);
  return out;
}

std::optional<FaceAdjacency> FindManifoldAdjacency(const TriangleMesh& mesh) {
  std::optional<FaceAdjacency> adjacency = FindOrientedAdjacency(mesh);
  if (!adjacency || !HasSingleFans(mesh, *adjacency) || HasPillow(*adjacency)) return std::nullopt;
  return adjacency;
}

}  // namespace meshfront
