#include "core/features/curve.h"

#include <algorithm>
#include <utility>

namespace meshfront {

Curve::Curve(std::vector<Vec3> vertices, bool closed) : vertices_(std::move(vertices)), closed_(closed) {
  arcs_.resize(size() + 1);
  for (size_t i = 0; i < size(); ++i) arcs_[i + 1] = arcs_[i] + Distance(vertices_[i], (*this)[i + 1]);
}

double Curve::ArcAt(const CurvePoint& p) const {
  const size_t i = p.segment % size();
  return ArcOfVertex(p.segment) + p.t * (arcs_[i + 1] - arcs_[i]);
}

CurvePoint Curve::PointAtArc(double arc) const {
  size_t rounds = 0;
  while (closed_ && arc >= length() && rounds < 2) arc -= length(), ++rounds;
  const size_t after = std::upper_bound(arcs_.begin(), arcs_.end(), arc) - arcs_.begin();
  const size_t i = std::min(after > 0 ? after - 1 : 0, size() - 1);
  const double edge = arcs_[i + 1] - arcs_[i];
  const double t = edge > 0 ? (arc - arcs_[i]) / edge : 0;
  if (t >= 1) return {static_cast<uint32_t>(i + 1 + rounds * size()), 0};
  return {static_cast<uint32_t>(i + rounds * size()), std::max(t, 0.0)};
}

}  // namespace meshfront
