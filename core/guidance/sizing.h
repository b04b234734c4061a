// Every formula of the guidance field, eq. 2–8, once.
#pragma once

#include "core/geometry/vec3.h"

namespace meshfront {

// A place and the ideal edge length there: what the guidance field is made of.
struct SizingSample {
  Vec3 position;
  double ideal_length = 0;  // > 0, may be +infinity (flat)
};

// l = 2 sin(rho/2) / max_curvature: the edge that subtends the angle rho on the osculating circle (sec. 3). +infinity at
// curvature 0.
double IdealLength(double rho, double max_curvature);
// The angle that an edge of `length` subtends at curvature `max_curvature`: 2 asin(length κ / 2), clamped to [0, 2π/3].
double SubtendedAngle(double length, double max_curvature);
// ξ(rho), eq. 6: the distance bound per unit of edge length; 0 at rho = 0, 1/√3 at rho = 2π/3.
double ErrorPerLength(double rho);
// ε = length ξ(SubtendedAngle(length, κ)), eq. 7 and 8.
double ErrorBound(double length, double max_curvature);
// The edge length whose eq. 7 bound is `error` at `max_curvature`: √(6ε/κ − 3ε²) for εκ ≤ 1, √3/κ beyond; +infinity at κ = 0.
double LengthForError(double error, double max_curvature);
// ĝ(d) = (1 − 1/η) d + l/η, eq. 5.
inline double GradedLength(double distance, double ideal_length, double eta) {
  return (1 - 1 / eta) * distance + ideal_length / eta;
}

}  // namespace meshfront
