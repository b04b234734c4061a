// Sizes are those of the mesh meshed as a mesh, without creases: beside a sharp edge its curvature asks for samples that
// are dense enough to round it little. Rejected: one spacing for all; fine where it need not be, or coarse where it may not.
#include "core/sampled_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"
#include "core/io/weld.h"
#include "core/mesh/repair_survey.h"
#include "core/mesh/surface_samples.h"
#include "core/preparation.h"

namespace meshfront {
namespace {

constexpr double kSamplesPerEdge = 4;  // then a support is as wide as an edge
// Broken faces have curvatures that mean nothing: however many samples they ask for, and however few flat ones do.
constexpr double kFewestSamples = 20000, kMostSamples = 400000;

// All corners at one place become one vertex, so that repair sees which faces lie beside each other, and turns those that face
// the other way. As meshes, parts that touch stay apart. Returns how many vertices are gone.
uint64_t WeldAll(TriangleMesh& mesh) {
  std::vector<Vec3> positions;
  Welder welder(positions);
  std::vector<VertexId> names;
  for (const Vec3& x : mesh.positions) names.push_back(welder.Add(x));
  for (Triangle& t : mesh.triangles) {
    for (VertexId& v : t) v = names[v.index()];
  }
  const uint64_t gone = mesh.positions.size() - positions.size();
  mesh.positions = std::move(positions);
  return gone;
}

}  // namespace

absl::StatusOr<SampledMesh> SampleAsPoints(Problem problem, const Context& context) {
  SampledMesh result;
  if (problem.options.attributes && !problem.mesh.attributes.empty())
    result.warnings.push_back("attributes are dropped where a mesh is meshed as a point set");
  problem.options.surface = SurfaceKind::kMesh;
  problem.options.attributes = false;
  problem.options.crease_angle.reset();
  problem.mesh.attributes = {};
  problem.mesh.normals.clear();
  MESHFRONT_RETURN_IF_ERROR(ValidateIndices(problem.mesh));
  const uint64_t welded = problem.options.repair ? WeldAll(problem.mesh) : 0;
  MESHFRONT_ASSIGN_OR_RETURN(const Preparation p, Prepare(std::move(problem), context));
  const TriangleMesh& mesh = p.surface->mesh();
  double area = 0;
  for (const Triangle& t : mesh.triangles)
    area += TriangleArea(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2]));
  const double least = std::sqrt(area / kMostSamples), most = std::sqrt(area / kFewestSamples);
  result.points =
      SampleFaces(mesh, [&](const Vec3& x) { return std::clamp(p.field->At(x) / kSamplesPerEdge, least, most); });
  for (Vec3& x : result.points.positions) x = x / p.scale;
  result.input = p.input;
  if (welded > 0) result.input.repairs.insert(result.input.repairs.begin(), {"welded_vertices", welded});
  result.input.repairs.push_back({"sampled_points", result.points.positions.size()});
  result.warnings.push_back(
      absl::StrCat("the mesh was sampled at ", result.points.positions.size(),
                   " points, and the surface is that of the samples: sharp edges are rounded, and ",
                   "gaps and layers closer than a few samples melt"));
  return result;
}

}  // namespace meshfront
