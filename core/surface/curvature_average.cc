// 1. How many triangles there would be, by the vertices' own curvature (PassesFor); 2. as often each vertex takes the mean of its ring
// and itself, weighted by area (Average); 3. a vertex keeps its own curvature as far as that is within a multiple of the mean.
// Rejected: the mean alone. It takes the peaks off ridges that are real and narrow; the multiple keeps the error small there.
// Rejected: a disk for each vertex by the edge that it asks for itself. What asks for the shortest edges is what should be averaged.
#include "core/surface/curvature_average.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/status_macros.h"
#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

constexpr size_t kGrain = 4096;
constexpr double kMostPlainPasses = 3;  // beyond, polynomials take fewer steps
constexpr double kLeastDamping = 20;    // of what is narrower than the disk
constexpr double kSamePasses =
    0.2;  // so much more or less is not averaged again: a search for a count asks several times

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

// As many passes of means as `passes` says, a part of one among them, or few steps that come to the same.
absl::Status CurvatureAverage::Average(double passes, const Context& context) {
  const absl::Span<const double> own = surface_->vertex_curvatures();
  means_.assign(own.begin(), own.end());
  passes_ = passes;
  if (passes > kMostPlainPasses) return AverageInSteps(passes, context);
  std::vector<double> ring_means;
  for (double left = passes; left > 0; --left) {
    MESHFRONT_RETURN_IF_ERROR(TakeRingMeans(means_, ring_means, context));
    const double part = std::min(left, 1.0);
    for (size_t v = 0; v < means_.size(); ++v) means_[v] += part * (ring_means[v] - means_[v]);
  }
  return absl::OkStatus();
}

// A pass multiplies by A what it averages, n of them by A^n, and the eigenvalues of A lie in [−1, 1]. The Chebyshev polynomial
// T_s(x(A)) / T_s(x₀), with x(1) = x₀ and x(−1) = −1, has the slope of A^n at 1, where smooth functions are, for x₀ = (1 + t²) / (1 − t²)
// with t = s / 2n, and falls below 1 / T_s(x₀) where A^n would vanish: about √n multiplications instead of n.
absl::Status CurvatureAverage::AverageInSteps(double passes, const Context& context) {
  const auto peak_of = [&](int steps) {  // x₀
    const double t = steps / (2 * passes);
    return (1 + t * t) / (1 - t * t);
  };
  const auto chebyshev = [](int order, double x) {
    double before = 1, at = x;
    for (int i = 1; i < order; ++i) before = std::exchange(at, 2 * x * at - before);
    return at;
  };
  int steps = 2;
  while (chebyshev(steps, peak_of(steps)) < kLeastDamping) ++steps;
  const double peak = peak_of(steps), scale = 0.5 * (peak + 1), shift = peak - scale;  // x(A) = shift + scale · A
  std::vector<double> before = means_, ring_means;                                     // of one step less
  double of_before = 1, of_means = peak;                                               // T at x₀
  for (int step = 1; step <= steps; ++step) {
    MESHFRONT_RETURN_IF_ERROR(TakeRingMeans(means_, ring_means, context));
    const double of_next = step == 1 ? peak : 2 * peak * of_means - of_before;
    const double doubled = step == 1 ? 1 / peak : 2 * of_means / of_next, less = step == 1 ? 0 : of_before / of_next;
    for (size_t v = 0; v < means_.size(); ++v) {
      const double next = doubled * (shift * means_[v] + scale * ring_means[v]) - less * before[v];
      before[v] = std::exchange(means_[v], next);
    }
    if (step > 1) of_before = std::exchange(of_means, of_next);
  }
  for (double& mean : means_) mean = std::max(mean, 0.0);
  return absl::OkStatus();
}

// Of each vertex and its ring, weighted by area.
absl::Status CurvatureAverage::TakeRingMeans(absl::Span<const double> values, std::vector<double>& means,
                                             const Context& context) const {
  std::vector<double> weighted(values.size());
  for (size_t v = 0; v < values.size(); ++v) weighted[v] = areas_[v] * values[v];
  means.resize(values.size());
  return ParallelFor(values.size(), kGrain, context, [&](size_t begin, size_t end) {
    // Locals, which the stores below cannot be taken to change.
    const double *const from = weighted.data(), *const per_sum = inverse_sums_.data();
    const uint32_t *const begins = rings_->begin.data(), *const neighbours = rings_->neighbours.data();
    double* const out = means.data();
    for (size_t v = begin; v < end; ++v)
      out[v] = per_sum[v] * Sum(from, neighbours + begins[v], neighbours + begins[v + 1], from[v]);
  });
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
