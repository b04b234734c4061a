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

  // g, and whether a refinement is what decides there.
  struct Value {
    double length;
    bool is_refined;
  };
  Value ValueAt(const Vec3& x) const {
    const double unrefined = field_->At(x);
    double g = unrefined;
    for (const SizingSample& s : cones_)
      g = std::min(g, GradedLength(Distance(s.position, x), s.ideal_length, field_->eta()));
    g = std::max(g, field_->options().min_length);
    return {g, g < unrefined};
  }
  double At(const Vec3& x) const { return ValueAt(x).length; }
  // From now on g(place) ≤ length. The surroundings of the place are what lies within `reach`.
  void Refine(const Vec3& place, double length, double reach) {
    cones_.push_back({place, length * field_->eta()});
    reaches_.push_back(reach);
  }
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
