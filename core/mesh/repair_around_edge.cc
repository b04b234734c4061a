#include "core/mesh/repair_around_edge.h"

#include <algorithm>
#include <cmath>

namespace meshfront {
namespace {

// Grows with the angle of (x, y) from 0 to 4 in a full turn; opposite directions differ by 2 exactly. No library
// function whose last bit could differ between machines.
double PseudoAngle(double x, double y) {
  const double sum = std::abs(x) + std::abs(y);
  if (!(sum > 0)) return 0;
  const double p = x / sum;
  return y >= 0 ? 1 - p : 3 + p;
}

struct SortedFace {
  double angle;
  FaceAtEdge face;
};

std::vector<SortedFace> SortedByAngle(const Vec3& a, const Vec3& b, const std::vector<FaceAtEdge>& faces) {
  const Vec3 axis = Normalized(b - a);
  // The coordinate axis farthest from the edge gives a frame around it.
  const Vec3 size{std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)};
  const Vec3 helper = size.x <= size.y && size.x <= size.z ? Vec3{1, 0, 0}
                      : size.y <= size.z                   ? Vec3{0, 1, 0}
                                                           : Vec3{0, 0, 1};
  const Vec3 u = Normalized(Cross(axis, helper)), v = Cross(axis, u);
  std::vector<SortedFace> sorted;
  for (const FaceAtEdge& f : faces) sorted.push_back({PseudoAngle(Dot(f.apex - a, u), Dot(f.apex - a, v)), f});
  std::sort(sorted.begin(), sorted.end(), [](const SortedFace& x, const SortedFace& y) {
    return x.angle != y.angle ? x.angle < y.angle : x.face.half_edge < y.face.half_edge;
  });
  return sorted;
}

// The two of three that are flattest, opposed ones first.
std::pair<int, int> FlattestOfThree(const std::vector<SortedFace>& faces) {
  std::pair<int, int> best{-1, -1};
  double best_bend = 1e9;
  for (int i = 0; i < 3; ++i) {
    for (int j = i + 1; j < 3; ++j) {
      double bend = std::abs(faces[j].angle - faces[i].angle - 2);
      if (faces[i].face.forward == faces[j].face.forward) bend += 100;
      if (bend < best_bend) best_bend = bend, best = {i, j};
    }
  }
  return best;
}

}  // namespace

std::vector<std::pair<uint32_t, uint32_t>> PairFacesAround(const Vec3& a, const Vec3& b, std::vector<FaceAtEdge> faces,
                                                           bool opposed_only) {
  const std::vector<SortedFace> sorted = SortedByAngle(a, b, faces);
  const size_t count = sorted.size();
  std::vector<std::pair<uint32_t, uint32_t>> pairs;
  if (count == 3 && !opposed_only) {
    const auto [i, j] = FlattestOfThree(sorted);
    return {{sorted[i].face.half_edge, sorted[j].face.half_edge}};
  }
  // A backward face has its back towards growing angles, a forward one towards falling: brackets that match. Twice
  // around, as the circle has no beginning.
  std::vector<bool> paired(count, false);
  std::vector<size_t> open;
  for (size_t k = 0; k < 2 * count; ++k) {
    const size_t i = k % count;
    if (paired[i]) continue;
    if (!sorted[i].face.forward) {
      if (k < count) open.push_back(i);
      continue;
    }
    while (!open.empty() && paired[open.back()]) open.pop_back();
    if (open.empty() || (opposed_only && sorted[open.back()].face.apex == sorted[i].face.apex)) continue;
    paired[i] = paired[open.back()] = true;
    pairs.push_back({sorted[open.back()].face.half_edge, sorted[i].face.half_edge});
    open.pop_back();
  }
  if (opposed_only) return pairs;
  std::vector<size_t> rest;
  for (size_t i = 0; i < count; ++i) {
    if (!paired[i]) rest.push_back(i);
  }
  for (size_t i = 0; i + 1 < rest.size(); i += 2) {
    pairs.push_back({sorted[rest[i]].face.half_edge, sorted[rest[i + 1]].face.half_edge});
  }
  return pairs;
}

}  // namespace meshfront
