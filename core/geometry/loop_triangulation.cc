#include "core/geometry/loop_triangulation.h"

#include <limits>

namespace meshfront {

std::optional<std::vector<ClosureStep>> TriangulateLoop(int count, const ClosureWeight& weight) {
  constexpr double kForbidden = std::numeric_limits<double>::infinity();
  const auto at = [count](int i, int j) { return static_cast<size_t>(i) * count + j; };
  std::vector<double> best(static_cast<size_t>(count) * count, 0);
  std::vector<int> apex(best.size(), -1);
  for (int span = 2; span < count; ++span) {
    for (int first = 0; first + span < count; ++first) {
      const int last = first + span;
      best[at(first, last)] = kForbidden;
      for (int k = first + 1; k < last; ++k) {
        const double below = best[at(first, k)] + best[at(k, last)];
        if (!(below < best[at(first, last)])) continue;
        const double own = weight(first, k, last);
        if (own >= 0 && below + own < best[at(first, last)])
          best[at(first, last)] = below + own, apex[at(first, last)] = k;
      }
    }
  }
  if (count < 3 || best[at(0, count - 1)] == kForbidden) return std::nullopt;
  std::vector<ClosureStep> steps = {{0, count - 1, apex[at(0, count - 1)]}};
  for (size_t i = 0; i < steps.size(); ++i) {
    const ClosureStep s = steps[i];
    if (s.apex - s.first > 1) steps.push_back({s.first, s.apex, apex[at(s.first, s.apex)]});
    if (s.last - s.apex > 1) steps.push_back({s.apex, s.last, apex[at(s.apex, s.last)]});
  }
  return steps;
}

}  // namespace meshfront
