// How many vertices the refinement may add where a number of triangles is wanted.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace meshfront {

// Spreads a number of insertions over a surface that is covered from one end to the other, and over what is far off and what
// is less so: otherwise nothing were left for the worst place, should it come last.
class InsertionBudget {
 public:
  // `most`: insertions in all, infinite for no limit. `predicted_triangles`: of the whole surface; 0 if not known.
  InsertionBudget(double most, double predicted_triangles) : most_(most), predicted_triangles_(predicted_triangles) {}

  bool IsLimited() const { return std::isfinite(most_); }
  // How many more there may be by now, after `used`, for a triangle that is `excess` times the bound off, when there are so many
  // triangles.
  size_t Left(uint64_t used, uint64_t triangles, double excess) const {
    constexpr double kAny = 1e9;
    double due = (excess < kNearExcess ? kNearPart : excess < kWorstExcess ? 1 : kWorstPart) * most_;
    if (predicted_triangles_ > 0) {
      const double covered = std::min(1.0, static_cast<double>(triangles) / predicted_triangles_);
      due *= covered + kAhead * (1 - covered);
    }
    return static_cast<size_t>(std::clamp(due - static_cast<double>(used), 0.0, kAny));
  }

 private:
  static constexpr double kNearExcess = 1.25, kNearPart = 0.6;  // less far off, that part of all
  // Farther off, that part: such places are few, and the one that is left out makes the maximum.
  static constexpr double kWorstExcess = 1.9, kWorstPart = 1.5;
  static constexpr double kAhead = 0.25;  // of all, from the beginning on: the places that need them come in clusters

  double most_, predicted_triangles_;
};

}  // namespace meshfront
