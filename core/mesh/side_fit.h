// A quadric over a plane, fitted to samples on one side of an edge, and where several of them meet.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "absl/types/span.h"
#include "core/geometry/vec3.h"

namespace meshfront {

// The height of a place over c0 + c1 a + c2 b + c3 a² + c4 ab + c5 b², lengths in parts of `radius` from `origin`.
struct SideFit {
  Vec3 origin, u, v, normal;  // orthonormal
  double radius = 1;
  std::array<double, 6> c{};
  double residual2 = 0;  // weighted sum of the squared heights of the samples that were fitted
  double weight = 0;     // of all of them

  double HeightAt(const Vec3& x) const;
  Vec3 GradientAt(const Vec3& x) const;  // of the height, not of unit length
};

// Weighted least squares; samples count up to `radius` from x, near ones most. Of the normals only the mean is used, as the
// direction of heights. A plane where a bend does not stand clear of the noise, and with fewer than 12 samples. A hint of a ridge keeps
// narrow strips from bending.
SideFit FitSide(const Vec3& x, double radius, absl::Span<const Vec3> positions, absl::Span<const Vec3> normals,
                absl::Span<const uint32_t> samples);

// The place near x where all the fits, 1 to 3, are zero; none where they are almost parallel there or it is farther than `reach`.
std::optional<Vec3> FindMeeting(absl::Span<const SideFit* const> fits, const Vec3& x, double reach);

}  // namespace meshfront
