// 1. the longest edge at each vertex    2. samples farther than that from the nearest vertex    3. of those, whose places
// on the surface are    4. the best of each part
#include "core/uncovered_samples.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/geometry/point_tree.h"

namespace meshfront {
namespace {

// Within a triangle a vertex is nearer than its longest edge by far, also where that bends.
constexpr double kCoveredPerEdge = 1;
constexpr size_t kFewest = 12;
// Spacings beside a rim: the front may stop so far inside of the last samples.
constexpr double kBesideRim = 1;

std::vector<double> LongestEdges(const TriangleMesh& mesh) {
  std::vector<double> longest(mesh.positions.size(), 0);
  for (const Triangle& t : mesh.triangles) {
    for (int i = 0; i < 3; ++i) {
      const VertexId a = t[i], b = t[(i + 1) % 3];
      const double length = Distance(mesh.PositionAt(a), mesh.PositionAt(b));
      longest[a.index()] = std::max(longest[a.index()], length);
      longest[b.index()] = std::max(longest[b.index()], length);
    }
  }
  return longest;
}

}  // namespace

std::vector<SourcePoint> FindUncovered(const ImplicitMlsSurface& surface, const TriangleMesh& mesh) {
  const MlsSamples& samples = surface.samples();
  const std::vector<double> longest = LongestEdges(mesh);
  const PointTree tree(mesh.positions);
  const auto is_covered = [&](const Vec3& x, double spacing) {
    const uint32_t v = tree.FindNearest(x, std::numeric_limits<double>::infinity(), [](uint32_t) { return true; });
    if (v == PointTree::kNone) return false;
    const double reach = kCoveredPerEdge * longest[v] + kBesideRim * spacing;
    return SquaredDistance(x, mesh.positions[v]) <= reach * reach;
  };
  struct Part {
    size_t count = 0;
    double least = std::numeric_limits<double>::infinity();
    SourcePoint seed;
  };
  std::vector<Part> parts(samples.component_count());
  for (uint32_t i = 0; i < samples.samples().size(); ++i) {
    if (samples.ComponentOf(i) == MlsSamples::kStray) continue;
    const double spacing = samples.SpacingAt(i);
    if (is_covered(samples.samples()[i].position, spacing)) continue;
    const SourcePoint place = surface.AtSample(i);
    if (is_covered(place.position, spacing)) continue;
    Part& part = parts[samples.ComponentOf(i)];
    ++part.count;
    const double asymmetry = surface.AsymmetryAt(i);
    if (asymmetry < part.least) part.least = asymmetry, part.seed = place;
  }
  std::vector<SourcePoint> seeds;
  for (const Part& part : parts)
    if (part.count >= kFewest) seeds.push_back(part.seed);
  return seeds;
}

}  // namespace meshfront
