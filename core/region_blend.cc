// Create: 1. the mean edge of the border at each of its vertices    2. ways to the border along edges, in edges of where they end
// (MeasureDepths)    3. what is fixed: the border, and what lies deep    4. the Laplacian system, with weights by the cotangents of the
// angles opposite, which are kept positive.
// Apply: samples at the vertices, and between them where they lie far apart, and at the samples of the ideal field, so that no detail of
// that is lost between vertices.
// Rejected: f from the depth alone, by a ramp; it has a ridge wherever two borders are as near.
#include "core/region_blend.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>
#include <utility>

#include "core/base/status_macros.h"
#include "core/geometry/triangle.h"
#include "core/guidance/blend.h"

namespace meshfront {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Weights of edges, whose cotangents are negative or beyond all measure at thin faces.
constexpr double kLeastWeight = 0.05, kMostWeight = 20;
// Samples between vertices lie so many edges apart: g rises by a tenth between them.
constexpr double kSpacing = 1.0 / 3;  // of MeshSurface::CurvatureSamples'

uint32_t NodeOf(const MeshSurface& part, uint32_t h) { return part.OriginalOf(OriginOf(part.mesh(), h)); }

double CotangentOpposite(const TriangleMesh& mesh, uint32_t h) {
  const Vec3& apex = mesh.PositionAt(OriginOf(mesh, PreviousHalfEdge(h)));
  const Vec3 a = mesh.PositionAt(OriginOf(mesh, h)) - apex, b = mesh.PositionAt(TargetOf(mesh, h)) - apex;
  const double sine = Norm(Cross(a, b)), cosine = Dot(a, b);
  return sine > 0 ? cosine / sine : cosine > 0 ? kMostWeight : 0;
}

// Half the cotangent for each side of an edge, over creases as well.
std::vector<WeightedEdge> WeightedEdgesOf(const MeshSurface& part) {
  std::vector<WeightedEdge> edges;
  for (uint32_t h = 0; h < 3 * part.mesh().triangles.size(); ++h) {
    const uint32_t a = NodeOf(part, h), b = NodeOf(part, NextHalfEdge(h));
    edges.push_back({a, b, std::clamp(0.5 * CotangentOpposite(part.mesh(), h), kLeastWeight, kMostWeight)});
  }
  return edges;
}

// The ways from each node to the border, in edges of where they end; +infinity where none leads there.
std::vector<double> MeasureDepths(const MeshSurface& part, const std::vector<double>& border_edges) {
  const TriangleMesh& mesh = part.mesh();
  std::vector<std::vector<std::pair<uint32_t, double>>> ways(border_edges.size());
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    const uint32_t a = NodeOf(part, h), b = NodeOf(part, NextHalfEdge(h));
    const double length = std::sqrt(SquaredLength(mesh, h));
    ways[a].push_back({b, length}), ways[b].push_back({a, length});
  }
  std::vector<double> depths(border_edges.size(), kInfinity);
  using Entry = std::tuple<double, uint32_t, double>;  // depth, node, edge of the border there
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (uint32_t v = 0; v < border_edges.size(); ++v) {
    if (border_edges[v] > 0) depths[v] = 0, queue.push({0, v, border_edges[v]});
  }
  while (!queue.empty()) {
    const auto [depth, node, edge] = queue.top();
    queue.pop();
    if (depth > depths[node]) continue;
    for (const auto& [next, length] : ways[node]) {
      const double there = depth + length / edge;
      if (there < depths[next]) depths[next] = there, queue.push({there, next, edge});
    }
  }
  return depths;
}

// Of each part of the region that hangs together, the node farthest from the border.
std::vector<uint32_t> DeepestNodes(const MeshSurface& part, const std::vector<double>& depths) {
  const auto half_edges = static_cast<uint32_t>(3 * part.mesh().triangles.size());
  std::vector<std::vector<uint32_t>> neighbours(depths.size());
  for (uint32_t h = 0; h < half_edges; ++h) neighbours[NodeOf(part, h)].push_back(NodeOf(part, NextHalfEdge(h)));
  for (uint32_t h = 0; h < half_edges; ++h) neighbours[NodeOf(part, NextHalfEdge(h))].push_back(NodeOf(part, h));
  std::vector<bool> seen(depths.size(), false);
  std::vector<uint32_t> deepest;
  for (uint32_t h = 0; h < half_edges; ++h) {
    if (seen[NodeOf(part, h)]) continue;
    std::vector<uint32_t> queue{NodeOf(part, h)};
    seen[queue[0]] = true;
    uint32_t best = queue[0];
    for (size_t i = 0; i < queue.size(); ++i) {
      if (depths[queue[i]] > depths[best]) best = queue[i];
      for (const uint32_t n : neighbours[queue[i]]) {
        if (!seen[n]) seen[n] = true, queue.push_back(n);
      }
    }
    deepest.push_back(best);
  }
  return deepest;
}

}  // namespace

