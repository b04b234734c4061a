// 1. the neighbours' plane at each point without a normal    2. a minimum spanning tree over neighbours, the edges
// along which sides are clearest first, carries the side from one to the next    3. parts without any given normal are
// turned so that they enclose a positive volume
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/base/status_macros.h"
#include "core/geometry/point_tree.h"
#include "core/mesh/point_noise.h"
#include "core/mesh/point_repair.h"
#include "core/mesh/point_sides.h"
#include "core/mesh/union_find.h"

namespace meshfront {
namespace {

constexpr size_t kPlaneNeighbours = 14;
constexpr size_t kGrain = 256;
// Neighbours that are no more in doubt than this tell of a wrong side; others may lie around an edge.
constexpr double kClear = 0.3;

struct Neighbours {
  size_t each = 0;
  std::vector<uint32_t> list;  // `each` a point, the nearest first
};

struct Pair {
  double doubt;
  uint32_t a, b;
  bool unlike;  // one of them is to be turned
};

// Neighbours by how clear their sides are, the clearest first.
std::vector<Pair> SortedPairs(const TriangleMesh& points, const Neighbours& neighbours) {
  std::vector<Pair> pairs;
  for (uint32_t i = 0; i < points.positions.size(); ++i) {
    for (size_t at = 0; at < neighbours.each; ++at) {
      const uint32_t j = neighbours.list[i * neighbours.each + at];
      const SideComparison sides =
          CompareSides(points.positions[i], points.normals[i], points.positions[j], points.normals[j]);
      pairs.push_back({sides.doubt, i, j, sides.agreement < 0});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& x, const Pair& y) {
    if (x.doubt != y.doubt) return x.doubt < y.doubt;
    return x.a != y.a ? x.a < y.a : x.b < y.b;
  });
  return pairs;
}

// Turns the parts that hold a given normal to agree with it, the others outward. Returns whether each point is to be
// turned.
std::vector<bool> Sides(const TriangleMesh& points, const std::vector<bool>& given, ParityUnionFind& sets) {
  const size_t n = points.positions.size();
  std::vector<double> votes(n, 0), volumes(n, 0);
  std::vector<Vec3> centers(n);
  std::vector<double> counts(n, 0);
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t root = sets.Find(i).first;
    centers[root] += points.positions[i], counts[root] += 1;
  }
  for (uint32_t i = 0; i < n; ++i) {
    const auto [root, unlike] = sets.Find(i);
    const double sign = unlike ? -1 : 1;
    votes[root] += given[i] ? sign : 0;
    volumes[root] += sign * Dot(points.normals[i], points.positions[i] - centers[root] / counts[root]);
  }
  std::vector<bool> turned(n);
  for (uint32_t i = 0; i < n; ++i) {
    const auto [root, unlike] = sets.Find(i);
    turned[i] = unlike != ((votes[root] != 0 ? votes[root] : volumes[root]) < 0);
  }
  return turned;
}

}  // namespace

absl::StatusOr<SideReport> EstimateNormals(TriangleMesh& points, size_t plane_neighbours, bool turn_given,
                                           const Context& context) {
  const size_t n = points.positions.size(), asked = std::max(plane_neighbours, kPlaneNeighbours);
  Neighbours neighbours{std::min(kPlaneNeighbours, n - 1), {}};
  neighbours.list.resize(n * neighbours.each);
  std::vector<bool> given;
  for (const Vec3& normal : points.normals) given.push_back(normal != Vec3{});
  const PointTree tree(points.positions);
  MESHFRONT_RETURN_IF_ERROR(ParallelFor(n, kGrain, context, [&](size_t begin, size_t end) {
    std::vector<std::pair<double, uint32_t>> found;
    std::vector<uint32_t> around;
    for (size_t i = begin; i < end; ++i) {
      tree.FindNearest(points.positions[i], (given[i] ? neighbours.each : asked) + 1, found);
      uint32_t* list = neighbours.list.data() + i * neighbours.each;
      size_t at = 0;
      for (const auto& entry : found) {
        if (entry.second != i && at < neighbours.each) list[at++] = entry.second;
      }
      if (given[i]) continue;
      around.clear();
      for (const auto& entry : found) around.push_back(entry.second);
      points.normals[i] = FitNeighbourPlane(points.positions, around).normal;
    }
  }));
  const std::vector<Pair> pairs = SortedPairs(points, neighbours);
  MESHFRONT_RETURN_IF_ERROR(context.CheckStop());
  ParityUnionFind sets(n);
  for (const Pair& pair : pairs)
    sets.Unite(pair.a, pair.b, (turn_given || !(given[pair.a] && given[pair.b])) && pair.unlike);
  const std::vector<bool> turned = Sides(points, given, sets);
  SideReport report;
  for (size_t i = 0; i < n; ++i) {
    if (!turned[i] || (given[i] && !turn_given)) continue;
    points.normals[i] = -points.normals[i];
    report.turned += given[i];
  }
  for (const Pair& pair : pairs) {
    if (pair.doubt > kClear) break;
    report.undecided_pairs += pair.a < pair.b && pair.unlike != (turned[pair.a] != turned[pair.b]);
  }
  return report;
}

}  // namespace meshfront
