// The guidance field plus the cones that the front adds where it has to advance again at finer steps.
#pragma once

#include <algorithm>
#include <vector>

#include "core/guidance/guidance_field.h"

namespace meshfront {

// Lipschitz like the field itself. Not thread-safe while Refine is called.
class LocalField {
 public:
  explicit LocalField(const GuidanceField& field) : field_(&field) {}

  double At(const Vec3& x) const {
    double g = field_->At(x);
    for (const SizingSample& s : cones_)
      g = std::min(g, GradedLength(Distance(s.position, x), s.ideal_length, field_->eta()));
    return std::max(g, field_->options().min_length);
  }
  // From now on g(place) ≤ length. The surroundings of the place are what lies within `reach`.
  void Refine(const Vec3& place, double length, double reach) {
    cones_.push_back({place, length * field_->eta()});
    reaches_.push_back(reach);
  }
  // Whether a refinement is what decides at x.
  bool IsRefinedAt(const Vec3& x) const { return !cones_.empty() && At(x) < field_->At(x); }
  // How many refinements have `place` in their surroundings.
  size_t RefinementsNear(const Vec3& place) const {
    size_t count = 0;
    for (size_t i = 0; i < cones_.size(); ++i)
      count += SquaredDistance(cones_[i].position, place) <= reaches_[i] * reaches_[i];
    return count;
  }
  size_t refinements() const { return cones_.size(); }

 private:
  const GuidanceField* field_;
  std::vector<SizingSample> cones_;
  std::vector<double> reaches_;
};

}  // namespace meshfront
