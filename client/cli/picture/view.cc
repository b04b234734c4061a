// Algorithm: 1. sample the area vectors of the faces (ProjectedAreas); 2. score every candidate direction by the area it shows;
// 3. frame the shape in the best one (FrameShape). Principal axes were rejected: they tilt upright statues.
#include "client/cli/picture/view.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

#include "core/geometry/triangle.h"

namespace meshfront {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
// Faces looked at when directions are scored: enough for three digits of the projected area.
constexpr size_t kScoredFaces = 20000;
// A view from above must show this much more for each step of elevation, z up this much more than y up, and a view from
// the far side this much more than one from the front: shapes are made to be looked at from the front, standing.
constexpr double kElevationPenalty = 0.06, kZUpPenalty = 0.2, kBehindPenalty = 0.05;
constexpr double kMargin = 1.06;  // air around the shape

struct Candidate {
  View view;
  double preference;
};

View LookFrom(double azimuth, double elevation, bool z_up) {
  View view;
  const double c = std::cos(elevation), s = std::sin(elevation);
  view.toward = {c * std::sin(azimuth), s, c * std::cos(azimuth)};
  view.right = {std::cos(azimuth), 0, -std::sin(azimuth)};
  if (z_up) {  // a quarter turn about x takes y to z
    auto turned = [](const Vec3& v) { return Vec3{v.x, -v.z, v.y}; };
    view.toward = turned(view.toward), view.right = turned(view.right);
  }
  view.up = Cross(view.toward, view.right);
  return view;
}

std::vector<Candidate> Candidates(std::optional<UpAxis> up) {
  constexpr std::array<double, 3> elevations = {18, 35, 60};
  std::vector<Candidate> candidates;
  for (const bool z_up : {false, true}) {
    if (up && z_up != (*up == UpAxis::kZ)) continue;
    for (size_t e = 0; e < elevations.size(); ++e) {
      for (int azimuth = -165; azimuth <= 165; azimuth += 30) {
        const bool behind = std::abs(azimuth) > 90;
        candidates.push_back({LookFrom(azimuth * kDegree, elevations[e] * kDegree, z_up),
                              1 - kElevationPenalty * e - (z_up ? kZUpPenalty : 0) - (behind ? kBehindPenalty : 0)});
      }
    }
  }
  return candidates;
}

bool IsDrawable(const TriangleMesh& mesh, const Triangle& t) {
  for (const VertexId v : t) {
    if (v.index() >= mesh.positions.size() || !IsFinite(mesh.PositionAt(v))) return false;
  }
  return true;
}

std::vector<Vec3> ProjectedAreas(const TriangleMesh& mesh) {
  std::vector<Vec3> areas;
  const size_t stride = std::max<size_t>(1, mesh.triangles.size() / kScoredFaces);
  for (size_t i = 0; i < mesh.triangles.size(); i += stride) {
    const Triangle& t = mesh.triangles[i];
    if (!IsDrawable(mesh, t)) continue;
    areas.push_back(AreaVector(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])));
  }
  return areas;
}

double Score(const Candidate& candidate, const std::vector<Vec3>& areas) {
  double shown = 0;
  for (const Vec3& area : areas) shown += std::max(0.0, Dot(area, candidate.view.toward));
  return shown * candidate.preference;
}

void FrameShape(const TriangleMesh& mesh, View* view) {
  Box3 box;  // in the axes of the view
  auto extend = [&](const Vec3& p) {
    if (IsFinite(p)) box.Extend(Vec3{Dot(p, view->right), Dot(p, view->up), Dot(p, view->toward)});
  };
  if (mesh.IsPointSet()) {
    for (const Vec3& p : mesh.positions) extend(p);
  }
  for (const Triangle& t : mesh.triangles) {
    if (!IsDrawable(mesh, t)) continue;
    for (const VertexId v : t) extend(mesh.PositionAt(v));
  }
  if (box.empty()) return;
  const Vec3 middle = box.Center();
  view->center = middle.x * view->right + middle.y * view->up + middle.z * view->toward;
  const Vec3 size = box.max - box.min;
  const double extent = std::max(size.x, size.y);
  view->half_extent = extent > 0 ? 0.5 * kMargin * extent : 1;
}

}  // namespace

View ChooseView(const TriangleMesh& mesh, std::optional<UpAxis> up) {
  const std::vector<Vec3> areas = ProjectedAreas(mesh);
  const std::vector<Candidate> candidates = Candidates(up);
  View best = LookFrom(30 * kDegree, 18 * kDegree, up == UpAxis::kZ);
  double best_score = 0;
  for (const Candidate& candidate : candidates) {
    const double score = Score(candidate, areas);
    if (score > best_score) best = candidate.view, best_score = score;
  }
  FrameShape(mesh, &best);
  return best;
}

}  // namespace meshfront
