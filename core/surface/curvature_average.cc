// 1. How many triangles there would be, by the vertices' own curvature (PassesFor); 2. as often each vertex takes the mean of its ring
// and itself, weighted by area (Average); 3. a vertex keeps its own curvature as far as that is within a multiple of the mean.
// Rejected: the mean alone. It takes the peaks off ridges that are real and narrow; the multiple keeps the error small there.
// Rejected: a disk for each vertex by the edge that it asks for itself. What asks for the shortest edges is what should be averaged.
#include "core/surface/curvature_average.h"

#include <algorithm>
#include <cmath>

#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr size_t kGrain = 4096;
constexpr int kKeptEvery = 4;   // passes
constexpr size_t kMaxKept = 4;  // the last ones

template <int kCount>
double SumOf(const double* values, const uint32_t* ring, double sum) {
  for (int i = 0; i < kCount; ++i) sum += values[ring[i]];
  return sum;
}
// The sum over a ring, in its order. Most have six.
inline double Sum(const double* values, const uint32_t* ring, const uint32_t* end, double sum) {
  switch (end - ring) {
    case 5:
      return SumOf<5>(values, ring, sum);
    case 6:
      return SumOf<6>(values, ring, sum);
    case 7:
      return SumOf<7>(values, ring, sum);
    default:
      for (; ring != end; ++ring) sum += values[*ring];
      return sum;
  }
}

}  // namespace

absl::StatusOr<CurvatureAverage> CurvatureAverage::Create(const MeshSurface& surface, const Context& context) {
  const TriangleMesh& mesh = surface.mesh();
  std::shared_ptr<const VertexRings> rings = surface.vertex_rings();
  if (!rings) {
    MESHFRONT_ASSIGN_OR_RETURN(VertexRings made, CreateVertexRings(mesh, surface.adjacency(), context));
    rings = std::make_shared<const VertexRings>(std::move(made));
  }
  CurvatureAverage average(surface, std::move(rings));
  average.areas_.assign(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    const double third = TriangleArea(mesh.PositionAt(t[0]), mesh.PositionAt(t[1]), mesh.PositionAt(t[2])) / 3;
    for (const VertexId v : t) average.areas_[v.index()] += third;
  }
  average.inverse_sums_.assign(mesh.positions.size(), 0);
  for (uint32_t v = 0; v < mesh.positions.size(); ++v) {
    double area = average.areas_[v];
    for (const uint32_t u : average.rings_->Of(v)) area += average.areas_[u];
    if (area > 0) average.inverse_sums_[v] = 1 / area;
  }
  return average;
}

double CurvatureAverage::PassesFor(absl::FunctionRef<double(double max_curvature)> ideal_length, double eta) const {
  const absl::Span<const double> own = surface_->vertex_curvatures();
  double triangles = 0;  // equilateral ones of side l/η
  for (size_t v = 0; v < own.size(); ++v) {
    const double edge = ideal_length(own[v]) / eta;
    triangles += 4 / std::sqrt(3.0) * areas_[v] / (edge * edge);
  }
  const double coarser = static_cast<double>(surface_->mesh().triangles.size()) / triangles;
  return coarser > 0 ? std::clamp(kPassesPerCoarser * (coarser - 1), 0.0, kMaxPasses) : 0;
}

// The last pass in part, so that a little more of them changes little.
absl::Status CurvatureAverage::Average(double passes, const Context& context) {
  const absl::Span<const double> own = surface_->vertex_curvatures();
  const auto before = std::find_if(kept_.rbegin(), kept_.rend(), [&](const Kept& k) { return k.passes <= passes; });
  int done = before == kept_.rend() ? 0 : before->passes;
  if (done > 0)
    means_ = before->means;
  else
    means_.assign(own.begin(), own.end());
  std::vector<double> weighted(own.size());
  for (; done < passes; ++done) {
    const double part = std::min(passes - done, 1.0);
    for (size_t v = 0; v < own.size(); ++v) weighted[v] = areas_[v] * means_[v];
    MESHFRONT_RETURN_IF_ERROR(ParallelFor(own.size(), kGrain, context, [&](size_t begin, size_t end) {
      // Locals, which the stores below cannot be taken to change.
      const double *const from = weighted.data(), *const per_sum = inverse_sums_.data();
      const uint32_t *const begins = rings_->begin.data(), *const neighbours = rings_->neighbours.data();
      double* const means = means_.data();
      for (size_t v = begin; v < end; ++v) {
        const double sum = Sum(from, neighbours + begins[v], neighbours + begins[v + 1], from[v]);
        means[v] += part * (sum * per_sum[v] - means[v]);
      }
    }));
    if (part == 1 && (done + 1) % kKeptEvery == 0) Keep(done + 1);
  }
  passes_ = passes;
  return absl::OkStatus();
}

void CurvatureAverage::Keep(int passes) {
  if (!kept_.empty() && kept_.back().passes >= passes) return;
  if (kept_.size() == kMaxKept)
    std::rotate(kept_.begin(), kept_.begin() + 1, kept_.end());
  else
    kept_.emplace_back();
  kept_.back() = {passes, means_};
}

absl::StatusOr<std::vector<double>> CurvatureAverage::ForEdges(
    absl::FunctionRef<double(double max_curvature)> ideal_length, double eta, const Context& context) {
  const absl::Span<const double> own = surface_->vertex_curvatures();
  const double passes = PassesFor(ideal_length, eta);
  if (passes != passes_) MESHFRONT_RETURN_IF_ERROR(Average(passes, context));
  std::vector<double> curvatures(own.begin(), own.end());
  if (passes == 0) return curvatures;
  for (size_t v = 0; v < own.size(); ++v) curvatures[v] = std::min(own[v], kMostPerAverage * means_[v]);
  return curvatures;
}

}  // namespace meshfront
