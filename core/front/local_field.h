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
    for (const SizingSample& s : cones_) g = std::min(g, GradedLength(Distance(s.position, x), s.ideal_length, field_->eta()));
    return std::max(g, field_->options().min_length);
  }
  // From now on g(place) ≤ length.
  void Refine(const Vec3& place, double length) { cones_.push_back({place, length * field_->eta()}); }
  // How often the surroundings of `place` were refined.
  size_t RefinementsNear(const Vec3& place, double radius) const {
    return std::count_if(cones_.begin(), cones_.end(),
                         [&](const SizingSample& s) { return SquaredDistance(s.position, place) <= radius * radius; });
  }
  size_t refinements() const { return cones_.size(); }

 private:
  const GuidanceField* field_;
  std::vector<SizingSample> cones_;
};

}  // namespace meshfront
