// 1. the longest edge at each vertex    2. samples farther than that from the nearest vertex    3. of those, whose places
// on the surface are, patches of which all are    4. the best of each part
#include "core/uncovered_samples.h"

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/geometry/point_tree.h"

namespace meshfront {
namespace {

// Within a triangle a vertex is nearer than its longest edge by far, also where that bends.
constexpr double kCoveredPerEdge = 1;
// Noise leaves single samples uncovered, not all of those that lie beside each other.
constexpr size_t kFewest = 24, kFewestOfAPatch = 4;
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

std::vector<SourcePoint> FindUncovered(const PointSurface& surface, const TriangleMesh& mesh) {
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
  for (uint32_t p = 0; p < samples.patch_count(); ++p) {
    const absl::Span<const uint32_t> members = samples.MembersOf(p);
    if (members.size() < kFewestOfAPatch) continue;
    const auto is_beside_all = [&](uint32_t i) {
      const double spacing = samples.SpacingAt(i);
      return !is_covered(samples.samples()[i].position, spacing) && !is_covered(surface.AtSample(i).position, spacing);
    };
    if (!std::all_of(members.begin(), members.end(), is_beside_all)) continue;
    Part& part = parts[samples.ComponentOf(members[0])];
    part.count += members.size();
    const double asymmetry = surface.AsymmetryAt(members[0]);
    if (asymmetry < part.least) part.least = asymmetry, part.seed = surface.AtSample(members[0]);
  }
  std::vector<SourcePoint> seeds;
  for (const Part& part : parts)
    if (part.count >= kFewest) seeds.push_back(part.seed);
  return seeds;
}

}  // namespace meshfront
