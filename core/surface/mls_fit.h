// The original moving-least-squares fit at a place: a plane through the samples around it, and a polynomial over the
// plane.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "absl/types/span.h"
#include "core/geometry/jet.h"
#include "core/geometry/vec3.h"
#include "core/surface/mls_samples.h"

namespace meshfront {

// A sample near the place x of a fit, as seen from there.
struct MlsNear {
  Vec3 d;  // p − x
  double inverse_squared_support;
};

// The plane with unit normal n through q = x + t n that makes Σ w_i (n·(p_i − q))² least, w_i = (1 − |p_i − q|²/h_i²)⁴,
// and the polynomial g over it that makes Σ w_i (g(p_i) − n·(p_i − q))² least. x is projected to q + g(0, 0) n.
struct MlsFit {
  // 2: cubic terms change neither g(0, 0) nor its slope where samples lie evenly, and need twice as many samples.
  static constexpr int kDegree = 2;
  static constexpr int kTerms = (kDegree + 1) * (kDegree + 2) / 2;

  Vec3 normal, u, v;                        // orthonormal; the polynomial's axes
  double t = 0;                             // q over x along the normal
  double unit = 0;                          // the polynomial's arguments are in parts of it: the mean support
  std::array<double, kTerms> polynomial{};  // 1, a, b, a², ab, b²
  std::array<double, 6> inverse_bend{};  // of the energy's second derivatives by turns along u, v and by t: upper half
  std::array<double, kTerms * kTerms> gram{};  // Σ w φ φᵀ of the polynomial's terms, its upper half

  // The distance of x from where it is projected to, negative inside: 0 on the surface.
  double SignedDistance() const { return -(t + polynomial[0]); }
};

// The samples of the patch's list that may have a say at x or a little above or below.
void FindNearSamples(const MlsSamples& samples, const Vec3& x, uint32_t patch, std::vector<MlsNear>& near);

// Newton's method for the plane from the one given, which must be close, then linear least squares. Leaves of `near` what
// has a say. Nothing where the samples are too few, or where that plane is no minimum near x. 2 µs.
std::optional<MlsFit> FitPolynomial(std::vector<MlsNear>& near, double support, const Vec3& normal, double t);

// SignedDistance with its derivatives by x: those of the minima that the fit is. `near` are the fit's.
template <int kOrder>
Jet<kOrder> DeriveSignedDistance(absl::Span<const MlsNear> near, const MlsFit& fit);

}  // namespace meshfront