// Of each vertex on the border, the mean of its edges there; 0 of others.
void RegionBlend::MeasureBorder(std::vector<double>& border_edges) {
  const TriangleMesh& mesh = part_->mesh();
  std::vector<int> counts(mesh.positions.size(), 0);
  border_edges.assign(mesh.positions.size(), 0);
  for (uint32_t h = 0; h < 3 * mesh.triangles.size(); ++h) {
    if (!part_->IsBorder(h)) continue;
    for (const uint32_t v : {NodeOf(*part_, h), NodeOf(*part_, NextHalfEdge(h))}) {
      border_edges[v] += std::sqrt(SquaredLength(mesh, h));
      ++counts[v];
    }
  }
  for (size_t v = 0; v < counts.size(); ++v) {
    if (counts[v] == 0) continue;
    border_edges[v] /= counts[v];
    shortest_ = shortest_ == 0 ? border_edges[v] : std::min(shortest_, border_edges[v]);
    longest_ = std::max(longest_, border_edges[v]);
  }
}

absl::StatusOr<RegionBlend> RegionBlend::Create(const MeshSurface& part, double width, double eta,
                                                const Context& context) {
  RegionBlend blend(part);
  std::vector<double> border_edges;
  blend.MeasureBorder(border_edges);
  const std::vector<double> depths = MeasureDepths(part, border_edges);
  const double deep = std::max(width, 1 / (1 - 1 / eta));
  std::vector<bool> is_zero(depths.size(), false);
  for (size_t v = 0; v < depths.size(); ++v) is_zero[v] = depths[v] >= deep;
  for (const uint32_t v : DeepestNodes(part, depths)) is_zero[v] = is_zero[v] || depths[v] > 0;
  std::vector<std::pair<uint32_t, BlendValues>> fixed;
  for (uint32_t v = 0; v < depths.size(); ++v) {
    if (border_edges[v] > 0)
      fixed.push_back({v, {1, border_edges[v]}});
    else if (is_zero[v] && part.OriginalOf(VertexId(v)) == v)
      fixed.push_back({v, {0, 0}});
  }
  const auto count = static_cast<uint32_t>(depths.size());
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<BlendValues> values,
                             SolveBlend(count, WeightedEdgesOf(part), fixed, context));
  for (uint32_t v = 0; v < count; ++v) {
    const BlendValues& value = values[part.OriginalOf(VertexId(v))];
    blend.share_.push_back(value[0]);
    blend.length_.push_back(value[1]);
  }
  return blend;
}

absl::StatusOr<GuidanceField> RegionBlend::Apply(const GuidanceField& ideal, absl::Span<const SizingSample> added,
                                                 const Context& context) const {
  const double eta = ideal.eta();
  const TriangleMesh& mesh = part_->mesh();
  std::vector<double> spacing;
  for (uint32_t v = 0; v < mesh.positions.size(); ++v)
    spacing.push_back(kSpacing * eta * (length_[v] + (1 - share_[v]) * ideal.At(mesh.positions[v])));
  // Interpolates two values of the vertices, whatever they are.
  MESHFRONT_ASSIGN_OR_RETURN(const std::vector<CurvatureSample> places,
                             part_->CurvatureSamples(share_, spacing, length_, context));
  std::vector<SizingSample> samples(added.begin(), added.end());
  for (const CurvatureSample& p : places) {
    const double share = p.max_curvature, length = p.sheet_distance;
    samples.push_back({p.position, eta * (length + (1 - share) * ideal.At(p.position))});
  }
  for (const SizingSample& s : ideal.kept_samples()) {
    const auto hit = faces_.FindClosestPoint(s.position);
    if (!hit || !std::isfinite(s.ideal_length)) continue;
    const Triangle& t = mesh.triangles[hit->face.index()];
    double share = 0, length = 0;
    for (int i = 0; i < 3; ++i) {
      share += hit->point.weights[i] * share_[t[i].index()];
      length += hit->point.weights[i] * length_[t[i].index()];
    }
    samples.push_back({s.position, eta * length + (1 - share) * s.ideal_length});
  }
  std::erase_if(samples, [](const SizingSample& s) { return !(s.ideal_length > 0); });
  GuidanceOptions options = ideal.options();
  if (longest_ > 0) {
    options.min_length = std::min(options.min_length, shortest_);
    options.max_length = std::max(options.max_length, longest_);
  }
  return GuidanceField::Create(std::move(samples), options, context);
}

}  // namespace meshfront
