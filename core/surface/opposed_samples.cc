// A nearest-neighbour search that skips a node when no normal in the box around its samples' normals can be opposed. Rejected: the
// search alone; where edges are long it looked at every sample within their reach, a third of the time of the whole job.
#include "core/surface/opposed_samples.h"

#include <algorithm>
#include <limits>

#include "core/surface/tolerances.h"

namespace meshfront {
namespace {

using namespace surface_tolerances;

// The least that n·v is for any v in the box.
double LeastDot(const Vec3& n, const Box3& box) {
  double least = 0;
  for (int axis = 0; axis < 3; ++axis) least += std::min(n[axis] * box.min[axis], n[axis] * box.max[axis]);
  return least;
}

}  // namespace

// Children come after their parent.
OpposedSamples::OpposedSamples(const MlsSamples& samples) : samples_(samples), normals_(samples.tree().nodes().size()) {
  const PointTree& tree = samples.tree();
  for (size_t at = normals_.size(); at-- > 0;) {
    const PointTree::Node& node = tree.nodes()[at];
    if (node.is_leaf()) {
      for (uint32_t i = node.begin; i < node.end; ++i) normals_[at].Extend(samples.samples()[tree.order()[i]].normal);
    } else {
      for (const size_t child : {at + 1, static_cast<size_t>(node.right)})
        normals_[at].Extend(normals_[child].min), normals_[at].Extend(normals_[child].max);
    }
  }
}

double OpposedSamples::DistanceFrom(uint32_t sample, double limit) const {
  const MlsSample& s = samples_.samples()[sample];
  const auto is_opposed = [&](uint32_t i) {
    return samples_.ComponentOf(i) != MlsSamples::kStray && Dot(samples_.samples()[i].normal, s.normal) < kOpposed;
  };
  const uint32_t found = samples_.tree().FindNearest(s.position, limit * limit, is_opposed, [&](uint32_t node) {
    return LeastDot(s.normal, normals_[node]) < kOpposed + kDotSlack;
  });
  return found == PointTree::kNone ? std::numeric_limits<double>::infinity()
                                   : Distance(samples_.samples()[found].position, s.position);
}

}  // namespace meshfront
