// Sizes are those of the mesh meshed as a mesh, without creases: beside a sharp edge its curvature asks for samples that
// are dense enough to round it little. Rejected: one spacing for all; fine where it need not be, or coarse where it may not.
#include "core/sampled_mesh.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"
#include "core/io/weld.h"
#include "core/mesh/repair_survey.h"
#include "core/mesh/surface_samples.h"
#include "core/mesh/union_find.h"
#include "core/mesh/winding_number.h"
#include "core/preparation.h"

namespace meshfront {
namespace {

constexpr double kSamplesPerEdge = 4;  // then a support is as wide as an edge
// Broken faces have curvatures that mean nothing: however many samples they ask for, and however few flat ones do.
constexpr double kFewestSamples = 20000, kMostSamples = 200000;
// A sample is inside of something when the mesh winds around the place this part of the spacing above it more than so often:
// open parts wind less than once around what they hold, and just below a loose face it is a half.
constexpr double kAbovePerSpacing = 0.1, kInside = 0.7;
constexpr size_t kGrain = 256;

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

using Spacing = std::function<double(const Vec3&)>;

std::vector<uint32_t> ComponentsOf(const TriangleMesh& mesh) {
  UnionFind sets(mesh.positions.size());
  for (const Triangle& t : mesh.triangles)
    sets.Unite(t[0].index(), t[1].index()), sets.Unite(t[0].index(), t[2].index());
  std::vector<uint32_t> components;
  for (const Triangle& t : mesh.triangles) components.push_back(sets.Find(t[0].index()));
  return components;
}

// Samples that lie inside of another part, which their fronts would run into. Of parts that lie inside altogether none goes:
// they meet nothing. Returns how many are gone.
absl::StatusOr<uint64_t> DropInner(const TriangleMesh& mesh, const Spacing& spacing, FaceSamples& samples,
                                   const Context& context) {
  const WindingNumber winding(mesh);
  const size_t n = samples.faces.size();
  std::vector<uint8_t> is_inner(n, 0);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(n, kGrain, context, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Vec3& x = samples.points.positions[i];
      is_inner[i] = winding.IsAbove(x + kAbovePerSpacing * spacing(x) * samples.points.normals[i], kInside);
    }
  }));
  const std::vector<uint32_t> components = ComponentsOf(mesh);
  std::vector<bool> is_outer(mesh.positions.size(), false);
  for (size_t i = 0; i < n; ++i) {
    if (!is_inner[i]) is_outer[components[samples.faces[i]]] = true;
  }
  TriangleMesh kept;
  for (size_t i = 0; i < n; ++i) {
    if (is_inner[i] && is_outer[components[samples.faces[i]]]) continue;
    kept.positions.push_back(samples.points.positions[i]);
    kept.normals.push_back(samples.points.normals[i]);
  }
  samples.points = std::move(kept);
  return n - samples.points.positions.size();
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
  const Spacing spacing = [&](const Vec3& x) { return std::clamp(p.field->At(x) / kSamplesPerEdge, least, most); };
  FaceSamples samples = SampleFaces(mesh, spacing);
  MESHFRONT_ASSIGN_OR_RETURN(const uint64_t inner, DropInner(mesh, spacing, samples, context));
  result.points = std::move(samples.points);
  for (Vec3& x : result.points.positions) x = x / p.scale;
  result.input = p.input;
  AddGaps({p.gaps.filled, {}}, result.input.repairs);  // of those left open the samples may close some
  if (welded > 0) result.input.repairs.insert(result.input.repairs.begin(), {"welded_vertices", welded});
  if (inner > 0) result.input.repairs.push_back({"dropped_inner_points", inner});
  result.input.repairs.push_back({"sampled_points", result.points.positions.size()});
  result.warnings.push_back(
      absl::StrCat("the mesh was sampled at ", result.points.positions.size(),
                   " points, and the surface is that of the samples: sharp edges are rounded, and ",
                   "gaps and layers closer than a few samples melt"));
  return result;
}

}  // namespace meshfront
